//! What may be mistaken about a whole take: the hand is the person's other one, or two cameras have each other's pictures. A
//! wrong hand, or a right one before wrong cameras, fits most silhouettes halfway, so that no frame need contradict it.

use phalanx_camera::Camera;
use phalanx_hand::{Dof, HandShape, Pose};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::consensus::evenly;
use super::found::{Found, views_used};
use super::frame_fit::FrameFitter;
use super::misfit;
use super::observation::Sight;
use super::search::{self, TURNS};
use super::starts;
use super::take_frame::TakeFrame;
use super::views;
use super::weights::ViewWeights;
use crate::error::Result;
use crate::progress::Progress;

/// What is mistaken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Mistake {
    /// The hand is of the other side.
    OtherSide,
    /// Each of two cameras has the pictures of the other.
    Exchanged([usize; 2]),
}

/// Frames that are asked first, and frames that are asked if one of these says yes.
const FIRST: usize = 4;
const FRAMES: usize = 12;

/// Another explanation that is at most so many times as far from most frames as their own fits is hardly worse: it is looked
/// for once, with a hand that was learnt from other fits. A choice: of most takes with the right hand the other one was
/// 1.4 times as far or more; of a right hand that comes into the pictures of two webcams it was 1.1 times as far, and of a
/// wrong one before two cameras too.
const HARDLY_WORSE: f64 = 1.2;

/// Of so many cameras every two may be exchanged; of more, asking takes too long.
const CAMERAS: usize = 4;

/// What is asked of a whole take.
pub(super) struct Asked {
    pub(super) mistake: Option<Mistake>,
    /// Whether a hand of the other side is a clearly worse explanation.
    pub(super) tells_side: bool,
}

/// What is mistaken about cameras and hand of a take, whose frames were fitted to `found`: what agrees best of what
/// explains them better than their fits.
pub(super) fn of_take(
    fitter: &FrameFitter<'_>,
    cameras: &[Camera],
    frames: &[TakeFrame],
    found: &[Option<Found>],
    progress: &dyn Progress,
) -> Result<Asked> {
    let other_side = compared(fitter, found, of_other_side, progress)?;
    let mut likeliest = other_side.if_better().map(|far| (far, Mistake::OtherSide));
    for pair in exchangeable(fitter, cameras.len(), found)? {
        let exchanged = |fitter: &FrameFitter<'_>, k: usize, _: &Found| {
            of_exchanged(fitter, cameras, &frames[k], pair)
        };
        let Some(far) = compared(fitter, found, exchanged, progress)?.if_better() else { continue };
        if likeliest.is_none_or(|(least, _)| far < least) {
            likeliest = Some((far, Mistake::Exchanged(pair)));
        }
    }
    let mistake = likeliest.map(|(_, mistake)| mistake);
    Ok(Asked { mistake, tells_side: other_side.is_worse() })
}

/// The pairs of cameras that may be exchanged: all, or none where views agree with three quarters of the frames, which
/// those before wrong cameras do not.
fn exchangeable(
    fitter: &FrameFitter<'_>,
    cameras: usize,
    found: &[Option<Found>],
) -> Result<Vec<[usize; 2]>> {
    let told = told(found);
    let own = |k: usize| Ok(mean(&far(fitter, told[k].1)?));
    let own = evenly(told.len(), FRAMES).into_iter().map(own);
    let mut own: Vec<f64> = own.collect::<Result<_>>()?;
    own.sort_by(f64::total_cmp);
    if cameras > CAMERAS || own.get(3 * own.len() / 4).is_none_or(|far| *far < misfit::BEGINS) {
        return Ok(Vec::new());
    }
    Ok((0..cameras).flat_map(|one| (0..one).map(move |other| [other, one])).collect())
}

/// The frames that two cameras or more were used of, with their numbers.
fn told(found: &[Option<Found>]) -> Vec<(usize, &Found)> {
    let fitted = (0..found.len()).filter_map(|k| Some((k, found[k].as_ref()?)));
    fitted.filter(|(_, found)| found.cameras_used() > 1).collect()
}

/// Whether a hand of the other side is the better explanation of most frames. Two cameras do not always tell, and one
/// never does.
pub(super) fn is_other_side(
    fitter: &FrameFitter<'_>,
    found: &[Option<Found>],
    progress: &dyn Progress,
) -> Result<bool> {
    Ok(compared(fitter, found, of_other_side, progress)?.if_better().is_some())
}

/// How far another explanation is from agreeing with each of some frames, and how far the frame's own fit is; nothing of too few
/// frames.
struct Compared(Vec<[f64; 2]>);

