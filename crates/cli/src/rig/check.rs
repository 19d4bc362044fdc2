//! `phalanx rig check`.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use clap::Args;
use phalanx_camera::{Rig, ViewAngle, ViewScale};
use phalanx_hand::HandShape;
use serde::Serialize;

use super::simulation::{Angle, Simulation, simulate};
use super::volume;
use crate::form::Form;
use crate::progress::Bar;
use crate::recording::source::{RecordingArguments, Source};
use crate::segment::SegmentArguments;
use crate::side::SideName;
use phalanx_cli::reading;

/// Two views nearer than this see a hand alike, degrees: a triangulated point is then five times less
/// sure along the view than across it (1 / tan 11°).
const ALIKE_DEGREES: f64 = 11.0;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The rig.
    #[arg(value_name = "RIG.toml")]
    rig: PathBuf,
    /// Recordings of the hand where it works, as `phalanx track` takes them: the hand is looked for in some of their
    /// moments. Without them it is taken to be in the middle of the rig's working volume.
    #[arg(value_name = "RECORDING")]
    recordings: Vec<String>,
    #[command(flatten)]
    segment: SegmentArguments,
    /// Which hand the recordings show.
    #[arg(long, value_enum, default_value_t)]
    side: SideName,
    /// Say what deviation and error to expect of each angle: draw a hand that moves in the working volume, and fit
    /// it as this rig sees it. Real pictures have ragged outlines, so take it for the best that can be.
    #[arg(long)]
    simulate: bool,
    #[command(flatten)]
    form: Form,
}

#[derive(Serialize)]
struct Report {
    views: Vec<View>,
    pairs: Vec<Pair>,
    #[serde(skip_serializing_if = "Option::is_none")]
    simulation: Option<Simulation>,
}

/// How a camera sees the middle of the volume.
#[derive(Serialize)]
struct View {
    camera: String,
    distance_mm: f64,
    px_per_mm: f64,
    /// How long a hand of 190 mm is.
    hand_px: f64,
}

/// Between two cameras' lines of sight.
#[derive(Serialize)]
struct Pair {
    cameras: [String; 2],
    angle_deg: f64,
}

/// Reads a rig file, which errors name.
pub(crate) fn read(path: &Path) -> Result<Rig> {
    let named = || path.display().to_string();
    let bytes = reading::read(path).with_context(named)?;
    let advice = || format!("{}: no rig; `phalanx rig import` makes one of a calibration", named());
    let text = std::str::from_utf8(&bytes).with_context(advice)?;
    ensure!(HandShape::from_toml(text).is_err(), "{}: this is a hand, not a rig", named());
    Rig::from_toml(text).map_err(|error| {
        let is_other = matches!(error, phalanx_camera::Error::Toml { .. });
        anyhow::Error::from(error).context(if is_other { advice() } else { named() })
    })
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let rig = arguments.rig()?;
    let scales = rig.view_scales().with_context(|| arguments.rig.display().to_string())?;
    let report = Report {
        views: scales.into_iter().map(View::of).collect(),
        pairs: rig.view_angles().into_iter().map(Pair::of).collect(),
        simulation: arguments.simulate.then(|| simulate(&rig, &Bar::new())).transpose()?,
    };
    for pair in report.pairs.iter().filter(|pair| pair.angle_deg < ALIKE_DEGREES) {
        let [first, second] = &pair.cameras;
        eprintln!(
            "doubt: {first} and {second} look from nearly the same side ({:.0}°): together they hardly \
             tell how far away a hand is",
            pair.angle_deg
        );
    }
    arguments.form.print(&report, || report.table())
}

impl Arguments {
    /// The rig, with its working volume where the recordings show the hand, if there are any.
    fn rig(&self) -> Result<Rig> {
        let rig = read(&self.rig)?;
        if self.recordings.is_empty() {
            return Ok(rig);
        }
        let recording = RecordingArguments {
            recordings: self.recordings.clone(),
            landmarks: Vec::new(),
            segment: self.segment.clone(),
            timestamps: None,
        };
        let source = Source::new(&rig, &recording, self.side.into())?;
        Ok(Rig { volume: volume::seen(&source, self.side.into())?.volume, ..rig })
    }
}

/// Whether two cameras look from nearly the same side.
pub(crate) fn is_alike(pair: &ViewAngle) -> bool {
    pair.angle.to_degrees() < ALIKE_DEGREES
}

/// What to expect of the rig's angles.
fn expected(text: &mut String, simulation: &Simulation) -> std::fmt::Result {
    let Simulation { moments, trusted, joints_mm, angles } = simulation;
    writeln!(
        text,
        "\nof {moments} moments of a drawn hand {trusted} are fitted without a doubt, their joints {joints_mm:.1} mm off"
    )?;
    writeln!(text, "{:16}  {:>12}  {:>14}", "angle", "deviation, °", "mean error, °")?;
    angles.iter().try_for_each(|Angle { name, std_deg, error_deg }| {
        writeln!(text, "{name:16}  {std_deg:12.1}  {error_deg:14.1}")
    })
}

impl View {
    fn of(scale: ViewScale) -> Self {
        let hand_px = scale.hand_px();
        let ViewScale { camera, distance: distance_mm, px_per_mm } = scale;
        Self { camera, distance_mm, px_per_mm, hand_px }
    }
}

impl Pair {
    fn of(pair: ViewAngle) -> Self {
        let ViewAngle { first, second, angle } = pair;
        Self { cameras: [first, second], angle_deg: angle.to_degrees() }
    }
}

impl Report {
    fn table(&self) -> Result<String> {
        let names = self.views.iter().map(|view| view.camera.chars().count());
        let wide = names.max().unwrap_or_default().max("camera".len());
        let mut text = format!(
            "{:wide$}  {:>12}  {:>9}  {:>15}\n",
            "camera", "distance, mm", "px per mm", "190 mm hand, px"
        );
        for View { camera, distance_mm, px_per_mm, hand_px } in &self.views {
            writeln!(text, "{camera:wide$}  {distance_mm:12.0}  {px_per_mm:9.2}  {hand_px:15.0}")?;
        }
        for Pair { cameras: [first, second], angle_deg } in &self.pairs {
            writeln!(text, "{first} and {second} look from {angle_deg:.0}° apart")?;
        }
        if let Some(simulation) = &self.simulation {
            expected(&mut text, simulation)?;
        }
        Ok(text)
    }
}
