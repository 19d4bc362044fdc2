//! Where a picture's grey levels change most.

use glam::DVec2;
use image::{DynamicImage, GrayImage};
use imageproc::filter::gaussian_blur_f32;

/// Deviation of the blur that takes a sensor's noise away, px.
const BLUR: f32 = 1.0;

/// Steps of a profile, px.
const STEP: f64 = 0.5;

/// An edge changes grey levels by at least so many times what is usual within the hand.
const STRONG: f64 = 2.0;

/// A picture in grey, and the change of its levels that is usual within the hand.
pub(super) struct Photograph {
    levels: GrayImage,
    usual: f64,
}

impl Photograph {
    /// Of a picture and the hand's pixels in it.
    pub(super) fn new(picture: &DynamicImage, hand: impl Iterator<Item = [u32; 2]>) -> Self {
        let levels = gaussian_blur_f32(&picture.to_luma8(), BLUR);
        let mut own = Self { levels, usual: 0.0 };
        let mut changes: Vec<f64> = hand
            .map(|[x, y]| {
                let place = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
                own.change(place, DVec2::X).hypot(own.change(place, DVec2::Y))
            })
            .collect();
        changes.sort_by(f64::total_cmp);
        own.usual = changes.get(changes.len() / 2).copied().unwrap_or_default();
        own
    }

    /// How far along a direction from a place the strongest edge across it is, px, at most `reach`; none where no
    /// edge is strong.
    pub(super) fn edge(&self, at: DVec2, direction: DVec2, reach: f64) -> Option<f64> {
        let steps = (reach / STEP).floor() as i32;
        let (change, along) = (-steps..=steps)
            .map(|step| STEP * f64::from(step))
            .map(|along| (self.change(at + direction * along, direction).abs(), along))
            .max_by(|a, b| a.0.total_cmp(&b.0))?;
        (change > STRONG * self.usual).then_some(along)
    }

    /// The slope of the grey levels at a place along a direction, per px.
    fn change(&self, at: DVec2, direction: DVec2) -> f64 {
        self.level(at + 0.5 * direction) - self.level(at - 0.5 * direction)
    }

    /// The grey level at a place, between pixels' middles.
    fn level(&self, at: DVec2) -> f64 {
        let (width, height) = (f64::from(self.levels.width()), f64::from(self.levels.height()));
        let at = (at - 0.5).clamp(DVec2::ZERO, DVec2::new(width, height) - 1.001);
        let (corner, part) = (at.floor(), at.fract());
        let of = |dx: u32, dy: u32| {
            f64::from(self.levels.get_pixel(corner.x as u32 + dx, corner.y as u32 + dy).0[0])
        };
        let row = |dy: u32| of(0, dy) + part.x * (of(1, dy) - of(0, dy));
        row(0) + part.y * (row(1) - row(0))
    }
}

#[cfg(test)]
mod tests {
    use image::Luma;

    use super::*;

    #[test]
    fn an_edge_is_where_levels_change() {
        let picture = GrayImage::from_fn(40, 30, |x, _| Luma([if x < 21 { 60 } else { 160 }]));
        let hand = (0..20).flat_map(|x| (0..30).map(move |y| [x, y]));
        let photograph = Photograph::new(&picture.into(), hand);
        let edge = photograph.edge(DVec2::new(19.0, 15.0), DVec2::X, 5.0);
        assert!((edge.unwrap() - 2.0).abs() <= STEP);
        assert!(photograph.edge(DVec2::new(30.0, 15.0), DVec2::X, 5.0).is_none());
    }
}
