//! Means over squares of a picture.

/// The mean over squares, as far as they are in the picture, of a side of `2 radius + 1` pixels.
pub(super) fn box_mean(values: &[f64], width: usize, radius: usize) -> Vec<f64> {
    let along_rows = line_means(values, (width, 1), radius);
    line_means(&along_rows, (values.len() / width.max(1), width), radius)
}

/// The mean over the neighbours up to a radius away along lines of some length whose values are a stride apart.
fn line_means(values: &[f64], (length, stride): (usize, usize), radius: usize) -> Vec<f64> {
    let mut means = vec![0.0; values.len()];
    let block = length * stride;
    let starts = (0..values.len()).step_by(block.max(1));
    for first in starts.flat_map(|block| block..block + stride) {
        let at = |k: usize| first + k * stride;
        let mut sum: f64 = (0..radius.min(length)).map(|k| values[at(k)]).sum();
        for k in 0..length {
            if k + radius < length {
                sum += values[at(k + radius)];
            }
            if k > radius {
                sum -= values[at(k - radius - 1)];
            }
            let count = (k + radius + 1).min(length) - k.saturating_sub(radius);
            means[at(k)] = sum / count as f64;
        }
    }
    means
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #![proptest_config(crate::property::cases(64))]

        #[test]
        fn running_sums_are_the_means_of_squares(
            (width, values) in (1_usize..9, 0_usize..9).prop_flat_map(|(width, height)| {
                (Just(width), prop::collection::vec(-9.0..9.0_f64, width * height))
            }),
            radius in 0_usize..12,
        ) {
            let means = box_mean(&values, width, radius);
            prop_assert_eq!(means.len(), values.len());
            for (at, mean) in means.iter().enumerate() {
                let is_near = |k: &usize| {
                    (k / width).abs_diff(at / width) <= radius
                        && (k % width).abs_diff(at % width) <= radius
                };
                let near: Vec<usize> = (0..values.len()).filter(is_near).collect();
                let slow = near.iter().map(|&k| values[k]).sum::<f64>() / near.len() as f64;
                prop_assert!((mean - slow).abs() < 1e-9, "{} is not {}", mean, slow);
            }
        }
    }
}
