//! The files of a crate and the arrows between them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use anyhow::{Context, Result};

use super::imports;

/// A module's place in its crate: `a::b` is `["a", "b"]`; the root's is empty.
type Place = Vec<String>;

pub(super) struct Modules {
    /// What each file names, by its module's place.
    files: BTreeMap<Place, Vec<Place>>,
}

impl Modules {
    /// Reads the sources of a crate.
    pub(super) fn read(src: &Path) -> Result<Self> {
        let mut sources = BTreeMap::new();
        read_folder(src, &Place::new(), &mut sources)?;
        let places: BTreeSet<&Place> = sources.keys().collect();
        let named = |(place, source): (&Place, &String)| {
            let paths = imports::paths(source).into_iter();
            let named = paths.filter_map(|path| absolute(place, &path, &places)).collect();
            (place.clone(), named)
        };
        Ok(Self { files: sources.iter().map(named).collect() })
    }

    /// What files take from the crate's root and not from where it is defined.
    pub(super) fn root_imports(&self) -> Vec<String> {
        let mut found = Vec::new();
        for (place, named) in self.files.iter().filter(|(place, _)| !place.is_empty()) {
            let roots = named.iter().filter(|path| self.file_of(path).is_empty());
            let names: BTreeSet<String> = roots.map(|path| path.join("::")).collect();
            if !names.is_empty() {
                let names: Vec<String> = names.into_iter().collect();
                found.push(format!("{} takes {} from the root", name(place), names.join(", ")));
            }
        }
        found
    }

    /// Files that import from one another, if there are any.
    pub(super) fn circle(&self) -> Option<String> {
        let mut arrows: BTreeMap<&Place, BTreeSet<&Place>> = BTreeMap::new();
        for (place, named) in self.files.iter().filter(|(place, _)| !place.is_empty()) {
            let below = named.iter().map(|path| self.file_of(path));
            arrows.insert(
                place,
                below.filter(|below| !below.is_empty() && *below != place).collect(),
            );
        }
        // What has no arrow out of it, or none into it, is in no circle.
        loop {
            let before = arrows.len();
            let left: BTreeSet<&Place> = arrows.keys().copied().collect();
            arrows.retain(|_, below| below.iter().any(|place| left.contains(place)));
            let reached: BTreeSet<&Place> = arrows.values().flatten().copied().collect();
            arrows.retain(|place, _| reached.contains(place));
            if arrows.len() == before {
                break;
            }
        }
        let names: Vec<String> = arrows.keys().map(|place| name(place)).collect();
        (!names.is_empty()).then(|| format!("in or between circles: {}", names.join(", ")))
    }

    /// The place of the file that holds what a path names.
    fn file_of<'a>(&'a self, path: &Place) -> &'a Place {
        let files = (0..=path.len()).rev();
        let mut found = files.filter_map(|length| self.files.get_key_value(&path[..length]));
        found.next().expect("a crate has a root").0
    }
}

/// A path of the crate from its root; `None` for what is of another crate.
fn absolute(place: &Place, path: &str, places: &BTreeSet<&Place>) -> Option<Place> {
    let mut base = place.clone();
    let mut segments: Vec<&str> = path.split("::").collect();
    match segments[0] {
        "crate" => {
            base.clear();
            segments.remove(0);
        }
        "self" => drop(segments.remove(0)),
        "super" => {}
        child => {
            base.push(child.to_owned());
            if !places.contains(&base) {
                return None;
            }
            segments.remove(0);
        }
    }
    while segments.first() == Some(&"super") {
        base.pop();
        segments.remove(0);
    }
    let names = segments.into_iter().filter(|&segment| segment != "self");
    base.extend(names.map(str::to_owned));
    Some(base)
}

/// Reads the sources of a folder, but for those of tests.
fn read_folder(folder: &Path, place: &Place, sources: &mut BTreeMap<Place, String>) -> Result<()> {
    for entry in std::fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        let stem = path.file_stem().context("a file has a name")?.to_string_lossy().into_owned();
        if path.is_dir() {
            read_folder(&path, &[&place[..], &[stem]].concat(), sources)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") && stem != "tests" {
            let is_folder_s = ["lib", "main", "mod"].contains(&stem.as_str());
            let place = if is_folder_s { place.clone() } else { [&place[..], &[stem]].concat() };
            let source = std::fs::read_to_string(&path);
            sources.insert(place, source.with_context(|| path.display().to_string())?);
        }
    }
    Ok(())
}

fn name(place: &Place) -> String {
    format!("{}.rs", place.join("/"))
}
