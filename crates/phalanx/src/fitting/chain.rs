//! Which poses of a take's frames are likeliest together.

use super::frame_fit::Found;
use super::motion::Motion;

/// Of several poses of each frame, the ones that are likeliest as they follow each other (Viterbi 1967): each is
/// as unlikely as its views say, and as the way to it from the pose before. `None` of a frame without any.
pub(super) fn likeliest(hypotheses: Vec<Vec<Found>>) -> Vec<Option<Found>> {
    let best: Vec<Option<Found>> = hypotheses.iter().map(|frame| frame.first().cloned()).collect();
    let Some(motion) = Motion::of(&best) else { return best };
    let chosen = chosen(&hypotheses, &motion);
    let frames = hypotheses.into_iter().zip(chosen);
    frames.map(|(mut frame, chosen)| Some(frame.swap_remove(chosen?))).collect()
}

/// Which of its poses is chosen for each frame.
fn chosen(hypotheses: &[Vec<Found>], motion: &Motion) -> Vec<Option<usize>> {
    let seen: Vec<usize> = (0..hypotheses.len()).filter(|&k| !hypotheses[k].is_empty()).collect();
    // What speaks against the best way to each pose, and the pose before on that way.
    let mut ways: Vec<Vec<(f64, usize)>> = Vec::with_capacity(seen.len());
    for (n, &k) in seen.iter().enumerate() {
        let to = |own: &Found| {
            let before = n.checked_sub(1).map(|before| (&ways[before], seen[before]));
            let (way, from) = before.map_or((0.0, 0), |(ways, before)| {
                let from = |(earlier, found): (usize, &Found)| {
                    let change = motion.against(&found.refined.pose, &own.refined.pose, k - before);
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
