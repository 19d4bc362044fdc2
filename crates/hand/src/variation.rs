//! Other people's hands.

use glam::DVec3;

use crate::shape::{FingerShape, ForearmShape, HandShape, PalmShape, ThumbShape};

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
        let vary = &mut factor;
        let mut finger = |shape: &FingerShape| FingerShape {
            base_mm: length(shape.base_mm, vary),
            splay_deg: shape.splay_deg,
            lengths_mm: each(shape.lengths_mm, vary),
            radii_mm: each(shape.radii_mm, vary),
        };
        let fingers = self.fingers().map(&mut finger);
        let [index, middle, ring, little] = fingers;
        Self {
            side: self.side,
            thumb: ThumbShape {
                base_mm: length(self.thumb.base_mm, vary),
                lengths_mm: each(self.thumb.lengths_mm, vary),
                radii_mm: each(self.thumb.radii_mm, vary),
                ..self.thumb
            },
            index,
            middle,
            ring,
            little,
            palm: PalmShape {
                wrist_half_width_mm: self.palm.wrist_half_width_mm * vary(),
                wrist_radius_mm: self.palm.wrist_radius_mm * vary(),
                knuckle_radii_mm: each(self.palm.knuckle_radii_mm, vary),
                web_reach: self.palm.web_reach,
                web_radius_mm: self.palm.web_radius_mm * vary(),
                thumb_web_radius_mm: self.palm.thumb_web_radius_mm * vary(),
                heel_mm: length(self.palm.heel_mm, vary),
                heel_radius_mm: self.palm.heel_radius_mm * vary(),
            },
            forearm: ForearmShape {
                half_widths_mm: each(self.forearm.half_widths_mm, vary),
                ..self.forearm
            },
        }
    }
}

/// A bone from the wrist, longer or shorter.
fn length(bone: DVec3, vary: &mut impl FnMut() -> f64) -> DVec3 {
    bone * vary()
}

fn each<const N: usize>(values: [f64; N], vary: &mut impl FnMut() -> f64) -> [f64; N] {
    values.map(|value| value * vary())
}
