//! A pose fitted to what cameras saw, from coarse to fine.

use glam::DAffine3;
use phalanx_hand::{HandShape, Pose};

use crate::error::{Error, Result};
use crate::geometry::correspondence::View;
use crate::observation::silhouette::Evidence;
use crate::pose_fit::settings::Refinement;
use crate::posture_search::Search;
use crate::priors::pose::PosePrior;
use crate::solver::levenberg_marquardt::{ANY_ENERGY, Outcome, State, Stop, descend, overlaps};
use crate::solver::normal_equations::covariance;
use crate::solver::problem::{Frame, Freedom, Problem};

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
    /// For each view, how much of its border the pose leaves unexplained: the mean robust squared
    /// distance over the most that it can be, 0 to 1.
    pub unexplained: Vec<f64>,
    /// Root of the mean (robust) squared distance of the borders, px.
    pub border_px: f64,
    /// Whether hand and cameras had to be doubted.
    pub doubted: bool,
    /// The energy: half the robust squared distances of the borders over their noise, and what the
    /// prior and the joints' ranges say.
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

impl Refinement {
    /// Fits the pose of a hand, whose frame at rest is mapped to the world by `rest`, to what
    /// cameras saw, from `start`. Those numbers that the prior does not leave open keep their
    /// values.
    ///
    /// The energy after it is never above that of the start, as the last level has it of the hand and
    /// the cameras as they are given; and with these the start itself is what comes out unless
    /// another pose wins half a hundredth of that energy. Where hand and cameras are doubted, they are
    /// found anew each time.
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
        let mut problem = Problem {
            given: hand,
            rest,
            frames: vec![Frame { evidence, prior }],
            freedom: Freedom::default(),
        };
        let start = State { moments: vec![problem.moment(0, start)], shared: problem.shared() };
        let stay = Stop { steps: 0, ..self.levels[0].stop() };
        let given = descend(&problem, start, self.finest(), stay, &mut views)?;
        let best = self.descend(&problem, &given, &mut views)?;
        let mut best = self.retry(&problem, best, &mut views)?;
        if best.energy > (1.0 - WORTH_LEAVING) * given.energy {
            best = Outcome { converged: best.converged, steps: best.steps, ..given.clone() };
        }
        let mut doubted = false;
        if let Some(doubt) = self.doubt.filter(|doubt| best.border_px(self.noise) > doubt.beyond) {
            doubted = true;
            problem.freedom = Freedom { hand: doubt.hand, cameras: doubt.cameras };
            best = self.doubt(&problem, &given, &best, &mut views)?;
        }
        let overlaps = overlaps(&problem, &best.state, self.finest(), &mut views)?.swap_remove(0);
        Ok(Refined {
            pose: best.state.moments[0].pose,
            covariance: covariance(&best.frames[0], prior.dofs().len()).ok_or_else(|| {
                let reason = "leaves directions open that the silhouettes do not tell".to_owned();
                Error::Precision { reason }
            })?,
            overlaps,
            unexplained: best.unexplained(self.finest()),
            border_px: best.border_px(self.noise),
            energy: best.energy,
            doubted,
            converged: best.converged,
            steps: best.steps,
        })
    }

    /// Fits what is doubted too: from a fit of the pose alone, and from a start that is nearly as good,
    /// since it may have been found with another hand.
    fn doubt(
        &self,
        problem: &Problem<'_>,
        given: &Outcome,
        fitted: &Outcome,
        views: &mut [Vec<View>],
    ) -> Result<Outcome> {
        let mut best = self.loosen(problem, fitted, views)?;
        if fitted.energy < given.energy && given.energy <= GOOD * fitted.energy {
            let near = self.loosen(problem, given, views)?;
            best = best.or(near);
        }
        self.retry(problem, best, views)
    }

    /// Fits what is doubted too, from a fit of the pose alone.
    fn loosen(
        &self,
        problem: &Problem<'_>,
        fitted: &Outcome,
        views: &mut [Vec<View>],
    ) -> Result<Outcome> {
        let moment = problem.moment(0, &fitted.state.moments[0].pose);
        let state = State { moments: vec![moment], shared: problem.shared() };
        let mut best = self.descend_from(1, problem, state.clone(), ANY_ENERGY, views)?;
        if best.energy > fitted.energy {
            // What was coarse led away.
            let tried = best.steps;
            best = self.descend_from(self.levels.len(), problem, state, ANY_ENERGY, views)?;
            best.steps += tried;
        }
        best.steps += fitted.steps;
        Ok(best)
    }

    /// Tries digits in other postures, first each alone and then neighbours together, until that
    /// wins nothing.
    fn retry(
        &self,
        problem: &Problem<'_>,
        mut best: Outcome,
        views: &mut [Vec<View>],
    ) -> Result<Outcome> {
        for _ in 0..self.retries {
            let before = best.energy;
            for tries in [Tries::Digits, Tries::Pairs] {
                if best.border_px(self.noise) <= self.content {
                    return Ok(best);
                }
                let (state, won) = searched(problem, &best.state, tries, views)?;
                if won < WORTH_FITTING * best.energy {
                    continue;
                }
                let other = self.descend_from(1, problem, state, best.energy, views)?;
                best = best.or(other);
            }
            if best.energy >= before {
                break;
            }
        }
        Ok(best)
    }

    /// From coarse to fine with hand and cameras as given.
    fn descend(
        &self,
        problem: &Problem<'_>,
        given: &Outcome,
        views: &mut [Vec<View>],
    ) -> Result<Outcome> {
        let coarsest = &self.levels[0];
        let start = given.state.clone();
        let coarse = descend(problem, start, self.measure(coarsest), coarsest.stop(), views)?;
        let mut after = self.descend_from(1, problem, coarse.state, ANY_ENERGY, views)?;
        after.steps += coarse.steps;
        // What was coarse may have led away from a good start.
        if given.energy > GOOD * after.energy {
            return Ok(after);
        }
        let start = given.state.clone();
        let near = self.descend_from(self.levels.len(), problem, start, after.energy, views)?;
        Ok(after.or(near))
    }

    /// The levels from one on. The last is not gone through unless its first step promises to lead
    /// below an energy.
    pub(crate) fn descend_from(
        &self,
        first: usize,
        problem: &Problem<'_>,
        start: State,
        hope: f64,
        views: &mut [Vec<View>],
    ) -> Result<Outcome> {
        let last = self.levels.len() - 1;
        let mut steps = 0;
        let mut state = start;
        for level in &self.levels[first.min(last)..last] {
            let outcome = descend(problem, state, self.measure(level), level.stop(), views)?;
            steps += outcome.steps;
            state = outcome.state;
        }
        let level = &self.levels[last];
        let stop = Stop { hope, ..level.stop() };
        let mut outcome = descend(problem, state, self.measure(level), stop, views)?;
        outcome.steps += steps;
        Ok(outcome)
    }
}

/// A state with the digits in better postures, and how much less speaks against it.
fn searched(
    problem: &Problem<'_>,
    state: &State,
    tries: Tries,
    views: &mut [Vec<View>],
) -> Result<(State, f64)> {
    let Frame { evidence, prior } = problem.frames[0];
    let motions: Vec<DAffine3> = (0..evidence.len())
        .map(|view| problem.motion(&state.moments[0], &state.shared, view))
        .collect();
    let mut search = Search {
        hand: &state.shared.proportions.hand(problem.given),
        rest: problem.rest,
        evidence,
        prior,
        motions: &motions,
        views: &mut views[0],
    };
    let mut state = state.clone();
    let pose = &mut state.moments[0].pose;
    let found = match tries {
        Tries::Digits => search.run(pose)?,
        Tries::Pairs => search.run_pairs(pose)?,
    };
    *pose = found.pose;
    Ok((state, found.won))
}
