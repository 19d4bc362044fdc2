//! `phalanx import-calibration`.

use std::path::PathBuf;
use std::str::FromStr;

use anyhow::{Context, Result, ensure};
use clap::Args;
use glam::DVec3;
use phalanx_camera::{Camera, Rig, Volume, cameras_from_opencv_json};

use crate::output;

/// Side of the cube in which the hand works unless it is said, mm.
const SIDE_MM: f64 = 300.0;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The calibration: OpenCV's matrices and coefficients, JSON.
    #[arg(value_name = "FILE.json")]
    calibration: PathBuf,
    /// What a length of 1 is in the calibration, such as a square of the chessboard, mm.
    #[arg(long, value_name = "MM")]
    square_mm: f64,
    #[command(flatten)]
    volume: VolumeArguments,
    /// Where the rig goes.
    #[arg(long, value_name = "FILE.toml")]
    out: PathBuf,
}

/// Where the hand works, in the calibration's world.
#[derive(Args)]
struct VolumeArguments {
    /// Where the wrist is at rest, mm; by default where the cameras' axes come nearest.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    center: Option<Vector>,
    /// The box in which the wrist moves, mm; 300 on each side by default.
    #[arg(long, value_name = "X,Y,Z")]
    size: Option<Vector>,
    /// From elbow to wrist at rest; by default up the first camera's picture.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    forearm: Option<Vector>,
    /// Out of the back of the hand at rest; by default towards the cameras.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    up: Option<Vector>,
}

/// Three numbers: `X,Y,Z`.
#[derive(Debug, Clone, Copy)]
struct Vector(DVec3);

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

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let path = &arguments.calibration;
    let rig = rig(arguments).with_context(|| path.display().to_string())?;
    output::write_whole(&arguments.out, rig.as_bytes())
}

/// The rig file's text.
fn rig(arguments: &Arguments) -> Result<String> {
    let text = std::fs::read_to_string(&arguments.calibration)?;
    let cameras = cameras_from_opencv_json(&text, arguments.square_mm)?;
    let volume = arguments.volume.of(&cameras)?;
    Ok(Rig { cameras, volume }.to_toml()?)
}

impl VolumeArguments {
    fn of(&self, cameras: &[Camera]) -> Result<Volume> {
        if let (Some(center), Some(forearm), Some(up)) = (self.center, self.forearm, self.up) {
            let size = self.size.map_or(DVec3::splat(SIDE_MM), |size| size.0);
            return Ok(Volume { center: center.0, size, forearm: forearm.0, up: up.0 });
        }
        let guess = Volume::between(cameras, SIDE_MM)
            .context("give --center, --forearm and --up: they cannot be guessed")?;
        let or = |given: Option<Vector>, guessed: DVec3| given.map_or(guessed, |vector| vector.0);
        Ok(Volume {
            center: or(self.center, guess.center),
            size: or(self.size, guess.size),
            forearm: or(self.forearm, guess.forearm),
            up: or(self.up, guess.up),
        })
    }
}
