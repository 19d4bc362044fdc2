//! What a camera saw.

use glam::{DVec2, DVec3};
use image::{GrayImage, Luma};
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
    /// 255 where it is known whether there is hand, 0 elsewhere.
    known: GrayImage,
    /// How far off its place the border is, over what it is where pixels were seen at once.
    grain: f64,
    /// How much a place of the border counts.
    weight: f64,
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

    /// The same, where it is `known` only of some pixels, by their middles, whether they are hand:
    /// not where a sleeve covers the arm, or beyond the border of the picture that a window looks
    /// into.
    ///
    /// # Errors
    /// As of [`new`](Self::new); also a mask whose border lies nowhere that is known.
    pub fn within(
        camera: &Camera,
        mask: &GrayImage,
        known: impl Fn(DVec2) -> bool,
    ) -> Result<Self> {
        camera.validate()?;
        let name = || camera.name.clone();
        let expected = (camera.intrinsics.width, camera.intrinsics.height);
        if mask.dimensions() != expected {
            return Err(Error::MaskSize { camera: name(), found: mask.dimensions(), expected });
        }
        let known = GrayImage::from_fn(mask.width(), mask.height(), |x, y| {
            let middle = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
            Luma([if known(middle) { 255 } else { 0 }])
        });
        let mut cracks = Vec::new();
        find_cracks(mask, &mut cracks);
        cracks.retain(|&crack| is_known(&known, crack));
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
            known,
            grain: 1.0,
            weight: 1.0,
            rays: rays.ok_or_else(|| Error::NoBorder { camera: name() })?,
            normals: cracks.iter().map(|&crack| outwards(mask, crack)).collect(),
            nearest: nearest_cracks(&cracks, expected),
            cracks,
        })
    }

    /// The same, of a mask that was resampled from another, whose pixels are `pixel` of this mask's
    /// wide: both put the border off its place, the other's half as far, as it is smoothed.
    #[must_use]
    pub fn resampled(self, pixel: f64) -> Self {
        Self { grain: 1.0_f64.hypot(0.5 * pixel), ..self }
    }

    /// The same, where each place of the border counts `weight` times as much as one that is known to
    /// [`Refinement::noise`](crate::Refinement::noise) independently of its neighbours: places that
    /// err together, or further, count less.
    #[must_use]
    pub fn weighted(self, weight: f64) -> Self {
        Self { weight, ..self }
    }

    /// How much a place of the border counts.
    pub(crate) fn weight(&self) -> f64 {
        self.weight
    }

    /// Standard deviation of the border's place over that of a mask whose pixels were seen at once.
    pub(crate) fn grain(&self) -> f64 {
        self.grain
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The silhouette.
    pub fn mask(&self) -> &GrayImage {
        &self.mask
    }

    /// 255 where it is known whether there is hand, 0 elsewhere.
    pub(crate) fn known(&self) -> &GrayImage {
        &self.known
    }

    /// Whether the pixels on both sides of a drawn crack are known.
    pub(crate) fn is_known(&self, crack: DVec2) -> bool {
        is_known(&self.known, crack)
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

    /// Intersection over union with another mask of this size, of what is known.
    pub(crate) fn overlap(&self, other: &GrayImage) -> f64 {
        let (mut both, mut either) = (0_u32, 0_u32);
        let pixels = self.mask.iter().zip(other.iter()).zip(self.known.iter());
        for ((&a, &b), _) in pixels.filter(|(_, known)| **known > 127) {
            let (a, b) = (a > 127, b > 127);
            both += u32::from(a && b);
            either += u32::from(a || b);
        }
        f64::from(both) / f64::from(either.max(1))
    }
}

/// The pixels on both sides of a crack.
fn beside(crack: DVec2) -> [[u32; 2]; 2] {
    [-0.25, 0.25].map(|offset| [(crack.x + offset) as u32, (crack.y + offset) as u32])
}

fn is_known(known: &GrayImage, crack: DVec2) -> bool {
    beside(crack).iter().all(|&[x, y]| known.get_pixel(x, y).0[0] > 127)
}

/// The middles of the pixel edges between hand and background, px, row by row.
pub(crate) fn find_cracks(mask: &GrayImage, cracks: &mut Vec<DVec2>) {
    cracks.clear();
    let rows: &[u8] = mask.as_raw();
    let mut above: &[u8] = &[];
    for (y, row) in rows.chunks_exact(mask.width() as usize).enumerate() {
        let y = y as f64;
        let (to_the_left, own) = (&row[..row.len() - 1], &row[1..]);
        changes(to_the_left, own, |x| cracks.push(DVec2::new(x as f64 + 1.0, y + 0.5)));
        changes(above, row, |x| cracks.push(DVec2::new(x as f64 + 0.5, y)));
        above = row;
    }
}

/// Calls for every place at which one row of pixels is hand and the other is not.
fn changes(one: &[u8], other: &[u8], mut at: impl FnMut(usize)) {
    // Nearly all of a picture is alike: pieces that are need not be looked at pixel by pixel.
    const PIECE: usize = 16;
    for (k, (one, other)) in one.chunks(PIECE).zip(other.chunks(PIECE)).enumerate() {
        if one != other {
            let pairs = one.iter().zip(other).enumerate();
            pairs
                .filter(|(_, (a, b))| (**a > 127) != (**b > 127))
                .for_each(|(x, _)| at(PIECE * k + x));
        }
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
    let (w, h) = (width as usize, height as usize);
    let mut nearest = Nearest {
        cracks,
        of_pixels: vec![u32::MAX; w * h],
        squared: vec![f64::INFINITY; w * h],
        width: w,
    };
    for (index, crack) in cracks.iter().enumerate() {
        for [x, y] in beside(*crack) {
            nearest.offer(x as usize, y as usize, index as u32);
        }
    }
    for y in 0..h {
        for x in 0..w {
            if y > 0 {
                nearest.take_row(x, y, y - 1);
            }
            if x > 0 {
                nearest.take(x, y, x - 1, y);
            }
        }
        (0..w - 1).rev().for_each(|x| nearest.take(x, y, x + 1, y));
    }
    for y in (0..h - 1).rev() {
        for x in (0..w).rev() {
            nearest.take_row(x, y, y + 1);
            if x + 1 < w {
                nearest.take(x, y, x + 1, y);
            }
        }
        (1..w).for_each(|x| nearest.take(x, y, x - 1, y));
    }
    nearest.of_pixels
}

/// The nearest crack of every pixel so far.
struct Nearest<'a> {
    cracks: &'a [DVec2],
    of_pixels: Vec<u32>,
    /// How far it is from the pixel's middle, squared.
    squared: Vec<f64>,
    width: usize,
}

impl Nearest<'_> {
    /// A crack that may be nearer to a pixel.
    fn offer(&mut self, x: usize, y: usize, crack: u32) {
        let Some(at) = self.cracks.get(crack as usize) else { return };
        let pixel = y * self.width + x;
        let squared = at.distance_squared(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
        if squared < self.squared[pixel] {
            (self.of_pixels[pixel], self.squared[pixel]) = (crack, squared);
        }
    }

    /// That of another pixel.
    fn take(&mut self, x: usize, y: usize, from_x: usize, from_y: usize) {
        let crack = self.of_pixels[from_y * self.width + from_x];
        if crack != self.of_pixels[y * self.width + x] {
            self.offer(x, y, crack);
        }
    }

    /// Those of the three nearest pixels of another row.
    fn take_row(&mut self, x: usize, y: usize, from_y: usize) {
        for from_x in x.saturating_sub(1)..self.width.min(x + 2) {
            self.take(x, y, from_x, from_y);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Masks of few and of many changes.
    fn masks() -> impl Strategy<Value = GrayImage> {
        (1_u32..50, 1_u32..20, 0.0..1.0_f64).prop_flat_map(|(width, height, share)| {
            let pixel = prop::bool::weighted(share).prop_map(|hand| if hand { 200 } else { 100 });
            prop::collection::vec(pixel, (width * height) as usize)
                .prop_map(move |pixels| GrayImage::from_raw(width, height, pixels).unwrap())
        })
    }

    /// By looking at every pair of pixels.
    fn slow_cracks(mask: &GrayImage) -> Vec<DVec2> {
        let is_hand = |x: u32, y: u32| mask.get_pixel(x, y).0[0] > 127;
        let mut cracks = Vec::new();
        for y in 0..mask.height() {
            let across = (1..mask.width()).filter(|&x| is_hand(x - 1, y) != is_hand(x, y));
            cracks.extend(across.map(|x| DVec2::new(f64::from(x), f64::from(y) + 0.5)));
            let down = (0..mask.width()).filter(|&x| y > 0 && is_hand(x, y - 1) != is_hand(x, y));
            cracks.extend(down.map(|x| DVec2::new(f64::from(x) + 0.5, f64::from(y))));
        }
        cracks
    }

    proptest! {
        #![proptest_config(crate::property::cases(256))]

        #[test]
        fn cracks_are_where_neighbours_differ(mask in masks()) {
            let mut cracks = Vec::new();
            find_cracks(&mask, &mut cracks);
            prop_assert_eq!(cracks, slow_cracks(&mask));
        }

        /// The sweeps may miss the nearest by a little.
        #[test]
        fn the_nearest_crack_is_nearest(mask in masks()) {
            let cracks = slow_cracks(&mask);
            prop_assume!(!cracks.is_empty());
            let nearest = nearest_cracks(&cracks, mask.dimensions());
            for (x, y, _) in mask.enumerate_pixels() {
                let middle = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
                let found = cracks[nearest[(y * mask.width() + x) as usize] as usize];
                let least = cracks.iter().map(|crack| crack.distance(middle)).fold(f64::MAX, f64::min);
                prop_assert!(found.distance(middle) <= least + 0.5, "{found} from {middle}");
            }
        }
    }
}
