//! The log-polar grid: which bin a displacement falls into.
#![allow(clippy::inline_always, reason = "must be compiled with the caller's instruction set")]

use std::f64::consts::TAU;

/// Rings of the grid: the disc inside μ/8, then the octaves up to 2μ.
pub const RINGS: usize = 5;

/// Sectors of the grid, 30° each.
pub const SECTORS: usize = 12;

/// Bins of a shape context. Bin `ring * SECTORS + sector`: the innermost ring first.
pub const BINS: usize = RINGS * SECTORS;

/// Bins with those of a sixth ring, for the pairs that are dropped.
pub(crate) const SLOTS: usize = BINS + SECTORS;

/// Where the first sector begins, measured from the axis: a quarter of a sector.
///
/// At 7.5° + 30°k every edge has an irrational slope (±tan 7.5°, tan 22.5°, ... lie in ℚ(√2, √3)
/// but not in ℚ), so that two pixels are never on an edge when the axis joins grid points too,
/// and the last bit of rounding decides nothing. Edges at 30°k hold the grid's rows and columns,
/// edges at 15° + 30°k its diagonals.
const OFFSET: f64 = SECTOR / 4.0;

const SECTOR: f64 = TAU / SECTORS as f64;

/// cos and sin of [`OFFSET`], 7.5°.
const COS_OFFSET: f64 = 0.991_444_861_373_810_4;
const SIN_OFFSET: f64 = 0.130_526_192_220_051_6;

const TAN_30: f64 = 0.577_350_269_189_625_8;
const TAN_60: f64 = 1.732_050_807_568_877_2;

/// Rings end a hair inside their nominal radius, so that a distance which *is* μ or its double in
/// exact arithmetic (small regular figures) goes outwards whatever the rounding.
const HAIR: f64 = 1e-9;

/// The outer radii of the rings for a mean distance μ, in its unit: μ/8, μ/4, μ/2, μ, 2μ.
///
/// ```
/// assert_eq!(phalanx_shape_context::ring_radii(40.0), [5.0, 10.0, 20.0, 40.0, 80.0]);
/// ```
pub fn ring_radii(mean_distance: f64) -> [f64; RINGS] {
    [0.125, 0.25, 0.5, 1.0, 2.0].map(|octave| octave * mean_distance)
}

/// Where each sector begins, in radians from the axis, turning from +x towards +y: 7.5° + 30°k.
///
/// Sector `k` reaches from edge `k` to edge `k + 1`; the last one ends where the first begins.
///
/// ```
/// let edges = phalanx_shape_context::sector_edges().map(f64::to_degrees);
/// assert!((edges[0] - 7.5).abs() < 1e-9 && (edges[11] - 337.5).abs() < 1e-9);
/// ```
pub fn sector_edges() -> [f64; SECTORS] {
    std::array::from_fn(|k| OFFSET + SECTOR * k as f64)
}

/// The same ring's sector on the other side: the bin of j → i, given that of i → j.
pub(crate) const OPPOSITE: [u8; SLOTS] = {
    let mut opposite = [0; SLOTS];
    let mut bin = 0;
    while bin < SLOTS {
        let (ring, sector) = (bin / SECTORS, bin % SECTORS);
        opposite[bin] = (ring * SECTORS + (sector + SECTORS / 2) % SECTORS) as u8;
        bin += 1;
    }
    opposite
};

/// The grid at one scale and in one direction.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Grid {
    /// cos and sin of the first sector's edge in the image.
    cos: f64,
    sin: f64,
    squared_radii: [f64; RINGS],
}

impl Grid {
    /// The grid of points with this mean distance along this axis (a unit vector).
    #[inline(always)]
    pub(crate) fn new(mean_distance: f64, axis: [f64; 2]) -> Self {
        let squared = mean_distance * mean_distance * (1.0 - HAIR);
        Self {
            cos: axis[0] * COS_OFFSET - axis[1] * SIN_OFFSET,
            sin: axis[1] * COS_OFFSET + axis[0] * SIN_OFFSET,
            squared_radii: [1.0 / 64.0, 1.0 / 16.0, 0.25, 1.0, 4.0].map(|octave| octave * squared),
        }
    }

    /// The slot of a displacement: one of the [`BINS`], or beyond them when the other point is too
    /// far, or in the same place and so in no direction (as a point is from itself).
    ///
    /// Comparisons and selections only, so that loops over it become vector instructions.
    #[inline(always)]
    pub(crate) fn slot(&self, dx: f64, dy: f64) -> u64 {
        let squared = dx * dx + dy * dy;
        let x = self.cos * dx + self.sin * dy;
        let y = self.cos * dy - self.sin * dx;

        let mut ring = 0;
        for radius in self.squared_radii {
            ring += u64::from(squared >= radius);
        }
        ring = if squared == 0.0 { RINGS as u64 } else { ring };

        // The sector within the first quadrant, mirrored into the quadrant at hand.
        let (u, v) = (x.abs(), y.abs());
        let mut sector = 0;
        sector += u64::from(v >= TAN_30 * u);
        sector += u64::from(v >= TAN_60 * u);
        sector = if (x < 0.0) == (y < 0.0) { sector } else { 5 - sector };
        sector += if y < 0.0 { 6 } else { 0 };
        ring * SECTORS as u64 + sector
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn constants_are_those_of_the_angles_they_name() {
        assert!((COS_OFFSET - (PI / 24.0).cos()).abs() < 1e-16);
        assert!((SIN_OFFSET - (PI / 24.0).sin()).abs() < 1e-16);
        assert!((TAN_30 - (PI / 6.0).tan()).abs() < 1e-15);
        assert!((TAN_60 - (PI / 3.0).tan()).abs() < 1e-15);
    }
}
