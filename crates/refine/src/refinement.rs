//! One frame: a pose fitted to what cameras saw.

use glam::{DAffine3, DVec3};
use phalanx_hand::{HandShape, Pose};

use crate::fit::{State, Stop, descend};
use crate::problem::{Frame, Freedom, Measure, Moment, Problem, Shared};
use crate::proportions::Proportions;
use crate::search::try_postures;
use crate::system::covariance;
use crate::view::View;
use crate::{Error, Evidence, PosePrior, Result};

/// How poses are refined.
#[derive(Debug, Clone, PartialEq)]
pub struct Refinement {
    /// From coarse to fine.
    pub levels: Vec<Level>,
    /// Standard deviation of a border's place, px.
    pub noise: f64,
    /// Standard deviation of what segmentation adds to or takes from a whole border, px.
    pub margin: f64,
    /// How uncertain the hand is: standard deviations of the logarithms of its size and of each bone
    /// and radius.
    pub hand: Option<[f64; 2]>,
    /// How uncertain the cameras are: turn, radians, and shift, mm.
    pub cameras: Option<[f64; 2]>,
}

/// A level of detail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// How far borders may be apart and still count, px.
    pub reach: f64,
    /// Of so many places along the border one is looked at.
    pub every: usize,
    /// Steps at most.
    pub steps: usize,
}

impl Default for Refinement {
    fn default() -> Self {
        let level = |reach, every, steps| Level { reach, every, steps };
        Self { levels: vec![level(12.0, 4, 8), level(3.0, 2, 8), level(1.0, 1, 8)], noise: 0.5, margin: 0.5, hand: None, cameras: None }
    }
}

/// A refined pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Refined {
    /// The pose.
    pub pose: Pose,
    /// The posterior covariance of the prior's numbers ([`PosePrior::dofs`]), column after column,
    /// from the curvature of the energy.
    pub covariance: Vec<f64>,
    /// Intersection over union of the drawn and the observed silhouette, for each view.
    pub overlaps: Vec<f64>,
    /// The energy: half the robust squared distances of the borders over their noise, and what the
    /// prior and the joints' ranges say.
    pub energy: f64,
    /// Whether the last steps won nothing worth having.
    pub converged: bool,
    /// How many steps were tried.
    pub steps: usize,
}

impl Refinement {
    /// Fits the pose of a hand, whose frame at rest is mapped to the world by `rest`, to what
    /// cameras saw, from `start`. Those numbers that the prior does not leave open keep their
    /// values.
    ///
    /// The result's energy is never above that of the start.
    ///
    /// # Errors
    /// No evidence, a parameter out of its range, a hand that no one has or that a camera cannot
    /// draw.
    pub fn run(
        &self,
        hand: &HandShape,
        rest: &DAffine3,
        evidence: &[Evidence],
        start: &Pose,
        prior: &PosePrior,
    ) -> Result<Refined> {
        self.check()?;
        hand.validate()?;
        if evidence.is_empty() {
            return Err(Error::NoEvidence);
        }
        let mut views = vec![evidence.iter().map(View::new).collect::<Result<Vec<_>>>()?];
        let problem = Problem {
            given: hand,
            rest,
            frames: vec![Frame { evidence, prior }],
            freedom: Freedom { hand: self.hand, cameras: self.cameras },
        };
        let shared = Shared {
            proportions: Proportions::of(hand),
            corrections: vec![[DVec3::ZERO; 2]; evidence.len()],
        };
        let start = State { moments: vec![Moment { pose: *start, margins: vec![0.0; evidence.len()] }], shared };
        let finest = self.measure(self.levels.last().expect("checked"));
        let mut state = start.clone();
        let mut steps = 0;
        for (k, level) in self.levels.iter().enumerate() {
            let stop = Stop { steps: level.steps, gain: 1e-3 };
            let outcome = descend(&problem, state, self.measure(level), stop, &mut views)?;
            state = outcome.state;
            steps += outcome.steps;
            if k == 0 && std::env::var("SEARCH").is_ok() {
                let pose = &mut state.moments[0].pose;
                *pose = try_postures(hand, rest, evidence, prior, pose, &mut views[0])?;
            }
        }
        // What was coarse may have led away from a good start.
        let stay = Stop { steps: 0, gain: 0.0 };
        let before = descend(&problem, start, finest, stay, &mut views)?;
        let after = descend(&problem, state, finest, stay, &mut views)?;
        let best = if after.energy <= before.energy { after } else { before };
        let best = descend(&problem, best.state, finest, Stop { steps: 1, gain: 1e-3 }, &mut views)?;
        let overlaps = views[0].iter().zip(evidence).map(|(view, seen)| seen.overlap(view.drawn()));
        Ok(Refined {
            pose: best.state.moments[0].pose,
            covariance: covariance(&best.frames[0], prior.dofs().len()).unwrap_or_default(),
            overlaps: overlaps.collect(),
            energy: best.energy,
            converged: best.converged,
            steps,
        })
    }

    fn measure(&self, level: &Level) -> Measure {
        Measure { reach: level.reach, noise: self.noise, margin: self.margin, every: level.every }
    }

    fn check(&self) -> Result<()> {
        let wrong = |name, value, allowed| Err(Error::Parameter { name, value, allowed });
        if !(self.noise > 0.0 && self.noise.is_finite()) {
            return wrong("noise", self.noise, "positive");
        }
        for level in &self.levels {
            if !(level.reach > 0.0 && level.reach.is_finite()) {
                return wrong("reach", level.reach, "positive");
            }
            if level.every == 0 {
                return wrong("every", 0.0, "at least 1");
            }
        }
        match self.levels.last() {
            None => wrong("number of levels", 0.0, "at least 1"),
            Some(level) if level.every != 1 => {
                wrong("every of the last level", level.every as f64, "1")
            }
            Some(_) => Ok(()),
        }
    }
}
