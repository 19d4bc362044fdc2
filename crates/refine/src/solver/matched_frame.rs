//! A frame's views matched with a pose: its energy, before any slope is worked out.

use glam::DVec3;
use phalanx_hand::{HandShape, PosedHand};

use crate::error::Result;
use crate::geometry::correspondence::ViewMatcher;
use crate::geometry::drawn_term::DrawnTerm;
use crate::observation::silhouette::SilhouetteObservation;
use crate::priors::gaussian::GaussianPenalty;
use crate::priors::nuisance::ExtrinsicsCorrection;
use crate::solver::jacobian::Place;
use crate::solver::loss::RobustLoss;
use crate::solver::normal_equations::NormalEquations;
use crate::solver::problem::{Frame, FrameParameters, Problem, SharedParameters};

/// Where it is counted how many pixels a millimetre is.
pub(super) enum DistanceAt {
    /// Where the hand is expected: its distance follows from where several views see it.
    Rest(DVec3),
    /// Where the hand is. One view sees rays pass a hand the nearer, in millimetres, the closer it comes to
    /// the camera; only in pixels that says nothing for it.
    Hand(DVec3),
}

/// One frame of a problem, and the numbers that it is looked at with.
#[derive(Clone, Copy)]
pub(crate) struct FramePoint<'a> {
    pub(crate) problem: &'a Problem<'a>,
    pub(crate) frame: usize,
    pub(crate) parameters: &'a FrameParameters,
    pub(crate) shared: &'a SharedParameters,
    pub(crate) loss: RobustLoss,
}

/// A view's boundary beside a posed hand.
pub(super) struct MatchedBoundary<'a> {
    pub(super) place: Place<'a>,
    /// How many pixels a millimetre is.
    pub(super) scale: f64,
    /// By which share that grows as the pose moves by a millimetre, along the axes of the frame at rest.
    pub(super) nearer: DVec3,
    /// How far rays pass the hand, px, in the order of the view's correspondences.
    pub(super) distances: Vec<f64>,
    /// How far the whole boundary lies outside the hand, px.
    pub(super) margin: f64,
    /// What the areas between the silhouettes cost, if they are looked at, each place counting once.
    pub(super) areas: f64,
    /// How far the boundary is off its place, over what it is where pixels were seen at once.
    pub(super) grain: f64,
    /// The share of it that is unexplained.
    pub(super) unexplained: f64,
    /// How much each place counts in the frame's energy, and in its slope.
    pub(super) weights: [f64; 2],
}

/// A frame whose views are matched.
pub(crate) struct MatchedFrame<'a> {
    pub(super) at: FramePoint<'a>,
    pub(super) hand: HandShape,
    pub(super) posed: PosedHand,
    pub(super) boundaries: Vec<MatchedBoundary<'a>>,
    /// What is known of the frame beforehand.
    pub(super) prior: NormalEquations,
}

/// Sums of the same energies in another order differ by less than this share.
const ROUNDING: f64 = 1e-9;

impl DistanceAt {
    pub(super) fn of(problem: &Problem<'_>, frame: usize, parameters: &FrameParameters) -> Self {
        if problem.frames[frame].evidence.views() > 1 {
            return Self::Rest(problem.rest.translation);
        }
        Self::Hand(problem.rest.transform_point3(parameters.pose.translation()))
    }

    pub(super) fn point(&self) -> DVec3 {
        let (Self::Rest(point) | Self::Hand(point)) = *self;
        point
    }

    fn slope(&self, seen: &SilhouetteObservation, problem: &Problem<'_>) -> DVec3 {
        match self {
            Self::Rest(_) => DVec3::ZERO,
            Self::Hand(point) => problem.rest.matrix3.transpose() * seen.nearer(*point),
        }
    }
}

impl MatchedFrame<'_> {
    /// For each view, the share of its boundary that is unexplained.
    pub(crate) fn unexplained(&self) -> Vec<f64> {
        self.boundaries.iter().map(|boundary| boundary.unexplained).collect()
    }
}

