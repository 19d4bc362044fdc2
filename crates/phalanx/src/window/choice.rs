//! Which of the things that look like hands is the hand.

use glam::{DVec2, DVec3};
use phalanx_camera::{Camera, Ray, triangulate};
use phalanx_segmentation::LocatedHand;

/// The most things that are considered in each view.
const MOST: usize = 6;

/// How far a wrist's ray usually misses the wrist, mm.
const MISS: f64 = 15.0;

/// How far a wrist usually moves from one frame to the next, mm.
const MOTION: f64 = 50.0;

/// The hand in each view, among what may be one, the likeliest first: strangeness, the rays' misses
/// and the way from the last frame's wrist are each a squared distance in standard deviations, and
/// their sum is the least. Every view has at least one.
pub(super) fn choose(
    looks: &[(Camera, Vec<LocatedHand>)],
    last: Option<DVec3>,
) -> Vec<LocatedHand> {
    let counts: Vec<usize> = looks.iter().map(|(_, hands)| hands.len().min(MOST)).collect();
    let mut choice = vec![0; looks.len()];
    let mut best = (f64::INFINITY, choice.clone());
    loop {
        let cost = cost(looks, &choice, last);
        if cost < best.0 {
            best = (cost, choice.clone());
        }
        // The next choice, counted up like an odometer.
        let Some(view) = (0..choice.len()).find(|&v| choice[v] + 1 < counts[v]) else { break };
        choice[view] += 1;
        choice[..view].fill(0);
    }
    looks.iter().zip(best.1).map(|((_, hands), k)| hands[k]).collect()
}

fn cost(looks: &[(Camera, Vec<LocatedHand>)], choice: &[usize], last: Option<DVec3>) -> f64 {
    let hands = || looks.iter().zip(choice).map(|((camera, hands), &k)| (camera, &hands[k]));
    let strangeness: f64 = hands().map(|(_, hand)| hand.strangeness).sum();
    let rays: Vec<Ray> = hands()
        .filter_map(|(camera, hand)| camera.unproject(DVec2::from_array(hand.wrist)))
        .collect();
    let met = triangulate(&rays).ok();
    let misses = met.map_or(0.0, |met| rays.len() as f64 * (met.spread / MISS).powi(2));
    let moved = last.map_or(0.0, |last| match met {
        Some(met) => met.point.distance_squared(last),
        None => rays.iter().map(|ray| distance_squared(ray, last)).fold(0.0, f64::max),
    });
    strangeness + misses + moved / (MOTION * MOTION)
}

/// The squared distance of a point from a ray's line.
fn distance_squared(ray: &Ray, point: DVec3) -> f64 {
    (point - ray.origin).cross(ray.direction).length_squared()
}
