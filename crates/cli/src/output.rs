//! An estimate as text, JSON and picture.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use anyhow::{Context, Result};
use image::{ImageFormat, RgbImage};
use phalanx::{Estimate, Estimator};
use phalanx_hand::{Dof, Unit};
use phalanx_segmentation::{Evidence, Forearm};
use serde::Serialize;

/// The JSON of an estimate: degrees and millimetres.
#[derive(Serialize)]
struct Report<'a> {
    /// Each number of the pose by name.
    pose: BTreeMap<&'static str, Figure>,
    /// 21 joints in the world.
    joints_mm: Vec<[f64; 3]>,
    views: Vec<View<'a>>,
}

#[derive(Serialize)]
struct Figure {
    value: f64,
    std: f64,
    unit: &'static str,
}

/// What was seen of the forearm in one view.
#[derive(Serialize)]
struct View<'a> {
    camera: &'a str,
    forearm: &'static str,
    border_crossings: usize,
}

/// The estimate as JSON.
pub(crate) fn json(estimator: &Estimator, estimate: &Estimate) -> Result<String> {
    let figure = |dof: Dof| {
        let (value, std) = (estimate.pose[dof], estimate.std[dof.index()]);
        let (unit, symbol) = (dof.unit(), symbol(dof));
        (dof.name(), Figure { value: unit.to_file(value), std: unit.to_file(std), unit: symbol })
    };
    let views = views(estimator, estimate).map(|(camera, forearm)| View {
        camera,
        forearm: match forearm.evidence {
            Evidence::Border => "border",
            Evidence::Stump => "stump",
        },
        border_crossings: forearm.crossings,
    });
    let report = Report {
        pose: Dof::ALL.into_iter().map(figure).collect(),
        joints_mm: estimate.joints.iter().map(|joint| joint.to_array()).collect(),
        views: views.collect(),
    };
    Ok(serde_json::to_string_pretty(&report)?)
}

/// The estimate as a table for people.
pub(crate) fn text(estimate: &Estimate) -> String {
    let mut text = String::new();
    for dof in Dof::ALL {
        let unit = dof.unit();
        let (value, std) = (estimate.pose[dof], estimate.std[dof.index()]);
        let (value, std) = (unit.to_file(value), unit.to_file(std));
        writeln!(text, "{dof:18} {value:8.1} ± {std:5.1} {}", symbol(dof))
            .expect("writing to a string");
    }
    text
}

/// What should be known of an estimate's views before it is trusted.
pub(crate) fn doubts(estimator: &Estimator, estimate: &Estimate) -> Vec<String> {
    let doubt = |(camera, forearm): (&str, &Forearm)| match (forearm.evidence, forearm.crossings) {
        (Evidence::Stump, _) => Some(format!(
            "camera '{camera}': the forearm does not reach the border of the picture; its end was guessed"
        )),
        (Evidence::Border, 0 | 1) => None,
        (Evidence::Border, crossings) => Some(format!(
            "camera '{camera}': the hand crosses the border {crossings} times; the longest crossing is taken for the forearm"
        )),
    };
    views(estimator, estimate).filter_map(doubt).collect()
}

fn views<'a>(
    estimator: &'a Estimator,
    estimate: &'a Estimate,
) -> impl Iterator<Item = (&'a str, &'a Forearm)> {
    let names = estimator.rig().cameras.iter().map(|camera| camera.name.as_str());
    names.zip(&estimate.forearms)
}

fn symbol(dof: Dof) -> &'static str {
    match dof.unit() {
        Unit::Angle => "deg",
        Unit::Length => "mm",
    }
}

/// Writes a picture as PNG under a temporary name and renames it, so that it is never
/// half-written.
pub(crate) fn write_png(path: &Path, picture: &RgbImage) -> Result<()> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let write = || -> Result<()> {
        let mut file = tempfile::NamedTempFile::new_in(folder)?;
        let mut png = std::io::Cursor::new(Vec::new());
        picture.write_to(&mut png, ImageFormat::Png)?;
        file.write_all(png.get_ref())?;
        file.persist(path)?;
        Ok(())
    };
    write().with_context(|| format!("writing {}", path.display()))
}
