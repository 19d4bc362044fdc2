//! The data sets of the paper's § 3: trajectories of the fingers, each repeated at seven θ_Z.

use std::path::Path;

use anyhow::{Result, bail};
use phalanx_hand::{Dof, Pose, Unit};

use crate::files;

/// The paper's seven angles about the forearm, degrees.
const THETA_Z_DEG: [f64; 7] = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0];

/// Poses to learn from, with the name that tables give them.
pub(crate) struct DataSet {
    pub(crate) name: String,
    pub(crate) poses: Vec<Pose>,
}

impl DataSet {
    /// `open-close` or `complex`, from `fixtures/trajectories/`.
    pub(crate) fn stored(name: &str) -> Result<Self> {
        let path = files::in_repository(&format!("fixtures/trajectories/{name}.csv"));
        Self::from_file(name, &path)
    }

    /// Any trajectory from a file. Where θ_Z does not vary in it, every pose is repeated at the
    /// paper's seven angles, as the paper did with its glove's recordings; where it varies, the
    /// poses are taken as they are.
    pub(crate) fn from_file(name: &str, path: &Path) -> Result<Self> {
        let frames = files::poses(path)?.poses;
        let turns = frames.iter().any(|pose| pose[Dof::ThetaZ] != frames[0][Dof::ThetaZ]);
        let poses = if turns { frames } else { at_seven_angles(&frames) };
        Ok(Self { name: name.to_owned(), poses })
    }

    /// The angles that vary: those over which errors are averaged.
    pub(crate) fn active_angles(&self) -> Result<Vec<Dof>> {
        let varies = |dof: &Dof| self.poses.iter().any(|pose| pose[*dof] != self.poses[0][*dof]);
        let active: Vec<Dof> =
            Dof::ALL.into_iter().filter(|dof| dof.unit() == Unit::Angle).filter(varies).collect();
        if active.is_empty() {
            bail!("data set '{}': no angle varies", self.name);
        }
        Ok(active)
    }
}

/// Every pose at each of the seven angles, frame by frame.
pub(crate) fn at_seven_angles(frames: &[Pose]) -> Vec<Pose> {
    let turned = |pose: &Pose| {
        THETA_Z_DEG.map(|degrees| {
            let mut pose = *pose;
            pose[Dof::ThetaZ] = degrees.to_radians();
            pose
        })
    };
    frames.iter().flat_map(turned).collect()
}
