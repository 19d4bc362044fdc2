//! Which poses of a take's frames are likeliest together.

use super::found::Found;
use super::frame_fit::FrameFitter;
use super::line_of_sight::LineOfSight;
use super::motion::Motion;
use super::times::Times;

/// Of several poses of each frame, the ones that are likeliest as they follow each other (Viterbi 1967): each is
/// as unlikely as its views say, and as the way to it from the pose before. `None` of a frame without any.
pub(super) fn likeliest(
    hypotheses: Vec<Vec<Found>>,
    times: &Times,
    fitter: &FrameFitter<'_>,
) -> Vec<Option<Found>> {
    let best: Vec<Option<Found>> = hypotheses.iter().map(|frame| frame.first().cloned()).collect();
    let Some(motion) = Motion::of_found(&best, times, fitter.prior) else { return best };
    let along = LineOfSight::of(&best, times, fitter.hand);
    let against = |one: &Found, other: &Found, away: f64| {
        let along = along.as_ref().map_or(0.0, |along| {
            along.against(&one.frame(fitter.hand), &other.frame(fitter.hand), away)
        });
        motion.against(&one.refined.pose, &other.refined.pose, away) + along
    };
    let chosen = chosen(&hypotheses, times, against);
    let frames = hypotheses.into_iter().zip(chosen);
    frames.map(|(mut frame, chosen)| Some(frame.swap_remove(chosen?))).collect()
}

/// Which of its poses is chosen for each frame, by what speaks against one pose so many steps after another.
fn chosen(
    hypotheses: &[Vec<Found>],
    times: &Times,
    against: impl Fn(&Found, &Found, f64) -> f64,
) -> Vec<Option<usize>> {
    let seen: Vec<usize> = (0..hypotheses.len()).filter(|&k| !hypotheses[k].is_empty()).collect();
    // What speaks against the best way to each pose, and the pose before on that way.
    let mut ways: Vec<Vec<(f64, usize)>> = Vec::with_capacity(seen.len());
    for (n, &k) in seen.iter().enumerate() {
        let to = |own: &Found| {
            let before = n.checked_sub(1).map(|before| (&ways[before], seen[before]));
            let (way, from) = before.map_or((0.0, 0), |(ways, before)| {
                let from = |(earlier, found): (usize, &Found)| {
                    let away = times.between(before, k);
                    let change = against(found, own, away);
                    (ways[earlier].0 + change, earlier)
                };
                let all = hypotheses[before].iter().enumerate().map(from);
                all.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 0))
            });
            (way + own.refined.energy, from)
        };
        let of_frame = hypotheses[k].iter().map(to).collect();
        ways.push(of_frame);
    }
    let mut chosen = vec![None; hypotheses.len()];
    let last = ways
        .last()
        .and_then(|ways| (0..ways.len()).min_by(|&a, &b| ways[a].0.total_cmp(&ways[b].0)));
    let mut next = last.unwrap_or(0);
    for (n, &k) in seen.iter().enumerate().rev() {
        chosen[k] = Some(next);
        next = ways[n][next].1;
    }
    chosen
}

#[cfg(test)]
mod tests {
    use phalanx_hand::{Dof, HandShape, Pose};
    use phalanx_refine::{PoseFit, PoseFitSettings};
    use proptest::prelude::*;

    use super::*;
    use crate::fitting::weights::ViewWeights;
    use crate::synthesis::postures::coupled;

    /// A pose with one joint bent, which what was seen speaks against so much.
    fn found((bent, energy): (f64, f64)) -> Found {
        let mut pose = Pose::REST;
        pose[Dof::IndexPip] = bent;
        let found = Found::at(pose, 0.0);
        let refined = PoseFit { energy, ..found.refined };
        Found { refined, ..found }
    }

    /// What speaks against one pose of each frame that has any.
    fn against(
        hypotheses: &[Vec<Found>],
        times: &Times,
        motion: &Motion,
        choice: &[Option<usize>],
    ) -> f64 {
        let frames = hypotheses.iter().zip(choice).enumerate();
        let chain: Vec<(usize, &Found)> =
            frames.filter_map(|(k, (frame, own))| Some((k, &frame[(*own)?]))).collect();
        let seen: f64 = chain.iter().map(|(_, found)| found.refined.energy).sum();
        let moved = |pair: &[(usize, &Found)]| {
            let [(before, one), (after, other)] = [pair[0], pair[1]];
            motion.against(&one.refined.pose, &other.refined.pose, times.between(before, after))
        };
        seen + chain.windows(2).map(moved).sum::<f64>()
    }

    /// Every way to choose a pose of each frame that has any.
    fn choices(hypotheses: &[Vec<Found>]) -> Vec<Vec<Option<usize>>> {
        hypotheses.iter().fold(vec![Vec::new()], |ways, frame| {
            let own: Vec<Option<usize>> = match frame.len() {
                0 => vec![None],
                count => (0..count).map(Some).collect(),
            };
            let with = |way: &Vec<Option<usize>>| {
                let way = way.clone();
                own.iter().map(move |own| [&way[..], &[*own]].concat()).collect::<Vec<_>>()
            };
            ways.iter().flat_map(with).collect()
        })
    }

    proptest! {
        #![proptest_config(crate::property::cases(64))]

        #[test]
        fn no_other_choice_is_likelier(
            frames in prop::collection::vec(
                prop::collection::vec((-1.0..1.0_f64, 0.0..20.0_f64), 0..4),
                1..6,
            ),
            usual in 0.05..0.5_f64,
        ) {
            let frame = |frame: Vec<(f64, f64)>| frame.into_iter().map(found).collect();
            let hypotheses: Vec<Vec<Found>> = frames.into_iter().map(frame).collect();
            let known = [0.0, usual].map(|bent| Some(found((bent, 0.0))));
            let motion = Motion::of_found(&known, &Times::even(known.len()), coupled());
            let motion = motion.expect("one frame follows another");
            let times = Times::even(hypotheses.len());
            let change = |one: &Found, other: &Found, away: f64| {
                motion.against(&one.refined.pose, &other.refined.pose, away)
            };
            let chosen = chosen(&hypotheses, &times, change);
            let own = against(&hypotheses, &times, &motion, &chosen);
            for other in choices(&hypotheses) {
                let is_answered = chosen.iter().map(Option::is_some);
                prop_assert!(is_answered.eq(other.iter().map(Option::is_some)));
                prop_assert!(own <= against(&hypotheses, &times, &motion, &other) + 1e-9);
            }
        }
    }

    #[test]
    fn a_pose_that_nothing_before_or_after_leads_to_is_not_taken() {
        let (refinement, weights) = (PoseFitSettings::default(), ViewWeights::unknown(0));
        let hand = &HandShape::adult();
        let fitter = FrameFitter { hand, prior: coupled(), refinement: &refinement, weights };
        let usual = |k: u32| found((0.02 * f64::from(k), 5.0));
        let mut hypotheses: Vec<Vec<Found>> = (0..20).map(|k| vec![usual(k)]).collect();
        // It explains the picture a little better.
        hypotheses[3].insert(0, found((1.5, 4.5)));
        let times = Times::even(hypotheses.len());
        let bent: Vec<f64> = likeliest(hypotheses, &times, &fitter)
            .into_iter()
            .map(|found| found.expect("every frame has a pose").refined.pose[Dof::IndexPip])
            .collect();
        assert!(bent.iter().zip(0..).all(|(bent, k)| (bent - 0.02 * f64::from(k)).abs() < 1e-12));
    }
}
