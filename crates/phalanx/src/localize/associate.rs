//! Which candidates of all views are one hand, and where it is.

use glam::DVec3;
use phalanx_camera::{Ray, triangulate};

use crate::localize::detect::{Detections, LEFT_OUT, may_have_arm, probability, unlikely};
use crate::localize::sighting::{Sighting, arm};

/// A hand in space: where its wrist is, and which way its arm points.
#[derive(Debug, Clone, PartialEq)]
pub struct Placement {
    /// The wrist, mm in the world.
    pub wrist: DVec3,
    /// Unit vector along the forearm towards the hand, in the world.
    pub arm: DVec3,
    /// For each view, which of its candidates is the hand; `None` where none agrees with the others.
    pub chosen: Vec<Option<usize>>,
    /// How little the candidates look like one hand: a sum of squared distances in standard deviations.
    pub cost: f64,
}

/// How far a wrist's ray usually misses the wrist, mm.
const MISS: f64 = 15.0;

/// How wide wrists are seen, mm, and the standard deviation of its logarithm: a finger is not half as
/// wide.
const WIDTH: f64 = 54.0;
const WIDTH_SPREAD: f64 = 0.25;

/// How far an arm is usually seen from where the views together say that it points to, as a share of
/// its length.
const TURN: f64 = 0.1;

/// What a view costs on average in which a candidate is the hand: as many degrees of freedom.
const USUAL: f64 = 15.0;

/// Points of the palm that lie within the silhouette of every view that sees the hand, ahead of the wrist,
/// mm: up to the knuckles of the mean hand.
const PALM: [f64; 4] = [0.0, 25.0, 50.0, 75.0];

/// How far off the distance may be that a wrist's width says, as steps of its logarithm: two standard
/// deviations either way.
const DEPTHS: [f64; 9] = [0.0, 0.125, -0.125, 0.25, -0.25, 0.375, -0.375, 0.5, -0.5];

/// Wrists nearer than half a hand to each other are one placement's.
const SAME_WRIST: f64 = 90.0;
/// Cosine of the angle up to which arms point the same way: half a right angle.
const SAME_ARM: f64 = 0.7;

/// Angles by which an arm may point away from a camera or towards it, from across its view.
const SLANTS_DEG: [f64; 5] = [0.0, 30.0, -30.0, 60.0, -60.0];

/// The placements that the candidates of all views allow, the likeliest first, at most `most`. Each
/// pair of candidates of two views, and each candidate alone, says where the hand may be; the other
/// views then agree or are left out. Where only one view shows anything, what does not look like a hand in it is no
/// placement unless nothing does. Where views tell no more of an arm's direction than how it looks
/// in one picture, placements differ in how far it points away from the camera.
pub fn associate(views: &[Detections], most: usize) -> Vec<Placement> {
    let seen: Vec<Seen<'_>> = views.iter().map(Seen::of).collect();
    let mut found: Vec<Placement> = Vec::new();
    for (a, first) in seen.iter().enumerate() {
        for one in &first.candidates {
            found.extend(of_one(one, &seen));
            for other in seen[a + 1..].iter().flat_map(|view| &view.candidates) {
                found.extend(of_pair(one, other, &seen));
            }
        }
    }
    // The only view that shows anything cannot bear out what does not look like a hand in it.
    let showing = seen.iter().filter(|view| !view.candidates.is_empty()).count();
    if showing == 1 && found.iter().any(|placement| placement.views() > 0) {
        found.retain(|placement| placement.views() > 0);
    }
    found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let mut distinct: Vec<Placement> = Vec::new();
    for placement in found {
        let is_known = distinct.iter().any(|other| {
            other.wrist.distance(placement.wrist) < SAME_WRIST
                && other.arm.dot(placement.arm) > SAME_ARM
        });
        if !is_known && distinct.len() < most {
            distinct.push(placement);
        }
    }
    distinct
}

/// What may be the hand, and what it says of where that is.
struct Candidate<'a> {
    /// How little it looks like a hand, and what is behind its wrist like an arm.
    unlikely: f64,
    sighting: Sighting<'a>,
}

/// A view, and what may be the hand in it.
struct Seen<'a> {
    view: &'a Detections,
    candidates: Vec<Candidate<'a>>,
}

impl<'a> Seen<'a> {
    fn of(view: &'a Detections) -> Self {
        let candidate = |hand| {
            // Where the lens maps nothing there is no hand either.
            let sighting = Sighting::new(&view.camera, hand).ok()?;
            let before_arm = if may_have_arm(hand) { 0.0 } else { LEFT_OUT };
            Some(Candidate { unlikely: unlikely(hand) + before_arm, sighting })
        };
        Self { view, candidates: view.hands.iter().filter_map(candidate).collect() }
    }

