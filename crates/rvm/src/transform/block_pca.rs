//! Principal components of blocks of inputs.

use faer::{Mat, MatRef};
use rayon::prelude::*;

use crate::data::check;
use crate::error::Result;
use crate::transform::affine_map::AffineMap;
use crate::transform::pca::{FeatureBlock, Pca, of_blocks};

/// Principal components of blocks of inputs, concatenated. Each block is scaled to a total variance
/// of 1, whatever the number and units of its inputs.
///
/// ```
/// use phalanx_rvm::{BlockPca, FeatureBlock, faer::Mat};
///
/// # fn main() -> phalanx_rvm::Result<()> {
/// let x = Mat::from_fn(5, 100, |i, t| ((t * (3 + i * i)) as f64 * 0.618).fract());
/// let blocks = [FeatureBlock { inputs: 2, components: 1 }, FeatureBlock { inputs: 3, components: 3 }];
/// let components = BlockPca::fit(x.as_ref(), &blocks)?;
/// let z = components.apply(x.as_ref())?;
/// assert_eq!(z.shape(), (4, 100));
/// assert!((z.row(0).squared_norm_l2() / 100.0 - 1.0).abs() < 1e-3);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(transparent))]
pub struct BlockPca {
    blocks: Vec<AffineMap>,
}

impl BlockPca {
    /// Fits X (K×I), whose rows are made up of `blocks`.
    pub fn fit(x: MatRef<'_, f64>, blocks: &[FeatureBlock]) -> Result<Self> {
        Self::of(&of_blocks(x, blocks)?)
    }

    /// The maps of some components.
    pub(crate) fn of(parts: &[Pca]) -> Result<Self> {
        let map = |part: &Pca| AffineMap::about(&part.mean, part.matrix.as_ref());
        Ok(Self { blocks: parts.iter().map(map).collect::<Result<_>>()? })
    }

    /// Assembles the maps of the blocks, in the order of their inputs.
    pub fn from_parts(blocks: Vec<AffineMap>) -> Self {
        Self { blocks }
    }

    /// The maps of the blocks.
    pub fn blocks(&self) -> &[AffineMap] {
        &self.blocks
    }

    /// Length K of an input.
    pub fn inputs(&self) -> usize {
        // A map without outputs may claim any number of inputs.
        self.blocks.iter().map(AffineMap::inputs).fold(0, usize::saturating_add)
    }

    /// Number of components of all blocks.
    pub fn outputs(&self) -> usize {
        self.blocks.iter().map(AffineMap::outputs).sum()
    }

    /// The components of one input `x`, all finite. `single` is working memory.
    pub fn apply_into(&self, x: &[f64], single: &mut Vec<f32>, z: &mut Vec<f64>) -> Result<()> {
        check::length("inputs", self.inputs(), x.len())?;
        z.clear();
        let mut rest = x;
        for block in &self.blocks {
            let own;
            (own, rest) = rest.split_at(block.inputs());
            block.append(own, single, z)?;
        }
        Ok(())
    }

    /// The components of each column of `x`, K×n. The numbers are those of
    /// [`apply_into`](Self::apply_into).
    pub fn apply(&self, x: MatRef<'_, f64>) -> Result<Mat<f64>> {
        let of = |(single, input): &mut (Vec<f32>, Vec<f64>), i: usize| {
            input.clear();
            input.extend(x.col(i).iter());
            let mut z = Vec::with_capacity(self.outputs());
            self.apply_into(input, single, &mut z)?;
            Ok(z)
        };
        let columns = (0..x.ncols()).into_par_iter().map_init(Default::default, of);
        let columns = columns.collect::<Result<Vec<_>>>()?;
        Ok(Mat::from_fn(self.outputs(), x.ncols(), |k, i| columns[i][k]))
    }
}
