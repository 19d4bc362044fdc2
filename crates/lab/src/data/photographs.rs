//! Folders of photographs, and a view of the hand model that is framed as they are.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use glam::DVec3;
use image::RgbImage;
use phalanx::WORKING_SIZE;
use phalanx_camera::{Camera, Intrinsics, Rig};
use phalanx_segmentation::downsample;
use rayon::prelude::*;

use crate::files;

/// From the wrist to a little beyond the fingertips.
const HAND_MM: f64 = 195.0;

/// The top camera of the desk, aimed and zoomed so that the hand and so much of the forearm fill
/// its width.
pub(crate) fn framed(forearm_mm: f64) -> Result<Rig> {
    let mut rig = files::rig(None)?.select(&["top"])?;
    let top = &rig.cameras[0];
    let middle = DVec3::new(0.0, 0.0, 0.5 * (HAND_MM - forearm_mm));
    let position = DVec3::new(0.0, top.centre().y, middle.z);
    let intrinsics = top.intrinsics;
    let (width, height) = (intrinsics.width, intrinsics.height);
    let focal = f64::from(width) * position.y / (HAND_MM + forearm_mm);
    let intrinsics = Intrinsics::pinhole(width, height, focal);
    rig.cameras[0] = Camera::look_at(&top.name, intrinsics, position, middle, DVec3::X)?;
    Ok(rig)
}

/// All photographs below a folder with their names, in order; large ones at the working size.
/// What cannot be read is named on standard error and left out.
pub(crate) fn below(folder: &Path) -> Result<Vec<(String, RgbImage)>> {
    let mut paths = Vec::new();
    collect(folder, &mut paths)?;
    paths.sort();
    let load = |path: &PathBuf| -> Result<(String, RgbImage)> {
        let image = image::open(path).with_context(|| path.display().to_string())?.to_rgb8();
        let name = path.strip_prefix(folder).unwrap_or(path).display().to_string();
        let (width, height) = WORKING_SIZE;
        if image.width() > width && image.height() > height {
            return Ok((name, downsample(&image, width, height)?));
        }
        Ok((name, image))
    };
    let loaded: Vec<_> = paths.par_iter().map(load).collect();
    let readable = loaded.into_iter().filter_map(|photograph| {
        photograph.inspect_err(|error| eprintln!("left out: {error:#}")).ok()
    });
    let photographs: Vec<_> = readable.collect();
    if photographs.is_empty() {
        bail!("{}: no photographs", folder.display());
    }
    Ok(photographs)
}

fn collect(folder: &Path, paths: &mut Vec<PathBuf>) -> Result<()> {
    let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    for entry in entries {
        let path = entry.with_context(|| folder.display().to_string())?.path();
        let extension = path.extension().map(std::ffi::OsStr::to_ascii_lowercase);
        if path.is_dir() {
            collect(&path, paths)?;
        } else if extension
            .is_some_and(|extension| ["jpg", "jpeg", "png"].iter().any(|known| extension == *known))
        {
            paths.push(path);
        }
    }
    Ok(())
}
