//! The pictures that a take was made of.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use image::{DynamicImage, imageops::FilterType};
use phalanx_camera::{Camera, Rig};
use phalanx_io::take::Take;

use crate::recording::assign::{assign, names};
use crate::recording::timeline::{Moment, Timeline};
use crate::recording::{Recording, Stamp, check_shape, open, timestamps};

/// Wider pictures are made smaller, px.
const WIDEST: u32 = 640;

/// One camera's recording.
pub(super) struct Filmed {
    /// The camera, its image as large as pictures are shown.
    pub(super) camera: Camera,
    /// As it was calibrated.
    calibrated: Camera,
    recording: Box<dyn Recording>,
    /// Where it is.
    pub(super) path: PathBuf,
    /// The number of the camera's frame at each moment.
    frames: Vec<Option<usize>>,
}

/// Frames' times are written with six decimals; frames are farther apart than this, s.
const SAME: f64 = 1e-3;

/// Opens the recordings of the cameras that the take has, matched as they were when it was made.
///
/// # Errors
/// No recording of the take's cameras, one that cannot be opened, moments that are not the take's.
pub(super) fn open_all(
    take: &Take,
    rig: &Rig,
    recordings: &[String],
    timestamps: Option<&Path>,
) -> Result<Vec<Filmed>> {
    let views = &take.header.views;
    let assigned = assign(&rig.cameras, recordings, "recordings")?;
    let both = rig.cameras.iter().zip(assigned);
    let both = both.filter_map(|(camera, path)| Some((camera.clone(), path?)));
    let (cameras, paths): (Vec<Camera>, Vec<PathBuf>) =
        both.filter(|(camera, _)| views.contains(&camera.name)).unzip();
    for view in views.iter().filter(|view| cameras.iter().all(|camera| camera.name != **view)) {
        eprintln!("phalanx: camera '{view}' of the take has no recording here and is left out");
    }
    ensure!(
        !cameras.is_empty(),
        "none of the take's cameras ({}) has a recording; the rig's cameras are {}: is it another take's rig?",
        views.join(", "),
        names(&rig.cameras)
    );
    let times = timestamps::of_cameras(timestamps, &cameras)?;
    let recordings: Vec<Box<dyn Recording>> =
        paths.iter().map(|path| open(path)).collect::<Result<_>>()?;
    let own = recordings.iter().zip(&cameras).zip(&times);
    let stamps = own.map(|((recording, camera), times)| {
        timestamps::stamped(recording.stamps(), camera, times.as_deref())
    });
    let stamps: Vec<Cow<'_, [Stamp]>> = stamps.collect::<Result<_>>()?;
    let stamps: Vec<&[Stamp]> = stamps.iter().map(AsRef::as_ref).collect();
    let moments = Timeline::new(&stamps).moments;
    check(take, &moments)?;
    let filmed = recordings.into_iter().zip(paths).zip(&cameras).enumerate();
    let filmed = filmed.map(|(view, ((recording, path), camera))| {
        let frames = moments.iter().map(|moment| moment.frames[view]).collect();
        Filmed { camera: shown(camera), calibrated: camera.clone(), recording, path, frames }
    });
    Ok(filmed.collect())
}

/// Whether the take's frames are of these moments.
fn check(take: &Take, moments: &[Moment]) -> Result<()> {
    for frame in &take.frames {
        let moment = usize::try_from(frame.index).ok().and_then(|index| moments.get(index));
        let Some(time) = moment.and_then(|moment| moment.time) else { continue };
        ensure!(
            (time - frame.time).abs() < SAME,
            "frame {} was at {:.3} s when the take was made, but at {time:.3} s in this recording: is it \
             another, or were other --timestamps given?",
            frame.index,
            frame.time
        );
    }
    let by_clock = take.header.rate_hz.is_none();
    ensure!(
        !by_clock || moments.iter().all(|moment| moment.time.is_some()),
        "the take's frames have times that this recording lacks: give the --timestamps that it was made with"
    );
    Ok(())
}

impl Filmed {
    /// The picture of a take's frame, which comes after the last one that was asked for; `None` where the
    /// camera has none.
    ///
    /// # Errors
    /// A picture that cannot be read.
    pub(super) fn picture(&mut self, index: u64) -> Result<Option<DynamicImage>> {
        let moment = usize::try_from(index).ok().and_then(|moment| self.frames.get(moment));
        let Some(frame) = moment.copied().flatten() else { return Ok(None) };
        let (width, height) = self.size();
        let picture = self.recording.read(frame)?;
        check_shape(&picture, &self.calibrated).with_context(|| {
            format!("{}, frame {}", self.path.display(), self.recording.stamps()[frame].name)
        })?;
        Ok(Some(picture.resize_exact(width, height, FilterType::Triangle)))
    }

    /// Width and height of the pictures, px.
    pub(super) fn size(&self) -> (u32, u32) {
        (self.camera.intrinsics.width, self.camera.intrinsics.height)
    }
}

/// The camera with an image that is not too wide.
fn shown(camera: &Camera) -> Camera {
    let size = |length: u32| (length * WIDEST).div_ceil(camera.intrinsics.width.max(WIDEST));
    let [width, height] = [camera.intrinsics.width, camera.intrinsics.height].map(size);
    camera.with_intrinsics(camera.intrinsics.resized(width, height))
}
