//! Boundaries found fast against boundaries found slowly.

use glam::DVec2;
use image::GrayImage;
use phalanx_segmentation::Mask;
use proptest::prelude::*;

use crate::observation::boundary::{boundary_edges, differing};
use crate::observation::distance_transform::nearest_edges;

/// Masks of few and of many changes.
fn masks() -> impl Strategy<Value = Mask> {
    (1_u32..50, 1_u32..20, 0.0..1.0_f64).prop_flat_map(|(width, height, share)| {
        let pixel = prop::bool::weighted(share).prop_map(|hand| if hand { 200 } else { 100 });
        prop::collection::vec(pixel, (width * height) as usize)
            .prop_map(move |pixels| GrayImage::from_raw(width, height, pixels).unwrap().into())
    })
}

/// By looking at every pair of pixels.
fn slow_edges(mask: &Mask) -> Vec<DVec2> {
    let is_hand = |x: u32, y: u32| mask.is_hand(x, y);
    let mut edges = Vec::new();
    for y in 0..mask.height() {
        let across = (1..mask.width()).filter(|&x| is_hand(x - 1, y) != is_hand(x, y));
        edges.extend(across.map(|x| DVec2::new(f64::from(x), f64::from(y) + 0.5)));
        let down = (0..mask.width()).filter(|&x| y > 0 && is_hand(x, y - 1) != is_hand(x, y));
        edges.extend(down.map(|x| DVec2::new(f64::from(x) + 0.5, f64::from(y))));
    }
    edges
}

proptest! {
    #![proptest_config(crate::property::cases(256))]

    #[test]
    fn edges_are_where_neighbours_differ(mask in masks()) {
        let mut edges = Vec::new();
        boundary_edges(&mask, &mut edges);
        prop_assert_eq!(edges, slow_edges(&mask));
    }

    #[test]
    fn pixels_differ_where_one_is_hand_and_the_other_is_not(
        masks in (1_u32..50, 1_u32..20).prop_flat_map(|(width, height)| {
            let pixels = prop::collection::vec(any::<u8>(), (width * height) as usize);
            let mask = move |pixels| Mask::from(GrayImage::from_raw(width, height, pixels).unwrap());
            prop::array::uniform3(pixels.prop_map(mask))
        }),
    ) {
        let [one, other, known] = &masks;
        let pixels = one.enumerate_pixels().enumerate();
        let is_differing = |x, y| one.is_hand(x, y) != other.is_hand(x, y) && known.is_hand(x, y);
        let slow = pixels.filter(|(_, (x, y, _))| is_differing(*x, *y)).map(|(pixel, _)| pixel);
        let fast: Vec<usize> = differing([one, other], known).collect();
        prop_assert_eq!(fast, slow.collect::<Vec<_>>());
    }

    /// The sweeps may miss the nearest by a little.
    #[test]
    fn the_nearest_edge_is_nearest(mask in masks()) {
        let mut edges = Vec::new();
        boundary_edges(&mask, &mut edges);
        prop_assume!(!edges.is_empty());
        let nearest = nearest_edges(&edges, mask.dimensions());
        for (x, y, _) in mask.enumerate_pixels() {
            let middle = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
            let found = edges[nearest[(y * mask.width() + x) as usize] as usize];
            let least = edges.iter().map(|edge| edge.distance(middle)).fold(f64::MAX, f64::min);
            prop_assert!(found.distance(middle) <= least + 0.5, "{found} from {middle}");
        }
    }
}
