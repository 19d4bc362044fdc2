//! Which of the hands in a picture is meant.

use phalanx_hand::{Landmarks, Side};

/// A hand in a picture.
pub(super) struct Candidate {
    pub(super) points: Landmarks,
    /// Which hand it is said to be, and how surely.
    pub(super) said: Option<(Side, f64)>,
}

/// The hand of a side in each of some pictures: by what it is called where any of them shows several,
/// the surest of those; else the one that there is.
pub(super) fn choose(
    frames: Vec<Vec<Candidate>>,
    side: Side,
) -> Result<Vec<Option<Landmarks>>, String> {
    let several = frames.iter().any(|hands| hands.len() > 1);
    let chosen = |(frame, hands): (usize, Vec<Candidate>)| {
        if several && hands.iter().any(|hand| hand.said.is_none()) {
            let count = hands.len();
            return Err(format!(
                "frame {frame} of the file shows {count} hands and does not say which is left and which right"
            ));
        }
        let meant = hands.into_iter().filter_map(|hand| match hand.said {
            _ if !several => Some((1.0, hand.points)),
            Some((own, sure)) => (own == side).then_some((sure, hand.points)),
            None => None,
        });
        Ok(meant.max_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, points)| points))
    };
    frames.into_iter().enumerate().map(chosen).collect()
}
