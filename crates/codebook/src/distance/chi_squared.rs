/// The χ² statistic of two histograms, ½ Σ (a − b)² / (a + b) with 0/0 = 0 (Puzicha, Hofmann and
/// Buhmann, 1997; Belongie, Malik and Puzicha, 2002, section 3): between 0 and 1 when both sum to
/// 1, and already a square, as its root is a metric.
///
/// Bins beyond the end of the shorter histogram are not looked at.
///
/// ```
/// use phalanx_codebook::chi_squared;
///
/// assert_eq!(chi_squared(&[1.0, 0.0], &[0.0, 1.0]), 1.0); // nothing in common
/// assert_eq!(chi_squared(&[0.5, 0.5], &[0.5, 0.5]), 0.0);
/// ```
pub fn chi_squared(a: &[f32], b: &[f32]) -> f64 {
    let term = |(&a, &b): (&f32, &f32)| {
        let (a, b) = (f64::from(a), f64::from(b));
        if a + b > 0.0 { (a - b) * (a - b) / (a + b) } else { 0.0 }
    };
    0.5 * a.iter().zip(b).map(term).sum::<f64>()
}
