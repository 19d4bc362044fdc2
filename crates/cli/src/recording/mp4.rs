//! H.264 video in an MP4 file, decoded without any other program.

use std::collections::VecDeque;
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use image::DynamicImage;
use re_mp4::{Mp4, TrackKind};
use rust_h264::decoder::{Frame, OrderedDecoder};
use rust_h264::nal::{AvccConfig, parse_avcc, parse_avcc_config, parse_sps_info};

use super::yuv::{Colours, Planes};
use super::{Recording, Stamp};
use phalanx_cli::reading;

/// The most bytes that one frame may take in the file.
const MOST_BYTES: u64 = 64 << 20;
/// The most pixels that a frame may have.
const MOST_PIXELS: u64 = 64 << 20;

/// A video whose frames are decoded one after the other.
pub(super) struct Mp4Video {
    file: BufReader<File>,
    samples: Vec<Sample>,
    stamps: Vec<Stamp>,
    length_size: usize,
    colours: Colours,
    decoder: OrderedDecoder<usize>,
    /// The next sample to decode, and whether the decoder's last pictures were taken out.
    next_sample: usize,
    flushed: bool,
    /// Decoded pictures that were not asked for yet, by frame.
    ready: VecDeque<(usize, Frame)>,
}

/// Where a frame's bytes are, in the order of decoding, and which frame it is in the order of showing.
struct Sample {
    offset: u64,
    size: u64,
    frame: usize,
}

impl Mp4Video {
    pub(super) fn open(path: &Path) -> Result<Self> {
        let file = reading::open(path)?;
        let size = file.metadata()?.len();
        let mut file = BufReader::new(file);
        let mp4 = Mp4::read(&mut file, size).map_err(|error| anyhow::anyhow!("{error}"))?;
        let track = mp4.tracks().values().find(|track| track.kind == Some(TrackKind::Video));
        let track = track.context("it holds no video")?;
        let codec = track.codec_string(&mp4).unwrap_or_default();
        ensure!(codec.starts_with("avc"), "its codec is '{codec}', not H.264");
        let config = track.raw_codec_config(&mp4).context("it lacks the decoder's settings")?;
        let config = parse_avcc_config(&config).map_err(anyhow::Error::msg)?;
        let mut decoder = OrderedDecoder::new();
        for nal in config.sps_nals.iter().chain(&config.pps_nals) {
            decoder.decode_nal_with_meta(nal, 0)?;
        }
        let mut order: Vec<usize> = (0..track.samples.len()).collect();
        order.sort_by_key(|&k| track.samples[k].composition_timestamp);
        let mut frame_of = vec![0; order.len()];
        order.iter().enumerate().for_each(|(frame, &sample)| frame_of[sample] = frame);
        let stamp = |(frame, &sample): (usize, &usize)| {
            let sample = &track.samples[sample];
            let time = sample.composition_timestamp as f64 / sample.timescale.max(1) as f64;
            Stamp { name: frame.to_string(), time: Some(time) }
        };
        let samples = track.samples.iter().zip(frame_of);
        Ok(Self {
            stamps: order.iter().enumerate().map(stamp).collect(),
            samples: samples
                .map(|(sample, frame)| Sample { offset: sample.offset, size: sample.size, frame })
                .collect(),
            length_size: config.length_size,
            colours: colours(&config)?,
            file,
            decoder,
            next_sample: 0,
            flushed: false,
            ready: VecDeque::new(),
        })
    }

    /// Decodes until there is another picture; false at the end.
    fn advance(&mut self) -> Result<bool> {
        let Some(sample) = self.samples.get(self.next_sample) else {
            let rest = if self.flushed { Vec::new() } else { self.decoder.flush_with_meta() };
            self.flushed = true;
            let more = !rest.is_empty();
            self.ready.extend(rest.into_iter().map(|(picture, frame)| (frame, picture)));
            return Ok(more);
        };
        self.next_sample += 1;
        ensure!(sample.size <= MOST_BYTES, "frame {} is larger than 64 MiB", sample.frame);
        let mut bytes = vec![0; sample.size as usize];
        self.file.seek(SeekFrom::Start(sample.offset))?;
        self.file.read_exact(&mut bytes).context("the file ends within a frame")?;
        for nal in parse_avcc(&bytes, self.length_size) {
            let pictures = self.decoder.decode_nal_with_meta(&nal, sample.frame)?;
            self.ready.extend(pictures.into_iter().map(|(picture, frame)| (frame, picture)));
        }
        Ok(true)
    }
}

impl Recording for Mp4Video {
    fn stamps(&self) -> &[Stamp] {
        &self.stamps
    }

    fn read(&mut self, frame: usize) -> Result<DynamicImage> {
        loop {
            while let Some((found, picture)) = self.ready.pop_front() {
                if found == frame {
                    return to_rgb(&picture, self.colours);
                }
                if found > frame {
                    self.ready.push_front((found, picture));
                    bail!("the video does not hold frame {frame}: it may be damaged there");
                }
            }
            ensure!(self.advance()?, "the video ends before frame {frame}");
        }
    }
}

/// How the stream says that its colours are meant; a picture that is too large is refused here.
fn colours(config: &AvccConfig<'_>) -> Result<Colours> {
    let sps = config.sps_nals.first().context("it lacks the decoder's settings")?;
    let info = parse_sps_info(sps)?;
    let pixels = u64::from(info.coded_width) * u64::from(info.coded_height);
    ensure!(
        pixels <= MOST_PIXELS,
        "its frames of {}×{} px are larger than 64 megapixels",
        info.width,
        info.height
    );
    Ok(Colours::new(info.matrix, info.full_range, info.height))
}

fn to_rgb(picture: &Frame, colours: Colours) -> Result<DynamicImage> {
    ensure!(picture.bit_depth == 8, "its colours have {} bits, not 8", picture.bit_depth);
    let planes = Planes {
        size: (picture.width, picture.height),
        chroma_height: picture.chroma_height(),
        luma: &picture.y,
        blue_difference: &picture.u,
        red_difference: &picture.v,
    };
    Ok(DynamicImage::ImageRgb8(planes.to_rgb(colours)))
}
