//! How refined estimates err, and how their deviations must be scaled to say so.

use phalanx_hand::{Digit, Dof};
use serde::{Deserialize, Serialize};

use crate::checking::usual::quantile;
use crate::error::{Error, Result};
use crate::estimator::estimate::{Estimate, NORMAL_TAIL};

/// Numbers whose errors are alike: of the thumb; of the fingers by joint, from the abduction outwards; of the
/// wrist; of the hand's turn; of its place.
const KINDS: usize = 8;

/// Scenes that tell each kind of number apart; fewer tell all numbers together.
const SCENES_OF_KINDS: usize = 20;

/// The shares of a normal distribution's errors within one deviation and within the tail.
const OF_NORMAL: [f64; 2] = [0.6827, 0.95];

/// Scales are looked for between these, in steps of a hundredth.
const SCALES: [f64; 2] = [0.1, 30.0];
const STEP: f64 = 1.01;

/// Shares of the deviations by other postures that are tried.
const SHARES: [f64; 8] = [0.0, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.4];

/// How refined estimates err beside what the curvature of the fit and other postures say. These know nothing of borders
/// that err together, nor of wrong hands and cameras beyond what was fitted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RefinedErrors {
    postures: SharesOfPostures,
    views: Vec<ErrorsOfViews>,
}

/// How much of the deviations by other postures counts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct SharesOfPostures {
    /// Where hand and cameras explain what was seen.
    certain: f64,
    /// Where they had to be fitted too: of a hand that is not known some posture has always fewer wrong pixels.
    doubted: f64,
}

/// How errors spread beside deviations, from so many views.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct ErrorsOfViews {
    views: usize,
    /// Where hand and cameras explain what was seen.
    certain: [Spread; KINDS],
    /// Where they had to be fitted too.
    doubted: [Spread; KINDS],
}

/// How errors spread, in deviations that are said.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Spread {
    /// The deviation.
    std: f64,
    /// What 95 of 100 are within.
    tail: f64,
}

/// How well the numbers of a refined pose are known, standard deviations in their units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RefinedDeviations {
    /// By the curvature of the fit; `None` of what is not estimated.
    pub(crate) curvature: [Option<f64>; Dof::COUNT],
    /// By other postures that explain the silhouettes about as well.
    pub(crate) postures: [f64; Dof::COUNT],
}

impl RefinedDeviations {
    /// Both together, so much of those by other postures.
    pub(crate) fn with_postures(&self, share: f64) -> [Option<f64>; Dof::COUNT] {
        let with = |dof: usize| Some(self.curvature[dof]?.hypot(share * self.postures[dof]));
        std::array::from_fn(with)
    }
}

/// A refined estimate whose truth is known.
pub(crate) struct RefinedTrial {
    pub(crate) views: usize,
    /// Whether hand and cameras had to be fitted.
    pub(crate) is_doubted: bool,
    /// How far each number is from the truth, in its unit.
    pub(crate) errors: [f64; Dof::COUNT],
    pub(crate) deviations: RefinedDeviations,
}

impl RefinedTrial {
    /// The errors of numbers that have a deviation, and these, with a share of other postures.
    fn errors_beside(&self, share: f64) -> impl Iterator<Item = (Dof, f64, f64)> {
        let stds = self.deviations.with_postures(share);
        Dof::ALL.into_iter().filter_map(move |dof| {
            let std = stds[dof.index()].filter(|std| *std > 0.0)?;
            Some((dof, self.errors[dof.index()], std))
        })
    }
}

impl RefinedErrors {
    /// From some trials.
    pub(crate) fn learn(trials: &[RefinedTrial]) -> Self {
        let mut counts: Vec<usize> = trials.iter().map(|trial| trial.views).collect();
        counts.sort_unstable();
        counts.dedup();
        // Few fits are in another posture than the hand's: all views together tell how much these count.
        let share = |is_doubted| {
            let alike = trials.iter().filter(|trial| trial.is_doubted == is_doubted);
            share_of_postures(&alike.collect::<Vec<_>>())
        };
        let postures = SharesOfPostures { certain: share(false), doubted: share(true) };
        let of = |views| {
            let spreads = |is_doubted| {
                let alike =
                    |trial: &&RefinedTrial| trial.views == views && trial.is_doubted == is_doubted;
                let trials: Vec<_> = trials.iter().filter(alike).collect();
                Spread::of_kinds(&trials, postures.of(is_doubted))
            };
            ErrorsOfViews { views, certain: spreads(false), doubted: spreads(true) }
        };
        Self { postures, views: counts.into_iter().map(of).collect() }
    }

