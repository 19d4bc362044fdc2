//! The frames of all cameras.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use image::RgbImage;
use phalanx_camera::Rig;

/// One moment in all views.
pub(super) struct Frame {
    pub(super) name: String,
    pub(super) images: Vec<RgbImage>,
}

/// All frames that the first camera has, in order: `<camera>/<frame>.jpg`.
pub(super) fn read(folder: &Path, rig: &Rig) -> Result<Vec<Frame>> {
    let first = folder.join(&rig.cameras[0].name);
    let entries = std::fs::read_dir(&first).with_context(|| first.display().to_string())?;
    let mut names = Vec::new();
    for entry in entries {
        names.push(entry?.file_name().to_string_lossy().into_owned());
    }
    names.sort();
    names.iter().map(|name| frame(folder, rig, name)).collect()
}

fn frame(folder: &Path, rig: &Rig, file: &str) -> Result<Frame> {
    let image = |camera: &phalanx_camera::Camera| -> Result<RgbImage> {
        let path = folder.join(&camera.name).join(file);
        let image = image::open(&path).with_context(|| path.display().to_string())?.to_rgb8();
        let expected = (camera.intrinsics.width, camera.intrinsics.height);
        let found = image.dimensions();
        ensure!(found == expected, "{}: {found:?} px, not {expected:?}", path.display());
        Ok(image)
    };
    let images = rig.cameras.iter().map(image).collect::<Result<_>>()?;
    let name = Path::new(file).file_stem().map_or(file.into(), |stem| stem.to_string_lossy());
    Ok(Frame { name: name.into_owned(), images })
}
