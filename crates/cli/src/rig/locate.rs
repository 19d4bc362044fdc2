//! `phalanx rig volume`.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;
use phalanx::VolumeEstimate;
use phalanx_camera::Rig;
use phalanx_cli::files::Output;
use serde_json::json;

use super::{check, volume};
use crate::form::Form;
use crate::recording::source::{RecordingArguments, Source};
use crate::side::SideName;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The rig, as `phalanx rig import` writes it.
    #[arg(value_name = "RIG.toml")]
    rig: PathBuf,
    #[command(flatten)]
    recording: RecordingArguments,
    /// Which hand it is.
    #[arg(long, value_enum, default_value_t)]
    side: SideName,
    /// Where the rig goes with its volume.
    #[arg(long, value_name = "FILE.toml")]
    out: PathBuf,
    #[command(flatten)]
    form: Form,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let rig = check::read(&arguments.rig)?;
    let source = Source::new(&rig, &arguments.recording, arguments.side.into())?;
    let segment = arguments.recording.segment.path();
    let inputs: Vec<&PathBuf> = source.inputs().chain([&arguments.rig]).chain(segment).collect();
    let out = Output::new(&arguments.out, &inputs)?;
    let VolumeEstimate { volume, turns } = volume::seen(&source, arguments.side.into())?;
    let rig = Rig { volume, ..rig };
    out.write(rig.to_toml()?.as_bytes())?;
    let turns = turns.map(|turn| turn.map(f64::to_degrees));
    let center = rig.volume.center;
    let said = json!({
        "rig": arguments.out, "center_mm": center.to_array(),
        "turns_deg": { "x": turns[0], "y": turns[1], "forearm": turns[2] },
    });
    arguments.form.say(&out, &said, || {
        let [x, y, z] = turns.map(|turn| turn.map(whole));
        let center = center.to_array().map(whole);
        format!(
            "the wrist works around {}, {}, {} mm; the hand turns by {} to {}° about X, {} to {}° about Y and {} to \
             {}° about the forearm",
            center[0], center[1], center[2], x[0], x[1], y[0], y[1], z[0], z[1]
        )
    })
}

/// A whole number, without the sign of a zero.
fn whole(value: f64) -> f64 {
    value.round() + 0.0
}

#[cfg(test)]
mod tests {
    use super::whole;

    #[test]
    fn a_zero_has_no_sign() {
        assert_eq!([-0.4, 0.4, -0.6].map(whole).map(|value| value.to_string()), ["0", "0", "-1"]);
    }
}