    /// A refined estimate with deviations as they are found to be from so many views as it has, or the next
    /// fewer that were tried.
    pub(crate) fn scaled(
        &self,
        mut estimate: Estimate,
        deviations: &RefinedDeviations,
        is_doubted: bool,
    ) -> Estimate {
        let seen = estimate.observation.views.len();
        let tried = self.views.iter().rev().find(|tried| tried.views <= seen);
        estimate.std = deviations.with_postures(self.postures.of(is_doubted));
        let Some(tried) = tried.or(self.views.first()) else { return estimate };
        let kinds = if is_doubted { &tried.doubted } else { &tried.certain };
        for dof in Dof::ALL {
            let Spread { std, tail } = kinds[kind(dof)];
            if let Some(said) = &mut estimate.std[dof.index()] {
                *said *= std;
                estimate.tails[dof.index()] = tail / std;
            }
        }
        estimate
    }

    /// Refuses what is no scale.
    pub(crate) fn check(&self) -> Result<()> {
        let spreads =
            self.views.iter().flat_map(|tried| tried.certain.iter().chain(&tried.doubted));
        let expected = spreads.clone().count();
        let is_scale = |value: f64| value > 0.0 && value.is_finite();
        let found = spreads.filter(|spread| is_scale(spread.std) && is_scale(spread.tail)).count();
        let SharesOfPostures { certain, doubted } = self.postures;
        let are_shares = [certain, doubted].iter().all(|share| (0.0..=SHARES[7]).contains(share));
        if found == expected && are_shares {
            return Ok(());
        }
        Err(Error::Mismatch { part: "scales of refined deviations", found, expected })
    }
}

impl SharesOfPostures {
    fn of(self, is_doubted: bool) -> f64 {
        if is_doubted { self.doubted } else { self.certain }
    }
}

/// The share of the deviations by other postures that makes errors the most likely, by Student's distribution of four
/// degrees of freedom, which is what robust fits take errors to have (Lange, Little and Taylor 1989); all where
/// there are none.
fn share_of_postures(trials: &[&RefinedTrial]) -> f64 {
    const FREEDOM: f64 = 4.0;
    const SCALE_STEP: f64 = 1.1;
    let scales = || {
        let scales = std::iter::successors(Some(SCALES[0]), |scale| Some(SCALE_STEP * scale));
        scales.take_while(|&scale| scale <= SCALES[1])
    };
    let unlikely = |share: f64| {
        let errors: Vec<(f64, f64)> = trials
            .iter()
            .flat_map(|trial| trial.errors_beside(share))
            .map(|(_, error, std)| (error / std, std.ln()))
            .collect();
        let at = |scale: f64| -> f64 {
            let of = |(error, log_std): &(f64, f64)| {
                let tail = (error / scale).powi(2) / FREEDOM;
                scale.ln() + log_std + 0.5 * (FREEDOM + 1.0) * tail.ln_1p()
            };
            errors.iter().map(of).sum()
        };
        scales().map(at).fold(f64::INFINITY, f64::min)
    };
    if trials.is_empty() {
        return 1.0;
    }
    let shares = SHARES.map(|share| (share, unlikely(share)));
    shares.into_iter().min_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(1.0, |(share, _)| share)
}

impl Spread {
    /// What a normal distribution of the deviation that is said has.
    const AS_SAID: Self = Self { std: 1.0, tail: NORMAL_TAIL };

    fn of_kinds(trials: &[&RefinedTrial], postures: f64) -> [Self; KINDS] {
        let errors = |is_meant: &dyn Fn(Dof) -> bool| -> Vec<f64> {
            let all = trials.iter().flat_map(|trial| trial.errors_beside(postures));
            all.filter(|(dof, ..)| is_meant(*dof)).map(|(_, error, std)| error / std).collect()
        };
        let all = Self::of(errors(&|_| true));
        std::array::from_fn(|own| {
            let own = errors(&|dof| kind(dof) == own);
            if own.is_empty() || trials.len() < SCENES_OF_KINDS { all } else { Self::of(own) }
        })
    }

    /// Of errors in deviations.
    ///
    /// Where tails are heavier than a normal distribution's, no deviation has both shares of
    /// [`OF_NORMAL`]. It is the one whose shares miss them least, by the sum of squares.
    fn of(mut errors: Vec<f64>) -> Self {
        if errors.is_empty() {
            return Self::AS_SAID;
        }
        errors.sort_by(f64::total_cmp);
        let within = |most: f64| errors.partition_point(|&error| error <= most) as f64;
        let missed = |scale: f64| -> f64 {
            let of = |(share, deviations): (f64, f64)| {
                (within(deviations * scale) / errors.len() as f64 - share).powi(2)
            };
            OF_NORMAL.into_iter().zip([1.0, NORMAL_TAIL]).map(of).sum()
        };
        let scales = std::iter::successors(Some(SCALES[0]), |scale| Some(STEP * scale));
        let scales = scales.take_while(|&scale| scale <= SCALES[1]);
        let best = scales.min_by(|&a, &b| missed(a).total_cmp(&missed(b)));
        let std = best.unwrap_or(Self::AS_SAID.std);
        Self { std, tail: quantile(errors, OF_NORMAL[1]).max(f64::MIN_POSITIVE) }
    }
}

