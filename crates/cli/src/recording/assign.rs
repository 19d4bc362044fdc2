//! Which recording is which camera's.

use std::path::{Path, PathBuf};

use crate::counts::counted;
use anyhow::{Context, Result, bail, ensure};
use phalanx_camera::Camera;

/// So many of the names in a folder are said.
const NAMED: usize = 4;

/// The recording, or what else `things` are, of each camera of a rig, in its order; `None` for a camera that
/// has none.
///
/// # Errors
/// More recordings than cameras, a name that no camera has, two recordings of one camera.
pub(crate) fn assign(
    cameras: &[Camera],
    recordings: &[String],
    things: &str,
) -> Result<Vec<Option<PathBuf>>> {
    let names = || names(cameras);
    if let [folder] = recordings
        && cameras.len() > 1
        && named(cameras, folder).is_none()
    {
        if let Some((name, path)) = folder.split_once('=').filter(|_| !Path::new(folder).exists()) {
            bail!("{name}={path}: the rig has no camera '{name}'; its cameras are {}", names());
        }
        ensure!(Path::new(folder).exists(), "{folder}: there is no such file or folder");
        ensure!(
            Path::new(folder).is_dir(),
            "{folder}: this is one camera's; give the {things} of all {} cameras in the order {}, or say whose it \
             is: {}=PATH",
            cameras.len(),
            names(),
            cameras[0].name
        );
        let found = folders_of(cameras, Path::new(folder));
        return found.with_context(|| {
            format!(
                "{folder}: nothing in it is named after a camera ({}): {}; name what it holds like the cameras, or say whose \
                 each of the {things} is, as {}=PATH",
                names(),
                held(Path::new(folder)),
                cameras[0].name
            )
        });
    }
    ensure!(
        recordings.len() <= cameras.len(),
        "{} {things} for the {} of the rig ({})",
        recordings.len(),
        counted(cameras.len(), "camera"),
        names()
    );
    let mut assigned = vec![None; cameras.len()];
    let is_named = recordings.iter().all(|recording| named(cameras, recording).is_some());
    ensure!(
        is_named || recordings.len() == cameras.len(),
        "{} {things} for {} cameras ({}): name those that are there, as {}=PATH; the others are left out",
        recordings.len(),
        cameras.len(),
        names(),
        cameras[0].name
    );
    for (k, recording) in recordings.iter().enumerate() {
        let (camera, path) =
            if is_named { named(cameras, recording).context("named")? } else { (k, &**recording) };
        if assigned[camera].replace(PathBuf::from(path)).is_some() {
            bail!("camera '{}' is given twice", cameras[camera].name);
        }
    }
    Ok(assigned)
}

/// The names of cameras.
pub(crate) fn names(cameras: &[Camera]) -> String {
    cameras.iter().map(|camera| camera.name.as_str()).collect::<Vec<_>>().join(", ")
}

/// What a folder holds, in words, the first few by name.
fn held(folder: &Path) -> String {
    let mut names: Vec<String> = entries(folder)
        .iter()
        .filter_map(|path| Some(path.file_name()?.to_string_lossy().into_owned()))
        .collect();
    names.sort();
    let more = if names.len() > NAMED { ", …" } else { "" };
    names.truncate(NAMED);
    if names.is_empty() {
        "it is empty".to_owned()
    } else {
        format!("it holds {}{more}", names.join(", "))
    }
}

/// The files and folders in a folder; none of one that cannot be read.
fn entries(folder: &Path) -> Vec<PathBuf> {
    let read = std::fs::read_dir(folder);
    read.map(|read| read.filter_map(|entry| Some(entry.ok()?.path())).collect()).unwrap_or_default()
}

/// A recording as `NAME=PATH`: the number of the camera, and the path.
pub(crate) fn named<'a>(cameras: &[Camera], recording: &'a str) -> Option<(usize, &'a str)> {
    let (name, path) = recording.split_once('=')?;
    Some((cameras.iter().position(|camera| camera.name == name)?, path))
}

/// What a folder holds for each camera: a folder or a file of its name; `None` where it holds nothing for any.
fn folders_of(cameras: &[Camera], folder: &Path) -> Option<Vec<Option<PathBuf>>> {
    let entries = entries(folder);
    let of = |camera: &Camera| {
        let mut own = entries.iter().filter(|path| {
            let name = if path.is_dir() { path.file_name() } else { path.file_stem() };
            name.is_some_and(|name| name.to_string_lossy() == camera.name)
        });
        own.next().cloned()
    };
    let found: Vec<Option<PathBuf>> = cameras.iter().map(of).collect();
    found.iter().any(Option::is_some).then_some(found)
}

#[cfg(test)]
mod tests {
    use phalanx_camera::Rig;

    use super::*;

    fn cameras() -> Vec<Camera> {
        Rig::from_toml(include_str!("../../fixtures/desk.toml")).unwrap().cameras
    }

    fn assigned(recordings: &[&str]) -> Result<Vec<Option<PathBuf>>> {
        let recordings: Vec<String> = recordings.iter().map(|&text| text.to_owned()).collect();
        assign(&cameras(), &recordings, "recordings")
    }

    #[test]
    fn recordings_go_by_order_or_by_name() {
        let [a, b, c] = ["a.mp4", "b.mp4", "c.mp4"].map(|path| Some(PathBuf::from(path)));
        let in_order = assigned(&["a.mp4", "b.mp4", "c.mp4"]).unwrap();
        assert_eq!(in_order, [a.clone(), b, c.clone()]);
        let names: Vec<String> = cameras().into_iter().map(|camera| camera.name).collect();
        let (first, last) = (format!("{}=a.mp4", names[0]), format!("{}=c.mp4", names[2]));
        assert_eq!(assigned(&[&last, &first]).unwrap(), [a, None, c]);
        for wrong in [&["a"; 4][..], &["a", "b"], &[&first, &first]] {
            assert!(assigned(wrong).is_err(), "{wrong:?}");
        }
        let refusal = |path: &str| assigned(&[path]).unwrap_err().to_string();
        assert_eq!(refusal("nowhere"), "nowhere: there is no such file or folder");
        let said = refusal("nobody=a.mp4");
        assert!(
            said.starts_with("nobody=a.mp4: the rig has no camera 'nobody'; its cameras are "),
            "{said}"
        );
        let video = tempfile::NamedTempFile::new().unwrap();
        let said = refusal(&video.path().display().to_string());
        assert!(said.contains("give the recordings of all 3 cameras in the order"), "{said}");
        let empty = tempfile::tempdir().unwrap();
        let said = refusal(&empty.path().display().to_string());
        assert!(said.contains("nothing in it is named after a camera"), "{said}");
        assert!(said.contains(": it is empty; name what it holds like the cameras, or "), "{said}");
        for name in ["e", "d", "c", "b", "a"] {
            std::fs::create_dir(empty.path().join(name)).unwrap();
        }
        let said = refusal(&empty.path().display().to_string());
        assert!(
            said.contains(": it holds a, b, c, d, …; name what it holds like the cameras"),
            "{said}"
        );
    }

    #[test]
    fn one_folder_may_hold_all() {
        let folder = tempfile::tempdir().unwrap();
        let cameras = cameras();
        std::fs::create_dir(folder.path().join(&cameras[1].name)).unwrap();
        std::fs::write(folder.path().join(format!("{}.mp4", cameras[2].name)), b"").unwrap();
        let found = assigned(&[&folder.path().display().to_string()]).unwrap();
        assert_eq!(found[0], None);
        assert!(found[1].as_ref().unwrap().is_dir());
        assert!(found[2].as_ref().unwrap().is_file());
    }
}
