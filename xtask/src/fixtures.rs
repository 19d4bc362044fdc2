//! `cargo xtask fixtures`: writes the generated files of `fixtures/`, or checks them.

use anyhow::{Result, bail};
use clap::Args;
use faer::{Mat, Side};
use phalanx_hand::{Dof, HandShape, Pose, write_poses};

use crate::{data_set, files, metrics, trajectories};

#[derive(Args)]
pub(crate) struct Arguments {
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
        println!("{name}: {}", Difficulty::of(frames));
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
    fn of(frames: &[Pose]) -> Self {
        Self {
            frames: frames.len(),
            mean_predictor_mae_deg: mean_predictor_mae_deg(frames),
            components: components_for(0.95, frames),
        }
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

fn mean_predictor_mae_deg(frames: &[Pose]) -> f64 {
    let truth = phalanx::targets(&data_set::at_seven_angles(frames));
    let mean = row_means(&truth);
    let guess = Mat::from_fn(truth.nrows(), truth.ncols(), |row, _| mean[row]);
    let active: Vec<Dof> =
        Dof::ALL.into_iter().filter(|&dof| dof.is_internal() || dof == Dof::ThetaZ).collect();
    metrics::AngleErrors::new(guess.as_ref(), truth.as_ref(), &active).mae()
}

/// How many principal components of the 20 internal angles hold `share` of their variance.
fn components_for(share: f64, frames: &[Pose]) -> usize {
    let angles = phalanx::targets(frames);
    let mean = row_means(&angles);
    let covariance = Mat::from_fn(Dof::INTERNAL, Dof::INTERNAL, |a, b| -> f64 {
        (0..frames.len()).map(|i| (angles[(a, i)] - mean[a]) * (angles[(b, i)] - mean[b])).sum()
    });
    let mut variances =
        covariance.self_adjoint_eigenvalues(Side::Lower).expect("a covariance has eigenvalues");
    variances.sort_by(|a, b| b.total_cmp(a));
    let total: f64 = variances.iter().sum();
    let mut held = 0.0;
    1 + variances
        .iter()
        .take_while(|variance| {
            held += **variance;
            held < share * total
        })
        .count()
}

fn row_means(values: &Mat<f64>) -> Vec<f64> {
    let columns = values.ncols();
    (0..values.nrows())
        .map(|row| (0..columns).map(|i| values[(row, i)]).sum::<f64>() / columns as f64)
        .collect()
}
