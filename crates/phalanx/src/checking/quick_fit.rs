//! Hands fitted to what was seen in a few steps, to find out whether they explain it.

use glam::DAffine3;
use phalanx_camera::Camera;
use phalanx_hand::{HandShape, Pose};
use phalanx_refine::{Level, PoseFitSettings, PosePrior, Screened, SilhouetteObservation};

use crate::error::Result;
use crate::estimator::observation::Observation;

/// A start is first drawn to borders that are three fingers' radii away, and then fitted closely enough
/// for its borders to be compared: a finger in the wrong place is a radius off.
const COARSE: Level = Level { reach: 12.0, every: 4, steps: 4 };
const CLOSE: Level = Level { reach: 3.0, every: 2, steps: 3 };

/// What was seen, to fit hands to.
pub(crate) struct QuickFit {
    rest: DAffine3,
    /// Nothing of a silhouette without a border.
    evidence: Vec<Option<SilhouetteObservation>>,
}

/// A hand after a few steps.
#[derive(Debug, Clone)]
pub(crate) struct Fitted {
    /// The share of each view's border that it explains.
    pub(crate) borders: Vec<f64>,
}

impl QuickFit {
    pub(crate) fn new(cameras: &[Camera], rest: DAffine3, observation: &Observation) -> Self {
        let views = observation.views.iter();
        Self {
            rest,
            evidence: views.map(|view| view.evidence(&cameras[view.camera]).ok()).collect(),
        }
    }

    /// The same without a view.
    pub(crate) fn without(&self, view: usize) -> Self {
        let mut evidence = self.evidence.clone();
        evidence[view] = None;
        Self { rest: self.rest, evidence }
    }

    /// The best hand after a few steps from some starts; nothing where it leads nowhere.
    pub(crate) fn best(
        &self,
        hand: &HandShape,
        starts: &[Pose],
        prior: &PosePrior,
    ) -> Result<Option<Fitted>> {
        let Some(coarse) = self.steps(hand, starts, prior, COARSE)? else { return Ok(None) };
        let Some(close) = self.steps(hand, &[coarse.pose], prior, CLOSE)? else { return Ok(None) };
        let mut unexplained = close.unexplained.iter();
        let share = |evidence: &Option<SilhouetteObservation>| {
            evidence.as_ref().and_then(|_| unexplained.next()).map_or(0.0, |share| 1.0 - share)
        };
        Ok(Some(Fitted { borders: self.evidence.iter().map(share).collect() }))
    }

    fn steps(
        &self,
        hand: &HandShape,
        starts: &[Pose],
        prior: &PosePrior,
        level: Level,
    ) -> Result<Option<Screened>> {
        let seen: Vec<SilhouetteObservation> = self.evidence.iter().flatten().cloned().collect();
        if seen.is_empty() {
            return Ok(None);
        }
        let settings = PoseFitSettings::default();
        let screened = settings.screen(hand, &self.rest, &seen, starts, prior, level)?;
        Ok(screened.into_iter().min_by(|a, b| a.energy.total_cmp(&b.energy)))
    }
}
