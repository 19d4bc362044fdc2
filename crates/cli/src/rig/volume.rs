//! Where the hand works, in a calibration's world: said, guessed or seen.

use std::str::FromStr;

use anyhow::{Context, Result, ensure};
use clap::Args;
use glam::DVec3;
use phalanx::{TakeSettings, VolumeEstimate, fit_take, trusted_volume};
use phalanx_camera::{Camera, Volume};
use phalanx_hand::{HandShape, Side};

use crate::counts::counted;
use crate::finding::{Finding, State};
use crate::progress::Bar;
use crate::recording::agreement;
use crate::recording::source::Source;

/// Side of the cube in which the hand works unless it is said, mm.
const SIDE_MM: f64 = 300.0;

/// Moments of a recording that tell where a hand works.
const MOMENTS: usize = 24;

/// Where the hand works and how it is held, in the calibration's world.
#[derive(Args)]
pub(crate) struct VolumeArguments {
    /// Where the wrist is at rest, mm; by default where the cameras' axes come nearest.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    center: Option<Vector>,
    /// From elbow to wrist at rest; by default up the first camera's picture.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    forearm: Option<Vector>,
    /// Out of the back of the hand at rest; by default towards the cameras.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    up: Option<Vector>,
}

/// Three numbers: `X,Y,Z`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Vector(pub(crate) DVec3);

impl FromStr for Vector {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let numbers = text.split(',').map(|number| number.trim().parse::<f64>());
        let numbers: Vec<f64> = numbers.collect::<Result<_, _>>().context("expected X,Y,Z")?;
        let numbers = <[f64; 3]>::try_from(numbers).ok().context("expected X,Y,Z")?;
        let vector = DVec3::from_array(numbers);
        ensure!(vector.is_finite(), "a number is not finite");
        Ok(Self(vector))
    }
}

impl VolumeArguments {
    /// The options that were not given.
    pub(crate) fn not_given(&self) -> Vec<&'static str> {
        let options = [("--center", self.center), ("--forearm", self.forearm), ("--up", self.up)];
        options.iter().filter(|(_, given)| given.is_none()).map(|(name, _)| *name).collect()
    }

    /// The volume that was given, or is known, or is guessed, in this order, each number of it.
    pub(crate) fn of(
        &self,
        size: Option<Vector>,
        known: Option<Volume>,
        cameras: &[Camera],
    ) -> Result<Volume> {
        let given = [self.center, self.forearm, self.up].map(|option| option.map(|v| v.0));
        let size = size.map(|size| size.0);
        if let [Some(center), Some(forearm), Some(up)] = given {
            let size = size.or(known.map(|known| known.size)).unwrap_or(DVec3::splat(SIDE_MM));
            return Ok(Volume { center, size, forearm, up });
        }
        let guess = match known {
            Some(known) => known,
            None => Volume::between(cameras, SIDE_MM)
                .context("give --center, --forearm and --up: they cannot be guessed")?,
        };
        let [center, forearm, up] = given;
        Ok(Volume {
            center: center.unwrap_or(guess.center),
            size: size.unwrap_or(guess.size),
            forearm: forearm.unwrap_or(guess.forearm),
            up: up.unwrap_or(guess.up),
        })
    }
}

/// Where the hand works in some moments of a recording; cameras that do not see one hand are doubted.
pub(super) fn seen(source: &Source, side: Side) -> Result<VolumeEstimate> {
    let mut failures = Vec::new();
    let frames = source.reader()?.read_some(MOMENTS, &mut failures);
    if let Some(first) = failures.first() {
        let said = format!("{} cannot be used: {first}", counted(failures.len(), "picture"));
        ensure!(failures.len() < frames.len(), said);
        eprintln!("phalanx: {said}");
    }
    let hand = HandShape { side, ..HandShape::adult() };
    let settings = TakeSettings { hand, ..TakeSettings::default() };
    let fit = fit_take(&source.cameras, &frames, &settings, &Bar::new())?;
    if source.cameras.len() > 1 {
        let findings = agreement::findings(source, &fit).into_iter();
        let findings = findings.filter(|finding| finding.state != State::Good);
        for Finding { what, text, .. } in findings {
            eprintln!("doubt: {what}: {text}");
        }
    }
    Ok(trusted_volume(&fit)?)
}