impl<'a> FramePoint<'a> {
    /// The frame with its views matched; `None` as soon as its energy is surely above `most`.
    pub(crate) fn matched(
        self,
        views: &mut [ViewMatcher],
        most: f64,
    ) -> Result<Option<MatchedFrame<'a>>> {
        let Self { problem, frame, parameters, shared, loss } = self;
        let Frame { evidence, prior } = &problem.frames[frame];
        let hand = match problem.freedom.hand {
            Some(_) => shared.shape.hand(problem.given),
            None => problem.given.clone(),
        };
        let posed = hand.pose(&parameters.pose, problem.rest);
        let [own, of_all] = self.unknowns();
        let mut known = NormalEquations::new(own, of_all);
        known.add_prior(prior, &parameters.pose);
        known
            .add_penalties(self.first_correction(), &problem.penalties_of(&parameters.corrections));
        let distance_at = DistanceAt::of(problem, frame, parameters);
        let mut energy = known.energy;
        let mut boundaries = Vec::with_capacity(views.len());
        for (v, (view, seen)) in views.iter_mut().zip(evidence.silhouettes).enumerate() {
            let place = Place::new(seen.camera(), self.correction(v), problem.rest.translation);
            let scale = seen.pixels_per_mm(distance_at.point());
            view.match_boundary(&place.seen(&posed.primitives), seen, loss.every, loss.drawn)?;
            let distances =
                view.correspondences.iter().map(|found| scale * found.approach.distance);
            let distances: Vec<f64> = distances.collect();
            let margin = loss.margin(&distances);
            let energies: f64 = distances.iter().map(|d| loss.energy(d - margin)).sum();
            let grain = seen.grain();
            let areas = match loss.drawn {
                DrawnTerm::Outline => 0.0,
                DrawnTerm::Area => {
                    let differences = seen.differences(view.drawn());
                    differences.map(|apart| loss.density(apart / grain)).sum::<f64>() / grain
                }
            };
            let unexplained = loss.unexplained(energies, distances.len(), areas);
            let belief = loss.belief(unexplained, evidence.views());
            let weights = belief.map(|share| share * seen.weight());
            // All that is added later only adds to the energy.
            energy +=
                weights[0] * (energies + areas) + GaussianPenalty::new(margin, loss.margin).energy;
            if energy > most * (1.0 + ROUNDING) {
                return Ok(None);
            }
            let nearer = distance_at.slope(seen, problem);
            boundaries.push(MatchedBoundary {
                place,
                scale,
                nearer,
                distances,
                margin,
                areas,
                grain,
                unexplained,
                weights,
            });
        }
        if loss.drawn == DrawnTerm::Area {
            for (view, seen) in views.iter_mut().zip(evidence.silhouettes) {
                view.match_areas(seen, loss.every);
            }
        }
        Ok(Some(MatchedFrame { at: self, hand, posed, boundaries, prior: known }))
    }

    /// How a view's camera stands otherwise than given.
    pub(super) fn correction(&self, view: usize) -> Option<&'a ExtrinsicsCorrection> {
        self.parameters.corrections.get(view).or(self.shared.corrections.get(view))
    }

    /// Where the frame's own corrections begin among its unknowns.
    pub(super) fn first_correction(&self) -> usize {
        let Frame { evidence, prior } = &self.problem.frames[self.frame];
        prior.dofs().len() + evidence.silhouettes.len()
    }

    /// How many proportions of the hand are unknown.
    pub(super) fn of_hand(&self) -> usize {
        self.problem.freedom.hand.map_or(0, |_| self.shared.shape.logarithms.len())
    }

    /// How many unknowns are the frame's own, and how many are all frames'.
    fn unknowns(&self) -> [usize; 2] {
        let numbers = ExtrinsicsCorrection::NUMBERS;
        let own = self.first_correction() + numbers * self.parameters.corrections.len();
        [own, self.of_hand() + numbers * self.shared.corrections.len()]
    }
}
