//! A camera whose masks are of something else through a whole take: of another moment, of another hand, or through
//! another calibration. A single frame hardly tells, since a hand that fits two right views half fits a wrong one, too.

use rayon::prelude::*;

use super::consensus::evenly;
use super::found::Found;
use super::frame_fit::{FrameFitter, Postures};
use super::views;
use crate::error::Result;
use crate::progress::Progress;

/// One frame in so many with a view that contradicts its pose is enough to ask which view is wrong.
const CONTESTED: usize = 10;

/// Fits that are made to find out, of all frames and views together.
const FITS: usize = 180;

/// Frames that must tell of two views.
const LEAST: usize = 6;

/// By so many standard errors other views must agree better without one view than without another.
const SURE: f64 = 2.0;

/// How far each view is from agreeing with a frame that was fitted without one of them.
type Trial = Vec<Option<f64>>;

/// The view that contradicts most frames when they are fitted without it, and without which the others agree better
/// than without any other; `None` where frames do not tell.
pub(super) fn of_take(
    fitter: &FrameFitter<'_>,
    found: &[Option<Found>],
    progress: &dyn Progress,
) -> Result<Option<usize>> {
    let found: Vec<&Found> = found.iter().flatten().collect();
    let is_used = |view: &usize| !fitter.weights.wrong[*view];
    let views: Vec<usize> = (0..fitter.weights.wrong.len()).filter(is_used).collect();
    if views.len() < 3 || !is_contested(fitter, &found)? {
        return Ok(None);
    }
    let chosen = evenly(found.len(), FITS / views.len());
    progress.begin("ask which camera is wrong", chosen.len());
    let of_frame = |&k: &usize| {
        let trials = views.iter().map(|&view| trial(fitter, found[k], view)).collect();
        progress.step();
        trials
    };
    let trials: Vec<Vec<Option<Trial>>> = chosen.par_iter().map(of_frame).collect::<Result<_>>()?;
    Ok(wrong_of(&views, &trials))
}

/// Which of some views is wrong, by the trials of each frame without each of them.
fn wrong_of(views: &[usize], trials: &[Vec<Option<Trial>>]) -> Option<usize> {
    let own = |k: usize| -> Vec<f64> {
        trials.iter().filter_map(|trials| trials[k].as_ref()?[views[k]]).collect()
    };
    let told: Vec<usize> = (0..views.len()).filter(|&k| own(k).len() >= LEAST).collect();
    if told.len() < 3 {
        return None;
    }
    let is_wrong = |one: usize| {
        let contradicted = own(one).into_iter().filter(|&far| far > 1.0).count();
        let mut others = told.iter().filter(|&&other| other != one);
        2 * contradicted > own(one).len()
            && others.all(|&other| is_surely_better(views, trials, one, other))
    };
    told.iter().copied().find(|&one| is_wrong(one)).map(|one| views[one])
}

/// Whether enough frames have a view that contradicts their pose.
fn is_contested(fitter: &FrameFitter<'_>, found: &[&Found]) -> Result<bool> {
    let contradicted = |own: &&Found| views::is_beyond_any(fitter, own);
    let contradicted: Vec<bool> = found.par_iter().map(contradicted).collect::<Result<_>>()?;
    Ok(CONTESTED * contradicted.into_iter().filter(|is| *is).count() >= found.len())
}

/// A frame fitted without one view more; `None` of a view that shows none of it, and where fewer than two others do.
fn trial(fitter: &FrameFitter<'_>, found: &Found, view: usize) -> Result<Option<Trial>> {
    let is_used = |&other: &usize| found.crops[other].is_some() && !found.left_out[other];
    let used = (0..found.crops.len()).filter(is_used).count();
    if !is_used(&view) || used < 3 {
        return Ok(None);
    }
    let mut left_out = found.left_out.clone();
    left_out[view] = true;
    let Some(without) = fitter.again(found, &left_out, &[], Postures::All)? else {
        return Ok(None);
    };
    views::misfits(fitter, &without).map(Some)
}

/// Whether the views beside two of them agree better without the first than without the second.
fn is_surely_better(
    views: &[usize],
    trials: &[Vec<Option<Trial>>],
    first: usize,
    second: usize,
) -> bool {
    let better = |trials: &Vec<Option<Trial>>| -> Option<f64> {
        let (without_first, without_second) = (trials[first].as_ref()?, trials[second].as_ref()?);
        let others = (0..without_first.len()).filter(|k| *k != views[first] && *k != views[second]);
        let less: Vec<f64> = others
            .filter_map(|other| Some(without_second[other]? - without_first[other]?))
            .collect();
        (!less.is_empty()).then(|| mean(&less))
    };
    let better: Vec<f64> = trials.iter().filter_map(better).collect();
    let middle = mean(&better);
    let squares: Vec<f64> = better.iter().map(|own| (own - middle).powi(2)).collect();
    better.len() >= LEAST && middle > SURE * (mean(&squares) / (better.len() - 1) as f64).sqrt()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frames of three views, fitted without each of them in turn.
    fn frames(without: impl Fn(usize) -> [[f64; 3]; 3]) -> Vec<Vec<Option<Trial>>> {
        let trial = |far: [f64; 3]| Some(far.map(Some).to_vec());
        (0..8).map(|frame| without(frame).map(trial).to_vec()).collect()
    }

    const VIEWS: [usize; 3] = [0, 1, 2];

    #[test]
    fn the_view_that_contradicts_the_others_is_wrong() {
        // A pose that fits a wrong view and a right one fits neither well.
        let wrong = |frame: usize| {
            let by_chance = 0.05 * (frame % 3) as f64;
            [[1.2, 0.5, 0.6], [1.1, 0.6, 0.5], [0.3 + by_chance, 0.3, 1.5]]
        };
        assert_eq!(wrong_of(&VIEWS, &frames(wrong)), Some(2));
    }

    #[test]
    fn a_view_that_is_wrong_in_some_frames_is_not_wrong() {
        let wrong = |frame: usize| match frame {
            0..3 => [[1.2, 0.5, 0.6], [1.1, 0.6, 0.5], [0.3, 0.3, 1.5]],
            _ => [[0.5, 0.3, 0.3], [0.3, 0.5, 0.3], [0.3, 0.3, 0.5]],
        };
        assert_eq!(wrong_of(&VIEWS, &frames(wrong)), None);
    }

    #[test]
    fn views_that_fit_alike_are_not_wrong() {
        assert_eq!(wrong_of(&VIEWS, &frames(|_| [[1.2; 3]; 3])), None);
    }

    #[test]
    fn frames_that_lack_a_view_do_not_tell() {
        let mut lacking = frames(|_| [[1.2, 0.5, 0.6], [1.1, 0.6, 0.5], [0.3, 0.3, 1.5]]);
        lacking.iter_mut().skip(4).for_each(|frame| frame[1] = None);
        assert_eq!(wrong_of(&VIEWS, &lacking), None);
        assert_eq!(wrong_of(&VIEWS, &[]), None);
    }
}
