//! A folder of pictures, a file for each frame.

use std::cmp::Ordering;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};
use image::DynamicImage;

use super::{Recording, Stamp};
use crate::input;

/// The endings of files that hold a picture.
const ENDINGS: [&str; 9] = ["png", "jpg", "jpeg", "pgm", "ppm", "bmp", "tif", "tiff", "webp"];

/// A folder of pictures in the order of their names; numbers in names count as numbers.
pub(crate) struct PictureFolder {
    folder: PathBuf,
    /// The names of its files.
    files: Vec<OsString>,
    stamps: Vec<Stamp>,
}

impl PictureFolder {
    pub(crate) fn open(folder: &Path) -> Result<Self> {
        let mut paths = Vec::new();
        for entry in std::fs::read_dir(folder)? {
            let path = entry?.path();
            if is_picture(&path) {
                paths.push(path);
            }
        }
        paths.sort_by(|a, b| natural_order(&stem(a), &stem(b)).then_with(|| a.cmp(b)));
        let stamps = paths.iter().map(|path| Stamp { name: stem(path), time: None }).collect();
        let files = paths.iter().filter_map(|path| Some(path.file_name()?.to_owned())).collect();
        Ok(Self { folder: folder.to_owned(), files, stamps })
    }

    /// The file of a frame.
    pub(crate) fn path(&self, frame: usize) -> PathBuf {
        self.folder.join(&self.files[frame])
    }
}

impl Recording for PictureFolder {
    fn stamps(&self) -> &[Stamp] {
        &self.stamps
    }

    fn read(&mut self, frame: usize) -> Result<DynamicImage> {
        ensure!(frame < self.files.len(), "there is no such frame");
        input::picture(&self.path(frame), None)
    }
}

/// Hidden files, such as those that file managers leave, are none.
pub(crate) fn is_picture(path: &Path) -> bool {
    let hidden = path.file_name().is_none_or(|name| name.to_string_lossy().starts_with('.'));
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    !hidden && ending.is_some_and(|ending| ENDINGS.contains(&ending.as_str()))
}

fn stem(path: &Path) -> String {
    path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Compares names piece by piece, runs of digits by their value: `frame9` comes before `frame10`.
fn natural_order(one: &str, other: &str) -> Ordering {
    let (mut one, mut other) = (one, other);
    loop {
        let (Some(a), Some(b)) = (one.chars().next(), other.chars().next()) else {
            return one.len().cmp(&other.len());
        };
        let order = if a.is_ascii_digit() && b.is_ascii_digit() {
            let (number, rest) = take_number(one);
            let (other_number, other_rest) = take_number(other);
            (one, other) = (rest, other_rest);
            number.len().cmp(&other_number.len()).then_with(|| number.cmp(other_number))
        } else {
            (one, other) = (&one[a.len_utf8()..], &other[b.len_utf8()..]);
            a.cmp(&b)
        };
        if order != Ordering::Equal {
            return order;
        }
    }
}

/// The digits that a text begins with, without leading zeros, and what follows them.
fn take_number(text: &str) -> (&str, &str) {
    let end = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    (text[..end].trim_start_matches('0'), &text[end..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_names_count_as_numbers() {
        let mut names = ["f10", "f9", "f010b", "f1", "g", "f"];
        names.sort_by(|a, b| natural_order(a, b));
        assert_eq!(names, ["f", "f1", "f9", "f10", "f010b", "g"]);
    }

    #[test]
    fn other_files_are_passed_over() {
        assert!(is_picture(Path::new("a/0001.JPG")));
        for other in ["a/.0001.jpg", "a/Thumbs.db", "a/notes.txt", "a/png"] {
            assert!(!is_picture(Path::new(other)), "{other}");
        }
    }
}
