//! Hands and their wrists in masks of every kind.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use image::Luma;
use phalanx_segmentation::{
    Cleanup, EndModel, Error, HandDetection, HandDetector, Mask, WristModel, WristTrainer,
};
use proptest::prelude::*;

use crate::property;

/// A hand of 180 units with its fingers straight, and a forearm of another 250, cut off or bent; positions in units are
/// along the arm from the wrist and across it.
#[derive(Debug, Clone, Copy)]
struct Drawn {
    wrist: [f64; 2],
    /// Direction of the arm, radians, and pixels to the unit.
    angle: f64,
    scale: f64,
    /// How far back the arm goes, units.
    arm: f64,
    /// Where it bends by a right angle, units behind the wrist.
    elbow: f64,
    /// How far ahead of the wrist the fingertips are, units.
    tips: f64,
}

const UPRIGHT: Drawn = Drawn {
    wrist: [60.0, 62.0],
    angle: -FRAC_PI_2,
    scale: 0.3,
    arm: 1000.0,
    elbow: 1000.0,
    tips: 180.0,
};

fn capsule(p: [f64; 2], a: [f64; 2], b: [f64; 2], radius: f64) -> bool {
    let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    let along = ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / (dx * dx + dy * dy);
    let t = along.clamp(0.0, 1.0);
    (p[0] - a[0] - t * dx).hypot(p[1] - a[1] - t * dy) < radius
}

impl Drawn {
    fn covers(&self, x: f64, y: f64) -> bool {
        let [dx, dy] = [(x - self.wrist[0]) / self.scale, (y - self.wrist[1]) / self.scale];
        let (sin, cos) = self.angle.sin_cos();
        let p = [dx * cos + dy * sin, dy * cos - dx * sin];
        let back = -p[0];
        let forearm =
            (0.0..self.arm.min(self.elbow)).contains(&back) && p[1].abs() < 28.0 + 0.06 * back;
        let upper_arm = self.elbow < self.arm
            && (back - self.elbow).abs() < 42.0
            && (-42.0..self.arm - self.elbow).contains(&p[1]);
        let palm = (0.0..95.0).contains(&p[0]) && p[1].abs() < 28.0 + 0.22 * p[0].min(60.0);
        let tip = self.tips - 8.0;
        let fingers =
            [-30.0, -10.0, 10.0, 30.0].iter().any(|&v| capsule(p, [90.0, v], [tip, v], 8.0));
        forearm || upper_arm || palm || fingers || capsule(p, [35.0, 32.0], [85.0, 65.0], 10.0)
    }

    fn mask(&self, width: u32, height: u32) -> Mask {
        Mask::from_fn(width, height, |x, y| self.covers(f64::from(x) + 0.5, f64::from(y) + 0.5))
    }

    /// The likeliest hand in its picture, checked against the truth.
    fn check(&self, mask: &Mask) -> HandDetection {
        let hand = find(mask)[0];
        let [dx, dy] = [hand.wrist[0] - self.wrist[0], hand.wrist[1] - self.wrist[1]];
        let length = self.tips * self.scale;
        assert!(dx.hypot(dy) < 0.2 * length, "{hand:?} of {self:?}");
        let cosine = hand.direction[0] * self.angle.cos() + hand.direction[1] * self.angle.sin();
        assert!(cosine > 15_f64.to_radians().cos(), "{hand:?} of {self:?}");
        assert!((hand.length / length - 1.0).abs() < 0.25, "{hand:?} of {self:?}");
        assert!(!hand.cut_off, "{hand:?} of {self:?}");
        hand
    }
}

fn find(mask: &Mask) -> Vec<HandDetection> {
    HandDetector::default().find(mask, &Cleanup::default(), WristModel::builtin()).unwrap()
}

