//! What happens inside a camera: from directions to pixels and back.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::lens::Lens;

/// A camera's inside, in pixels, with pixel centres at integer + 0.5: the image spans
/// 0 to `width` and 0 to `height`, x to the right and y down.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Intrinsics {
    /// Image width, px.
    pub width: u32,
    /// Image height, px.
    pub height: u32,
    /// Focal length along x, px.
    pub fx: f64,
    /// Focal length along y, px.
    pub fy: f64,
    /// Principal point's x, px.
    pub cx: f64,
    /// Principal point's y, px.
    pub cy: f64,
    /// The lens.
    pub lens: Lens,
}

impl Intrinsics {
    /// The longest image side that is believed, px.
    pub const MAX_SIDE: u32 = 16_384;

    /// The longest focal length that is believed, px.
    pub const MAX_FOCAL: f64 = 1e6;

    /// A perfect lens with square pixels and its principal point in the middle of the image.
    pub fn pinhole(width: u32, height: u32, focal: f64) -> Self {
        Self {
            width,
            height,
            fx: focal,
            fy: focal,
            cx: f64::from(width) / 2.0,
            cy: f64::from(height) / 2.0,
            lens: Lens::PERFECT,
        }
    }

    /// The pixel of a direction (x/z, y/z) in the camera's frame; `None` where the lens has
    /// folded over. It may lie outside the image.
    ///
    /// ```
    /// use glam::DVec2;
    /// use phalanx_camera::Intrinsics;
    ///
    /// let intrinsics = Intrinsics::pinhole(120, 90, 265.0);
    /// let pixel = intrinsics.to_pixel(DVec2::new(0.1, 0.0)).expect("a perfect lens maps all");
    /// assert!((pixel - DVec2::new(86.5, 45.0)).length() < 1e-9);
    /// ```
    pub fn to_pixel(&self, normalised: DVec2) -> Option<DVec2> {
        if self.lens.is_perfect() {
            return normalised.is_finite().then(|| self.scaled(normalised));
        }
        (normalised.is_finite() && self.lens.is_one_to_one_at(normalised))
            .then(|| self.scaled(self.lens.distort(normalised)))
    }

    /// The direction (x/z, y/z) in the camera's frame that a pixel looks in; `None` where the
    /// lens maps none to it.
    pub fn to_normalised(&self, pixel: DVec2) -> Option<DVec2> {
        self.lens.undistort(self.unscaled(pixel))
    }

    /// From a pixel of [`undistorted`](Self::undistorted) to this camera's pixel.
    pub fn distort(&self, pixel: DVec2) -> Option<DVec2> {
        self.to_pixel(self.unscaled(pixel))
    }

    /// From this camera's pixel to that of [`undistorted`](Self::undistorted).
    ///
    /// ```
    /// use glam::DVec2;
    /// use phalanx_camera::{Distortion, Intrinsics};
    ///
    /// let lens = Distortion { k1: -0.3, ..Distortion::NONE }.into();
    /// let camera = Intrinsics { lens, ..Intrinsics::pinhole(120, 90, 265.0) };
    /// let corner = DVec2::new(119.5, 0.5);
    /// let straight = camera.undistort(corner).expect("short of the fold");
    /// assert!(straight.x > corner.x && straight.y < corner.y); // it was pulled in
    /// assert!((camera.distort(straight).expect("the way back") - corner).length() < 1e-8);
    /// ```
    pub fn undistort(&self, pixel: DVec2) -> Option<DVec2> {
        Some(self.scaled(self.to_normalised(pixel)?))
    }

    /// The same camera with a perfect lens.
    #[must_use]
    pub fn undistorted(&self) -> Self {
        Self { lens: Lens::PERFECT, ..*self }
    }

