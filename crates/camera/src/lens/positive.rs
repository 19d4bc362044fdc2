//! Polynomials that stay positive.

/// Whether a polynomial, lowest coefficient first, is positive all the way from 0 to `end` ≥ 0. Where
/// that cannot be told, because it all but touches zero, the answer is no.
///
/// Its coefficients in Bernstein's basis bound it from below; where they do not decide, the interval
/// is halved (de Casteljau).
pub(super) fn is_positive<const N: usize>(coefficients: [f64; N], end: f64) -> bool {
    let mut power = 1.0;
    let scaled = coefficients.map(|c| {
        let term = c * power;
        power *= end;
        term
    });
    if !scaled.iter().all(|c| c.is_finite()) {
        return false;
    }
    let least = scaled[0] + scaled[1..].iter().map(|c| c.min(0.0)).sum::<f64>();
    least > 0.0 || stays(bernstein(scaled), HALVINGS)
}

/// How often an interval is halved before the answer is no: down to the rounding of its ends.
const HALVINGS: u32 = 50;

/// From powers to Bernstein's basis, both on 0 to 1: b_j = Σ_i C(j, i) / C(N − 1, i) a_i.
fn bernstein<const N: usize>(power: [f64; N]) -> [f64; N] {
    let mut result = [0.0; N];
    for (j, b) in result.iter_mut().enumerate() {
        let mut share = 1.0;
        for (i, a) in power.iter().enumerate().take(j + 1) {
            *b += share * a;
            share *= (j - i) as f64 / (N - 1 - i).max(1) as f64;
        }
    }
    result
}

fn stays<const N: usize>(b: [f64; N], halvings: u32) -> bool {
    if b.iter().all(|&c| c > 0.0) {
        return true;
    }
    if b[0] <= 0.0 || b[N - 1] <= 0.0 || halvings == 0 {
        return false;
    }
    let (mut left, mut right) = (b, b);
    for (step, end) in left.iter_mut().enumerate() {
        *end = right[0];
        for i in 0..N - 1 - step {
            right[i] = 0.5 * (right[i] + right[i + 1]);
        }
    }
    stays(left, halvings - 1) && stays(right, halvings - 1)
}

#[cfg(test)]
mod tests {
    use super::is_positive;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::property::cases(256))]

        #[test]
        fn agrees_with_a_search(c in prop::array::uniform7(-2.0..2.0), end in 0.0..3.0_f64) {
            let value = |s: f64| c.iter().rev().fold(0.0, |sum, k| sum * s + k);
            let steps = 4000;
            let least = (0..=steps)
                .map(|i| value(end * f64::from(i) / f64::from(steps)))
                .fold(f64::INFINITY, f64::min);
            // The search may miss a dip between its steps.
            prop_assume!(least.abs() > 1e-2);
            prop_assert_eq!(is_positive(c, end), least > 0.0);
        }
    }

    #[test]
    fn what_touches_zero_or_is_no_number_is_not_positive() {
        assert!(!is_positive([1.0, -2.0, 1.0], 2.0)); // (1 − s)²
        assert!(!is_positive([1.0, -2.0, 1.0], 1.0));
        assert!(is_positive([1.0, -2.0, 1.0], 0.999));
        assert!(!is_positive([1.0, f64::NAN, 0.0], 1.0));
        assert!(!is_positive([1.0, -1.0, 0.0], f64::INFINITY));
    }
}
