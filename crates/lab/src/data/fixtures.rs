//! `cargo xtask fixtures`: writes the generated files of `fixtures/`, or checks them.

use anyhow::{Result, bail};
use clap::Args;
use phalanx::draw_silhouette;
use phalanx_camera::Camera;
use phalanx_hand::{Dof, HandShape, Pose, write_poses};
use phalanx_segmentation::Silhouette;
use rayon::prelude::*;

use crate::baselines::principal_axes::PrincipalAxes;
use crate::data::data_set;
use crate::data::trajectories;
use crate::files;
use crate::metrics;

#[derive(Args)]
pub struct Arguments {
    /// Write nothing; fail where a file is not as generated.
    #[arg(long)]
    check: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let open_close = trajectories::open_close();
    let complex = trajectories::complex();
    let generated = [
        ("fixtures/hand.toml", hand_file()),
        ("fixtures/trajectories/open-close.csv", trajectory_file(&open_close)?),
        ("fixtures/trajectories/complex.csv", trajectory_file(&complex)?),
    ];
    for (path, bytes) in &generated {
        let path = files::in_repository(path);
        if !arguments.check {
            files::write_whole(&path, bytes)?;
        } else if std::fs::read(&path).ok().as_ref() != Some(bytes) {
            bail!("{} is not as generated: run `cargo xtask fixtures`", path.display());
        }
    }
    for (name, frames) in [("open-close", &open_close), ("complex", &complex)] {
        let (difficulty, coverage) = (Difficulty::of(frames)?, Coverage::of(frames)?);
        files::print(&format!("{name}: {difficulty}\n{name}: {coverage}\n"))?;
    }
    Ok(())
}

fn hand_file() -> Vec<u8> {
    let header = "# A mean adult's right hand, as `cargo xtask fixtures` writes it: millimetres and degrees\n\
                  # in the hand frame (+X to the thumb's side, +Y out of the back, +Z towards the fingers).\n\n";
    [header.as_bytes(), HandShape::adult().to_toml().as_bytes()].concat()
}

fn trajectory_file(poses: &[Pose]) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    write_poses(&mut bytes, poses, &trajectories::columns())?;
    Ok(bytes)
}

/// How hard a trajectory is to guess.
struct Difficulty {
    frames: usize,
    mean_predictor_mae_deg: f64,
    components: usize,
}

impl Difficulty {
    fn of(frames: &[Pose]) -> Result<Self> {
        Ok(Self {
            frames: frames.len(),
            mean_predictor_mae_deg: mean_predictor_mae_deg(frames),
            components: components(frames)?,
        })
    }
}

impl std::fmt::Display for Difficulty {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{} frames × 7 θ_Z; predicting the mean errs by {:.2}° over the 21 active angles; {} principal \
             components hold 95 % of the internal variance",
            self.frames, self.mean_predictor_mae_deg, self.components
        )
    }
}

/// How much of the picture the hand and forearm fill, over poses and cameras of the desk.
struct Coverage {
    mean: f64,
    std: f64,
    /// Silhouettes that leave by more than one border crossing.
    cut: usize,
    silhouettes: usize,
}

impl Coverage {
    fn of(frames: &[Pose]) -> Result<Self> {
        let (rig, hand) = (files::rig(None)?, HandShape::adult());
        let rest = rig.volume.rest_frame();
        let silhouette = |pose: &Pose, camera: &Camera| -> Result<(f64, bool)> {
            let silhouette = Silhouette::from_mask(&draw_silhouette(camera, &hand, pose, &rest)?)?;
            let pixels = silhouette.mask.area();
            let share = pixels as f64 / silhouette.mask.len() as f64;
            Ok((share, silhouette.forearm.crossings > 1))
        };
        let drawn = data_set::at_seven_angles(frames)
            .par_iter()
            .flat_map_iter(|pose| rig.cameras.iter().map(|camera| silhouette(pose, camera)))
            .collect::<Result<Vec<_>>>()?;
        let count = drawn.len() as f64;
        let mean = drawn.iter().map(|(share, _)| share).sum::<f64>() / count;
        let variance = drawn.iter().map(|(share, _)| (share - mean).powi(2)).sum::<f64>() / count;
        let cut = drawn.iter().filter(|(_, cut)| *cut).count();
        Ok(Self { mean, std: variance.sqrt(), cut, silhouettes: drawn.len() })
    }
}

impl std::fmt::Display for Coverage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "silhouettes cover {:.1} % of the picture (standard deviation {:.1} %); {} of {} touch \
             another border too",
            100.0 * self.mean,
            100.0 * self.std,
            self.cut,
            self.silhouettes
        )
    }
}

fn mean_predictor_mae_deg(frames: &[Pose]) -> f64 {
    let truth = phalanx::targets(&data_set::at_seven_angles(frames));
    let guess = metrics::mean_predictor(&truth, truth.ncols());
    let active: Vec<Dof> =
        Dof::ALL.into_iter().filter(|&dof| dof.is_internal() || dof == Dof::ThetaZ).collect();
    metrics::AngleErrors::new(guess.as_ref(), truth.as_ref(), &active).mae()
}

/// How many principal components hold 95 % of the variance of the internal angles.
fn components(frames: &[Pose]) -> Result<usize> {
    let angles = phalanx::targets(frames);
    Ok(PrincipalAxes::of(angles.as_ref().subrows(0, Dof::INTERNAL))?.holding(0.95))
}