    /// The camera of a window of the image: `width`×`height` pixels from column `x`, row `y`.
    ///
    /// ```
    /// use phalanx_camera::Intrinsics;
    ///
    /// let whole = Intrinsics::pinhole(640, 480, 600.0);
    /// let window = whole.cropped(100, 50, 320, 240)?;
    /// assert_eq!((window.cx, window.cy, window.fx), (220.0, 190.0, 600.0));
    /// assert!(whole.cropped(400, 0, 320, 240).is_err()); // it would reach beyond the picture
    /// # Ok::<(), phalanx_camera::Error>(())
    /// ```
    pub fn cropped(&self, x: u32, y: u32, width: u32, height: u32) -> Result<Self> {
        let fits = |start: u32, length: u32, whole: u32| {
            length > 0 && start.checked_add(length).is_some_and(|end| end <= whole)
        };
        if !fits(x, width, self.width) || !fits(y, height, self.height) {
            let image = [self.width, self.height];
            return Err(Error::Window { x, y, width, height, image });
        }
        let (cx, cy) = (self.cx - f64::from(x), self.cy - f64::from(y));
        Ok(Self { width, height, cx, cy, ..*self })
    }

    /// The camera of the image scaled to `width`×`height` pixels.
    ///
    /// ```
    /// use phalanx_camera::Intrinsics;
    ///
    /// let small = Intrinsics::pinhole(640, 480, 600.0).resized(160, 120);
    /// assert_eq!((small.cx, small.cy, small.fx), (80.0, 60.0, 150.0));
    /// ```
    #[must_use]
    pub fn resized(&self, width: u32, height: u32) -> Self {
        let sx = f64::from(width) / f64::from(self.width);
        let sy = f64::from(height) / f64::from(self.height);
        Self {
            width,
            height,
            fx: self.fx * sx,
            fy: self.fy * sy,
            cx: self.cx * sx,
            cy: self.cy * sy,
            ..*self
        }
    }

    /// The principal point, px. It may lie outside a cropped image.
    pub fn principal_point(&self) -> DVec2 {
        DVec2::new(self.cx, self.cy)
    }

    /// Whether a pixel position lies within the image.
    pub fn contains(&self, pixel: DVec2) -> bool {
        (0.0..=f64::from(self.width)).contains(&pixel.x)
            && (0.0..=f64::from(self.height)).contains(&pixel.y)
    }

    /// Where the lens folds over in the direction of a point of the normalised plane that lies beyond
    /// the fold, if that is within the image.
    pub(crate) fn fold_before(&self, normalised: DVec2) -> Option<DVec2> {
        if self.lens.is_one_to_one_at(normalised) {
            return None;
        }
        let fold = self.scaled(self.lens.distort(self.lens.short_of_fold(normalised)));
        self.contains(fold).then_some(fold)
    }

    /// Checks every field on behalf of the camera of this name.
    pub(crate) fn validate(&self, camera: &str) -> Result<()> {
        let camera = || camera.to_owned();
        let Self { width, height, fx, fy, .. } = *self;
        if !self.lens.is_valid() {
            return Err(Error::NotFinite { camera: camera(), field: "distortion" });
        }
        if ![width, height].iter().all(|side| (1..=Self::MAX_SIDE).contains(side)) {
            return Err(Error::ImageSize { camera: camera(), width, height });
        }
        if ![fx, fy].iter().all(|&f| f > 0.0 && f <= Self::MAX_FOCAL) {
            return Err(Error::FocalLength { camera: camera(), fx, fy });
        }
        if ![self.cx, self.cy].iter().all(|c| c.abs() <= Self::MAX_FOCAL) {
            return Err(Error::NotFinite { camera: camera(), field: "principal_point_px" });
        }
        Ok(())
    }

    /// From the normalised plane to pixels, leaving out the lens.
    pub fn scaled(&self, normalised: DVec2) -> DVec2 {
        normalised * DVec2::new(self.fx, self.fy) + self.principal_point()
    }

    /// From pixels to the normalised plane, leaving out the lens.
    fn unscaled(&self, pixel: DVec2) -> DVec2 {
        (pixel - self.principal_point()) / DVec2::new(self.fx, self.fy)
    }
}
