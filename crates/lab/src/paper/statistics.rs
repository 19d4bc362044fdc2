//! Means over splits and how sure they are.

/// The mean of runs that differ in their seed, and its standard error.
#[derive(Clone, Copy, serde::Serialize)]
pub(super) struct Mean {
    pub(super) value: f64,
    pub(super) standard_error: f64,
}

impl Mean {
    pub(super) fn of(runs: &[f64]) -> Self {
        let count = runs.len() as f64;
        let value = runs.iter().sum::<f64>() / count;
        let squares: f64 = runs.iter().map(|run| (run - value).powi(2)).sum();
        Self { value, standard_error: (squares / (count * (count - 1.0).max(1.0))).sqrt() }
    }

    /// Is it above a bound by more than two standard errors?
    pub(super) fn is_above(self, bound: f64) -> bool {
        self.value - 2.0 * self.standard_error > bound
    }
}

#[cfg(test)]
mod tests {
    use super::Mean;

    #[test]
    fn the_standard_error_is_that_of_a_worked_example() {
        let mean = Mean::of(&[1.0, 2.0, 3.0, 6.0]);
        assert_eq!(mean.value, 3.0);
        let variance: f64 = (4.0 + 1.0 + 0.0 + 9.0) / 3.0;
        assert!((mean.standard_error - (variance / 4.0).sqrt()).abs() < 1e-12);
        assert!(mean.is_above(0.8) && !mean.is_above(0.9));
    }
}