    /// The share of the palm's points that lie outside the silhouette.
    fn outside(&self, wrist: DVec3, arm: DVec3) -> f64 {
        let is_outside = |&&ahead: &&f64| !self.view.covers(wrist + arm * ahead);
        PALM.iter().filter(is_outside).count() as f64 / PALM.len() as f64
    }

    /// The candidate that agrees best with a hand in space, if any does, and what that costs. Where none
    /// does, the silhouette still may.
    fn agreement(&self, wrist: DVec3, arm: DVec3) -> (Option<usize>, f64) {
        let costs = self.candidates.iter().map(|candidate| cost(candidate, wrist, arm));
        let best = costs.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        let backwards = probability(self.view.backwards_log_odds(wrist, arm));
        let outside = self.outside(wrist, arm).max(2.0 * backwards - 1.0);
        let by_mask = USUAL + (LEFT_OUT - USUAL) * outside;
        match best {
            Some((k, cost)) if cost < by_mask => (Some(k), cost),
            _ => (None, by_mask),
        }
    }
}

/// The placements that a pair of candidates proposes, with what all views say to them. None where the
/// two do not agree.
fn of_pair(one: &Candidate<'_>, other: &Candidate<'_>, seen: &[Seen<'_>]) -> Vec<Placement> {
    let pair = [one.sighting, other.sighting];
    let Ok(met) = triangulate(&pair.map(|sighting| sighting.wrist)) else { return Vec::new() };
    // Where planes are nearly parallel, they meet anywhere; what one view sees then agrees with others.
    let arms = arm(&pair).into_iter().chain(pair.iter().flat_map(slanted));
    let proposed = arms.map(|arm| judged(met.point, arm, seen)).filter(|found| found.views() > 1);
    proposed.map(|found| found.among_all(seen)).collect()
}

/// The placements that a candidate alone proposes: the distance follows from the wrist's width, roughly.
fn of_one(one: &Candidate<'_>, seen: &[Seen<'_>]) -> Vec<Placement> {
    let sighting = &one.sighting;
    let depth = sighting.camera.intrinsics.fx * WIDTH / sighting.hand.width.max(f64::MIN_POSITIVE);
    let ahead = sighting.camera.extrinsics.rotation.row(2).dot(sighting.wrist.direction);
    let at = |share: f64| {
        let distance = share.exp() * depth / ahead;
        sighting.wrist.origin + sighting.wrist.direction * distance
    };
    let arms: Vec<DVec3> = slanted(sighting).collect();
    let best = |&arm: &DVec3| {
        let proposed = DEPTHS.iter().map(|&share| judged(at(share), arm, seen));
        proposed.min_by(|a, b| a.cost.total_cmp(&b.cost))
    };
    arms.iter().filter_map(best).collect()
}

/// Directions in which an arm may point that look as one view sees it.
fn slanted<'a>(sighting: &'a Sighting<'_>) -> impl Iterator<Item = DVec3> + 'a {
    SLANTS_DEG.into_iter().map(|slant| {
        let (sin, cos) = slant.to_radians().sin_cos();
        sighting.across() * cos + sighting.wrist.direction * sin
    })
}

impl Placement {
    /// How many views have a candidate that is the hand.
    fn views(&self) -> usize {
        self.chosen.iter().flatten().count()
    }

    /// The same with the wrist where the rays of all views that agree meet, if that is likelier.
    fn among_all(self, seen: &[Seen<'_>]) -> Self {
        let chosen =
            self.chosen.iter().zip(seen).filter_map(|(k, view)| Some(&view.candidates[(*k)?]));
        let rays: Vec<Ray> = chosen.map(|candidate| candidate.sighting.wrist).collect();
        let Ok(met) = triangulate(&rays) else { return self };
        let refined = judged(met.point, self.arm, seen);
        if refined.cost < self.cost { refined } else { self }
    }
}

/// What all views say to a hand in space.
fn judged(wrist: DVec3, arm: DVec3, seen: &[Seen<'_>]) -> Placement {
    let mut placement = Placement { wrist, arm, chosen: Vec::new(), cost: 0.0 };
    for view in seen {
        let (chosen, cost) = view.agreement(wrist, arm);
        placement.chosen.push(chosen);
        placement.cost += cost;
    }
    placement
}

/// How little a candidate is the hand with its wrist at a point and its arm in a direction.
fn cost(candidate: &Candidate<'_>, wrist: DVec3, arm: DVec3) -> f64 {
    let Candidate { unlikely, sighting } = candidate;
    let width = sighting.width_mm(wrist);
    if width <= 0.0 {
        return f64::INFINITY;
    }
    let offset = (wrist - sighting.wrist.origin).cross(sighting.wrist.direction).length();
    unlikely
        + (offset / MISS).powi(2)
        + ((width / WIDTH).ln() / WIDTH_SPREAD).powi(2)
        + (sighting.miss(arm) / TURN).powi(2)
}
