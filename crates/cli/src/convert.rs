//! `phalanx convert`.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;
use phalanx_cli::files::Output;
use phalanx_io::export::{
    Axes, CoordinateNames, LengthUnit, Placement, bvh, c3d, deviation_file, frame_rate, glb,
    largest_jitter, motion_file, trc,
};
use phalanx_io::take::Take;
use serde_json::json;

use crate::counts::{counted, either};
use crate::form::Form;
use crate::take_file;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The take: .csv, .jsonl or .npz.
    #[arg(value_name = "TAKE")]
    take: PathBuf,
    /// Where it goes; the end of its name says as what: .csv, .jsonl, .npz, .trc, .mot (with the
    /// deviations in NAME_std.sto beside it), .bvh, .c3d or .glb.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// The axes of positions in .trc, .bvh, .c3d and .glb: `world` as calibrated, `hand` of the hand
    /// at rest (X to the thumb's side, Y out of the back, Z along the fingers), or for each of the
    /// file's axes the world's axis that it is: `xz-y` has Y up of a world with Z up.
    #[arg(long, default_value = "world", allow_hyphen_values = true)]
    axes: Axes,
    /// The unit of positions: mm, cm or m. Else mm; cm for .bvh; m for .glb.
    #[arg(long)]
    unit: Option<LengthUnit>,
    /// Whose names the columns of .mot have: phalanx, opensim (ARMS hand) or myohand.
    #[arg(long, default_value = "phalanx")]
    names: CoordinateNames,
    #[command(flatten)]
    form: Form,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let (out, inputs) = (&arguments.out, [&arguments.take]);
    let output = Output::new(out, &inputs)?;
    let kind = take_file::extension(out);
    let beside =
        (kind == "mot").then(|| Output::new(&deviations_beside(out), &inputs)).transpose()?;
    let take = take_file::read(&arguments.take)?;
    let bytes = converted(&take, arguments, &kind).with_context(|| out.display().to_string())?;
    output.write(&bytes)?;
    if let Some(beside) = beside {
        let unit = arguments.unit.unwrap_or(LengthUnit::Millimetre);
        let deviations = deviation_file(&take, arguments.names, unit)?;
        beside.write(deviations.as_bytes())?;
    }
    let deviations = if kind == "mot" {
        format!(" and {}", deviations_beside(out).display())
    } else {
        String::new()
    };
    let frames = counted(take.frames.len(), "frame");
    eprintln!("phalanx: {frames}; {}{deviations}", out.display());
    let told = untold(&take, arguments, &kind);
    for text in &told {
        eprintln!("phalanx: {text}");
    }
    let file = json!({ "file": out, "frames": take.frames.len(), "not_in_the_file": told });
    arguments.form.say_json(&output, &file)
}

fn converted(take: &Take, arguments: &Arguments, kind: &str) -> Result<Vec<u8>> {
    let unit = match kind {
        "bvh" => LengthUnit::Centimetre,
        "glb" => LengthUnit::Metre,
        _ => LengthUnit::Millimetre,
    };
    let placement = Placement { axes: arguments.axes, unit: arguments.unit.unwrap_or(unit) };
    if let Some(bytes) = take_file::encoded(take, kind)? {
        return Ok(bytes);
    }
    Ok(match kind {
        "trc" => {
            let name = arguments.out.file_name().unwrap_or_default().to_string_lossy();
            trc(take, &name, placement)?.into_bytes()
        }
        "mot" => motion_file(take, arguments.names, placement.unit)?.into_bytes(),
        "bvh" => bvh(take, placement)?.into_bytes(),
        "c3d" => c3d(take, placement)?,
        "glb" => glb(take, placement)?,
        _ => bail!("the name must end with .csv, .jsonl, .npz, .trc, .mot, .bvh, .c3d or .glb"),
    })
}

fn deviations_beside(motion: &Path) -> PathBuf {
    motion.with_file_name(format!("{}_std.sto", take_file::name(motion)))
}

/// What the file does not tell.
fn untold(take: &Take, arguments: &Arguments, kind: &str) -> Vec<String> {
    let mut told = Vec::new();
    let lost = take.frames.iter().filter(|frame| frame.estimate.is_none()).count();
    if lost > 0 && kind == "bvh" {
        told.push(format!(
            "{} without a hand {} the pose before",
            counted(lost, "frame"),
            either(lost, "repeats", "repeat")
        ));
    }
    let jitter = largest_jitter(take);
    if matches!(kind, "bvh" | "c3d") && jitter > 0.5 / frame_rate(take) {
        told.push(format!(
            "the frames are up to {:.0} ms off an even beat, which is all that .{kind} knows",
            1000.0 * jitter
        ));
    }
    let unconfirmed =
        arguments.names.coordinates().iter().filter(|coordinate| !coordinate.is_confirmed).count();
    if kind == "mot" && unconfirmed > 0 {
        told.push(format!(
            "the signs of {} are not yet confirmed on a model; compare before use",
            counted(unconfirmed, "column")
        ));
    }
    told
}