impl Compared {
    /// Of so many the other explanation is less than so many times as far as their own fit.
    fn within(&self, times: f64) -> usize {
        self.0.iter().filter(|[other, own]| *other < times * own).count()
    }

    /// How far the other explanation is on average, if it is the better one of most.
    fn if_better(&self) -> Option<f64> {
        let sum: f64 = self.0.iter().map(|[other, _]| other).sum();
        (2 * self.within(1.0) > self.0.len()).then(|| sum / self.0.len() as f64)
    }

    /// Whether it is clearly worse of most.
    fn is_worse(&self) -> bool {
        2 * self.within(HARDLY_WORSE) < self.0.len()
    }
}

/// Compares another explanation with the fits of some frames, by how far `other` says that the views of each are from agreeing
/// with it.
fn compared(
    fitter: &FrameFitter<'_>,
    found: &[Option<Found>],
    other: impl Fn(&FrameFitter<'_>, usize, &Found) -> Result<Vec<f64>> + Sync,
    progress: &dyn Progress,
) -> Result<Compared> {
    // A view that was wrong may be right then.
    let weights = ViewWeights::unknown(fitter.weights.wrong.len());
    let fitter = &FrameFitter { weights, ..*fitter };
    let told = told(found);
    // The other explanation of so many frames, and the frames' own.
    let asked = |frames: usize| -> Result<Compared> {
        let chosen = evenly(told.len(), frames);
        progress.begin("check side and cameras", chosen.len());
        let ask = |&k: &usize| {
            let (frame, own) = told[k];
            let [mut other, mut own] = [other(fitter, frame, own)?, far(fitter, own)?];
            // A view that shows nothing there contradicts it.
            let views = other.len().max(own.len());
            other.resize(views, 1.0);
            own.resize(views, 1.0);
            progress.step();
            // What some view contradicts explains nothing, however badly the fit does.
            let is_possible = other.iter().all(|far| *far < 1.0);
            Ok([if is_possible { mean(&other) } else { 1.0 }, mean(&own)])
        };
        Ok(Compared(chosen.par_iter().map(ask).collect::<Result<_>>()?))
    };
    if told.len() < FIRST {
        return Ok(Compared(Vec::new()));
    }
    let first = asked(FIRST)?;
    if first.within(HARDLY_WORSE) == 0 { Ok(first) } else { asked(FRAMES) }
}

/// How far each view that shows anything is from agreeing with a frame, also if it was left out of it. None counts for more than
/// one that just contradicts it.
fn far(fitter: &FrameFitter<'_>, found: &Found) -> Result<Vec<f64>> {
    Ok(views::misfits(fitter, found)?.into_iter().flatten().map(|far| far.min(1.0)).collect())
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// How far views are from agreeing with a hand of the other side whose arm is where the frame has it.
fn of_other_side(fitter: &FrameFitter<'_>, _: usize, own: &Found) -> Result<Vec<f64>> {
    let rest = own.frame(fitter.hand);
    let hand = &HandShape { side: fitter.hand.side.other(), ..fitter.hand.clone() };
    let fitter = &FrameFitter { hand, weights: fitter.weights.clone(), ..*fitter };
    let left_out = vec![false; own.left_out.len()];
    let evidence = fitter.seen(&own.crops, &own.points, &left_out, &rest);
    let turned = (0..TURNS).flat_map(|turn| {
        let mut pose = Pose::REST;
        pose[Dof::ThetaZ] = std::f64::consts::TAU * turn as f64 / TURNS as f64;
        starts::postures(&pose)
    });
    let fits = fitter.fits(&rest, &evidence, &turned.collect::<Vec<_>>())?;
    let Some(refined) = fits.into_iter().next() else { return Ok(Vec::new()) };
    let misfit = misfit::of_fit(&refined, views_used(&own.crops, &own.points, &left_out));
    far(fitter, &fitter.improved(Found { rest, refined, left_out, misfit, ..own.clone() })?)
}

/// How far they are from agreeing with the hand anywhere, if two cameras' pictures are exchanged.
fn of_exchanged(
    fitter: &FrameFitter<'_>,
    cameras: &[Camera],
    frame: &TakeFrame,
    [one, other]: [usize; 2],
) -> Result<Vec<f64>> {
    let mut frame = frame.clone();
    frame.masks.swap(one, other);
    if !frame.landmarks.is_empty() {
        frame.landmarks.swap(one, other);
    }
    match search::known_anywhere(fitter, &Sight::of(cameras, &frame)?)? {
        Some(found) => far(fitter, &fitter.improved(found)?),
        None => Ok(Vec::new()),
    }
}
