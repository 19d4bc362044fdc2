//! Several samples in each pixel.

use glam::DVec2;

/// How finely each pixel is sampled: on a regular grid of this many points a side.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Supersampling {
    /// The pixel's centre only.
    #[default]
    X1,
    /// 2 × 2 points.
    X2,
    /// 4 × 4 points.
    X4,
    /// 8 × 8 points.
    X8,
}

impl Supersampling {
    /// Points along one side of a pixel.
    pub fn per_side(self) -> u32 {
        match self {
            Self::X1 => 1,
            Self::X2 => 2,
            Self::X4 => 4,
            Self::X8 => 8,
        }
    }

    /// Points in a pixel.
    pub fn per_pixel(self) -> u32 {
        self.per_side().pow(2)
    }

    /// Where the points lie, from the pixel's upper left corner, px.
    pub(crate) fn offsets(self) -> impl Iterator<Item = DVec2> {
        let n = self.per_side();
        let at = move |i: u32| (f64::from(i) + 0.5) / f64::from(n);
        (0..n * n).map(move |i| DVec2::new(at(i % n), at(i / n)))
    }
}
