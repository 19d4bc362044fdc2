//! The postures of its digits that a take shows a hand in.

use phalanx_hand::Pose;

use super::found::Found;
use super::starts;

/// So many postures at most.
const MOST: usize = 16;

/// Postures nearer than this lead to the same fit: the root of the summed squares of their angles' differences, radians.
const SAME: f64 = 0.3;

/// Poses of a take whose digits differ from each other's most, each found as the one that is farthest from all before
/// it (Gonzalez 1985), the first being that of the frame whose views agree best.
pub(super) fn of<'a>(found: impl Iterator<Item = &'a Found>) -> Vec<Pose> {
    let mut frames: Vec<&Found> = found.collect();
    frames.sort_by(|a, b| a.misfit.total_cmp(&b.misfit));
    let mut left: Vec<(Pose, f64)> =
        frames.iter().map(|found| (found.refined.pose, f64::INFINITY)).collect();
    let mut chosen = Vec::new();
    while chosen.len() < MOST {
        // The first of several that are equally far.
        let farthest = left.iter().rev().max_by(|a, b| a.1.total_cmp(&b.1));
        let Some(&(pose, _)) = farthest.filter(|(_, apart)| *apart > SAME) else { break };
        for (other, nearest) in &mut left {
            *nearest = nearest.min(apart(other, &pose));
        }
        chosen.push(pose);
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
