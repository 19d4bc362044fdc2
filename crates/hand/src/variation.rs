//! Other people's hands.

use glam::DVec3;

use crate::shape::{FingerShape, ForearmShape, HandShape, PalmShape, ThumbShape};

/// What a number of a hand's shape measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// How long a bone is, or how far apart two places inside the hand are.
    Length,
    /// How thick the flesh about them is.
    Radius,
}

impl HandShape {
    /// A hand in which every bone's length and every radius is multiplied by a factor of its own,
    /// which `factor` gives (uniform in 0.9 … 1.1, say). The palm's bones are the distances of
    /// the digits' bases and of the heel from the wrist. Angles and the forearm's length, which
    /// pictures cut, stay.
    ///
    /// ```
    /// use glam::DAffine3;
    /// use phalanx_hand::{HandShape, Pose};
    ///
    /// let larger = HandShape::adult().scaled(|| 1.1);
    /// let reach = |shape: &HandShape| shape.pose(&Pose::REST, &DAffine3::IDENTITY).joints[12].length();
    /// assert!((reach(&larger) / reach(&HandShape::adult()) - 1.1).abs() < 1e-9);
    /// ```
    #[must_use]
    pub fn scaled(&self, mut factor: impl FnMut() -> f64) -> Self {
        self.scaled_by(|_| factor())
    }

    /// The same, where the factor of a bone's length may be another than that of a radius.
    ///
    /// ```
    /// use phalanx_hand::{HandShape, Measure};
    ///
    /// let adult = HandShape::adult();
    /// let slender = adult.scaled_by(|measure| match measure {
    ///     Measure::Length => 1.0,
    ///     Measure::Radius => 0.9,
    /// });
    /// assert_eq!(slender.length_mm(), adult.length_mm());
    /// assert!(slender.index.radii_mm[0] < adult.index.radii_mm[0]);
    /// ```
    #[must_use]
    pub fn scaled_by(&self, mut factor: impl FnMut(Measure) -> f64) -> Self {
        let vary = &mut factor;
        let mut finger = |shape: &FingerShape| FingerShape {
            base_mm: length(shape.base_mm, vary),
            splay_deg: shape.splay_deg,
            lengths_mm: lengths(shape.lengths_mm, vary),
            radii_mm: radii(shape.radii_mm, vary),
        };
        let fingers = self.fingers().map(&mut finger);
        let [index, middle, ring, little] = fingers;
        Self {
            side: self.side,
            thumb: ThumbShape {
                base_mm: length(self.thumb.base_mm, vary),
                lengths_mm: lengths(self.thumb.lengths_mm, vary),
                radii_mm: radii(self.thumb.radii_mm, vary),
                ..self.thumb
            },
            index,
            middle,
            ring,
            little,
            palm: PalmShape {
                wrist_half_width_mm: self.palm.wrist_half_width_mm * vary(Measure::Length),
                wrist_radius_mm: self.palm.wrist_radius_mm * vary(Measure::Radius),
                knuckle_radii_mm: radii(self.palm.knuckle_radii_mm, vary),
                web_reach: self.palm.web_reach,
                web_radius_mm: self.palm.web_radius_mm * vary(Measure::Radius),
                thumb_web_radius_mm: self.palm.thumb_web_radius_mm * vary(Measure::Radius),
                heel_mm: length(self.palm.heel_mm, vary),
                heel_radius_mm: self.palm.heel_radius_mm * vary(Measure::Radius),
            },
            forearm: ForearmShape {
                half_widths_mm: radii(self.forearm.half_widths_mm, vary),
                ..self.forearm
            },
        }
    }
}

/// A bone from the wrist, longer or shorter.
fn length(bone: DVec3, vary: &mut impl FnMut(Measure) -> f64) -> DVec3 {
    bone * vary(Measure::Length)
}

fn lengths(bones: [f64; 3], vary: &mut impl FnMut(Measure) -> f64) -> [f64; 3] {
    bones.map(|bone| bone * vary(Measure::Length))
}

fn radii<const N: usize>(radii: [f64; N], vary: &mut impl FnMut(Measure) -> f64) -> [f64; N] {
    radii.map(|radius| radius * vary(Measure::Radius))
}
