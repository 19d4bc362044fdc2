//! The table's regressors as § 5.2 uses them: at given counts, learnt from one half of a split.

use anyhow::{Context, Result};
use phalanx_rvm::Model;

use crate::data::described::{Described, Halves};
use crate::eval::table1::{PaperCounts, TableMethod};

/// A split of a data set as some cameras see it, with the models learnt from its first half.
pub(super) struct Trial {
    pub(super) halves: Halves,
    /// One for each method.
    pub(super) models: Vec<Model>,
}

impl Trial {
    /// The even split of this seed, and every method fitted at these counts.
    pub(super) fn new(
        described: &Described,
        views: &[usize],
        counts: PaperCounts,
        methods: &[TableMethod],
        seed: u64,
    ) -> Result<Self> {
        let halves = described.halves(views, seed)?;
        let fit = |method: &TableMethod| -> Result<Model> {
            let regressor = method.regressor(counts).context("it fits nothing")?;
            Ok(regressor.fit(&halves.train.x, &halves.train.y)?.model)
        };
        let named = |method: &TableMethod| fit(method).context(method.name());
        let models = methods.iter().map(named).collect::<Result<_>>()?;
        Ok(Self { halves, models })
    }
}
