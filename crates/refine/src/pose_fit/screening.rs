//! Many starts, a few coarse steps each: which of them are worth a fit.

use glam::DAffine3;
use phalanx_hand::{HandShape, Pose};

use crate::error::{Error, Result};
use crate::observation::evidence::Evidence;
use crate::pose_fit::settings::{Level, PoseFitSettings};
use crate::priors::pose::PosePrior;
use crate::solver::levenberg_marquardt::{ANY_ENERGY, State, Stop, levenberg_marquardt};
use crate::solver::problem::{Frame, FreeParameters, Problem};

/// A start after a few coarse steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Screened {
    /// Where the steps led.
    pub pose: Pose,
    /// What speaks against the pose.
    pub energy: f64,
    /// For each view, how much of its boundary the pose leaves unexplained: the mean robust squared
    /// distance over the most that it can be, 0 to 1.
    pub unexplained: Vec<f64>,
    /// The same of each view with landmarks.
    pub landmarks_unexplained: Vec<f64>,
}

impl PoseFitSettings {
    /// Takes a few steps from each start at one level of detail, with hand and cameras as given, and
    /// says how well each then fits. Energies of one call can be compared with each other.
    ///
    /// # Errors
    /// As of [`fit`](Self::fit).
    pub fn screen<'e>(
        &self,
        hand: &HandShape,
        rest: &DAffine3,
        evidence: impl Into<Evidence<'e>>,
        starts: &[Pose],
        prior: &PosePrior,
        level: Level,
    ) -> Result<Vec<Screened>> {
        self.check()?;
        let evidence = evidence.into();
        hand.validate()?;
        if evidence.is_empty() {
            return Err(Error::NoObservation);
        }
        let mut views = vec![self.matchers(evidence.silhouettes)?];
        let problem = Problem {
            given: hand,
            rest,
            frames: vec![Frame { evidence, prior }],
            freedom: FreeParameters::default(),
        };
        let loss = self.loss(&level);
        let stop = Stop { steps: level.steps, gain: COARSE_GAIN, target_energy: ANY_ENERGY };
        let mut screened = Vec::with_capacity(starts.len());
        for start in starts {
            let state = State {
                frames: vec![problem.frame_parameters(0, start)],
                shared: problem.shared(),
            };
            match levenberg_marquardt(&problem, state, loss, stop, &mut views) {
                Ok(outcome) => screened.push(Screened {
                    pose: outcome.state.frames[0].pose,
                    energy: outcome.energy,
                    unexplained: outcome.unexplained(loss),
                    landmarks_unexplained: outcome.landmarks_unexplained(),
                }),
                // A start that a camera cannot draw leads nowhere.
                Err(Error::Render { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(screened)
    }
}

/// Share of the energy that a coarse step must win to be followed by another: starts that compete
/// differ by more.
const COARSE_GAIN: f64 = 0.02;
