//! From masks to silhouettes: where the forearm ends, and what is refused.

use phalanx_segmentation::{Contour, Error, ForearmCue, Mask, Silhouette, Workspace};
use proptest::prelude::*;

use crate::common::{masks, placed};
use crate::property;

fn painted(width: u32, height: u32, hand: impl Fn(i32, i32) -> bool) -> Mask {
    Mask::from_fn(width, height, |x, y| hand(x as i32, y as i32))
}

/// A palm with three fingers upwards and a forearm down to row `end`.
fn toy_hand(width: u32, height: u32, end: i32) -> Mask {
    painted(width, height, |x, y| {
        let palm = (24..44).contains(&x) && (30..50).contains(&y);
        let fingers = (10..30).contains(&y) && (x - 24) % 8 < 4 && (24..44).contains(&x);
        let forearm = (28..40).contains(&x) && (50..end).contains(&y);
        palm || fingers || forearm
    })
}

proptest! {
    #![proptest_config(property::cases(256))]

    #[test]
    fn any_mask_gives_a_silhouette_inside_the_image_or_a_named_error(mask in masks()) {
        match Silhouette::from_mask(&mask) {
            Ok(Silhouette { mask, contour, forearm }) => {
                let [x, y] = forearm.end;
                prop_assert!((0.5..f64::from(mask.width())).contains(&x));
                prop_assert!((0.5..f64::from(mask.height())).contains(&y));
                prop_assert_eq!(forearm.cue == ForearmCue::SmoothEnd, contour.is_closed());
                prop_assert_eq!(forearm.cue == ForearmCue::SmoothEnd, forearm.crossings == 0);
                prop_assert_eq!(Contour::trace(&mask), contour);
            }
            Err(Error::EmptyMask { pixels: 0, .. }) => {
                prop_assert!(mask.iter().all(|&level| level <= 127));
            }
            Err(error) => {
                let named = matches!(error, Error::NoContour { .. } | Error::NoForearm { .. });
                prop_assert!(named, "{error}");
            }
        }
    }

    #[test]
    fn memory_from_another_mask_does_not_matter(first in masks(), second in masks()) {
        let (mut workspace, mut silhouette) = (Workspace::default(), Silhouette::default());
        let _ = silhouette.extract_into(&first, &mut workspace);
        let reused = silhouette.extract_into(&second, &mut workspace).map(|()| silhouette);
        prop_assert_eq!(reused, Silhouette::from_mask(&second));
    }

    #[test]
    fn a_stump_is_found_wherever_the_hand_lies(x in 0..20_u32, y in 0..9_u32) {
        let canvas = placed(&toy_hand(60, 80, 75), (90, 95), (x + 2, y + 2));
        let forearm = Silhouette::from_mask(&canvas).unwrap().forearm;
        prop_assert_eq!(forearm.cue, ForearmCue::SmoothEnd);
        prop_assert!((forearm.end[0] - f64::from(x) - 36.0).abs() < 1.0);
        prop_assert!((f64::from(y) + 77.0 - forearm.end[1]).abs() < 4.0);
        // Either side of the end, a forearm's width of 12 pixels apart.
        let [a, b] = forearm.sides;
        prop_assert!(((a[0] - b[0]).abs() - 12.0).abs() < 1.0, "{:?}", forearm.sides);
        for axis in [0, 1] {
            prop_assert!((f64::midpoint(a[axis], b[axis]) - forearm.end[axis]).abs() < 1e-9);
        }
    }
}

#[test]
fn the_forearm_ends_in_the_middle_of_the_longest_crossing() {
    let forearm = Silhouette::from_mask(&toy_hand(60, 70, 90)).unwrap().forearm;
    assert_eq!(
        (forearm.end, forearm.cue, forearm.crossings),
        ([34.0, 69.5], ForearmCue::Border, 1)
    );
    assert_eq!(forearm.sides, [[39.5, 69.5], [28.5, 69.5]]);

    // A finger that leaves by the top as well.
    let both =
        painted(60, 70, |x, y| (28..40).contains(&x) && y > 20 || (30..33).contains(&x) && y <= 20);
    let forearm = Silhouette::from_mask(&both).unwrap().forearm;
    assert_eq!((forearm.end, forearm.crossings), ([34.0, 69.5], 2));
}

#[test]
fn a_crossing_around_a_corner_is_one() {
    for (x, y, corner) in [(0, 0, [0.5, 0.5]), (29, 0, [29.5, 0.5]), (29, 19, [29.5, 19.5])] {
        let quarter = painted(30, 20, |px, py| (px - x).abs() < 6 && (py - y).abs() < 6);
        let forearm = Silhouette::from_mask(&quarter).unwrap().forearm;
        assert_eq!((forearm.end, forearm.crossings), (corner, 1));
    }
}

#[test]
fn of_two_smooth_ends_the_narrower_is_the_forearm() {
    let fist = painted(60, 80, |x, y| {
        (x - 30).pow(2) + (y - 20).pow(2) < 14 * 14
            || (23..37).contains(&x) && (20..70).contains(&y)
    });
    let forearm = Silhouette::from_mask(&fist).unwrap().forearm;
    assert_eq!(forearm.cue, ForearmCue::SmoothEnd);
    assert!(forearm.end[1] > 65.0);
}

#[test]
fn what_has_no_silhouette_is_named() {
    let of = |mask: &Mask| Silhouette::from_mask(mask).unwrap_err();
    let full = Mask::from_fn(20, 16, |_, _| true);
    assert_eq!(of(&full), Error::NoContour { pixels: 320, width: 20, height: 16 });
    assert!(of(&full).to_string().contains("covers the whole image border"));
    assert_eq!(of(&Mask::new(20, 16)), Error::EmptyMask { pixels: 0, needed: 1 });
    let small = Error::ImageTooSmall { width: 15, height: 99, minimum: 16 };
    assert_eq!(of(&Mask::new(15, 99)), small);
    let disc = painted(40, 40, |x, y| (x - 20).pow(2) + (y - 20).pow(2) < 100);
    assert!(matches!(of(&disc), Error::NoForearm { .. }));
    let dot = painted(40, 40, |x, y| x == 20 && y == 20);
    assert!(matches!(of(&dot), Error::NoForearm { .. }));
}

#[test]
fn a_second_extraction_uses_the_same_memory() {
    let mask = toy_hand(60, 70, 90);
    let (mut workspace, mut silhouette) = (Workspace::default(), Silhouette::default());
    silhouette.extract_into(&mask, &mut workspace).unwrap();
    let memory = |s: &Silhouette| (s.mask.as_ptr(), s.contour.points.as_ptr());
    let before = memory(&silhouette);
    silhouette.extract_into(&mask, &mut workspace).unwrap();
    assert_eq!(memory(&silhouette), before);
}
