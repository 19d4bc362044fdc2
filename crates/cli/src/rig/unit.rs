//! Which unit of length a calibration can have, by how large a hand would be in its pictures.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use anyhow::Error;
use phalanx_camera::{Camera, ViewScale, Volume};
use phalanx_io::calibration::{Missing, Unit};

use super::calibration;

/// The smallest hand that is told well, px from wrist to fingertip: its fingers are four pixels wide.
const SMALLEST_PX: f64 = 50.0;

/// Units that have a name on the command line.
const NAMED: [(&str, f64); 3] = [("mm", 1.0), ("cm", 10.0), ("m", 1000.0)];

/// What to say of a calibration that cannot be a rig with this unit, or that says none; nothing where the unit
/// is not to blame.
pub(super) fn advice(error: &Error, files: &[PathBuf], missing: &Missing) -> Option<String> {
    let sensible = if is_of_lengths(error) { sensible(files, missing)? } else { return None };
    let given = missing.unit.map(Unit::mm);
    if given.is_some_and(|mm| sensible.contains(&mm)) {
        return None;
    }
    let named = NAMED.iter().find(|(_, mm)| sensible.contains(mm));
    let such = match named {
        Some((name, _)) => format!("--unit {name}"),
        None => "a square of the chessboard, --square-mm".to_owned(),
    };
    let hardly = given.map(|mm| format!("a length of 1 is hardly {mm} mm: ")).unwrap_or_default();
    Some(format!(
        "{hardly}the cameras see a hand well if a length of 1 is {} to {} mm, such as {such}",
        rounded(*sensible.start()),
        rounded(*sensible.end())
    ))
}

/// Whether an error may come of a wrong unit.
fn is_of_lengths(error: &Error) -> bool {
    use phalanx_camera::Error::{Folding, HandSize, VolumeBehind, VolumeOutside};
    use phalanx_io::Error::{CalibrationDistance, CalibrationUnit};
    let of_rig = error.downcast_ref().is_some_and(|error| {
        matches!(
            error,
            Folding { .. } | HandSize { .. } | VolumeBehind { .. } | VolumeOutside { .. }
        )
    });
    let of_file = error
        .downcast_ref()
        .is_some_and(|error| matches!(error, CalibrationDistance { .. } | CalibrationUnit { .. }));
    of_rig || of_file
}

/// The lengths of 1, mm, with which a hand where the cameras look is neither smaller than can be told nor larger
/// than any picture.
fn sensible(files: &[PathBuf], missing: &Missing) -> Option<RangeInclusive<f64>> {
    // With the right unit cameras are neither too near nor too far to be believed, and it is a power of ten off
    // at most from one of these.
    let read = |power: i32| {
        let mm = 10_f64.powi(power);
        let unit = Unit::of_mm(mm).ok();
        let calibration = calibration::read(files, &Missing { unit, ..*missing }).ok()?;
        Some((mm, calibration.cameras))
    };
    let (mm, cameras) = (-1..=4).find_map(read)?;
    let center = Volume::between(&cameras, 1.0).ok()?.center;
    let hand_px = |camera: &Camera| Some(ViewScale::HAND_MM * camera.px_per_mm(center)?);
    let mut range = (0.0_f64, f64::INFINITY);
    for camera in &cameras {
        let side = f64::from(camera.intrinsics.width.max(camera.intrinsics.height));
        let px = hand_px(camera)?;
        range = (range.0.max(mm * px / side), range.1.min(mm * px / SMALLEST_PX));
    }
    (range.0 < range.1).then_some(range.0..=range.1)
}

/// Two digits.
fn rounded(mm: f64) -> String {
    // As a power of ten it is rounded first: 0.0996 becomes 0.10, not 0.100.
    let scientific = format!("{mm:.1e}");
    let power = scientific.split_once('e').and_then(|(_, power)| power.parse::<i32>().ok());
    let decimals = usize::try_from(1 - power.unwrap_or(0)).unwrap_or(0);
    scientific.parse().map_or(scientific, |rounded: f64| format!("{rounded:.decimals$}"))
}

#[cfg(test)]
mod tests {
    use super::rounded;

    #[test]
    fn lengths_are_said_with_two_digits() {
        for (mm, said) in
            [(0.3312, "0.33"), (4.0967, "4.1"), (0.0996, "0.10"), (33.4, "33"), (4096.7, "4100")]
        {
            assert_eq!(rounded(mm), said);
        }
    }
}
