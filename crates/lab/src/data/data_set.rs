//! The data sets of the paper's § 3: trajectories of the fingers, each repeated at seven θ_Z.

use std::path::Path;

use anyhow::{Result, bail};
use phalanx::{FixedPoses, OrientationRule, Progress, describe_each};
use phalanx_camera::Rig;
use phalanx_hand::{Dof, HandShape, Pose, Unit};

use crate::data::described::Described;
use crate::files;

/// The paper's seven angles about the forearm, degrees.
pub(crate) const THETA_Z_DEG: [f64; 7] = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0];

/// Poses to learn from, with the name that tables give them.
pub(crate) struct DataSet {
    pub(crate) name: String,
    pub(crate) poses: Vec<Pose>,
}

impl DataSet {
    /// `open-close` or `complex`, from `fixtures/trajectories/`.
    pub(crate) fn stored(name: &str) -> Result<Self> {
        let path = files::in_repository(&format!("fixtures/trajectories/{name}.csv"));
        Ok(Self { name: name.to_owned(), poses: at_seven_angles(&files::poses(&path)?.poses) })
    }

    /// Any trajectory from a file. Where θ_Z does not vary in it, every pose is repeated at the
    /// paper's seven angles, as the paper did with its glove's recordings; where it varies, the
    /// poses are taken as they are.
    pub(crate) fn from_file(name: &str, path: &Path) -> Result<Self> {
        let frames = files::poses(path)?.poses;
        let theta_z = frames[0][Dof::ThetaZ];
        let turns = frames.iter().any(|pose| pose[Dof::ThetaZ] != theta_z);
        if turns {
            return Ok(Self { name: name.to_owned(), poses: frames });
        }
        eprintln!(
            "{}: {} is {:.1} degrees in all {} rows: each is repeated at 0, 15, ... 90 degrees",
            path.display(),
            Dof::ThetaZ,
            theta_z.to_degrees(),
            frames.len()
        );
        Ok(Self { name: name.to_owned(), poses: at_seven_angles(&frames) })
    }

    /// Draws and describes every pose. Those that some camera does not show well enough are
    /// left out of the set, and said so on standard error.
    ///
    /// # Errors
    /// An unusable rig, fewer than four poses left (two to learn from and two to test on), or
    /// poses of which no angle varies.
    pub(crate) fn describe(
        self,
        rig: &Rig,
        hand: &HandShape,
        progress: &dyn Progress,
    ) -> Result<Described> {
        let (name, all) = (self.name, self.poses.len());
        let scenes = FixedPoses { rig, hand, poses: &self.poses };
        let results = describe_each(rig, &scenes, OrientationRule::HandAxis, progress)?;
        let (mut poses, mut contexts, mut first) = (Vec::new(), Vec::new(), None);
        for (pose, result) in self.poses.into_iter().zip(results) {
            match result {
                Ok(described) => {
                    poses.push(pose);
                    contexts.push(described);
                }
                Err(error) => first = first.or(Some(error)),
            }
        }
        if let Some(error) = first {
            let left_out = all - poses.len();
            eprintln!("{name}: {left_out} of {all} poses are left out; the first: {error:#}");
        }
        if poses.len() < 4 {
            bail!("data set '{name}': {} poses are too few to split", poses.len());
        }
        let active = active_angles(&poses);
        if active.is_empty() {
            bail!("data set '{name}': no angle varies");
        }
        Ok(Described { name, poses, contexts, active })
    }
}

/// The angles that vary: those over which errors are averaged.
pub(crate) fn active_angles(poses: &[Pose]) -> Vec<Dof> {
    let varies = |dof: &Dof| poses.iter().any(|pose| pose[*dof] != poses[0][*dof]);
    Dof::ALL.into_iter().filter(|dof| dof.unit() == Unit::Angle).filter(varies).collect()
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
