//! How well right answers explain what was seen.

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

/// The shares of right answers that are doubted for their overlaps, and for what they leave unexplained;
/// half of each by one view alone, half by all together. What is unexplained tells wrong answers from right
/// ones far better; overlaps are for what is no hand at all.
const DOUBTED: [f64; 2] = [0.005, 0.02];

/// How well an answer explains what was seen.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Explanation {
    /// Intersection over union of the drawn and the observed hand, in each view.
    pub(crate) overlaps: Vec<f64>,
    /// The share of each view's border that a pose near the answer explains.
    pub(crate) borders: Vec<f64>,
}

/// How well all but a few right answers explain what was seen, at least.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct UsualExplanation {
    overlaps: Least,
    borders: Least,
}

/// The least of something that is usual, 0 to 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Least {
    /// In each view.
    views: Vec<f64>,
    /// On the mean over the views.
    mean: f64,
}

impl UsualExplanation {
    /// From some answers, at least one.
    pub(crate) fn learn(answers: &[Explanation]) -> Self {
        let of = |all: fn(&Explanation) -> &Vec<f64>| answers.iter().map(all).collect::<Vec<_>>();
        Self {
            overlaps: Least::learn(&of(|answer| &answer.overlaps), DOUBTED[0]),
            borders: Least::learn(&of(|answer| &answer.borders), DOUBTED[1]),
        }
    }

    /// The views that an answer explains less well than is usual, in order.
    pub(crate) fn short(&self, answer: &Explanation) -> Vec<usize> {
        let mut short = self.overlaps.short(&answer.overlaps);
        short.extend(self.borders.short(&answer.borders));
        short.sort_unstable();
        short.dedup();
        short
    }

    /// The views of whose borders less is explained than is usual.
    pub(crate) fn short_of_borders(&self, borders: &[f64]) -> Vec<usize> {
        self.borders.short(borders)
    }

    /// Refuses what is of another number of views, or no share.
    pub(crate) fn check(&self, views: usize) -> Result<()> {
        [&self.overlaps, &self.borders].into_iter().try_for_each(|least| least.check(views))
    }
}

impl Least {
    fn learn(answers: &[&Vec<f64>], doubted: f64) -> Self {
        let views = answers.first().map_or(0, |values| values.len());
        let of_view = |view: usize| answers.iter().map(|values| values[view]).collect();
        let each = 0.5 * doubted / views.max(1) as f64;
        Self {
            views: (0..views).map(|view| quantile(of_view(view), each)).collect(),
            mean: quantile(answers.iter().map(|values| mean(values)).collect(), 0.5 * doubted),
        }
    }

    /// The views with less than is usual. Where none has and yet all together have, it is the view that
    /// comes nearest to it.
    fn short(&self, values: &[f64]) -> Vec<usize> {
        let beyond = |view: usize| values[view] - self.views[view];
        let short: Vec<usize> = (0..values.len()).filter(|&view| beyond(view) < 0.0).collect();
        if !short.is_empty() || mean(values) >= self.mean {
            return short;
        }
        let nearest = (0..values.len()).min_by(|&a, &b| beyond(a).total_cmp(&beyond(b)));
        nearest.into_iter().collect()
    }

    fn check(&self, views: usize) -> Result<()> {
        let is_share = |value: &&f64| (0.0..=1.0).contains(*value);
        let found = self.views.iter().chain([&self.mean]).filter(is_share).count();
        if self.views.len() == views && found == views + 1 {
            return Ok(());
        }
        Err(Error::Mismatch { part: "usual shares", found, expected: views + 1 })
    }
}

pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// The value that a share of all, of which there is at least one, is below.
pub(crate) fn quantile(mut values: Vec<f64>, share: f64) -> f64 {
    let place = (share * values.len() as f64) as usize;
    let place = place.min(values.len().saturating_sub(1));
    *values.select_nth_unstable_by(place, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answer(overlap: f64, borders: [f64; 2]) -> Explanation {
        Explanation { overlaps: vec![overlap; 2], borders: borders.to_vec() }
    }

    #[test]
    fn few_of_those_that_were_learnt_from_are_doubted() {
        let answers: Vec<Explanation> = (0..2000)
            .map(|k| {
                let share = |step: f64| 0.9 + 0.1 * (f64::from(k) * step).fract();
                answer(share(0.618), [share(0.755), share(0.57)])
            })
            .collect();
        let usual = UsualExplanation::learn(&answers);
        let doubted = answers.iter().filter(|answer| !usual.short(answer).is_empty()).count();
        let most = (DOUBTED[0] + DOUBTED[1]) * answers.len() as f64;
        assert!((0.5 * most..=most).contains(&(doubted as f64)), "{doubted} of {most}");
        usual.check(2).unwrap();
        usual.check(3).unwrap_err();
    }

    #[test]
    fn the_view_that_is_not_explained_is_named() {
        let answers: Vec<Explanation> = (0..100).map(|_| answer(0.9, [0.95, 0.9])).collect();
        let usual = UsualExplanation::learn(&answers);
        assert_eq!(usual.short(&answer(0.9, [0.95, 0.9])), [0; 0]);
        assert_eq!(usual.short(&answer(0.9, [0.95, 0.6])), [1]);
        assert_eq!(usual.short(&answer(0.2, [0.95, 0.9])), [0, 1]);
    }
}
