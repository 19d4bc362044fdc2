//! A posed hand as one camera sees it.

use glam::{DAffine3, DVec2, DVec3};
use phalanx_hand::Primitive;
use phalanx_render::Renderer;
use phalanx_segmentation::Mask;

use crate::error::{Error, Result};
use crate::geometry::bound::Bound;
use crate::geometry::drawn_term::DrawnTerm;
use crate::geometry::sphere_hull::{ClosestApproach, SphereHull};
use crate::observation::boundary::boundary_edges;
use crate::observation::silhouette::SilhouetteObservation;

/// A ray of the observed boundary and the primitive that should touch it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Correspondence {
    /// The ray, in the camera's frame.
    #[cfg(test)]
    pub(crate) ray: DVec3,
    /// Which primitive.
    pub(crate) primitive: usize,
    /// Where the ray passes it.
    pub(crate) approach: ClosestApproach,
}

/// A place of the drawn outline that bounds an area between the silhouettes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DrawnPlace {
    /// The primitive that is drawn there.
    pub(crate) drawn: Correspondence,
    /// How far outside the observed silhouette it is, px; negative within.
    pub(crate) outside: f64,
    /// How long a piece of the outline it stands for, px: as long as the edge of its pixel is along the outline.
    pub(crate) length: f64,
}

/// A drawn boundary that is as close as this, px, to an observed one says nothing that the observed one
/// does not say.
const CLOSE: f64 = 1.2;

/// How far drawn outlines may be off, over how far observed ones are.
const DEVIATION: f64 = 0.1;

/// Outlines are drawn no finer than this, px, and no coarser.
const FINEST: f64 = 0.005;
const COARSEST: f64 = 0.5;

/// A hull, and where its outline may be.
#[derive(Debug, Clone)]
struct Seen {
    hull: SphereHull,
    bound: Bound,
}

impl Correspondence {
    #[cfg_attr(not(test), allow(unused_variables, reason = "tests hold the same ray again"))]
    fn new(ray: DVec3, primitive: usize, approach: ClosestApproach) -> Self {
        Self {
            #[cfg(test)]
            ray,
            primitive,
            approach,
        }
    }
}

/// The memory in which one camera's view of one pose after another is compared with what it saw.
#[derive(Debug, Clone)]
pub(crate) struct ViewMatcher {
    renderer: Renderer,
    seen: Vec<Seen>,
    drawn: Mask,
    edges: Vec<DVec2>,
    /// The primitive that each observed edge was matched with last: seldom another next time.
    last: Vec<usize>,
    pub(crate) correspondences: Vec<Correspondence>,
    /// Where the drawn silhouette ends, if areas are looked at.
    pub(crate) drawn_places: Vec<DrawnPlace>,
}

impl ViewMatcher {
    /// For an observed boundary whose places are known to a standard deviation of `noise` px.
    pub(crate) fn new(evidence: &SilhouetteObservation, noise: f64) -> Result<Self> {
        let deviation = (DEVIATION * noise).clamp(FINEST, COARSEST);
        let camera = evidence.camera();
        let renderer = Renderer::new(camera).and_then(|own| own.with_deviation(deviation));
        let renderer = renderer.map_err(|reason| render_error(evidence, reason))?;
        Ok(Self {
            renderer,
            seen: Vec::new(),
            drawn: Mask::default(),
            edges: Vec::new(),
            last: vec![0; evidence.edges().len()],
            correspondences: Vec::new(),
            drawn_places: Vec::new(),
        })
    }

    /// Matches primitives, in the world, with the boundary that was seen: each observed edge with the primitive that it is
    /// least outside of; where outlines are compared, also each edge of the drawn silhouette's primitive with the
    /// observed edge that is nearest to it.
    pub(crate) fn match_boundary(
        &mut self,
        primitives: &[Primitive],
        evidence: &SilhouetteObservation,
        every: usize,
        drawn: DrawnTerm,
    ) -> Result<()> {
        let camera = evidence.camera();
        self.renderer
            .silhouette_into(primitives, &mut self.drawn)
            .map_err(|reason| render_error(evidence, reason))?;
        boundary_edges(&self.drawn, &mut self.edges);
        let to_camera = DAffine3::from_mat3_translation(
            camera.extrinsics.rotation,
            camera.extrinsics.translation,
        );
        self.seen.clear();
        self.seen
            .extend(primitives.iter().map(|primitive| Seen::new(&primitive.moved(&to_camera))));
        self.correspondences.clear();
        let observed = evidence.rays().iter().zip(evidence.normals()).zip(&mut self.last);
        for ((&ray, &normal), last) in observed.step_by(every) {
            let found = closest(&self.seen, ray, Some(normal), (*last).min(primitives.len() - 1));
            *last = found.primitive;
            self.correspondences.push(found);
        }
        if drawn == DrawnTerm::Outline {
            self.match_outline(evidence, every);
        }
        Ok(())
    }

