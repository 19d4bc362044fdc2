//! The pictures that a take was made of.

use std::path::Path;

use anyhow::{Result, ensure};
use image::{DynamicImage, imageops::FilterType};
use phalanx_camera::{Camera, Rig};
use phalanx_io::take::Take;

use crate::recording::assign::folders_of;
use crate::recording::timeline::Timeline;
use crate::recording::{Recording, Stamp, open};

/// Wider pictures are made smaller, px.
const WIDEST: u32 = 640;

/// One camera's recording.
pub(super) struct Filmed {
    /// The camera, its image as large as pictures are shown.
    pub(super) camera: Camera,
    recording: Box<dyn Recording>,
    /// The number of the camera's frame at each moment.
    frames: Vec<Option<usize>>,
}

/// Opens the recordings in a folder, of the cameras that the take, the rig and the folder all have.
///
/// # Errors
/// No such camera, a recording that cannot be opened.
pub(super) fn open_all(take: &Take, folder: &Path, rig: &Rig) -> Result<Vec<Filmed>> {
    let views = &take.header.views;
    let cameras = rig.cameras.iter().filter(|camera| views.contains(&camera.name));
    let cameras: Vec<Camera> = cameras.cloned().collect();
    let paths = folders_of(&cameras, folder).unwrap_or_default();
    ensure!(
        !paths.is_empty(),
        "{}: nothing there is named as a camera of the take and the rig ({})",
        folder.display(),
        views.join(", ")
    );
    let both = cameras.into_iter().zip(paths).filter_map(|(camera, path)| Some((camera, path?)));
    let both = both.map(|(camera, path)| Ok((shown(&camera), open(&path)?)));
    let both: Vec<(Camera, Box<dyn Recording>)> = both.collect::<Result<_>>()?;
    let stamps: Vec<&[Stamp]> = both.iter().map(|(_, recording)| recording.stamps()).collect();
    let moments = Timeline::new(&stamps).moments;
    let filmed = both.into_iter().enumerate().map(|(view, (camera, recording))| {
        let frames = moments.iter().map(|moment| moment.frames[view]).collect();
        Filmed { camera, recording, frames }
    });
    Ok(filmed.collect())
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
