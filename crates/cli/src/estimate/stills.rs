//! The frames that are estimated, each on its own.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use phalanx_camera::Camera;

use crate::recording::assign::{assign, named};
use crate::recording::pictures::PictureFolder;
use crate::recording::timeline::{Moment, Timeline};
use crate::recording::{Recording, Stamp};

/// What is given in place of a picture that there is not.
const NO_PICTURE: &str = "-";

/// A frame: the pictures of the cameras.
pub(super) struct Still {
    /// What the frame is called where there are several.
    pub(super) name: String,
    /// The cameras' pictures, in their order; `None` of a camera that has none of this frame.
    pub(super) paths: Vec<Option<PathBuf>>,
}

/// The frames of what was given: of files a picture per camera, frame after frame; of files by the cameras'
/// names one frame; of folders, by their names or not, the pictures that have one name.
///
/// # Errors
/// A folder that cannot be read or is no camera's.
pub(super) fn stills(cameras: &[Camera], given: &[PathBuf]) -> Result<Vec<Still>> {
    let texts: Vec<String> = given.iter().map(|path| path.display().to_string()).collect();
    if given.iter().all(|path| path.is_dir()) {
        return in_folders(&assign(cameras, &texts, "pictures")?);
    }
    if texts.iter().any(|text| named(cameras, text).is_some()) {
        let paths = assign(cameras, &texts, "pictures")?;
        if paths.iter().flatten().all(|path| path.is_dir()) {
            return in_folders(&paths);
        }
        return Ok(vec![Still { name: "1".to_owned(), paths }]);
    }
    // Another number of pictures than cameras is the estimator's to refuse.
    let each = if given.len().is_multiple_of(cameras.len()) { cameras.len() } else { given.len() };
    let picture = |path: &PathBuf| (path != Path::new(NO_PICTURE)).then(|| path.clone());
    let still = |(number, paths): (usize, &[PathBuf])| Still {
        name: (number + 1).to_string(),
        paths: paths.iter().map(picture).collect(),
    };
    Ok(given.chunks(each).enumerate().map(still).collect())
}

/// The frames of the cameras' folders; a camera without a folder has no pictures.
fn in_folders(folders: &[Option<PathBuf>]) -> Result<Vec<Still>> {
    let open = |folder: &PathBuf| {
        PictureFolder::open(folder).with_context(|| folder.display().to_string())
    };
    let folders = folders.iter().map(|folder| folder.as_ref().map(open).transpose());
    let folders: Vec<Option<PictureFolder>> = folders.collect::<Result<_>>()?;
    let opened = folders.iter().map(Option::as_ref);
    let stamps: Vec<&[Stamp]> =
        opened.map(|folder| folder.map_or(&[][..], Recording::stamps)).collect();
    let still = |moment: Moment| {
        let frames = moment.frames.iter().zip(&folders);
        let named =
            frames.clone().find_map(|(frame, folder)| Some(&folder.as_ref()?.stamps()[(*frame)?]));
        Still {
            name: named.map_or_else(String::new, |stamp| stamp.name.clone()),
            paths: frames.map(|(frame, folder)| Some(folder.as_ref()?.path((*frame)?))).collect(),
        }
    };
    Ok(Timeline::new(&stamps).moments.into_iter().map(still).collect())
}
