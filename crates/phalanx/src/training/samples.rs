//! What is kept of scenes one by one.

use std::collections::BTreeMap;

use faer::{Mat, MatRef};
use phalanx_hand::Dof;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

/// Some samples, one after the other.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Samples<T> {
    /// What is kept of each.
    x: Vec<T>,
    /// Poses, 28 numbers each.
    y: Vec<f64>,
}

impl<T> Samples<T> {
    pub(crate) fn new(z: &Mat<f64>, y: &Mat<f64>, number: impl Fn(f64) -> T) -> Self {
        let number = &number;
        let x = z.col_iter().flat_map(|column| column.iter().map(|&value| number(value)));
        let y = y.col_iter().flat_map(|column| column.iter().copied());
        Self { x: x.collect(), y: y.collect() }
    }

    /// All samples of some blocks, one after the other.
    pub(crate) fn of_blocks(blocks: BTreeMap<usize, Self>) -> Self {
        let count = |length: fn(&Self) -> usize| blocks.values().map(length).sum();
        let mut x = Vec::with_capacity(count(|samples| samples.x.len()));
        let mut y = Vec::with_capacity(count(|samples| samples.y.len()));
        for mut samples in blocks.into_values() {
            x.append(&mut samples.x);
            y.append(&mut samples.y);
        }
        Self { x, y }
    }

    /// What is kept of each, so many numbers, and the poses; a column each.
    pub(crate) fn columns(&self, read: usize) -> (MatRef<'_, T>, MatRef<'_, f64>) {
        let count = self.y.len() / Dof::COUNT;
        (
            MatRef::from_column_major_slice(&self.x, read, count),
            MatRef::from_column_major_slice(&self.y, Dof::COUNT, count),
        )
    }

    /// Refuses blocks that are not held, or not of so many samples.
    pub(crate) fn check(
        blocks: &BTreeMap<usize, Self>,
        read: usize,
        held: &[usize],
        samples: Option<usize>,
    ) -> Result<()> {
        let foreign = |part, found, expected| Err(Error::Mismatch { part, found, expected });
        if let Some(&block) = blocks.keys().find(|block| held.binary_search(block).is_err()) {
            return foreign("the number of a block of samples", block, held.len());
        }
        let found = blocks.values().map(|samples| samples.count(read)).sum::<Option<usize>>();
        if found.is_some() && found == samples {
            return Ok(());
        }
        foreign("samples", found.unwrap_or(0), samples.unwrap_or(0))
    }

    /// How many there are, if they are whole.
    pub(crate) fn count(&self, read: usize) -> Option<usize> {
        let count = self.y.len() / Dof::COUNT;
        let whole =
            self.y.len() == count * Dof::COUNT && Some(self.x.len()) == count.checked_mul(read);
        whole.then_some(count)
    }
}
