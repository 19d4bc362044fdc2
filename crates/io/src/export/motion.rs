//! MOT and STO: angles over time, for OpenSim.
//!
//! OpenSim's `Storage` stops reading without a word at a cell that is no number, NaN included: what
//! is not known is left out, whole rows or whole columns.

use phalanx_hand::Unit;

use crate::error::Result;
use crate::export::coordinates::Coordinate;
use crate::export::coordinates::CoordinateNames;
use crate::export::placement::LengthUnit;
use crate::take::{PoseEstimate, Take};

/// The take's angles as a MOT file: degrees, lengths in `unit`, no row for a frame without a hand.
///
/// # Errors
/// A take that does not keep to [`Take::validate`].
pub fn motion_file(take: &Take, names: CoordinateNames, unit: LengthUnit) -> Result<String> {
    take.validate()?;
    let value = |estimate: &PoseEstimate, coordinate: &Coordinate| {
        estimate.pose[coordinate.dof] * coordinate.sign
    };
    let mut notes = vec![about("angles", unit)];
    let coordinates = names.coordinates();
    let unconfirmed = coordinates.iter().filter(|coordinate| !coordinate.is_confirmed);
    notes.extend(note("Signs not yet confirmed on a model, compare before use:", unconfirmed));
    Ok(storage(take, "Coordinates", &notes, &coordinates, unit, value))
}

/// The deviations of [`motion_file`]'s numbers as a STO file with the same rows, and the same
/// columns but for numbers that some frame has no deviation of.
///
/// # Errors
/// A take that does not keep to [`Take::validate`].
pub fn deviation_file(take: &Take, names: CoordinateNames, unit: LengthUnit) -> Result<String> {
    take.validate()?;
    let value = |estimate: &PoseEstimate, coordinate: &Coordinate| {
        estimate.std[coordinate.dof.index()].unwrap_or(f64::NAN)
    };
    let estimates = take.frames.iter().filter_map(|frame| frame.estimate.as_ref());
    let is_known = |coordinate: &Coordinate| {
        estimates.clone().all(|estimate| estimate.std[coordinate.dof.index()].is_some())
    };
    let (known, unknown): (Vec<_>, Vec<_>) = names.coordinates().into_iter().partition(is_known);
    let mut notes = vec![about("standard deviations", unit)];
    notes.extend(note("Not estimated throughout, hence left out:", unknown.iter()));
    let title = "Standard deviations of coordinates";
    Ok(storage(take, title, &notes, &known, unit, value))
}

fn about(what: &str, unit: LengthUnit) -> String {
    format!("phalanx {}: {what}, lengths in {}", env!("CARGO_PKG_VERSION"), unit.symbol())
}

/// A line that says the same of some coordinates, if there are any.
fn note<'a>(what: &str, coordinates: impl Iterator<Item = &'a Coordinate>) -> Option<String> {
    let names: Vec<&str> = coordinates.map(|coordinate| coordinate.name).collect();
    (!names.is_empty()).then(|| format!("{what} {}", names.join(" ")))
}

fn storage(
    take: &Take,
    title: &str,
    notes: &[String],
    coordinates: &[Coordinate],
    unit: LengthUnit,
    value: impl Fn(&PoseEstimate, &Coordinate) -> f64,
) -> String {
    let found = take.frames.iter().filter_map(|frame| Some((frame.time, frame.estimate.as_ref()?)));
    let rows = found.map(|(time, estimate)| {
        let cells = coordinates.iter().map(|coordinate| {
            let scale = match coordinate.dof.unit() {
                Unit::Angle => 1_f64.to_degrees(),
                Unit::Length => unit.per_mm(),
            };
            format!("{:.6}", value(estimate, coordinate) * scale)
        });
        std::iter::once(format!("{time:.6}")).chain(cells).collect::<Vec<_>>().join("\t")
    });
    let rows: Vec<String> = rows.collect();
    let names = coordinates.iter().map(|coordinate| coordinate.name);
    let columns = std::iter::once("time").chain(names).collect::<Vec<_>>();
    format!(
        "{title}\nversion=1\nnRows={}\nnColumns={}\ninDegrees=yes\n\n{}\nendheader\n{}\n{}\n",
        rows.len(),
        columns.len(),
        notes.join("\n"),
        columns.join("\t"),
        rows.join("\n"),
    )
}
