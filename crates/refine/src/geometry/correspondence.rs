//! A posed hand as one camera sees it.

use glam::{DAffine3, DVec2, DVec3};
use image::GrayImage;
use phalanx_hand::Primitive;
use phalanx_render::Renderer;

use crate::error::{Error, Result};
use crate::geometry::sphere_hull::{Bound, Hull, Passing};
use crate::observation::boundary::find_cracks;
use crate::observation::silhouette::Evidence;

/// A ray of the observed border and the solid that should touch it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Match {
    /// The ray, in the camera's frame.
    #[cfg(test)]
    pub(crate) ray: DVec3,
    /// Which solid.
    pub(crate) solid: usize,
    /// Where the ray passes it.
    pub(crate) passing: Passing,
}

/// A drawn border that is as close as this, px, to an observed one says nothing that the observed one
/// does not say.
const CLOSE: f64 = 1.2;

/// How far drawn outlines may be off, px: a tenth of what is known of observed ones.
const DEVIATION: f64 = 0.05;

/// A hull, and where its outline may be.
#[derive(Debug, Clone)]
struct Seen {
    hull: Hull,
    bound: Bound,
}

impl Match {
    #[cfg_attr(not(test), allow(unused_variables, reason = "tests hold the same ray again"))]
    fn new(ray: DVec3, solid: usize, passing: Passing) -> Self {
        Self {
            #[cfg(test)]
            ray,
            solid,
            passing,
        }
    }
}

/// The memory in which one camera's view of one pose after another is compared with what it saw.
#[derive(Debug, Clone)]
pub(crate) struct View {
    renderer: Renderer,
    seen: Vec<Seen>,
    drawn: GrayImage,
    cracks: Vec<DVec2>,
    /// The solid that each observed crack was matched with last: seldom another next time.
    last: Vec<usize>,
    pub(crate) matches: Vec<Match>,
}

impl View {
    pub(crate) fn new(evidence: &Evidence) -> Result<Self> {
        let camera = evidence.camera();
        let renderer = Renderer::new(camera).and_then(|own| own.with_deviation(DEVIATION));
        let renderer = renderer.map_err(|reason| render_error(evidence, reason))?;
        Ok(Self {
            renderer,
            seen: Vec::new(),
            drawn: GrayImage::default(),
            cracks: Vec::new(),
            last: vec![0; evidence.cracks().len()],
            matches: Vec::new(),
        })
    }

    /// Matches solids, in the world, with the border that was seen, both ways: each observed crack
    /// with the solid that it is least outside of, and each crack of the drawn silhouette's solid
    /// with the observed crack that is nearest to it.
    pub(crate) fn compare(
        &mut self,
        solids: &[Primitive],
        evidence: &Evidence,
        every: usize,
    ) -> Result<()> {
        let camera = evidence.camera();
        self.renderer
            .silhouette_into(solids, &mut self.drawn)
            .map_err(|reason| render_error(evidence, reason))?;
        find_cracks(&self.drawn, &mut self.cracks);
        let to_camera = DAffine3::from_mat3_translation(
            camera.extrinsics.rotation,
            camera.extrinsics.translation,
        );
        self.seen.clear();
        self.seen.extend(solids.iter().map(|solid| Seen::new(&solid.moved(&to_camera))));
        self.matches.clear();
        let observed = evidence.rays().iter().zip(evidence.normals()).zip(&mut self.last);
        for ((&ray, &normal), last) in observed.step_by(every) {
            let found = closest(&self.seen, ray, Some(normal), (*last).min(solids.len() - 1));
            *last = found.solid;
            self.matches.push(found);
        }
        let mut last = 0;
        for &crack in self.cracks.iter().step_by(every) {
            if !evidence.is_known(crack) {
                continue;
            }
            let nearest = evidence.nearest(crack);
            if evidence.cracks()[nearest].distance_squared(crack) < CLOSE * CLOSE {
                continue;
            }
            let Some(direction) = camera.intrinsics.to_normalised(crack) else { continue };
            let own = closest(&self.seen, direction.extend(1.0).normalize(), None, last);
            last = own.solid;
            if own.passing.normal.truncate().dot(evidence.normals()[nearest]) > 0.0 {
                continue;
            }
            let ray = evidence.rays()[nearest];
            let passing = self.seen[last].hull.pass(ray);
            self.matches.push(Match::new(ray, last, passing));
        }
        Ok(())
    }

    /// Draws solids, in the world, into an image.
    pub(crate) fn draw(
        &mut self,
        solids: &[Primitive],
        evidence: &Evidence,
        image: &mut GrayImage,
    ) -> Result<()> {
        self.renderer
            .silhouette_into(solids, image)
            .map_err(|reason| render_error(evidence, reason))
    }

    /// The silhouette that was drawn last.
    pub(crate) fn drawn(&self) -> &GrayImage {
        &self.drawn
    }
}

impl Seen {
    fn new(solid_in_camera: &Primitive) -> Self {
        let hull = Hull::new(solid_in_camera);
        Self { hull, bound: hull.bound() }
    }
}

/// The solid that a ray is least outside of; `hint` is looked at first. Where it is known which way
/// the background is from the ray, solids whose outline faces another way count as further off.
fn closest(seen: &[Seen], ray: DVec3, background: Option<DVec2>, hint: usize) -> Match {
    /// How much further an outline that faces away counts as, mm: about a finger's radius, so that a
    /// finger's one side is not taken for the other.
    const FACING: f64 = 12.0;
    let place = ray.truncate() / ray.z;
    let cost = |passing: &Passing| {
        // The normal points from the ray into the solid; a squashed one's may be longer than 1.
        let turned = background.map_or(0.0, |out| 1.0 + out.dot(passing.normal.truncate()));
        passing.distance + 0.5 * FACING * turned.max(0.0)
    };
    let mut best = Match::new(ray, hint, seen[hint].hull.pass(ray));
    let mut least = cost(&best.passing);
    for (solid, candidate) in seen.iter().enumerate() {
        if solid == hint || candidate.bound.is_beyond(place, least) {
            continue;
        }
        // No cost is below the distance.
        if let Some(passing) = candidate.hull.pass_within(least, ray) {
            let cost = cost(&passing);
            if cost < least {
                (best, least) = (Match::new(ray, solid, passing), cost);
            }
        }
    }
    best
}

fn render_error(evidence: &Evidence, reason: phalanx_render::Error) -> Error {
    Error::Render { camera: evidence.camera().name.clone(), reason }
}
