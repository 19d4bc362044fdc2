//! Area averages against reals, and where the crop window lies.

use image::{GrayImage, RgbImage};
use phalanx_segmentation::{CropWindow, Error, Mask, downsample, downsample_mask};
use proptest::prelude::*;

use crate::property;

/// The length that target cell `i` of `count` shares with source cell `j` of `length`.
fn overlap(i: u32, count: u32, length: u32, j: u32) -> f64 {
    let scale = f64::from(length) / f64::from(count);
    let (start, end) = (f64::from(i) * scale, f64::from(i + 1) * scale);
    (end.min(f64::from(j + 1)) - start.max(f64::from(j))).max(0.0)
}

fn slow_average(
    image: &RgbImage,
    window: CropWindow,
    size: (u32, u32),
    at: (u32, u32),
) -> [f64; 3] {
    let mut sums = [0.0; 3];
    let area = f64::from(window.width) * f64::from(window.height);
    for y in 0..window.height {
        let down = overlap(at.1, size.1, window.height, y);
        for x in 0..window.width {
            let weight = down * overlap(at.0, size.0, window.width, x);
            let colour = image.get_pixel(window.x + x, window.y + y).0;
            for (sum, level) in sums.iter_mut().zip(colour) {
                *sum += weight * f64::from(level) * f64::from(size.0 * size.1) / area;
            }
        }
    }
    sums
}

proptest! {
    #![proptest_config(property::cases(64))]

    #[test]
    fn equals_the_average_in_reals(
        (width, height, levels) in (1..24_u32, 1..24_u32).prop_flat_map(|(w, h)| {
            (Just(w), Just(h), proptest::collection::vec(any::<u8>(), (w * h * 3) as usize))
        }),
        target in (1..12_u32, 1..12_u32),
    ) {
        let image = RgbImage::from_raw(width, height, levels).unwrap();
        let window = CropWindow::centred((width, height), target).unwrap();
        let small = downsample(&image, target.0, target.1).unwrap();
        for (x, y, colour) in small.enumerate_pixels() {
            let exact = slow_average(&image, window, target, (x, y));
            for (&level, exact) in colour.0.iter().zip(exact) {
                prop_assert!((f64::from(level) - exact).abs() < 0.5 + 1e-9, "{level} for {exact}");
            }
        }
    }

    #[test]
    fn the_window_fits_is_centred_and_has_the_targets_shape(
        source in (1..5000_u32, 1..5000_u32),
        target in (1..500_u32, 1..500_u32),
    ) {
        let window = CropWindow::centred(source, target).unwrap();
        prop_assert!(window.width == source.0 || window.height == source.1);
        for (at, length, whole) in
            [(window.x, window.width, source.0), (window.y, window.height, source.1)]
        {
            prop_assert!(length >= 1 && at + length <= whole);
            prop_assert!((whole - length - at).abs_diff(at) <= 1);
        }
        let [w, h] = [window.width, window.height].map(f64::from);
        let [tw, th] = [target.0, target.1].map(f64::from);
        let off = if window.width == source.0 { h - w * th / tw } else { w - h * tw / th };
        prop_assert!(off.abs() <= 1.0);
    }
}

#[test]
fn known_windows() {
    let window = |source| CropWindow::centred(source, (120, 90)).unwrap();
    assert_eq!(window((640, 480)), CropWindow { x: 0, y: 0, width: 640, height: 480 });
    assert_eq!(window((640, 360)), CropWindow { x: 80, y: 0, width: 480, height: 360 });
    assert_eq!(window((720, 720)), CropWindow { x: 0, y: 90, width: 720, height: 540 });
}

#[test]
fn a_mask_pixel_is_hand_from_half_coverage_on() {
    let mask = Mask::from(GrayImage::from_raw(4, 2, vec![200, 0, 128, 0, 127, 255, 0, 0]).unwrap());
    assert_eq!(downsample_mask(&mask, 2, 1).unwrap().as_raw(), &[255, 0]);
    assert_eq!(downsample_mask(&mask, 4, 2).unwrap().as_raw(), &[255, 0, 255, 0, 0, 255, 0, 0]);
    let all = Mask::from_fn(7, 5, |_, _| true);
    assert!(downsample_mask(&all, 3, 2).unwrap().iter().all(|&level| level == 255));
}

#[test]
fn an_image_without_pixels_is_an_error() {
    let empty = downsample(&RgbImage::new(0, 5), 4, 3);
    assert_eq!(empty, Err(Error::ImageTooSmall { width: 0, height: 5, minimum: 1 }));
    assert!(downsample(&RgbImage::new(8, 6), 4, 0).is_err());
}
