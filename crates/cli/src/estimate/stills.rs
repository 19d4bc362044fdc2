//! The frames that are estimated, each on its own.

use std::path::PathBuf;

use anyhow::{Context, Result};
use phalanx_camera::Camera;

use crate::recording::assign::assign;
use crate::recording::pictures::PictureFolder;
use crate::recording::timeline::{Moment, Timeline};
use crate::recording::{Recording, Stamp};

/// A frame: a picture of each camera.
pub(super) struct Still {
    /// What the frame is called where there are several.
    pub(super) name: String,
    /// The cameras' pictures, in their order; `None` of a camera that has none of this frame.
    pub(super) paths: Vec<Option<PathBuf>>,
}

/// The frames of what was given: of files a picture per camera, frame after frame; of folders the pictures
/// that have one name.
///
/// # Errors
/// A folder that cannot be read or is no camera's.
pub(super) fn stills(cameras: &[Camera], given: &[PathBuf]) -> Result<Vec<Still>> {
    if given.iter().all(|path| path.is_dir()) {
        return in_folders(cameras, given);
    }
    // Another number of pictures than cameras is the estimator's to refuse.
    let each = if given.len().is_multiple_of(cameras.len()) { cameras.len() } else { given.len() };
    let still = |(number, paths): (usize, &[PathBuf])| Still {
        name: (number + 1).to_string(),
        paths: paths.iter().cloned().map(Some).collect(),
    };
    Ok(given.chunks(each).enumerate().map(still).collect())
}

fn in_folders(cameras: &[Camera], given: &[PathBuf]) -> Result<Vec<Still>> {
    let given: Vec<String> = given.iter().map(|path| path.display().to_string()).collect();
    let mut folders = Vec::new();
    for (camera, folder) in cameras.iter().zip(assign(cameras, &given)?) {
        let folder =
            folder.with_context(|| format!("there is no folder for camera '{}'", camera.name))?;
        let name = || folder.display().to_string();
        folders.push(PictureFolder::open(&folder).with_context(name)?);
    }
    let stamps: Vec<&[Stamp]> = folders.iter().map(Recording::stamps).collect();
    let still = |moment: Moment| {
        let frames = moment.frames.iter().zip(&folders);
        let named = frames.clone().find_map(|(frame, folder)| Some(&folder.stamps()[(*frame)?]));
        Still {
            name: named.map_or_else(String::new, |stamp| stamp.name.clone()),
            paths: frames.map(|(frame, folder)| Some(folder.path((*frame)?))).collect(),
        }
    };
    Ok(Timeline::new(&stamps).moments.into_iter().map(still).collect())
}