/// The kind of a number.
fn kind(dof: Dof) -> usize {
    match dof.index() {
        k if k < Digit::Index.dofs()[0].index() => 0,
        k if dof.is_internal() => 1 + k % 4,
        k if k < Dof::ThetaX.index() => 5,
        k if k < Dof::TX.index() => 6,
        _ => 7,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// So many trials of three views whose errors are spread as a normal distribution's, `scale` times as
    /// wide as said; of proximal joints one in `outliers` is far out.
    fn trials(count: usize, scale: f64, outliers: usize) -> Vec<RefinedTrial> {
        let trial = |k: usize| {
            let error = |dof: usize| {
                let share = ((28 * k + dof) as f64 * 0.618_034).fract();
                // Of a logistic distribution, which is near enough: ln(p / (1 − p)) / 1.702.
                let error = ((0.5 + 0.5 * share) / (0.5 - 0.5 * share)).ln() / 1.702;
                let is_out = kind(Dof::ALL[dof]) == 3 && k.is_multiple_of(outliers);
                if is_out { 50.0 } else { scale * error }
            };
            let deviations = RefinedDeviations {
                curvature: [Some(1.0); Dof::COUNT],
                postures: [0.0; Dof::COUNT],
            };
            let errors = std::array::from_fn(error);
            RefinedTrial { views: 3, is_doubted: true, errors, deviations }
        };
        (0..count).map(trial).collect()
    }

    #[test]
    fn errors_twice_as_wide_as_said_are_said() {
        let errors = RefinedErrors::learn(&trials(200, 2.0, usize::MAX));
        for spread in errors.views[0].doubted {
            assert!((spread.std - 2.0).abs() < 0.2, "{spread:?}");
            assert!((spread.tail / spread.std - NORMAL_TAIL).abs() < 0.3, "{spread:?}");
        }
        assert_eq!(errors.views[0].certain, [Spread::AS_SAID; KINDS]);
        errors.check().unwrap();
    }

    #[test]
    fn heavy_tails_widen_the_interval_of_their_own_kind() {
        let errors = RefinedErrors::learn(&trials(200, 1.0, 10));
        let [.., other, proximal, _, _, _, _] = errors.views[0].doubted;
        assert!(proximal.tail > 10.0 * proximal.std, "{proximal:?}");
        assert!(proximal.std < 2.0, "{proximal:?}");
        assert!(other.tail < 2.5 * other.std, "{other:?}");
    }

    /// Where one finger in ten is in another posture, and which may be is known, deviations say so; where that says
    /// nothing of errors, it does not count.
    #[test]
    fn other_postures_count_where_they_are_what_errs() {
        let with_postures = |are_told: bool| {
            let mut trials = trials(200, 1.0, usize::MAX);
            for (k, trial) in trials.iter_mut().enumerate() {
                for dof in Digit::Ring.dofs() {
                    if k % 10 == 0 {
                        trial.errors[dof.index()] = 40.0;
                    }
                    if (k % 10 == 0) == are_told {
                        trial.deviations.postures[dof.index()] = 40.0;
                    }
                }
            }
            RefinedErrors::learn(&trials).postures.doubted
        };
        assert!(with_postures(true) >= 0.5, "{}", with_postures(true));
        assert_eq!(with_postures(false), 0.0);
    }

    #[test]
    fn few_scenes_tell_all_numbers_together() {
        let errors = RefinedErrors::learn(&trials(SCENES_OF_KINDS - 1, 1.0, 2));
        let [first, rest @ ..] = errors.views[0].doubted;
        assert!(rest.iter().all(|spread| *spread == first), "{errors:?}");
    }

    #[test]
    fn what_is_no_scale_is_refused() {
        let mut errors = RefinedErrors::learn(&trials(30, 1.0, usize::MAX));
        errors.views[0].certain[2].tail = f64::NAN;
        errors.check().unwrap_err();
        let mut errors = RefinedErrors::learn(&trials(30, 1.0, usize::MAX));
        errors.postures.doubted = -1.0;
        errors.check().unwrap_err();
    }
}