#[test]
fn wrists_are_found_however_the_arm_ends() {
    let straight = UPRIGHT.check(&UPRIGHT.mask(120, 120));
    assert!((straight.width / (56.0 * 0.3) - 1.0).abs() < 0.3, "{straight:?}");
    let whole = UPRIGHT.mask(120, 120).area() as f64;
    assert!(((straight.area + straight.behind) / whole - 1.0).abs() < 0.02, "{straight:?}");
    assert!((0.5..1.5).contains(&(straight.behind / (58.0 * straight.width))), "{straight:?}");
    // In a sleeve, within the picture.
    for arm in [90.0, 140.0] {
        let sleeved = Drawn { arm, ..UPRIGHT };
        let hand = sleeved.check(&sleeved.mask(120, 120));
        assert!(hand.arm < 0.3 * arm, "{hand:?}");
    }
    // Bent at the elbow, and leaving by a side.
    let bent = Drawn { elbow: 230.0, ..UPRIGHT };
    bent.check(&bent.mask(140, 160));
    // Through a corner, by two borders: both crossings are of the arm.
    let diagonal = Drawn { wrist: [45.0, 75.0], angle: -FRAC_PI_4, ..UPRIGHT };
    diagonal.check(&diagonal.mask(120, 120));
}

/// A forearm that ends at a rolled-up sleeve has two ends in the picture, and one view does not always tell them apart.
#[test]
fn the_hand_is_at_its_own_end_of_a_long_arm() {
    let mut right = 0;
    for k in 0..240 {
        let share = |of: i32| f64::from(k * of % 240) / 240.0;
        let (angle, scale) = (std::f64::consts::TAU * share(7), 0.27 + 0.3 * share(11));
        let (arm, tips) = (130.0 + 120.0 * share(13), 120.0 + 60.0 * share(17));
        let wrist = [f64::cos(angle), f64::sin(angle)].map(|along| (280.0 + 30.0 * along) * scale);
        let side = (560.0 * scale) as u32;
        let drawn = Drawn { wrist, angle, scale, arm, tips, ..UPRIGHT };
        let hand = find(&drawn.mask(side, side))[0];
        let along = hand.direction[0] * angle.cos() + hand.direction[1] * angle.sin();
        right += i32::from(along > 0.7 && hand.ahead_log_odds > 0.0);
    }
    assert!(right >= 236, "{right} of 240");
}

#[test]
fn end_models_are_read_back_or_refused() {
    let bytes = EndModel::builtin().to_bytes();
    assert_eq!(&EndModel::from_bytes(&bytes).unwrap(), EndModel::builtin());
    let text = String::from_utf8(bytes).unwrap();
    let refused = |text: &str| {
        let error = EndModel::from_bytes(text.as_bytes()).unwrap_err();
        assert!(matches!(error, Error::EndModel(_)), "{error}");
    };
    refused("");
    refused(&text.replace("model 1", "model 2"));
    refused(&text[..text.len() / 2]);
    refused(&text.replacen(' ', "  ", 1));
    refused(&text.replacen("\n0.", "\nNaN", 1));
    let mut rows: Vec<&str> = text.lines().collect();
    let zeros = ["0"; 24].join(" ");
    rows[2] = &zeros;
    refused(&rows.join("\n"));
    assert!(matches!(EndModel::from_bytes(&[255, 0, 7]), Err(Error::EndModel(_))));
}

#[test]
fn other_things_in_the_picture_are_no_hands() {
    let mut mask = UPRIGHT.mask(240, 160);
    // A face, larger than the hand, and a shelf along the border.
    for (x, y, level) in mask.enumerate_pixels_mut() {
        let (dx, dy) = (f64::from(x) - 180.0, f64::from(y) - 60.0);
        if (dx / 38.0).powi(2) + (dy / 48.0).powi(2) < 1.0 || (x > 130 && y < 6) {
            *level = Luma([255]);
        }
    }
    UPRIGHT.check(&mask);
    let mut detector = HandDetector::default();
    let hand = detector.find(&mask, &Cleanup::default(), WristModel::builtin()).unwrap()[0];
    assert_eq!(detector.isolate(&hand), detector_mask(&UPRIGHT.mask(240, 160)));
}

/// A mask as the detector cleans it.
fn detector_mask(mask: &Mask) -> Mask {
    let mut detector = HandDetector::default();
    let hand = detector.find(mask, &Cleanup::default(), WristModel::builtin()).unwrap()[0];
    detector.isolate(&hand)
}

#[test]
fn nothing_to_find_is_an_error() {
    let find = |mask: &Mask| {
        HandDetector::default().find(mask, &Cleanup::default(), WristModel::builtin())
    };
    assert!(matches!(find(&Mask::new(0, 5)), Err(Error::ImageTooSmall { .. })));
    assert!(matches!(find(&Mask::new(50, 50)), Err(Error::EmptyMask { .. })));
    let line = Mask::from_fn(50, 50, |x, y| (20..22).contains(&y) && (10..40).contains(&x));
    assert_eq!(find(&line), Err(Error::NoHand));
    assert!(matches!(WristTrainer::default().finish(), Err(Error::TooFewWrists { .. })));
}

