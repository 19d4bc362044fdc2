//! The clean-up against slow and obvious versions.

use phalanx_segmentation::{Cleanup, Error, Mask, Workspace, clean, clean_into};
use proptest::prelude::*;

use crate::common::{drawing, masks};
use crate::property;

/// Sizes and border contact of all components of pixels that `is`, and each pixel's component.
fn flood(mask: &Mask, hand: bool) -> (Vec<(usize, bool)>, Vec<Option<usize>>) {
    let (width, height) = (i64::from(mask.width()), i64::from(mask.height()));
    let is = |x: i64, y: i64| (mask.is_hand(x as u32, y as u32)) == hand;
    let (mut regions, mut of) = (Vec::new(), vec![None; (width * height) as usize]);
    for start in 0..width * height {
        if of[start as usize].is_some() || !is(start % width, start / width) {
            continue;
        }
        let (mut area, mut border, mut stack) = (0, false, vec![start]);
        of[start as usize] = Some(regions.len());
        while let Some(index) = stack.pop() {
            let (x, y) = (index % width, index / width);
            area += 1;
            border |= x == 0 || y == 0 || x + 1 == width || y + 1 == height;
            let around = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy)));
            for (dx, dy) in around.filter(|&(dx, dy)| hand || dx == 0 || dy == 0) {
                let (x, y) = (x + dx, y + dy);
                let inside = (0..width).contains(&x) && (0..height).contains(&y);
                if inside && is(x, y) && of[(y * width + x) as usize].is_none() {
                    of[(y * width + x) as usize] = Some(regions.len());
                    stack.push(y * width + x);
                }
            }
        }
        regions.push((area, border));
    }
    (regions, of)
}

fn slow_vote(mask: &Mask, radius: u32) -> Mask {
    Mask::from_fn(mask.width(), mask.height(), |x, y| {
        let columns = x.saturating_sub(radius)..=(x + radius).min(mask.width() - 1);
        let (mut hand, mut voters) = (0, 0);
        for x in columns {
            for y in y.saturating_sub(radius)..=(y + radius).min(mask.height() - 1) {
                voters += 2;
                hand += if mask.is_hand(x, y) { 2 } else { 0 };
            }
        }
        let own = mask.is_hand(x, y);
        2 * hand > voters || (2 * hand == voters && own)
    })
}

fn slow_clean(mask: &Mask, cleanup: &Cleanup) -> Option<Mask> {
    let mut mask = slow_vote(mask, cleanup.majority_radius);
    let (regions, of) = flood(&mask, true);
    let first_best = (0..regions.len()).rev().max_by_key(|&i| regions[i])?;
    let area = regions[first_best].0;
    for (level, of) in mask.iter_mut().zip(of) {
        *level = if of == Some(first_best) { 255 } else { 0 };
    }
    let (regions, of) = flood(&mask, false);
    let is_small =
        |i: usize| !regions[i].1 && regions[i].0 as f64 <= cleanup.max_hole * area as f64;
    for (level, of) in mask.iter_mut().zip(of) {
        *level = if of.is_some_and(is_small) { 255 } else { *level };
    }
    Some(mask)
}

proptest! {
    #![proptest_config(property::cases(256))]

    #[test]
    fn equals_the_slow_version(mask in masks(), radius in 0..4_u32, max_hole in 0.0..0.2) {
        let cleanup = Cleanup { majority_radius: radius, max_hole, min_hand: 0.0 };
        prop_assert_eq!(clean(&mask, &cleanup).ok(), slow_clean(&mask, &cleanup));
    }

    #[test]
    fn component_and_holes_change_nothing_the_second_time(mask in masks(), max_hole in 0.0..0.2) {
        let cleanup = Cleanup { majority_radius: 0, max_hole, min_hand: 0.0 };
        let Ok(once) = clean(&mask, &cleanup) else { return Ok(()) };
        // The hand has grown by its filled holes, and what a larger hand calls small may differ.
        let again = Cleanup { max_hole: 0.0, ..cleanup };
        prop_assert_eq!(&clean(&once, &again).unwrap(), &once);
    }

    #[test]
    fn memory_from_another_mask_does_not_matter(first in masks(), second in masks()) {
        let (mut workspace, mut out) = (Workspace::default(), Mask::default());
        let cleanup = Cleanup::default();
        let _ = clean_into(&first, &cleanup, &mut workspace, &mut out);
        let reused = clean_into(&second, &cleanup, &mut workspace, &mut out).map(|()| out);
        prop_assert_eq!(reused, clean(&second, &cleanup));
    }
}

#[test]
fn a_ring_stays_open_and_a_pinhole_is_filled() {
    let rows = ["........", ".######.", ".#.##.#.", ".####.#.", ".######.", "........"];
    let pinholes = drawing(&rows);
    let cleanup = Cleanup { majority_radius: 0, max_hole: 0.05, min_hand: 0.0 };
    let cleaned = clean(&pinholes, &cleanup).unwrap();
    assert_eq!(cleaned.get_pixel(2, 2).0[0], 255, "one pixel of 21");
    assert_eq!(cleaned.get_pixel(5, 2).0[0], 0, "two pixels of 21");
}

#[test]
fn what_cannot_be_cleaned_is_named() {
    let speck = drawing(&["....", ".#..", "....", "...."]);
    let needs_two = Cleanup { majority_radius: 0, min_hand: 0.1, ..Cleanup::default() };
    assert_eq!(clean(&speck, &needs_two), Err(Error::EmptyMask { pixels: 1, needed: 2 }));
    assert!(matches!(clean(&Mask::new(0, 3), &needs_two), Err(Error::ImageTooSmall { .. })));
    for bad in [
        Cleanup { majority_radius: 8, ..needs_two },
        Cleanup { max_hole: f64::NAN, ..needs_two },
        Cleanup { min_hand: 1.5, ..needs_two },
    ] {
        assert!(matches!(clean(&speck, &bad), Err(Error::Parameter { .. })));
    }
}