    /// Matches the drawn outline's primitives with the observed edges that are nearest to it.
    fn match_outline(&mut self, evidence: &SilhouetteObservation, every: usize) {
        for &edge in self.edges.iter().step_by(every) {
            if !evidence.is_known(edge) {
                continue;
            }
            let nearest = evidence.nearest(edge);
            if evidence.edges()[nearest].distance_squared(edge) < CLOSE * CLOSE {
                continue;
            }
            let Some(own) = self.drawn_at(edge, evidence, every) else { continue };
            if own.approach.normal.truncate().dot(evidence.normals()[nearest]) > 0.0 {
                continue;
            }
            let ray = evidence.rays()[nearest];
            let approach = self.seen[own.primitive].hull.closest_approach(ray);
            self.correspondences.push(Correspondence::new(ray, own.primitive, approach));
        }
    }

    /// Finds the places of the outline that was drawn last that bound areas between the silhouettes.
    pub(crate) fn match_areas(&mut self, evidence: &SilhouetteObservation, every: usize) {
        self.drawn_places.clear();
        for &edge in self.edges.iter().step_by(every) {
            let outside = evidence.outside(edge);
            if outside == 0.0 || !evidence.is_known(edge) {
                continue;
            }
            let Some(drawn) = self.drawn_at(edge, evidence, every) else { continue };
            let normal = drawn.approach.normal.truncate().normalize_or_zero();
            // Edges of pixels are along the image's axes.
            let is_upright = edge.x.fract() == 0.0;
            let length = if is_upright { normal.x } else { normal.y }.abs();
            self.drawn_places.push(DrawnPlace { drawn, outside, length });
        }
    }

    /// The primitive that is drawn at an edge of the drawn silhouette.
    fn drawn_at(
        &self,
        edge: DVec2,
        evidence: &SilhouetteObservation,
        every: usize,
    ) -> Option<Correspondence> {
        let direction = evidence.camera().intrinsics.to_normalised(edge)?;
        // What is drawn nearby is likely drawn by the same primitive.
        let nearest = evidence.nearest(edge);
        let hint = self.last[nearest - nearest % every].min(self.seen.len() - 1);
        Some(closest(&self.seen, direction.extend(1.0).normalize(), None, hint))
    }

    /// Draws primitives, in the world, into an image.
    pub(crate) fn draw(
        &mut self,
        primitives: &[Primitive],
        evidence: &SilhouetteObservation,
        image: &mut Mask,
    ) -> Result<()> {
        self.renderer
            .silhouette_into(primitives, image)
            .map_err(|reason| render_error(evidence, reason))
    }

    /// The silhouette that was drawn last.
    pub(crate) fn drawn(&self) -> &Mask {
        &self.drawn
    }
}

impl Seen {
    fn new(solid_in_camera: &Primitive) -> Self {
        let hull = SphereHull::new(solid_in_camera);
        Self { hull, bound: hull.bound() }
    }
}

/// The primitive that a ray is least outside of; `hint` is looked at first. Where it is known which way
/// the background is from the ray, primitives whose outline faces another way count as further off.
fn closest(seen: &[Seen], ray: DVec3, background: Option<DVec2>, hint: usize) -> Correspondence {
    /// How much further an outline that faces away counts as, mm: about a finger's radius, so that a
    /// finger's one side is not taken for the other.
    const FACING: f64 = 12.0;
    let place = ray.truncate() / ray.z;
    let cost = |approach: &ClosestApproach| {
        // The normal points from the ray into the solid; a squashed one's may be longer than 1.
        let turned = background.map_or(0.0, |out| 1.0 + out.dot(approach.normal.truncate()));
        approach.distance + 0.5 * FACING * turned.max(0.0)
    };
    let mut best = Correspondence::new(ray, hint, seen[hint].hull.closest_approach(ray));
    let mut least = cost(&best.approach);
    for (primitive, candidate) in seen.iter().enumerate() {
        if primitive == hint || candidate.bound.is_beyond(place, least) {
            continue;
        }
        // No cost is below the distance.
        if let Some(approach) = candidate.hull.closest_approach_within(least, ray) {
            let cost = cost(&approach);
            if cost < least {
                (best, least) = (Correspondence::new(ray, primitive, approach), cost);
            }
        }
    }
    best
}

fn render_error(evidence: &SilhouetteObservation, reason: phalanx_render::Error) -> Error {
    Error::Render { camera: evidence.camera().name.clone(), reason }
}
