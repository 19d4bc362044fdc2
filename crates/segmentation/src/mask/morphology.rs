//! Erosion and dilation by a square.

/// The darkest level within `radius` pixels to each side and up and down, in rows of `width`.
pub(crate) fn erode(pixels: &[u8], width: usize, radius: usize) -> Vec<u8> {
    over_squares(pixels, width, radius, u8::min)
}

/// The brightest level within `radius` pixels to each side and up and down, in rows of `width`.
pub(crate) fn dilate(pixels: &[u8], width: usize, radius: usize) -> Vec<u8> {
    over_squares(pixels, width, radius, u8::max)
}

fn over_squares(pixels: &[u8], width: usize, radius: usize, of: fn(u8, u8) -> u8) -> Vec<u8> {
    let mut across = pixels.to_vec();
    for (from, to) in pixels.chunks_exact(width).zip(across.chunks_exact_mut(width)) {
        merge_shifted(from, to, 1, radius, of);
    }
    let mut down = across.clone();
    merge_shifted(&across, &mut down, width, radius, of);
    down
}

/// Merges into each place of `to` those of `from` up to `radius` strides before and after it.
fn merge_shifted(from: &[u8], to: &mut [u8], stride: usize, radius: usize, of: fn(u8, u8) -> u8) {
    for shift in (1..=radius).map(|steps| (steps * stride).min(from.len())) {
        let (before, after) = (&from[..from.len() - shift], &from[shift..]);
        to[shift..].iter_mut().zip(before).for_each(|(to, &level)| *to = of(*to, level));
        to.iter_mut().zip(after).for_each(|(to, &level)| *to = of(*to, level));
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #![proptest_config(crate::property::cases(64))]

        #[test]
        fn each_pixel_takes_the_extreme_of_its_square(
            width in 1..9_usize,
            height in 1..9_usize,
            radius in 0..4_usize,
            levels in prop::collection::vec(any::<u8>(), 64),
        ) {
            let pixels = &levels[..width * height];
            let (least, most) = (erode(pixels, width, radius), dilate(pixels, width, radius));
            for place in 0..pixels.len() {
                let (x, y) = (place % width, place / width);
                let near = |at: &usize| {
                    (at % width).abs_diff(x) <= radius && (at / width).abs_diff(y) <= radius
                };
                let square = (0..pixels.len()).filter(near).map(|at| pixels[at]);
                prop_assert_eq!(Some(least[place]), square.clone().min());
                prop_assert_eq!(Some(most[place]), square.max());
            }
        }
    }
}
