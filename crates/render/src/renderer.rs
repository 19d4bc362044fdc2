//! The renderer: one camera and its buffers.

use glam::{DAffine3, DVec2, DVec3};
use image::{GrayImage, RgbImage};
use phalanx_camera::{Camera, Intrinsics, Lens};
use phalanx_hand::Primitive;

use crate::appearance::Appearance;
use crate::appearance::Sensor;
use crate::error::{Error, Result};
use crate::fill::Filler;
use crate::solid::Scene;
use crate::supersampling::Supersampling;
use crate::surface::Hit;
use crate::{clip, outline};

/// Depth along the camera's axis, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthMap {
    /// Width, px.
    pub width: u32,
    /// Height, px.
    pub height: u32,
    /// z in the camera's frame at each pixel's centre, mm, at least 1; infinity where there is
    /// nothing.
    pub depths: Vec<f32>,
}

/// Renders solids, given in the world's millimetres, through one camera.
///
/// It keeps its buffers from picture to picture; build one per camera and thread. Of a solid that
/// crosses the camera's plane the picture shows what is in front; one that holds the camera's
/// centre covers all of it.
#[derive(Debug, Clone)]
pub struct Renderer {
    intrinsics: Intrinsics,
    to_camera: DAffine3,
    /// Radius of a disc of the normalised plane that holds the picture, short of the fold.
    reach: f64,
    /// How far the polygons of outlines may stay inside them, px.
    deviation: f64,
    /// Corners of all outlines, px, and where each ends.
    corners: Vec<DVec2>,
    ends: Vec<usize>,
    /// One outline in the normalised plane.
    ideal: Vec<DVec2>,
    scene: Scene,
    filler: Filler,
    /// One sample of each pixel, and how many samples were covered.
    mask: Vec<u8>,
    counts: Vec<u16>,
}

impl Renderer {
    /// Radius, in the normalised plane, of the sharpest curve that a lens is taken to make of a
    /// straight line. It only decides how finely outlines are drawn.
    const SHARPEST: f64 = 2.0;

    /// How far outlines are off, px, unless it is said otherwise.
    const DEVIATION: f64 = 0.005;

    /// Places on each side of the picture at which the lens is asked how far it reaches, less one.
    const BORDER: u32 = 32;

    /// A renderer for this camera, which must be valid.
    pub fn new(camera: &Camera) -> Result<Self> {
        camera.validate()?;
        let intrinsics = camera.intrinsics;
        let (w, h) = (f64::from(intrinsics.width), f64::from(intrinsics.height));
        // All of the border, for a lens may not reach the corners.
        let shares = (0..=Self::BORDER).map(|k| f64::from(k) / f64::from(Self::BORDER));
        let border = shares
            .flat_map(|s| [(s * w, 0.0), (s * w, h), (0.0, s * h), (w, s * h)].map(DVec2::from));
        let radii: Option<Vec<f64>> =
            border.map(|p| intrinsics.to_normalised(p).map(DVec2::length)).collect();
        let farthest = match radii {
            Some(radii) => radii.into_iter().fold(0.0, f64::max),
            // The lens folds over within the picture.
            None => intrinsics.lens.short_of_fold(DVec2::X * Lens::FARTHEST).length(),
        };
        // A little more, where the lens allows it, so that what is cut there stays out of sight.
        let reach = (0..=10)
            .map(|percent| farthest * (1.1 - 0.01 * f64::from(percent)))
            .find(|&radius| intrinsics.lens.is_one_to_one_at(DVec2::X * radius));
        Ok(Self {
            intrinsics,
            to_camera: DAffine3::from_mat3_translation(
                camera.extrinsics.rotation,
                camera.extrinsics.translation,
            ),
            reach: reach.unwrap_or(farthest),
            deviation: Self::DEVIATION,
            corners: Vec::new(),
            ends: Vec::new(),
            ideal: Vec::new(),
            scene: Scene::default(),
            filler: Filler::new(intrinsics.width, intrinsics.height),
            mask: Vec::new(),
            counts: Vec::new(),
        })
    }

