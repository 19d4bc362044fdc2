//! Which primitives a ray may pass near, told by discs that hold their outlines: many at once.

use glam::DVec2;

use crate::geometry::sphere_hull::Bound;

/// Discs that are looked at together.
const BLOCK: usize = 8;

/// By this share discs are taken to be larger, which covers what single precision loses.
const LARGER: f64 = 1e-4;

/// The discs of some primitives, in the plane z = 1.
#[derive(Debug, Clone, Default)]
pub(crate) struct Discs {
    blocks: Vec<Block>,
    count: usize,
}

#[derive(Debug, Clone, Copy, Default)]
struct Block {
    x: [f32; BLOCK],
    y: [f32; BLOCK],
    radius: [f32; BLOCK],
    /// By how much the radius grows for each millimetre that rays may pass beside the primitive.
    per_mm: [f32; BLOCK],
}

impl Discs {
    /// The discs of other primitives, in place of these.
    pub(crate) fn replace<'a>(&mut self, bounds: impl Iterator<Item = &'a Bound>) {
        self.blocks.clear();
        self.count = 0;
        for bound in bounds {
            let lane = self.count % BLOCK;
            if lane == 0 {
                self.blocks.push(Block::default());
            }
            let block = self.blocks.last_mut().expect("just pushed");
            let (middle, radius, per_mm) = bound.disc();
            (block.x[lane], block.y[lane]) = (middle.x as f32, middle.y as f32);
            block.radius[lane] = (radius * (1.0 + LARGER)) as f32;
            block.per_mm[lane] = (per_mm * (1.0 + LARGER)) as f32;
            self.count += 1;
        }
    }

    /// The primitives that the ray through a place of the plane z = 1 may pass nearer than a distance, mm, in order: all
    /// that it does, and few others.
    #[inline]
    pub(crate) fn near(&self, place: DVec2, distance: f64) -> impl Iterator<Item = usize> + '_ {
        let (x, y, distance) = (place.x as f32, place.y as f32, distance.max(0.0) as f32);
        self.blocks.iter().enumerate().flat_map(move |(k, block)| {
            let first = BLOCK * k;
            let lanes = (self.count - first).min(BLOCK);
            let near = block.near(x, y, distance) & (u8::MAX >> (BLOCK - lanes));
            Bits(near).map(move |lane| first + lane)
        })
    }
}

impl Block {
    /// A bit for each disc that is not surely beyond a place.
    #[inline]
    fn near(&self, x: f32, y: f32, distance: f32) -> u8 {
        let is_near = |k: usize| {
            let (dx, dy) = (self.x[k] - x, self.y[k] - y);
            let radius = self.radius[k] + distance * self.per_mm[k];
            let is_beyond = dx * dx + dy * dy >= radius * radius;
            // What is not a number is nowhere, and may be near.
            !is_beyond
        };
        (0..BLOCK).fold(0, |near, k| near | u8::from(is_near(k)) << k)
    }
}

/// The bits that are set, from the lowest.
struct Bits(u8);

impl Iterator for Bits {
    type Item = usize;

    #[inline]
    fn next(&mut self) -> Option<usize> {
        if self.0 == 0 {
            return None;
        }
        let lowest = self.0.trailing_zeros() as usize;
        self.0 &= self.0 - 1;
        Some(lowest)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use phalanx_hand::{Primitive, Sphere};
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::sphere_hull::SphereHull;

    fn sphere() -> impl Strategy<Value = Sphere> {
        let at = prop::array::uniform3(-60.0..60.0_f64);
        (at, 2.0..20.0_f64, -50.0..900.0_f64).prop_map(|(at, radius, depth)| {
            Sphere::new(DVec3::from_array(at) + DVec3::Z * depth, radius)
        })
    }

    proptest! {
        #![proptest_config(crate::property::cases(128))]

        #[test]
        fn none_that_is_near_is_missed(
            cones in prop::collection::vec(prop::array::uniform2(sphere()), 1..20),
            at in prop::array::uniform2(-0.3..0.3_f64),
            distance in -5.0..40.0_f64,
        ) {
            let place = DVec2::from_array(at);
            let hulls = cones.iter().map(|ends| SphereHull::new(&Primitive::RoundCone(*ends)));
            let bounds: Vec<_> = hulls.map(|hull| hull.bound()).collect();
            let mut discs = Discs::default();
            discs.replace(bounds.iter());
            let near: Vec<usize> = discs.near(place, distance).collect();
            prop_assert!(near.is_sorted());
            for (k, bound) in bounds.iter().enumerate() {
                prop_assert!(near.contains(&k) || bound.is_beyond(place, distance), "{k}");
            }
        }
    }
}
