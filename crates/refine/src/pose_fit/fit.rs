//! A pose fitted to what cameras saw, from coarse to fine.

use glam::DAffine3;
use phalanx_hand::{HandShape, Pose};

use crate::error::{Error, Result};
use crate::geometry::correspondence::ViewMatcher;
use crate::geometry::drawn_term::DrawnTerm;
use crate::observation::evidence::Evidence;
use crate::observation::silhouette::SilhouetteObservation;
use crate::pose_fit::agreement::Agreement;
use crate::pose_fit::fitted_nuisance::FittedNuisance;
use crate::pose_fit::settings::PoseFitSettings;
use crate::posture_search::Search;
use crate::priors::pose::PosePrior;
use crate::solver::levenberg_marquardt::{ANY_ENERGY, Outcome, State, Stop, levenberg_marquardt};
use crate::solver::loss::RobustLoss;
use crate::solver::matched_frame::FramePoint;
use crate::solver::normal_equations::covariance;
use crate::solver::problem::{Frame, FreeParameters, Problem};

/// A refined pose.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseFit {
    /// The pose.
    pub pose: Pose,
    /// The posterior covariance of the prior's numbers ([`PosePrior::dofs`]), column after column,
    /// from the curvature of the energy, hand and cameras being unknown where they were fitted.
    pub covariance: Vec<f64>,
    /// Intersection over union of the drawn and the observed silhouette, for each view.
    pub ious: Vec<f64>,
    /// For each view, how much of its boundary the pose leaves unexplained: the mean robust squared
    /// distance over the most that it can be, 0 to 1.
    pub unexplained: Vec<f64>,
    /// The same of each view with landmarks, of which a point counts by its confidence.
    pub landmarks_unexplained: Vec<f64>,
    /// Root of the mean (robust) squared distance of the boundaries, px; 0 of landmarks alone.
    pub boundary_rms_px: f64,
    /// The hand's shape and the cameras' places, where they were fitted too.
    pub nuisance: Option<FittedNuisance>,
    /// The energy: half the robust squared distances of boundaries and landmarks over their noise, what areas between
    /// silhouettes cost ([`DrawnTerm`]), and what the prior and the joints' ranges say.
    pub energy: f64,
    /// Whether the last steps won nothing worth having.
    pub converged: bool,
    /// How many steps were tried.
    pub steps: usize,
}

/// What is tried in other postures.
#[derive(Clone, Copy)]
enum Tries {
    Digits,
    Pairs,
}

/// A start of at most so many times the energy that was reached from it is good in itself.
const GOOD: f64 = 2.0;

/// Share of a start's energy that must be won for the start to be left: some directions change the
/// energy so little that a pose would drift along them whenever it is refined again. Of what well-fitted
/// poses come to it is about a unit of the log-likelihood.
const WORTH_LEAVING: f64 = 0.005;

/// Share of a fit's energy that a search of postures must win, by its own count of pixels, for the fit
/// to be repeated from what it found.
const WORTH_FITTING: f64 = 0.02;

