//! One frame: a pose fitted to what cameras saw.

use glam::{DAffine3, DVec3};
use phalanx_hand::{HandShape, Pose};

use crate::fit::{State, Stop, descend};
use crate::problem::{Frame, Freedom, Measure, Problem, Shared};
use crate::proportions::Proportions;
use crate::system::covariance;
use crate::view::View;
use crate::{Error, Evidence, PosePrior, Result};

/// How poses are refined.
#[derive(Debug, Clone, PartialEq)]
pub struct Refinement {
    /// From coarse to fine, how far borders may be apart and still count, px.
    pub reaches: Vec<f64>,
    /// Standard deviation of a border's place, px.
    pub noise: f64,
    /// Steps at most at each reach.
    pub steps: usize,
}

impl Default for Refinement {
    fn default() -> Self {
        Self { reaches: vec![8.0, 4.0, 2.0], noise: 0.5, steps: 12 }
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
            freedom: Freedom::default(),
        };
        let shared = Shared {
            proportions: Proportions::of(hand),
            corrections: vec![[DVec3::ZERO; 2]; evidence.len()],
        };
        let start = State { poses: vec![*start], shared };
        let finest = self.measure(*self.reaches.last().expect("checked"));
        let mut state = start.clone();
        let mut steps = 0;
        for &reach in &self.reaches {
            let stop = Stop { steps: self.steps, gain: 1e-3 };
            let outcome = descend(&problem, state, self.measure(reach), stop, &mut views)?;
            state = outcome.state;
            steps += outcome.steps;
        }
        // What was coarse may have led away from a good start.
        let stay = Stop { steps: 0, gain: 0.0 };
        let before = descend(&problem, start, finest, stay, &mut views)?;
        let after = descend(&problem, state, finest, stay, &mut views)?;
        let best = if after.energy <= before.energy { after } else { before };
        let best = descend(&problem, best.state, finest, Stop { steps: 1, gain: 1e-3 }, &mut views)?;
        let overlaps = views[0].iter().zip(evidence).map(|(view, seen)| seen.overlap(view.drawn()));
        Ok(Refined {
            pose: best.state.poses[0],
            covariance: covariance(&best.frames[0]).unwrap_or_default(),
            overlaps: overlaps.collect(),
            energy: best.energy,
            converged: best.converged,
            steps,
        })
    }

    fn measure(&self, reach: f64) -> Measure {
        Measure { reach, noise: self.noise }
    }

    fn check(&self) -> Result<()> {
        let wrong = |name, value, allowed| Err(Error::Parameter { name, value, allowed });
        if !(self.noise > 0.0 && self.noise.is_finite()) {
            return wrong("noise", self.noise, "positive");
        }
        match self.reaches.iter().find(|reach| !(**reach > 0.0 && reach.is_finite())) {
            Some(&reach) => wrong("reach", reach, "positive"),
            None if self.reaches.is_empty() => wrong("number of reaches", 0.0, "at least 1"),
            None => Ok(()),
        }
    }
}
