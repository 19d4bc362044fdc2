//! `phalanx rig import`.

use std::path::PathBuf;

use anyhow::{Context, Error, Result, anyhow};
use clap::Args;
use phalanx_camera::Rig;
use phalanx_cli::files::Output;
use phalanx_io::calibration::{Missing, Unit, camera_distances};
use serde_json::json;

use crate::form::Form;
use crate::rig::calibration;
use crate::rig::unit;
use crate::rig::volume::{Vector, VolumeArguments};

#[derive(Args)]
pub(crate) struct Arguments {
    /// The calibration: one file, intrinsics and extrinsics, or a file a camera. Files of Anipose,
    /// FreeMoCap, Caliscope, Pose2Sim, OpenCV, EasyMocap, Kalibr, multical, COLMAP, Qualisys, Vicon, CMU
    /// Panoptic, bioCV and phalanx are recognised by what they hold.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// What a length of 1 is in the calibration: mm, cm, m, or a number of millimetres, such as a
    /// square of the chessboard. Few files say it.
    #[arg(long, value_name = "mm|cm|m|MM")]
    unit: Option<Unit>,
    /// The same as --unit with a number.
    #[arg(long, value_name = "MM", conflicts_with = "unit", value_parser = square)]
    square_mm: Option<Unit>,
    /// Width and height of the pictures, px, where the calibration does not say them.
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<(u32, u32)>,
    #[command(flatten)]
    volume: VolumeArguments,
    /// The box in which the wrist moves, mm; 300 on each side by default.
    #[arg(long, value_name = "X,Y,Z")]
    volume_size: Option<Vector>,
    /// Where the rig goes.
    #[arg(long, value_name = "FILE.toml")]
    out: PathBuf,
    #[command(flatten)]
    form: Form,
}

fn square(text: &str) -> Result<Unit> {
    let mm = text.trim().parse().context("expected a number of millimetres")?;
    Ok(Unit::of_mm(mm)?)
}

fn size(text: &str) -> Result<(u32, u32)> {
    let sides =
        text.split_once(['x', 'X', '×']).context("expected WIDTHxHEIGHT, such as 1280x720")?;
    Ok((sides.0.trim().parse()?, sides.1.trim().parse()?))
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let Arguments { files, unit, square_mm, size, .. } = arguments;
    let missing = Missing { unit: unit.or(*square_mm), size: *size };
    import(arguments, &missing).map_err(|error| {
        if let Some(advice) = unit::advice(&error, files, &missing) {
            return anyhow!("{error:#}; {advice}");
        }
        match size_advice(&error, &missing) {
            Some(advice) => error.context(advice),
            None => error,
        }
    })
}

/// What to say of a calibration without its pictures' size: OpenCV's and EasyMocap's seldom have it.
fn size_advice(error: &Error, missing: &Missing) -> Option<String> {
    let is_of_size = matches!(
        error.downcast_ref(),
        Some(phalanx_io::Error::CalibrationField { field, .. }) if field == "size"
    );
    (is_of_size && missing.size.is_none())
        .then(|| "give the pictures' size, such as --size 1280x720".to_owned())
}

fn import(arguments: &Arguments, missing: &Missing) -> Result<()> {
    let Arguments { files, volume, volume_size, out, form, .. } = arguments;
    let output = Output::new(out, files)?;
    let calibration = calibration::read(files, missing)?;
    for note in &calibration.notes {
        eprintln!("note: {note}");
    }
    // Before the volume, so that a wrong unit shows.
    let distances = camera_distances(&calibration.cameras);
    for pair in &distances {
        eprintln!("{} and {}: {:.0} mm apart", pair.first, pair.second, pair.mm);
    }
    let named = || calibration::named(files);
    let known = calibration.volume;
    let volume_of_hand =
        volume.of(*volume_size, known, &calibration.cameras).with_context(named)?;
    let rig = Rig { cameras: calibration.cameras, volume: volume_of_hand };
    let text = rig.to_toml().with_context(named)?;
    let scales = rig.view_scales().with_context(named)?;
    for scale in &scales {
        eprintln!(
            "{}: a hand of 190 mm is {:.0} px long in the picture, {:.0} mm away",
            scale.camera,
            scale.hand_px(),
            scale.distance
        );
    }
    let missing = if known.is_none() { volume.not_given() } else { Vec::new() };
    if !missing.is_empty() {
        eprintln!(
            "note: where the hand works was not given ({}) and is guessed: look at [volume] in {}, or let `phalanx \
             rig volume` find it in a recording",
            missing.join(", "),
            out.display()
        );
    }
    output.write(text.as_bytes())?;
    let views = scales.iter().map(|scale| {
        json!({ "camera": scale.camera, "distance_mm": scale.distance, "hand_px": scale.hand_px() })
    });
    let distances =
        distances.iter().map(|pair| json!({ "cameras": [pair.first, pair.second], "mm": pair.mm }));
    let said = json!({
        "rig": out, "notes": calibration.notes, "guessed": missing,
        "views": views.collect::<Vec<_>>(), "distances": distances.collect::<Vec<_>>(),
    });
    form.say_json(&output, &said)
}
