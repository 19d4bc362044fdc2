//! A fit from a start that is near.

use glam::DAffine3;
use phalanx_hand::{HandShape, Pose};

use crate::error::{Error, Result};
use crate::observation::evidence::Evidence;
use crate::pose_fit::fit::PoseFit;
use crate::pose_fit::settings::PoseFitSettings;
use crate::priors::pose::PosePrior;
use crate::solver::levenberg_marquardt::{State, levenberg_marquardt};
use crate::solver::problem::{Frame, FreeParameters, Problem};

impl PoseFitSettings {
    /// Fits a pose as [`fit`](Self::fit) does, at the last level alone and with hand and cameras as given:
    /// for starts that are within its reach, such as those that a motion predicts.
    ///
    /// # Errors
    /// As of [`fit`](Self::fit).
    pub fn fit_near<'e>(
        &self,
        hand: &HandShape,
        rest: &DAffine3,
        evidence: impl Into<Evidence<'e>>,
        start: &Pose,
        prior: &PosePrior,
    ) -> Result<PoseFit> {
        self.check()?;
        let evidence = evidence.into();
        hand.validate()?;
        let level =
            self.levels.last().filter(|_| !evidence.is_empty()).ok_or(Error::NoObservation)?;
        let mut views = vec![self.matchers(evidence.silhouettes)?];
        let problem = Problem {
            given: hand,
            rest,
            frames: vec![Frame { evidence, prior }],
            freedom: FreeParameters::default(),
        };
        let start =
            State { frames: vec![problem.frame_parameters(0, start)], shared: problem.shared() };
        let fitted = levenberg_marquardt(&problem, start, self.finest(), level.stop(), &mut views)?;
        self.concluded(&problem, &fitted, &mut views)
    }
}
