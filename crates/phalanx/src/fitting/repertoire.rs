//! The postures of its digits that a take shows a hand in.

use phalanx_hand::Pose;

use super::found::Found;
use super::starts;

/// So many postures at most.
const MOST: usize = 16;

/// Postures nearer than this lead to the same fit: the root of the summed squares of their angles' differences, radians.
const SAME: f64 = 0.3;

/// Poses of a take whose digits differ from each other's most, the first being that of the frame whose views agree best.
pub(super) fn of<'a>(found: impl Iterator<Item = &'a Found>) -> Vec<Pose> {
    let mut frames: Vec<&Found> = found.collect();
    frames.sort_by(|a, b| a.misfit.total_cmp(&b.misfit));
    of_poses(frames.iter().map(|found| found.refined.pose))
}

/// Those of some poses, the first of which is among them.
pub(super) fn of_poses(poses: impl Iterator<Item = Pose>) -> Vec<Pose> {
    spread(poses, apart, SAME, MOST)
}

/// Items that differ by more than `same`: the first, and then always the one that is farthest from all that were chosen
/// (Gonzalez 1985).
pub(super) fn spread<T: Copy>(
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
