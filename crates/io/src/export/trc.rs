//! TRC: the joints as markers, for OpenSim and Pose2Sim.

use crate::error::{Error, Result};
use crate::export::placement::{LengthUnit, Placement};
use crate::export::timing::frame_rate;
use crate::take::{JOINT_NAMES, Take};

/// The take's joints as a TRC file; `name` is the file's own, which its first line repeats. Joints
/// of frames without a hand are NaN.
///
/// # Errors
/// [`Error::Unit`] for centimetres, which readers of TRC do not know; a take that does not keep to
/// [`Take::validate`].
pub fn trc(take: &Take, name: &str, placement: Placement) -> Result<String> {
    take.validate()?;
    if placement.unit == LengthUnit::Centimetre {
        return Err(Error::Unit { format: "TRC", units: "mm or m" });
    }
    let (rate, frames, joints) = (frame_rate(take), take.frames.len(), JOINT_NAMES.len());
    let name: String = name.chars().filter(|letter| !letter.is_control()).collect();
    let unit = placement.unit.symbol();
    let markers = JOINT_NAMES.map(|joint| format!("{joint}\t\t\t")).concat();
    let axes: Vec<String> = (1..=joints).map(|k| format!("X{k}\tY{k}\tZ{k}")).collect();
    let mut lines = vec![
        format!("PathFileType\t4\t(X/Y/Z)\t{name}"),
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames".to_owned(),
        format!("{rate}\t{rate}\t{frames}\t{joints}\t{unit}\t{rate}\t1\t{frames}"),
        format!("Frame#\tTime\t{markers}"),
        format!("\t\t{}", axes.join("\t")),
        String::new(),
    ];
    lines.extend(take.frames.iter().zip(1_u64..).map(|(frame, number)| {
        let cells = (0..joints).map(|joint| match &frame.estimate {
            Some(estimate) => {
                let point = placement.point(&take.header, estimate.joints[joint]);
                format!("\t{:.6}\t{:.6}\t{:.6}", point.x, point.y, point.z)
            }
            None => "\tNaN\tNaN\tNaN".to_owned(),
        });
        format!("{number}\t{:.6}{}", frame.time, cells.collect::<Vec<_>>().concat())
    }));
    lines.push(String::new());
    Ok(lines.join("\n"))
}
