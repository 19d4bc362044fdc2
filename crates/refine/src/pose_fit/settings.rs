//! How poses are refined.

use crate::error::{Error, Result};
use crate::geometry::correspondence::ViewMatcher;
use crate::geometry::drawn_term::DrawnTerm;
use crate::observation::silhouette::SilhouetteObservation;
use crate::priors::nuisance::NuisanceParameters;
use crate::solver::levenberg_marquardt::{ANY_ENERGY, Stop};
use crate::solver::loss::RobustLoss;

/// How poses are refined.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseFitSettings {
    /// From coarse to fine.
    pub levels: Vec<Level>,
    /// Standard deviation of a boundary's place, px; the levels' reach goes with it
    /// ([`of_noise`](Self::of_noise)).
    pub noise: f64,
    /// Standard deviation of what segmentation adds to or takes from a whole boundary, px.
    pub margin: f64,
    /// How often digits are tried in other postures again where boundaries stay further apart than
    /// `restart_threshold`.
    pub max_restarts: usize,
    /// Root of the mean (robust) squared distance of the boundaries that needs no second try, px.
    pub restart_threshold: f64,
    /// Steps at most that a fit takes in the end until it has [converged](crate::PoseFit::converged).
    pub settling_steps: usize,
    /// The share of its boundary from which on a view that a pose leaves unexplained counts less, so that one
    /// that shows something else cannot drag the pose along; `None` where all views are believed.
    pub disagreement: Option<f64>,
    /// How it counts where the drawn hand's silhouette is not the observed one.
    pub drawn: DrawnTerm,
    /// What may be otherwise than given; `None` where hand and cameras are certain.
    pub nuisance: Option<NuisanceParameters>,
}

/// A level of detail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// How far boundaries may be apart and still count, px.
    pub reach: f64,
    /// Of so many places along the boundary one is looked at.
    pub every: usize,
    /// Steps at most.
    pub steps: usize,
}

/// Share of the energy that a step must win to be followed by another.
const GAIN: f64 = 1e-3;

impl Level {
    pub(crate) fn stop(&self) -> Stop {
        Stop { steps: self.steps, gain: GAIN, target_energy: ANY_ENERGY }
    }
}

impl Default for PoseFitSettings {
    fn default() -> Self {
        let level = |reach, every, steps| Level { reach, every, steps };
        Self {
            levels: vec![level(12.0, 4, 6), level(3.0, 2, 6), level(1.0, 1, 6)],
            noise: 0.5,
            margin: 1.0,
            max_restarts: 1,
            restart_threshold: 0.29,
            settling_steps: 20,
            disagreement: None,
            drawn: DrawnTerm::Outline,
            nuisance: None,
        }
    }
}

impl PoseFitSettings {
    /// The default where boundaries are known to a standard deviation of `noise` px: as much further apart
    /// they still count, but nowhere further than the coarsest level lets them. Boundaries that no longer
    /// count within what they are known to let a digit stretch out beyond a silhouette at no cost.
    ///
    /// ```
    /// use phalanx_refine::PoseFitSettings;
    ///
    /// assert_eq!(PoseFitSettings::of_noise(0.5), PoseFitSettings::default());
    /// let levels = PoseFitSettings::of_noise(2.0).levels;
    /// let reaches: Vec<f64> = levels.iter().map(|level| level.reach).collect();
    /// assert_eq!(reaches, [12.0, 12.0, 4.0]);
    /// ```
    #[must_use]
    pub fn of_noise(noise: f64) -> Self {
        let Self { levels, noise: usual, .. } = Self::default();
        let farthest = levels.iter().map(|level| level.reach).fold(0.0, f64::max);
        let reach = |reach: f64| (noise / usual * reach).min(farthest);
        let level = |level: Level| Level { reach: reach(level.reach), ..level };
        Self { noise, levels: levels.into_iter().map(level).collect(), ..Self::default() }
    }

    /// The default for a hand and cameras that may not be as they are given.
    #[must_use]
    pub fn of_strangers() -> Self {
        Self { nuisance: Some(NuisanceParameters::default()), ..Self::default() }
    }

    /// When a fit that has gone through all levels stops: where it has converged.
    pub(crate) fn settling(&self) -> Stop {
        Stop { steps: self.settling_steps, gain: 0.0, target_energy: ANY_ENERGY }
    }

    /// The measure of the last level.
    pub(crate) fn finest(&self) -> RobustLoss {
        self.loss(self.levels.last().expect("checked"))
    }

    pub(crate) fn loss(&self, level: &Level) -> RobustLoss {
        RobustLoss {
            reach: level.reach,
            noise: self.noise,
            margin: self.margin,
            every: level.every,
            disagreement: self.disagreement.unwrap_or(f64::INFINITY),
            drawn: self.drawn,
        }
    }

    /// What one pose after another is compared with the observed boundaries in.
    pub(crate) fn matchers(&self, evidence: &[SilhouetteObservation]) -> Result<Vec<ViewMatcher>> {
        evidence.iter().map(|seen| ViewMatcher::new(seen, self.noise)).collect()
    }

    pub(crate) fn check(&self) -> Result<()> {
        let wrong = |name, value, allowed| Err(Error::Parameter { name, value, allowed });
        if !(self.noise > 0.0 && self.noise.is_finite()) {
            return wrong("noise", self.noise, "positive");
        }
        if !(self.margin > 0.0 && self.margin.is_finite()) {
            return wrong("margin", self.margin, "positive");
        }
        if let Some(value) = self.disagreement.filter(|value| value.is_nan() || *value <= 0.0) {
            return wrong("disagreement", value, "positive");
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
            Some(_) => Ok(()),
        }
    }
}
