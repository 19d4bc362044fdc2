//! Where in the flesh joints lie, which no silhouette tells.

use phalanx_hand::{Digit, HandShape, JOINTS};

/// How far each joint is from the middle of the flesh about it, root mean square, mm: anywhere in a ball as
/// wide as the hand is there.
pub(super) fn joint_std_mm(hand: &HandShape) -> [f64; JOINTS] {
    // Of a uniform distribution within a ball of radius r: r √(3/5).
    radii_mm(hand).map(|radius| radius * 0.6_f64.sqrt())
}

/// Half as wide as a hand is at each of its 21 joints, mm.
fn radii_mm(hand: &HandShape) -> [f64; JOINTS] {
    let HandShape { palm, .. } = hand;
    let (half_width, half_depth) =
        (palm.wrist_half_width_mm + palm.wrist_radius_mm, palm.wrist_radius_mm);
    let of_digit = |digit: Digit| match digit {
        Digit::Thumb => hand.thumb.radii_mm,
        Digit::Index => hand.index.radii_mm,
        Digit::Middle => hand.middle.radii_mm,
        Digit::Ring => hand.ring.radii_mm,
        Digit::Little => hand.little.radii_mm,
    };
    let mut radii = [0.5 * (half_width + half_depth); JOINTS];
    for (joints, digit) in radii[1..].chunks_exact_mut(4).zip(Digit::ALL) {
        joints.copy_from_slice(&of_digit(digit));
    }
    radii
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thick_parts_leave_their_joints_more_room() {
        let std = joint_std_mm(&HandShape::adult());
        let [wrist, thumb_base, index_tip, little_tip] = [0, 1, 8, 20].map(|joint| std[joint]);
        assert!(wrist > thumb_base && thumb_base > index_tip && index_tip > little_tip);
        // A little finger's tip is about 12 mm wide.
        assert!((little_tip - 6.0 * 0.775).abs() < 0.5, "{little_tip}");
    }
}
