//! What a take shows of its hand: the postures of its digits, and where it is.

use glam::DAffine3;
use phalanx_hand::Pose;

use super::consensus;
use super::found::Found;
use super::observation::length_mm;
use super::report::FrameFit;
use super::starts;
use super::take::TakeFit;

/// So many postures at most.
const MOST: usize = 16;

/// Postures nearer than this lead to the same fit: the root of the summed squares of their angles' differences, radians.
const SAME: f64 = 0.3;

/// So many places at most, and how far they are from each other at least, turns in radians and ways over half the hand's
/// length: where a hand is looked for, starts are turned by twice as much.
const PLACES: usize = 6;
const SAME_PLACE: f64 = std::f64::consts::FRAC_PI_8;

/// Poses of a take whose digits differ from each other's most, the first being that of the frame whose views agree best.
pub(super) fn of<'a>(found: impl Iterator<Item = &'a Found>) -> Vec<Pose> {
    let mut frames: Vec<&Found> = found.collect();
    frames.sort_by(|a, b| a.misfit.total_cmp(&b.misfit));
    let poses = frames.iter().map(|found| found.refined.pose);
    spread(poses, apart, SAME, MOST)
}

/// The same of a fitted take, of which no frame is doubted.
pub(super) fn postures(take: &TakeFit) -> Vec<Pose> {
    spread(right(take).map(|frame| frame.pose), apart, SAME, MOST)
}

/// Frames of a take's hand that differ from each other most, the first being the take's middle.
pub(super) fn places(take: &TakeFit) -> Vec<DAffine3> {
    let rest = take.volume.volume.rest_frame();
    let frames = right(take).map(|frame| starts::frame_at(&frame.pose, &rest, &take.hand));
    let reach = 0.5 * length_mm(&take.known.hand.shape);
    let apart = |one: &DAffine3, other: &DAffine3| consensus::apart(one, other, reach);
    spread(std::iter::once(rest).chain(frames), apart, SAME_PLACE, PLACES)
}

fn right(take: &TakeFit) -> impl Iterator<Item = &FrameFit> {
    take.frames.iter().filter(|frame| frame.doubts.is_empty())
}

/// Items that differ by more than `same`: the first, and then always the one that is farthest from all that were chosen
/// (Gonzalez 1985).
fn spread<T: Copy>(
    items: impl Iterator<Item = T>,
    apart: impl Fn(&T, &T) -> f64,
    same: f64,
    most: usize,
) -> Vec<T> {
    let mut left: Vec<(T, f64)> = items.map(|item| (item, f64::INFINITY)).collect();
    let mut chosen = Vec::new();
    while chosen.len() < most {
        // The first of several that are equally far.
        let farthest = left.iter().rev().max_by(|a, b| a.1.total_cmp(&b.1));
        let Some(&(item, _)) = farthest.filter(|(_, apart)| *apart > same) else { break };
        for (other, nearest) in &mut left {
            *nearest = nearest.min(apart(other, &item));
        }
        chosen.push(item);
    }
    chosen
}

fn apart(one: &Pose, other: &Pose) -> f64 {
    starts::of_digits().map(|dof| (one[dof] - other[dof]).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use phalanx_hand::Dof;

    use super::*;

    #[test]
    fn postures_that_differ_are_told_once() {
        let bent = |angle: f64| {
            let mut pose = Pose::REST;
            pose[Dof::IndexPip] = angle;
            pose[Dof::TX] = 1e3 * angle;
            pose
        };
        let found = |(angle, misfit): (f64, f64)| Found::at(bent(angle), misfit);
        let frames = [(0.1, 0.5), (1.5, 0.4), (0.0, 0.1), (0.8, 0.3), (1.4, 0.2)].map(found);
        let postures = of(frames.iter());
        let angles: Vec<f64> = postures.iter().map(|pose| pose[Dof::IndexPip]).collect();
        assert_eq!(angles, [0.0, 1.5, 0.8]);
        let posed = starts::with_digits(&Pose::REST, &postures[1]);
        assert_eq!((posed[Dof::IndexPip], posed[Dof::TX]), (1.5, 0.0));
    }
}
