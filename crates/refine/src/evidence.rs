//! What a camera saw.

use glam::{DVec2, DVec3};
use image::GrayImage;
use phalanx_camera::Camera;

use crate::{Error, Result};

/// One camera and the silhouette that it saw.
///
/// The silhouette's border is held as its *cracks*: the middles of the pixel edges between hand and
/// background. A crack lies within half a pixel of the true border, on average on it. The image's
/// own border, where it cuts the forearm, has none.
#[derive(Debug, Clone)]
pub struct Evidence {
    camera: Camera,
    mask: GrayImage,
    /// Unit directions of the cracks in the camera's frame.
    rays: Vec<DVec3>,
    /// Their places, px.
    cracks: Vec<DVec2>,
    /// Which way the background is from each crack: unit vectors of the image.
    normals: Vec<DVec2>,
    /// The nearest crack of every pixel.
    nearest: Vec<u32>,
}

impl Evidence {
    /// A mask of the size of the camera's image, in which hand is over 127.
    ///
    /// # Errors
    /// A mask of another size, or one without a border between hand and background.
    pub fn new(camera: &Camera, mask: &GrayImage) -> Result<Self> {
        Self::within(camera, mask, |_| true)
    }

    /// The same, where only such border counts that lies at pixel positions for which `counts`:
    /// elsewhere nothing is known, such as where a sleeve covers the arm.
    ///
    /// # Errors
    /// As of [`new`](Self::new).
    pub fn within(
        camera: &Camera,
        mask: &GrayImage,
        counts: impl Fn(DVec2) -> bool,
    ) -> Result<Self> {
        camera.validate()?;
        let name = || camera.name.clone();
        let expected = (camera.intrinsics.width, camera.intrinsics.height);
        if mask.dimensions() != expected {
            return Err(Error::MaskSize { camera: name(), found: mask.dimensions(), expected });
        }
        let mut cracks = Vec::new();
        find_cracks(mask, &mut cracks);
        cracks.retain(|&crack| counts(crack));
        if cracks.is_empty() {
            return Err(Error::NoBorder { camera: name() });
        }
        let ray = |&crack: &DVec2| {
            let direction = camera.intrinsics.to_normalised(crack)?;
            Some(direction.extend(1.0).normalize())
        };
        let rays = cracks.iter().map(ray).collect::<Option<_>>();
        Ok(Self {
            camera: camera.clone(),
            mask: mask.clone(),
            rays: rays.ok_or_else(|| Error::NoBorder { camera: name() })?,
            normals: cracks.iter().map(|&crack| outwards(mask, crack)).collect(),
            nearest: nearest_cracks(&cracks, expected),
            cracks,
        })
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The silhouette.
    pub fn mask(&self) -> &GrayImage {
        &self.mask
    }

    /// Unit directions of the cracks, in the camera's frame.
    pub(crate) fn rays(&self) -> &[DVec3] {
        &self.rays
    }

    /// The places of the cracks, px.
    pub(crate) fn cracks(&self) -> &[DVec2] {
        &self.cracks
    }

    /// Which way the background is from each crack.
    pub(crate) fn normals(&self) -> &[DVec2] {
        &self.normals
    }

    /// The crack that is nearest to a pixel position in the image.
    pub(crate) fn nearest(&self, position: DVec2) -> usize {
        let (x, y) = (position.x as usize, position.y as usize);
        let (x, y) =
            (x.min(self.mask.width() as usize - 1), y.min(self.mask.height() as usize - 1));
        self.nearest[y * self.mask.width() as usize + x] as usize
    }

    /// Intersection over union with another mask of this size.
    pub(crate) fn overlap(&self, other: &GrayImage) -> f64 {
        let (mut both, mut either) = (0_u32, 0_u32);
        for (&a, &b) in self.mask.iter().zip(other.iter()) {
            let (a, b) = (a > 127, b > 127);
            both += u32::from(a && b);
            either += u32::from(a || b);
        }
        f64::from(both) / f64::from(either.max(1))
    }
}

/// The middles of the pixel edges between hand and background, px, row by row.
pub(crate) fn find_cracks(mask: &GrayImage, cracks: &mut Vec<DVec2>) {
    cracks.clear();
    let width = mask.width() as usize;
    let rows: &[u8] = mask.as_raw();
    let mut above: &[u8] = &[];
    for (y, row) in rows.chunks_exact(width).enumerate() {
        let y = y as f64;
        for (x, pair) in row.windows(2).enumerate() {
            if (pair[0] > 127) != (pair[1] > 127) {
                cracks.push(DVec2::new(x as f64 + 1.0, y + 0.5));
            }
        }
        for (x, (&a, &b)) in above.iter().zip(row).enumerate() {
            if (a > 127) != (b > 127) {
                cracks.push(DVec2::new(x as f64 + 0.5, y));
            }
        }
        above = row;
    }
}

/// Which way the background is from a crack: from the mean of the hand's pixels around it to the
/// crack.
pub(crate) fn outwards(mask: &GrayImage, crack: DVec2) -> DVec2 {
    const RADIUS: f64 = 2.5;
    let range = |at: f64, size: u32| {
        let first = (at - RADIUS).max(0.0) as u32;
        first..size.min((at + RADIUS).ceil() as u32)
    };
    let mut sum = DVec2::ZERO;
    for y in range(crack.y, mask.height()) {
        for x in range(crack.x, mask.width()) {
            let sign = if mask.get_pixel(x, y).0[0] > 127 { -1.0 } else { 1.0 };
            sum += (DVec2::new(f64::from(x), f64::from(y)) + 0.5 - crack) * sign;
        }
    }
    sum.normalize_or_zero()
}

/// The nearest crack of every pixel, by two sweeps that hand on neighbours' (Danielsson 1980): in
/// rare places the second nearest.
fn nearest_cracks(cracks: &[DVec2], (width, height): (u32, u32)) -> Vec<u32> {
    const NONE: u32 = u32::MAX;
    let (w, h) = (width as usize, height as usize);
    let mut nearest = vec![NONE; w * h];
    let far = |pixel: usize, crack: u32| {
        let centre = DVec2::new((pixel % w) as f64 + 0.5, (pixel / w) as f64 + 0.5);
        cracks.get(crack as usize).map_or(f64::INFINITY, |at| at.distance_squared(centre))
    };
    for (index, crack) in cracks.iter().enumerate() {
        for offset in [DVec2::splat(0.25), DVec2::splat(-0.25)] {
            let at = *crack + offset;
            let pixel = (at.y as usize).min(h - 1) * w + (at.x as usize).min(w - 1);
            if far(pixel, index as u32) < far(pixel, nearest[pixel]) {
                nearest[pixel] = index as u32;
            }
        }
    }
    let mut take = |pixel: usize, from: usize| {
        let candidate = nearest[from];
        if far(pixel, candidate) < far(pixel, nearest[pixel]) {
            nearest[pixel] = candidate;
        }
    };
    for y in 0..h {
        for x in 0..w {
            let pixel = y * w + x;
            if y > 0 {
                let beside = [x.checked_sub(1), Some(x), (x + 1 < w).then_some(x + 1)];
                for from in beside.into_iter().flatten() {
                    take(pixel, pixel - w - x + from);
                }
            }
            if x > 0 {
                take(pixel, pixel - 1);
            }
        }
        (0..w - 1).rev().for_each(|x| take(y * w + x, y * w + x + 1));
    }
    for y in (0..h - 1).rev() {
        for x in (0..w).rev() {
            let pixel = y * w + x;
            let beside = [x.checked_sub(1), Some(x), (x + 1 < w).then_some(x + 1)];
            for from in beside.into_iter().flatten() {
                take(pixel, pixel + w - x + from);
            }
            if x + 1 < w {
                take(pixel, pixel + 1);
            }
        }
        (1..w).for_each(|x| take(y * w + x, y * w + x - 1));
    }
    nearest
}