#[test]
fn wrist_models_are_read_back_or_refused() {
    let bytes = WristModel::builtin().to_bytes();
    assert_eq!(&WristModel::from_bytes(&bytes).unwrap(), WristModel::builtin());
    let text = String::from_utf8(bytes).unwrap();
    let refused = |text: &str| {
        let error = WristModel::from_bytes(text.as_bytes()).unwrap_err();
        assert!(matches!(error, Error::WristModel { .. }), "{error}");
    };
    refused("");
    refused(&text.replace("model 1", "model 2"));
    refused(&text[..text.len() / 2]);
    refused(&text.replacen(' ', "  ", 4));
    refused(&text.replacen("\n0.", "\nx.", 1));
    // A covariance of nothing.
    let flat: Vec<&str> = text
        .lines()
        .enumerate()
        .map(|(k, l)| if k == 2 { "0 0 0 0 0 0 0 0 0 0 0" } else { l })
        .collect();
    refused(&flat.join("\n"));
    assert!(matches!(WristModel::from_bytes(&[255, 0, 7]), Err(Error::WristModel { .. })));
}

proptest! {
    #![proptest_config(property::cases(64))]

    #[test]
    fn what_is_found_moves_turns_and_grows_with_the_hand(
        dx in -12.0..12.0, dy in -12.0..12.0, angle in -3.1..3.1, scale in 0.27..0.9,
    ) {
        let side = (400.0 * scale) as u32;
        let middle = 200.0 * scale;
        let back = 60.0 * scale;
        let wrist = [middle - back * f64::cos(angle) + dx * scale, middle - back * f64::sin(angle) + dy * scale];
        let drawn = Drawn { wrist, angle, scale, ..UPRIGHT };
        drawn.check(&drawn.mask(side, side));
    }

    #[test]
    fn whole_pixels_of_shift_shift_what_is_found(dx in 0_u32..30, dy in 0_u32..30) {
        // The arm ends within the picture, so that no border tells the two apart.
        let shift = [f64::from(dx), f64::from(dy)];
        let moved = [0, 1].map(|k| UPRIGHT.wrist[k] + shift[k]);
        let drawn = [UPRIGHT.wrist, moved].map(|wrist| Drawn { wrist, arm: 110.0, ..UPRIGHT });
        let [here, there] = drawn.map(|drawn| find(&drawn.mask(160, 160))[0]);
        let back = [0, 1].map(|k| there.wrist[k] - shift[k]);
        prop_assert!((back[0] - here.wrist[0]).hypot(back[1] - here.wrist[1]) < 1e-9);
        prop_assert_eq!((here.area, here.mahalanobis2), (there.area, there.mahalanobis2));
    }

    #[test]
    fn hostile_masks_do_no_harm(
        width in 1_u32..70, height in 1_u32..70, seed in 0_u64..1 << 40, density in 0_u64..100,
        block in 1_u32..9,
    ) {
        let mask = Mask::from_fn(width, height, |x, y| {
            let cell = u64::from(x / block) * 7919 + u64::from(y / block) * 104_729 + seed;
            let noise = cell.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40;
            noise % 100 < density
        });
        let mut detector = HandDetector::default();
        let Ok(hands) = detector.find(&mask, &Cleanup::default(), WristModel::builtin()) else {
            return Ok(());
        };
        for hand in hands {
            let [dx, dy] = hand.direction;
            prop_assert!((dx.hypot(dy) - 1.0).abs() < 1e-9);
            prop_assert!(hand.wrist[0] >= 0.0 && hand.wrist[0] <= f64::from(width));
            prop_assert!(hand.wrist[1] >= 0.0 && hand.wrist[1] <= f64::from(height));
            prop_assert!(hand.area >= 1.0 && hand.length > 0.0 && hand.arm >= 0.0);
            prop_assert!(hand.across[0] < hand.across[1] && hand.mahalanobis2.is_finite());
            let isolated = detector.isolate(&hand).area();
            prop_assert!(hand.area + hand.behind <= isolated as f64);
        }
    }
}
