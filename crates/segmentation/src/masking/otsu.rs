//! Otsu's threshold.

/// The level that splits a histogram into the two classes with the greatest variance between them
/// (Otsu 1979), and the difference of the class means; levels up to the first belong to the lower
/// class. A histogram of one level has no difference.
pub(crate) fn otsu(histogram: &[u32; 256]) -> (u8, f64) {
    let levels = || histogram.iter().zip(0_u32..);
    let count: f64 = histogram.iter().map(|&n| f64::from(n)).sum();
    let sum: f64 = levels().map(|(&n, level)| f64::from(n) * f64::from(level)).sum();
    let (mut best, mut threshold, mut difference) = (0.0, 0, 0.0);
    let (mut below, mut sum_below) = (0.0, 0.0);
    for (&n, level) in levels() {
        below += f64::from(n);
        sum_below += f64::from(n) * f64::from(level);
        let above = count - below;
        if below == 0.0 || above == 0.0 {
            continue;
        }
        let means_apart = (sum - sum_below) / above - sum_below / below;
        let between = below * above * means_apart * means_apart;
        if between > best {
            (best, threshold, difference) = (between, level as u8, means_apart);
        }
    }
    (threshold, difference)
}
