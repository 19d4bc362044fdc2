//! How many different postures some frames show.

use phalanx::{Observation, ObservedView};

/// The number of frames that differ from every frame before them, in some view, by more than borders that
/// are known to so many pixels do by themselves.
pub(crate) fn count<'a>(frames: impl Iterator<Item = &'a Observation>, border_px: f64) -> usize {
    let mut different: Vec<&Observation> = Vec::new();
    for frame in frames {
        let are_alike = |other: &&Observation| {
            let mut views = frame.views.iter().zip(&other.views);
            views.all(|(one, other)| differing(one, other) <= border_px * length(one))
        };
        if !different.iter().any(are_alike) {
            different.push(frame);
        }
    }
    different.len()
}

/// Pixels that are hand in one of two views alone; infinite for masks of different sizes.
fn differing(one: &ObservedView, other: &ObservedView) -> f64 {
    let (one, other) = (&one.silhouette.mask, &other.silhouette.mask);
    if one.dimensions() != other.dimensions() {
        return f64::INFINITY;
    }
    let (width, height) = one.dimensions();
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    pixels.filter(|&(x, y)| one.is_hand(x, y) != other.is_hand(x, y)).count() as f64
}

/// The length of a silhouette's border, px.
fn length(view: &ObservedView) -> f64 {
    view.silhouette.contour.points.len() as f64
}
