//! What a camera saw.

use glam::{DVec2, DVec3};
use phalanx_camera::Camera;
use phalanx_segmentation::Mask;

use crate::error::{Error, Result};
use crate::observation::boundary::{self, boundary_edges, outwards};
use crate::observation::distance_transform::nearest_edges;

/// One camera and the silhouette that it saw.
///
/// The silhouette's boundary is held as its *edges*: the middles of the pixel edges between hand and
/// background. An edge lies within half a pixel of the true boundary, on average on it. The image's
/// own boundary, where it cuts the forearm, has none.
#[derive(Debug, Clone)]
pub struct SilhouetteObservation {
    camera: Camera,
    mask: Mask,
    /// 255 where it is known whether there is hand, 0 elsewhere.
    known: Mask,
    /// How far off its place the boundary is, over what it is where pixels were seen at once.
    grain: f64,
    /// How much a place of the boundary counts.
    weight: f64,
    /// Unit directions of the edges in the camera's frame.
    rays: Vec<DVec3>,
    /// Their places, px.
    edges: Vec<DVec2>,
    /// Which way the background is from each edge: unit vectors of the image.
    normals: Vec<DVec2>,
    /// The nearest edge of every pixel.
    nearest: Vec<u32>,
}

impl SilhouetteObservation {
    /// A mask of the size of the camera's image, in which hand is over 127.
    ///
    /// # Errors
    /// A mask of another size, or one without a boundary between hand and background.
    pub fn new(camera: &Camera, mask: &Mask) -> Result<Self> {
        Self::within(camera, mask, |_| true)
    }

    /// The same, where it is `known` only of some pixels, by their middles, whether they are hand:
    /// not where a sleeve covers the arm, or beyond the boundary of the picture that a window looks
    /// into.
    ///
    /// # Errors
    /// As of [`new`](Self::new); also a mask whose boundary lies nowhere that is known.
    pub fn within(camera: &Camera, mask: &Mask, known: impl Fn(DVec2) -> bool) -> Result<Self> {
        camera.validate()?;
        let name = || camera.name.clone();
        let expected = (camera.intrinsics.width, camera.intrinsics.height);
        if mask.dimensions() != expected {
            return Err(Error::MaskSize { camera: name(), found: mask.dimensions(), expected });
        }
        let known = Mask::from_fn(mask.width(), mask.height(), |x, y| {
            let middle = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
            known(middle)
        });
        let mut edges = Vec::new();
        boundary_edges(mask, &mut edges);
        edges.retain(|&edge| boundary::is_known(&known, edge));
        if edges.is_empty() {
            return Err(Error::NoBoundary { camera: name() });
        }
        let ray = |&edge: &DVec2| {
            let direction = camera.intrinsics.to_normalised(edge)?;
            Some(direction.extend(1.0).normalize())
        };
        let rays = edges.iter().map(ray).collect::<Option<_>>();
        let nearest = nearest_edges(&edges, expected);
        Ok(Self {
            camera: camera.clone(),
            mask: mask.clone(),
            known,
            grain: 1.0,
            weight: 1.0,
            rays: rays.ok_or_else(|| Error::NoBoundary { camera: name() })?,
            normals: edges.iter().map(|&edge| outwards(mask, edge)).collect(),
            nearest,
            edges,
        })
    }

    /// The same, of a mask that was resampled from another, whose pixels are `pixel` of this mask's
    /// wide: both put the boundary off its place, the other's half as far, as it is smoothed.
    #[must_use]
    pub fn resampled(self, pixel: f64) -> Self {
        Self { grain: 1.0_f64.hypot(0.5 * pixel), ..self }
    }

    /// The same, where each place of the boundary counts `weight` times as much as one that is known to
    /// [`PoseFitSettings::noise`](crate::PoseFitSettings::noise) independently of its neighbours: places that
    /// err together, or further, count less.
    #[must_use]
    pub fn weighted(self, weight: f64) -> Self {
        Self { weight, ..self }
    }

    /// How much a place of the boundary counts.
    pub(crate) fn weight(&self) -> f64 {
        self.weight
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The silhouette.
    pub fn mask(&self) -> &Mask {
        &self.mask
    }

    /// 255 where it is known whether there is hand, 0 elsewhere.
    pub(crate) fn known(&self) -> &Mask {
        &self.known
    }

    /// Whether the pixels on both sides of a drawn edge are known.
    pub(crate) fn is_known(&self, edge: DVec2) -> bool {
        boundary::is_known(&self.known, edge)
    }

    /// Unit directions of the edges, in the camera's frame.
    pub(crate) fn rays(&self) -> &[DVec3] {
        &self.rays
    }

    /// The places of the edges, px.
    pub(crate) fn edges(&self) -> &[DVec2] {
        &self.edges
    }

    /// Pixels that a millimetre is wide at a point of the world, over the boundary's grain.
    pub(crate) fn pixels_per_mm(&self, at: DVec3) -> f64 {
        let intrinsics = &self.camera.intrinsics;
        let focal = (intrinsics.fx * intrinsics.fy).sqrt();
        focal / self.camera.extrinsics.to_camera(at).length() / self.grain
    }

    /// By which share pixels at a point of the world grow as it moves by a millimetre: the slope of their logarithm.
    pub(crate) fn nearer(&self, at: DVec3) -> DVec3 {
        let away = at - self.camera.centre();
        -away / away.length_squared()
    }

    /// How far the boundary is off its place, over what it is where pixels were seen at once.
    pub(crate) fn grain(&self) -> f64 {
        self.grain
    }

    /// How far drawn pixels that were not seen, and seen ones that are not drawn, are from the boundary, px; of what is
    /// known.
    pub(crate) fn differences<'a>(&'a self, drawn: &'a Mask) -> impl Iterator<Item = f64> + 'a {
        let width = self.mask.width() as usize;
        boundary::differing([drawn, &self.mask], &self.known).map(move |pixel| {
            let middle = DVec2::new((pixel % width) as f64, (pixel / width) as f64) + 0.5;
            f64::from(self.edges[self.nearest[pixel] as usize].distance(middle) as f32)
        })
    }

    /// How far outside the silhouette a place in the image is, px; negative within.
    pub(crate) fn outside(&self, place: DVec2) -> f64 {
        let apart = self.edges[self.nearest(place)].distance(place);
        if self.mask.is_hand(place.x as u32, place.y as u32) { -apart } else { apart }
    }

    /// Which way the background is from each edge.
    pub(crate) fn normals(&self) -> &[DVec2] {
        &self.normals
    }

    /// The edge that is nearest to a pixel position in the image.
    pub(crate) fn nearest(&self, position: DVec2) -> usize {
        let (x, y) = (position.x as usize, position.y as usize);
        let (x, y) =
            (x.min(self.mask.width() as usize - 1), y.min(self.mask.height() as usize - 1));
        self.nearest[y * self.mask.width() as usize + x] as usize
    }

    /// Intersection over union with another mask of this size, of what is known.
    pub(crate) fn iou(&self, other: &Mask) -> f64 {
        let (mut both, mut either) = (0_u32, 0_u32);
        let pixels = self.mask.iter().zip(other.iter()).zip(self.known.iter());
        for ((&a, &b), _) in pixels.filter(|(_, known)| Mask::is_hand_level(**known)) {
            let (a, b) = (Mask::is_hand_level(a), Mask::is_hand_level(b));
            both += u32::from(a && b);
            either += u32::from(a || b);
        }
        f64::from(both) / f64::from(either.max(1))
    }
}