    /// The same with outlines that may be so far off, px, in place of 0.005: coarser ones are drawn
    /// faster.
    ///
    /// # Errors
    /// A deviation that is not between 0.001 and 1.
    pub fn with_deviation(self, deviation: f64) -> Result<Self> {
        if !(0.001..=1.0).contains(&deviation) {
            return Err(Error::Deviation { found: deviation });
        }
        Ok(Self { deviation, ..self })
    }

    /// Width and height of the pictures, px.
    pub fn size(&self) -> (u32, u32) {
        (self.intrinsics.width, self.intrinsics.height)
    }

    /// The solids' silhouette: 255 where a pixel's centre is covered, else 0. Outlines are
    /// accurate to 0.01 px, unless they may be
    /// [further off](Self::with_deviation).
    ///
    /// ```
    /// use glam::DVec3;
    /// use phalanx_camera::{Camera, Intrinsics};
    /// use phalanx_hand::{Sphere, Primitive};
    /// use phalanx_render::Renderer;
    ///
    /// let intrinsics = Intrinsics::pinhole(120, 90, 265.0);
    /// let camera = Camera::look_at("top", intrinsics, 700.0 * DVec3::Y, DVec3::ZERO, DVec3::X)?;
    /// let sphere = [Primitive::Sphere(Sphere::new(DVec3::ZERO, 20.0))];
    /// let mut renderer = Renderer::new(&camera)?;
    ///
    /// let silhouette = renderer.silhouette(&sphere)?;
    /// assert_eq!((silhouette[(60, 45)].0, silhouette[(70, 45)].0), ([255], [0]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn silhouette(&mut self, primitives: &[Primitive]) -> Result<GrayImage> {
        let mut image = GrayImage::default();
        self.silhouette_into(primitives, &mut image)?;
        Ok(image)
    }

    /// [`silhouette`](Self::silhouette) into an image, which is replaced if its size is not
    /// the camera's.
    pub fn silhouette_into(
        &mut self,
        primitives: &[Primitive],
        image: &mut GrayImage,
    ) -> Result<()> {
        self.trace(primitives)?;
        self.fit(image);
        self.fill(DVec2::splat(0.5), image);
        Ok(())
    }

    /// How much of each pixel the solids cover, 0 to 255, by its samples.
    ///
    /// ```
    /// use glam::DVec3;
    /// use phalanx_camera::{Camera, Intrinsics};
    /// use phalanx_hand::{Sphere, Primitive};
    /// use phalanx_render::{Renderer, Supersampling};
    ///
    /// let intrinsics = Intrinsics::pinhole(120, 90, 265.0);
    /// let camera = Camera::look_at("top", intrinsics, 700.0 * DVec3::Y, DVec3::ZERO, DVec3::X)?;
    /// let sphere = [Primitive::Sphere(Sphere::new(DVec3::ZERO, 20.0))];
    /// let mut renderer = Renderer::new(&camera)?;
    ///
    /// let coverage = renderer.coverage(&sphere, Supersampling::X8)?;
    /// let area = coverage.iter().map(|&grey| f64::from(grey) / 255.0).sum::<f64>();
    /// let radius = 265.0 * 20.0 / f64::sqrt(700.0 * 700.0 - 20.0 * 20.0);
    /// assert!((area / (std::f64::consts::PI * radius * radius) - 1.0).abs() < 0.01);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn coverage(
        &mut self,
        primitives: &[Primitive],
        sampling: Supersampling,
    ) -> Result<GrayImage> {
        let mut image = GrayImage::default();
        self.coverage_into(primitives, sampling, &mut image)?;
        Ok(image)
    }

    /// [`coverage`](Self::coverage) into an image, which is replaced if its size is not the
    /// camera's.
    pub fn coverage_into(
        &mut self,
        primitives: &[Primitive],
        sampling: Supersampling,
        image: &mut GrayImage,
    ) -> Result<()> {
        self.trace(primitives)?;
        self.fit(image);
        let mut mask = std::mem::take(&mut self.mask);
        mask.resize(image.len(), 0);
        self.counts.clear();
        self.counts.resize(image.len(), 0);
        for offset in sampling.offsets() {
            mask.fill(0);
            self.fill(offset, &mut mask);
            for (count, &covered) in self.counts.iter_mut().zip(&mask) {
                *count += u16::from(covered & 1);
            }
        }
        self.mask = mask;
        let all = sampling.per_pixel();
        for (grey, &count) in image.iter_mut().zip(&self.counts) {
            *grey = ((u32::from(count) * 510 + all) / (2 * all)) as u8;
        }
        Ok(())
    }

    /// The depth of what each pixel's centre sees, by casting rays.
    ///
    /// ```
    /// use glam::DVec3;
    /// use phalanx_camera::{Camera, Intrinsics};
    /// use phalanx_hand::{Sphere, Primitive};
    /// use phalanx_render::Renderer;
    ///
    /// let intrinsics = Intrinsics::pinhole(120, 90, 265.0);
    /// let camera = Camera::look_at("top", intrinsics, 700.0 * DVec3::Y, DVec3::ZERO, DVec3::X)?;
    /// let sphere = [Primitive::Sphere(Sphere::new(DVec3::ZERO, 20.0))];
    /// let mut renderer = Renderer::new(&camera)?;
    ///
    /// let depth = renderer.depth(&sphere)?;
    /// assert!((depth.depths[45 * 120 + 60] - 680.0).abs() < 0.1);
    /// assert_eq!(depth.depths[0], f32::INFINITY);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn depth(&mut self, primitives: &[Primitive]) -> Result<DepthMap> {
        self.build(primitives)?;
        let (width, height) = self.size();
        let centres = (0..height).flat_map(|y| (0..width).map(move |x| centre(x, y)));
        let depths = centres.map(|pixel| match self.look(pixel) {
            Some((_, hit)) => hit.distance as f32,
            None => f32::INFINITY,
        });
        Ok(DepthMap { width, height, depths: depths.collect() })
    }

    /// A shaded colour picture with sensor noise, by casting rays; the same seed gives the
    /// same picture.
    ///
    /// ```
    /// use glam::DVec3;
    /// use phalanx_camera::{Camera, Intrinsics};
    /// use phalanx_hand::{Sphere, Primitive};
    /// use phalanx_render::{Appearance, Renderer};
    ///
    /// let intrinsics = Intrinsics::pinhole(120, 90, 265.0);
    /// let camera = Camera::look_at("top", intrinsics, 700.0 * DVec3::Y, DVec3::ZERO, DVec3::X)?;
    /// let sphere = [Primitive::Sphere(Sphere::new(DVec3::ZERO, 20.0))];
    /// let mut renderer = Renderer::new(&camera)?;
    ///
    /// let appearance = Appearance::default();
    /// let picture = renderer.shade(&sphere, &appearance, 1)?;
    /// assert_eq!(renderer.shade(&sphere, &appearance, 1)?, picture);
    /// assert_ne!(renderer.shade(&sphere, &appearance, 2)?, picture); // other noise
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn shade(
        &mut self,
        primitives: &[Primitive],
        appearance: &Appearance,
        seed: u64,
    ) -> Result<RgbImage> {
        appearance.validate(self.size())?;
        self.build(primitives)?;
        let light = self.to_camera.transform_vector3(appearance.light).normalize();
        let mut sensor = Sensor::new(appearance.noise_sigma, seed);
        let (width, height) = self.size();
        Ok(RgbImage::from_fn(width, height, |x, y| {
            let behind = appearance.background.colour(x, y, height);
            let corner = DVec2::new(f64::from(x), f64::from(y));
            let samples = appearance.sampling.offsets().map(|offset| {
                self.look(corner + offset).map_or(behind, |(direction, hit)| {
                    let view = -direction.normalize();
                    appearance.skin_colour(hit.normal.normalize_or_zero(), light, view)
                })
            });
            let sum: DVec3 = samples.sum();
            sensor.record(sum / f64::from(appearance.sampling.per_pixel()))
        }))
    }

    /// What a pixel position sees: the ray, with z = 1, so that distance is depth, and the hit.
    fn look(&self, pixel: DVec2) -> Option<(DVec3, Hit)> {
        if !self.scene.may_show_at(pixel) {
            return None;
        }
        let direction = self.intrinsics.to_normalised(pixel)?.extend(1.0);
        Some((direction, self.scene.nearest(pixel, direction)?))
    }

    /// Traces the outlines and builds the scene.
    fn build(&mut self, primitives: &[Primitive]) -> Result<()> {
        self.trace(primitives)?;
        self.scene.clear();
        let mut start = 0;
        for (primitive, &end) in primitives.iter().zip(&self.ends) {
            self.scene.push(&primitive.moved(&self.to_camera), &self.corners[start..end]);
            start = end;
        }
        Ok(())
    }

    /// Checks the solids and traces their outlines in pixels.
    fn trace(&mut self, primitives: &[Primitive]) -> Result<()> {
        self.corners.clear();
        self.ends.clear();
        let focal = self.intrinsics.fx.max(self.intrinsics.fy);
        for (index, primitive) in primitives.iter().enumerate() {
            check(primitive).map_err(|field| Error::Primitive { index, field })?;
            self.ideal.clear();
            let solid = primitive.moved(&self.to_camera);
            let deviation = self.deviation / focal;
            if outline::trace(&solid, clip::NEAR, deviation, &mut self.ideal).is_none() {
                clip::trace(&solid, self.reach, deviation, &mut self.ideal);
            }
            self.push_outline(focal);
            self.ends.push(self.corners.len());
        }
        Ok(())
    }

    /// Appends the outline held in `ideal` in pixels, bent by the lens.
    fn push_outline(&mut self, focal: f64) {
        if self.intrinsics.lens.is_perfect() {
            let corners = self.ideal.iter().filter(|corner| corner.is_finite());
            self.corners.extend(corners.map(|&corner| self.intrinsics.scaled(corner)));
            return;
        }
        let Some(last) = self.ideal.last() else { return };
        // A chord of length c strays c²/8R from its arc.
        let longest = (8.0 * Self::SHARPEST * self.deviation / focal).sqrt();
        // The lens may fold over beyond the picture. Pulling what is outside a disc onto its
        // rim leaves the inside of the outline as it is within the disc.
        let pull = |p: DVec2| p.clamp_length_max(self.reach);
        let mut from = *last;
        for &to in &self.ideal {
            let pieces = (from.distance(to) / longest).ceil().clamp(1.0, 4096.0);
            let points = (1..=pieces as u32).map(|i| from.lerp(to, f64::from(i) / pieces));
            self.corners.extend(points.filter_map(|p| self.intrinsics.to_pixel(pull(p))));
            from = to;
        }
    }

    /// Fills all outlines.
    fn fill(&mut self, sample: DVec2, mask: &mut [u8]) {
        let mut start = 0;
        for &end in &self.ends {
            self.filler.fill(&self.corners[start..end], sample, mask);
            start = end;
        }
    }

    /// Gives the image the camera's size and clears it.
    fn fit(&self, image: &mut GrayImage) {
        let (width, height) = self.size();
        if image.dimensions() == (width, height) {
            image.fill(0);
        } else {
            *image = GrayImage::new(width, height);
        }
    }
}

fn centre(x: u32, y: u32) -> DVec2 {
    DVec2::new(f64::from(x), f64::from(y)) + 0.5
}

/// The field of a solid that is out of its range.
fn check(primitive: &Primitive) -> std::result::Result<(), &'static str> {
    /// Lengths, mm, whose fourth powers are far from overflowing.
    const FARTHEST: f64 = 1e9;
    for sphere in primitive.spheres() {
        if !sphere.center.abs().cmple(DVec3::splat(FARTHEST)).all() {
            return Err("center");
        }
        if !(sphere.radius > 0.0 && sphere.radius <= FARTHEST) {
            return Err("radius");
        }
    }
    match primitive {
        Primitive::GeneralisedCylinder { thin_axis, .. } if !thin_axis.is_normalized() => {
            Err("thin_axis")
        }
        Primitive::GeneralisedCylinder { flatness, .. } if !(1e-3..=1.0).contains(flatness) => {
            Err("flatness")
        }
        _ => Ok(()),
    }
}
