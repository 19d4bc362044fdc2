//! Which of the things that look like hands is the hand.

use glam::DVec3;
use phalanx_camera::{Camera, Ray, triangulate};
use phalanx_segmentation::HandDetection;

use crate::localize::sighting::{Sighting, arm};
use crate::localize::unlikely;

/// The most things that are considered in each view.
const MOST: usize = 6;

/// How far a wrist's ray usually misses the wrist, mm.
const MISS: f64 = 15.0;

/// How far a wrist usually moves from one frame to the next, mm.
const MOTION: f64 = 50.0;

/// How wide wrists are seen, mm, and the standard deviation of its logarithm: a finger is not half as wide.
const WIDTH: f64 = 54.0;
const WIDTH_SPREAD: f64 = 0.25;

/// How far an arm is usually seen from where the views together say that it points to, as a share of
/// its length.
const TURN: f64 = 0.1;

/// The hand in each view, among what may be one, the likeliest first: how unlikely each is at its end of the arm, the
/// rays' misses, how wide the wrist would be, where else the arm would point to, and the way from the last frame's
/// wrist are each a squared distance in standard deviations, and their sum is the least. Every view
/// has at least one.
pub(super) fn choose(
    looks: &[(Camera, Vec<HandDetection>)],
    last: Option<DVec3>,
) -> Vec<HandDetection> {
    let views: Vec<Vec<Candidate<'_>>> = looks.iter().map(candidates).collect();
    let mut choice = vec![0; looks.len()];
    let mut best = (f64::INFINITY, choice.clone());
    loop {
        let chosen: Vec<&Candidate<'_>> =
            views.iter().zip(&choice).map(|(candidates, &k)| &candidates[k]).collect();
        let cost = cost(&chosen, last);
        if cost < best.0 {
            best = (cost, choice.clone());
        }
        // The next choice, counted up like an odometer.
        let Some(view) = (0..choice.len()).find(|&v| choice[v] + 1 < views[v].len()) else { break };
        choice[view] += 1;
        choice[..view].fill(0);
    }
    looks.iter().zip(best.1).map(|((_, hands), k)| hands[k]).collect()
}

/// What may be a hand, and what it says of where that is unless the lens has no place for it.
struct Candidate<'a> {
    unlikely: f64,
    sighting: Option<Sighting<'a>>,
}

fn candidates((camera, hands): &(Camera, Vec<HandDetection>)) -> Vec<Candidate<'_>> {
    let likeliest = hands.iter().take(MOST);
    likeliest
        .map(|hand| Candidate {
            unlikely: unlikely(hand),
            sighting: Sighting::new(camera, hand).ok(),
        })
        .collect()
}

fn cost(chosen: &[&Candidate<'_>], last: Option<DVec3>) -> f64 {
    let unlikely: f64 = chosen.iter().map(|candidate| candidate.unlikely).sum();
    let sightings: Vec<Sighting<'_>> =
        chosen.iter().filter_map(|candidate| candidate.sighting).collect();
    let rays: Vec<Ray> = sightings.iter().map(|sighting| sighting.wrist).collect();
    let met = triangulate(&rays).ok();
    let apart = met.map_or(0.0, |met| {
        rays.len() as f64 * (met.spread / MISS).powi(2) + disagreement(&sightings, met.point)
    });
    let moved = last.map_or(0.0, |last| match met {
        Some(met) => met.point.distance_squared(last),
        None => rays.iter().map(|ray| distance_squared(ray, last)).fold(0.0, f64::max),
    });
    unlikely + apart + moved / (MOTION * MOTION)
}

/// How little what views see is one arm with its wrist at a point.
fn disagreement(sightings: &[Sighting<'_>], wrist: DVec3) -> f64 {
    let width = |sighting: &Sighting<'_>| (sighting.width_mm(wrist) / WIDTH).ln() / WIDTH_SPREAD;
    let widths = sightings.iter().map(|sighting| width(sighting).powi(2)).sum::<f64>();
    let turns =
        |arm| -> f64 { sightings.iter().map(|sighting| (sighting.miss(arm) / TURN).powi(2)).sum() };
    // Where planes are nearly parallel, they meet anywhere; what one view sees then agrees with others.
    let arms = arm(sightings).into_iter().chain(sightings.iter().map(Sighting::across));
    widths + arms.map(turns).fold(f64::INFINITY, f64::min)
}

/// The squared distance of a point from a ray's line.
fn distance_squared(ray: &Ray, point: DVec3) -> f64 {
    (point - ray.origin).cross(ray.direction).length_squared()
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use phalanx_camera::Rig;

    use super::*;

    /// What looks like a hand at a point of the world, with an arm as wide, mm.
    fn located(
        camera: &Camera,
        wrist: DVec3,
        arm: DVec3,
        width: f64,
        mahalanobis2: f64,
    ) -> HandDetection {
        let [at, ahead] = [wrist, wrist + arm].map(|point| camera.project(point).unwrap());
        let depth = camera.extrinsics.to_camera(wrist).z;
        let width = width * camera.intrinsics.fx / depth;
        HandDetection {
            wrist: at.to_array(),
            direction: DVec2::normalize(ahead - at).to_array(),
            width,
            length: 3.0 * width,
            across: [-width, width],
            area: 4.0 * width * width,
            behind: 0.0,
            arm: 2.0 * width,
            cut_off: false,
            mahalanobis2,
            ahead_log_odds: f64::INFINITY,
            profile: Default::default(),
            component: 0,
        }
    }

    /// In every view a hand and, looking more like one, something else; all views should choose the
    /// hand.
    fn assert_chosen(hand: [DVec3; 2], other: impl Fn(usize, &Camera) -> HandDetection) {
        let rig = Rig::from_toml(include_str!("../../fixtures/desk.toml")).unwrap();
        let [wrist, arm] = hand;
        let look = |(view, camera): (usize, Camera)| {
            let hand = located(&camera, wrist, arm, WIDTH, 11.0);
            let hands = vec![other(view, &camera), hand];
            (camera, hands)
        };
        for views in [vec![0, 1], vec![0, 1, 2]] {
            let cameras = views.iter().map(|&view| rig.cameras[view].clone());
            let looks: Vec<(Camera, Vec<HandDetection>)> = cameras.enumerate().map(look).collect();
            for (chosen, (camera, _)) in choose(&looks, None).iter().zip(&looks) {
                assert_eq!(chosen, &located(camera, wrist, arm, WIDTH, 11.0), "{}", camera.name);
            }
        }
    }

    #[test]
    fn a_finger_is_no_hand() {
        let (wrist, arm) = (DVec3::new(10.0, -20.0, -30.0), DVec3::new(0.3, 0.1, 1.0).normalize());
        let finger = |_, camera: &Camera| located(camera, wrist + 130.0 * arm, arm, 18.0, 6.0);
        assert_chosen([wrist, arm], finger);
    }

    #[test]
    fn an_arm_points_one_way() {
        let (wrist, arm) = (DVec3::new(-20.0, 10.0, 0.0), DVec3::new(-0.2, 0.2, 1.0).normalize());
        let turned = |view, camera: &Camera| match view {
            1 => located(camera, wrist, -arm, WIDTH, 6.0),
            _ => located(camera, wrist, arm, WIDTH, 11.0),
        };
        assert_chosen([wrist, arm], turned);
    }
}
