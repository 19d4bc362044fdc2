//! `phalanx view`.

mod film;
mod footage;
mod label;
mod overlay;

use std::num::NonZeroUsize;
use std::path::PathBuf;

use anyhow::{Result, bail, ensure};
use clap::Args;
use glam::DVec2;
use image::codecs::jpeg::JpegEncoder;
use phalanx_cli::files::Output;
use phalanx_io::page::{ViewPicture, ViewPictures, view_page};
use phalanx_io::take::{Take, TakeFrame};
use phalanx_segmentation::Contour;

use crate::counts::counted;
use crate::rig::check;
use crate::take_file;
use footage::Filmed;

/// More pictures make a page that browsers open slowly; of more some are taken, evenly spaced.
const MOST_PICTURES: usize = 600;
/// The quality of the pictures in the page, of 100.
const JPEG_QUALITY: u8 = 75;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The take: .csv, .jsonl or .npz.
    #[arg(value_name = "TAKE")]
    take: PathBuf,
    /// The recording that was tracked: a folder that holds a folder of pictures or a video for each camera, named
    /// like it. Given once for each camera, one recording each, in the order of the rig or as CAMERA=PATH.
    #[arg(long, value_name = "RECORDING", requires = "rig")]
    frames: Vec<String>,
    /// When the recording's frames were taken, as `track` was told.
    #[arg(long, value_name = "FILE.csv", requires = "frames")]
    timestamps: Option<PathBuf>,
    /// The cameras, to draw the estimated hand over their pictures.
    #[arg(long, value_name = "RIG.toml", requires = "frames")]
    rig: Option<PathBuf>,
    /// Where it goes: .html makes a page. With --frames, .png makes a sheet of frames with the hand's outline over
    /// the pictures, and .mp4 or .mkv a video of them, if ffmpeg is installed.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// How many frames it is from one to the next on a sheet (12 in all by default) or in a video (1).
    #[arg(long, value_name = "N")]
    every: Option<NonZeroUsize>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let kind = take_file::extension(&arguments.out);
    ensure!(
        ["html", "png", "mp4", "mkv"].contains(&kind.as_str()),
        "{}: the name must end with .html for a page, .png for a sheet, .mp4 or .mkv for a video",
        arguments.out.display()
    );
    let take = take_file::read(&arguments.take)?;
    let timestamps = arguments.timestamps.as_deref();
    let mut filmed = match (&*arguments.frames, &arguments.rig) {
        (frames @ [_, ..], Some(rig)) => {
            footage::open_all(&take, &check::read(rig)?, frames, timestamps)?
        }
        _ if kind == "html" => Vec::new(),
        _ => bail!("{}: give --frames and --rig", arguments.out.display()),
    };
    let recordings = filmed.iter().map(|filmed| &filmed.path);
    let files = [&arguments.take].into_iter().chain(&arguments.rig).chain(&arguments.timestamps);
    let output = Output::new(&arguments.out, &recordings.chain(files).collect::<Vec<_>>())?;
    let every = arguments.every.map(NonZeroUsize::get);
    let written = match kind.as_str() {
        "html" => {
            let pictures = pictures(&take, &mut filmed)?;
            let page = view_page(&take, &take_file::name(&arguments.take), &pictures)?;
            output.write(page.as_bytes())?;
            "page"
        }
        "png" => {
            output.write_png(&film::sheet(&take, &mut filmed, every)?)?;
            "sheet"
        }
        _ => {
            film::video(&take, &mut filmed, every.unwrap_or(1), &output)?;
            "video"
        }
    };
    let frames = counted(take.frames.len(), "frame");
    eprintln!("phalanx: a {written} of a take of {frames}; {}", arguments.out.display());
    Ok(())
}

/// The pictures of a page.
fn pictures(take: &Take, filmed: &mut [Filmed]) -> Result<Vec<ViewPictures>> {
    let most = MOST_PICTURES / filmed.len().max(1);
    let step = take.frames.len().div_ceil(most).max(1);
    filmed.iter_mut().map(|own| of_camera(take, own, step)).collect()
}

fn of_camera(take: &Take, filmed: &mut Filmed, step: usize) -> Result<ViewPictures> {
    let (width, height) = filmed.size();
    let mut pictures = Vec::new();
    for (frame, this) in take.frames.iter().enumerate().step_by(step) {
        let Some(picture) = filmed.picture(this.index)? else { continue };
        let mut jpeg = Vec::new();
        let encoder = JpegEncoder::new_with_quality(&mut jpeg, JPEG_QUALITY);
        picture.to_rgb8().write_with_encoder(encoder)?;
        let joints = std::array::from_fn(|joint| {
            filmed.camera.project(this.estimate.as_ref()?.joints[joint])
        });
        let outline = outline(take, this, filmed);
        pictures.push(ViewPicture { frame, jpeg, joints, outline });
    }
    Ok(ViewPictures { name: filmed.camera.name.clone(), width, height, pictures })
}

/// The outline of a frame's estimated hand in a camera's picture.
fn outline(take: &Take, frame: &TakeFrame, filmed: &Filmed) -> Vec<Vec<DVec2>> {
    let Some(mask) = overlay::silhouette(take, frame, &filmed.camera) else { return Vec::new() };
    let piece = |piece: &[[f64; 2]]| piece.iter().copied().map(DVec2::from_array).collect();
    Contour::trace(&mask).pieces().map(piece).collect()
}
