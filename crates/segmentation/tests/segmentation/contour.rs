//! What a contour is, whatever the mask.

use std::collections::BTreeSet;

use imageproc::contours::find_contours;
use phalanx_segmentation::{Cleanup, Contour, Mask, clean};
use proptest::prelude::*;

use crate::common::{drawing, masks, placed};
use crate::property;

/// The largest component without holes, so that all its background is outside.
fn solid(mask: &Mask) -> Option<Mask> {
    clean(mask, &Cleanup { majority_radius: 0, max_hole: 1.0, min_hand: 0.0 }).ok()
}

fn pixel(point: [f64; 2]) -> [i64; 2] {
    point.map(|v| (v - 0.5) as i64)
}

fn level(mask: &Mask, [x, y]: [i64; 2]) -> Option<bool> {
    let (x, y) = (u32::try_from(x).ok()?, u32::try_from(y).ok()?);
    mask.get_pixel_checked(x, y).map(|level| level.0[0] > 127)
}

fn touches_background([x, y]: [i64; 2], mask: &Mask) -> bool {
    let around = [[x + 1, y], [x - 1, y], [x, y + 1], [x, y - 1]];
    around.iter().any(|&pixel| level(mask, pixel) == Some(false))
}

fn suzuki(mask: &Mask) -> Vec<[i64; 2]> {
    let padded = placed(mask, (mask.width() + 2, mask.height() + 2), (1, 1));
    let outer = find_contours::<i32>(&padded).swap_remove(0);
    outer.points.iter().map(|point| [i64::from(point.x) - 1, i64::from(point.y) - 1]).collect()
}

proptest! {
    #![proptest_config(property::cases(256))]

    #[test]
    fn points_are_an_eight_connected_chain_of_boundary_pixels(mask in masks()) {
        let Some(mask) = solid(&mask) else { return Ok(()) };
        let contour = Contour::trace(&mask);
        for piece in contour.pieces() {
            let steps = piece.windows(2).map(|pair| (pair[0], pair[1]));
            let close = contour.is_closed().then(|| (piece[piece.len() - 1], piece[0]));
            for (a, b) in steps.chain(close.filter(|_| piece.len() > 1)) {
                let step = (b[0] - a[0]).abs().max((b[1] - a[1]).abs());
                prop_assert_eq!(step, 1.0);
            }
        }
        for &point in &contour.points {
            prop_assert_eq!(level(&mask, pixel(point)), Some(true));
            prop_assert!(touches_background(pixel(point), &mask));
        }
        let in_pieces: usize = contour.pieces().map(<[_]>::len).sum();
        prop_assert_eq!(in_pieces, contour.points.len());
    }

    #[test]
    fn open_pieces_run_from_border_to_border(mask in masks()) {
        let Some(mask) = solid(&mask) else { return Ok(()) };
        let contour = Contour::trace(&mask);
        let (right, bottom) = (i64::from(mask.width()) - 1, i64::from(mask.height()) - 1);
        let at_border = |point| {
            let [x, y] = pixel(point);
            x == 0 || y == 0 || x == right || y == bottom
        };
        let touches = mask.enumerate_pixels().any(|(x, y, level)| {
            level.0[0] > 127 && at_border([f64::from(x) + 0.5, f64::from(y) + 0.5])
        });
        prop_assert_eq!(contour.is_closed(), !touches && !contour.points.is_empty());
        if !contour.is_closed() {
            for piece in contour.pieces() {
                prop_assert!(at_border(piece[0]) && at_border(piece[piece.len() - 1]));
            }
        }
    }

    #[test]
    fn closed_contours_are_those_of_suzuki_and_abe(mask in masks()) {
        let Some(mask) = solid(&mask) else { return Ok(()) };
        let mask = placed(&mask, (mask.width() + 2, mask.height() + 2), (1, 1));
        let contour = Contour::trace(&mask);
        prop_assert!(contour.is_closed());
        let mut theirs = suzuki(&mask);
        let ours: Vec<_> = contour.points.iter().map(|&point| pixel(point)).collect();
        // Both begin at the first pixel in reading order; the directions differ.
        theirs[1..].reverse();
        prop_assert_eq!(ours, theirs);
    }

    #[test]
    fn cut_contours_are_those_of_suzuki_and_abe_without_the_cut(mask in masks()) {
        let Some(mask) = solid(&mask) else { return Ok(()) };
        let ours: BTreeSet<_> = Contour::trace(&mask).points.into_iter().map(pixel).collect();
        let theirs: BTreeSet<_> =
            suzuki(&mask).into_iter().filter(|&pixel| touches_background(pixel, &mask)).collect();
        prop_assert_eq!(ours, theirs);
    }

    #[test]
    fn the_contour_moves_with_the_mask(mask in masks(), x in 1..9_u32, y in 1..9_u32) {
        let canvas = (mask.width() + 10, mask.height() + 10);
        let here = Contour::trace(&placed(&mask, canvas, (1, 1)));
        let there = Contour::trace(&placed(&mask, canvas, (x, y)));
        let [dx, dy] = [f64::from(x) - 1.0, f64::from(y) - 1.0];
        let moved: Vec<_> = here.points.iter().map(|p| [p[0] + dx, p[1] + dy]).collect();
        prop_assert_eq!(moved, there.points);
    }
}

#[test]
fn a_spur_is_walked_up_and_down() {
    let contour = Contour::trace(&drawing(&["......", ".####.", "......"]));
    let columns: Vec<_> = contour.points.iter().map(|point| point[0]).collect();
    assert_eq!(columns, [1.5, 2.5, 3.5, 4.5, 3.5, 2.5]);
    assert!(contour.is_closed());
}

#[test]
fn a_bar_through_the_image_has_two_sides_and_no_cut() {
    let contour = Contour::trace(&drawing(&["....", "####", "####", "...."]));
    assert!(!contour.is_closed());
    let pieces: Vec<_> = contour.pieces().map(<[_]>::to_vec).collect();
    let row = |y: f64| [0.5, 1.5, 2.5, 3.5].map(|x| [x, y]).to_vec();
    let backwards: Vec<_> = row(2.5).into_iter().rev().collect();
    assert_eq!(pieces.len(), 2);
    assert!(pieces.contains(&row(1.5)) && pieces.contains(&backwards));
}

#[test]
fn a_corner_and_a_line_to_the_border_are_cut_where_the_image_ends() {
    let corner = Contour::trace(&drawing(&["##..", "##..", "....", "...."]));
    assert_eq!(corner.points, [[1.5, 0.5], [1.5, 1.5], [0.5, 1.5]]);
    let line = Contour::trace(&drawing(&["....", ".#..", ".#..", ".#.."]));
    let rows: Vec<_> = line.points.iter().map(|point| point[1]).collect();
    assert_eq!(rows, [3.5, 2.5, 1.5, 2.5, 3.5]);
    assert_eq!(line.pieces().len(), 1);
}

#[test]
fn a_single_pixel_is_one_point_and_nothing_is_none() {
    let dot = Contour::trace(&drawing(&["...", ".#.", "..."]));
    assert_eq!((dot.points.as_slice(), dot.is_closed()), ([[1.5, 1.5]].as_slice(), true));
    assert_eq!(Contour::trace(&drawing(&["...", "..."])), Contour::default());
    assert_eq!(Contour::trace(&drawing(&["##", "##"])), Contour::default());
    assert_eq!(Contour::trace(&Mask::new(0, 0)), Contour::default());
}