impl PoseFitSettings {
    /// Fits the pose of a hand, whose frame at rest is mapped to the world by `rest`, to what
    /// cameras saw, from `start`. Those numbers that the prior does not leave open keep their
    /// values.
    ///
    /// The energy after it is never above that of the start, as the last level has it of the hand and
    /// the cameras as they are given; and with these the start itself is what comes out unless
    /// another pose wins half a hundredth of that energy. Nuisance parameters, where they are fitted, are
    /// found anew each time.
    ///
    /// # Errors
    /// No evidence, a parameter out of its range, a hand that no one has or that a camera cannot
    /// draw.
    pub fn fit<'e>(
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
        if evidence.is_empty() {
            return Err(Error::NoObservation);
        }
        let mut views = vec![self.matchers(evidence.silhouettes)?];
        let mut problem = Problem {
            given: hand,
            rest,
            frames: vec![Frame { evidence, prior }],
            freedom: FreeParameters::default(),
        };
        let start =
            State { frames: vec![problem.frame_parameters(0, start)], shared: problem.shared() };
        let stay = Stop { steps: 0, ..self.levels[0].stop() };
        let given = levenberg_marquardt(&problem, start, self.finest(), stay, &mut views)?;
        let best = self.coarse_to_fine(&problem, &given, &mut views)?;
        let mut best = self.restart(&problem, best, &mut views)?;
        let stays = best.energy > (1.0 - WORTH_LEAVING) * given.energy;
        if stays {
            best = Outcome { steps: best.steps, ..given.clone() };
        }
        let misses = best.boundary_rms_px(self.noise);
        if let Some(nuisance) = self.nuisance.filter(|nuisance| misses > nuisance.above_rms_px) {
            problem.freedom = FreeParameters { hand: nuisance.hand, cameras: nuisance.cameras };
            best = self.fit_nuisance(&problem, &given, &best, &mut views)?;
            best = self.settled(&problem, best, &mut views)?;
        } else if !stays {
            best = self.settled(&problem, best, &mut views)?;
        }
        self.concluded(&problem, &best, &mut views)
    }

    /// The last level once more, until the fit has converged.
    fn settled(
        &self,
        problem: &Problem<'_>,
        best: Outcome,
        views: &mut [Vec<ViewMatcher>],
    ) -> Result<Outcome> {
        if best.converged || self.settling_steps == 0 {
            return Ok(best);
        }
        let Outcome { state, steps, .. } = best;
        let stop = self.settling();
        let mut settled = levenberg_marquardt(problem, state, self.finest(), stop, views)?;
        settled.steps += steps;
        Ok(settled)
    }

    /// What came of one frame.
    pub(crate) fn concluded(
        &self,
        problem: &Problem<'_>,
        best: &Outcome,
        views: &mut [Vec<ViewMatcher>],
    ) -> Result<PoseFit> {
        let agreements = self.agreements(problem, best, &mut views[0])?;
        let (_, shared_prior) = problem.shared_prior(&best.state.shared);
        let numbers = problem.frames[0].prior.dofs().len();
        let is_free = problem.freedom.hand.is_some() || problem.freedom.cameras.is_some();
        let nuisance = is_free.then(|| FittedNuisance::of(problem, &best.state));
        Ok(PoseFit {
            pose: best.state.frames[0].pose,
            covariance: covariance(&best.frames[0], &shared_prior, numbers).ok_or_else(|| {
                let reason = "leaves directions open that the silhouettes do not tell".to_owned();
                Error::Precision { reason }
            })?,
            ious: agreements.iter().map(|view| view.iou).collect(),
            unexplained: agreements.iter().map(|view| view.unexplained).collect(),
            landmarks_unexplained: best.landmarks_unexplained(),
            boundary_rms_px: best.boundary_rms_px(self.noise),
            energy: best.energy,
            nuisance,
            converged: best.converged,
            steps: best.steps,
        })
    }

    /// How well each view agrees with what came of one frame: by outlines, however it was fitted, so that one share can be
    /// compared with another.
    fn agreements(
        &self,
        problem: &Problem<'_>,
        best: &Outcome,
        views: &mut [ViewMatcher],
    ) -> Result<Vec<Agreement>> {
        let State { frames, shared } = &best.state;
        let loss = RobustLoss { drawn: DrawnTerm::Outline, ..self.finest() };
        let at = FramePoint { problem, frame: 0, parameters: &frames[0], shared, loss };
        let matched = at.matched(views, f64::INFINITY)?.expect("no energy is above infinity");
        let seen = problem.frames[0].evidence.silhouettes.iter();
        let of_view =
            |((seen, view), unexplained): ((&SilhouetteObservation, &ViewMatcher), f64)| {
                Agreement { iou: seen.iou(view.drawn()), unexplained }
            };
        Ok(seen.zip(&*views).zip(matched.unexplained()).map(of_view).collect())
    }

    /// Fits the nuisance parameters too: from a fit of the pose alone, and from a start that is nearly as good,
    /// since it may have been found with another hand.
    fn fit_nuisance(
        &self,
        problem: &Problem<'_>,
        given: &Outcome,
        fitted: &Outcome,
        views: &mut [Vec<ViewMatcher>],
    ) -> Result<Outcome> {
        let mut best = self.free_nuisance(problem, fitted, views)?;
        if fitted.energy < given.energy && given.energy <= GOOD * fitted.energy {
            let near = self.free_nuisance(problem, given, views)?;
            best = best.or(near);
        }
        self.restart(problem, best, views)
    }

    /// Fits the nuisance parameters too, from a fit of the pose alone.
    fn free_nuisance(
        &self,
        problem: &Problem<'_>,
        fitted: &Outcome,
        views: &mut [Vec<ViewMatcher>],
    ) -> Result<Outcome> {
        let parameters = problem.frame_parameters(0, &fitted.state.frames[0].pose);
        let state = State { frames: vec![parameters], shared: problem.shared() };
        let mut best = self.levels_from(1, problem, state.clone(), ANY_ENERGY, views)?;
        if best.energy > fitted.energy {
            // What was coarse led away.
            let tried = best.steps;
            best = self.levels_from(self.levels.len(), problem, state, ANY_ENERGY, views)?;
            best.steps += tried;
        }
        best.steps += fitted.steps;
        Ok(best)
    }

    /// Tries digits in other postures, first each alone and then neighbours together, until that
    /// wins nothing.
    fn restart(
        &self,
        problem: &Problem<'_>,
        mut best: Outcome,
        views: &mut [Vec<ViewMatcher>],
    ) -> Result<Outcome> {
        for _ in 0..self.max_restarts {
            let before = best.energy;
            for tries in [Tries::Digits, Tries::Pairs] {
                if best.boundary_rms_px(self.noise) <= self.restart_threshold {
                    return Ok(best);
                }
                let (state, won) = search_postures(problem, &best.state, tries, views)?;
                if won < WORTH_FITTING * best.energy {
                    continue;
                }
                let other = self.levels_from(1, problem, state, best.energy, views)?;
                best = best.or(other);
            }
            if best.energy >= before {
                break;
            }
        }
        Ok(best)
    }

    /// From coarse to fine with hand and cameras as given.
    fn coarse_to_fine(
        &self,
        problem: &Problem<'_>,
        given: &Outcome,
        views: &mut [Vec<ViewMatcher>],
    ) -> Result<Outcome> {
        let coarsest = &self.levels[0];
        let start = given.state.clone();
        let coarse =
            levenberg_marquardt(problem, start, self.loss(coarsest), coarsest.stop(), views)?;
        let mut after = self.levels_from(1, problem, coarse.state, ANY_ENERGY, views)?;
        after.steps += coarse.steps;
        // What was coarse may have led away from a good start.
        if given.energy > GOOD * after.energy {
            return Ok(after);
        }
        let start = given.state.clone();
        let near = self.levels_from(self.levels.len(), problem, start, after.energy, views)?;
        Ok(after.or(near))
    }

    /// The levels from one on. The last is not gone through unless its first step promises to lead
    /// below an energy.
    pub(crate) fn levels_from(
        &self,
        first: usize,
        problem: &Problem<'_>,
        start: State,
        target_energy: f64,
        views: &mut [Vec<ViewMatcher>],
    ) -> Result<Outcome> {
        let last = self.levels.len() - 1;
        let mut steps = 0;
        let mut state = start;
        for level in &self.levels[first.min(last)..last] {
            let outcome =
                levenberg_marquardt(problem, state, self.loss(level), level.stop(), views)?;
            steps += outcome.steps;
            state = outcome.state;
        }
        let level = &self.levels[last];
        let stop = Stop { target_energy, ..level.stop() };
        let mut outcome = levenberg_marquardt(problem, state, self.loss(level), stop, views)?;
        outcome.steps += steps;
        Ok(outcome)
    }
}

/// A state with the digits in better postures, and how much less speaks against it.
fn search_postures(
    problem: &Problem<'_>,
    state: &State,
    tries: Tries,
    views: &mut [Vec<ViewMatcher>],
) -> Result<(State, f64)> {
    let Frame { evidence, prior } = problem.frames[0];
    let FittedNuisance { hand, motions } = &FittedNuisance::of(problem, state);
    let (rest, evidence, views) = (problem.rest, evidence.silhouettes, &mut views[0]);
    let mut search = Search { hand, rest, evidence, prior, motions, views };
    let mut state = state.clone();
    let pose = &mut state.frames[0].pose;
    let found = match tries {
        Tries::Digits => search.run(pose)?,
        Tries::Pairs => search.run_pairs(pose)?,
    };
    *pose = found.pose;
    Ok((state, found.won))
}
