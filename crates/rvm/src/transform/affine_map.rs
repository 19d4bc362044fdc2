//! An affine map in single precision.

use faer::linalg::matmul::matmul;
use faer::{Accum, ColMut, ColRef, Mat, MatRef, Par};

use crate::data::check;
use crate::error::{Error, Result};

/// z = P x + offset, from K inputs to d numbers.
///
/// P is stored in single precision: it is the largest part of a regressor, a prediction reads all
/// of it, and descriptors are not accurate to seven digits.
///
/// ```
/// use phalanx_rvm::{AffineMap, AffineMapParts, faer::mat};
///
/// # fn main() -> phalanx_rvm::Result<()> {
/// let parts = AffineMapParts { inputs: 2, matrix: vec![1.0, -1.0], offset: vec![0.5] };
/// let difference = AffineMap::from_parts(parts)?;
/// assert_eq!(difference.apply(mat![[3.0], [1.0]].as_ref())?, mat![[2.5]]);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "AffineMapParts", into = "AffineMapParts"))]
pub struct AffineMap {
    parts: AffineMapParts,
}

/// What a [`AffineMap`] is made of.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AffineMapParts {
    /// Length K of an input.
    pub inputs: usize,
    /// P, d×K, column by column.
    pub matrix: Vec<f32>,
    /// d numbers.
    pub offset: Vec<f32>,
}

impl AffineMap {
    /// Assembles a map from its parts, which are validated.
    pub fn from_parts(parts: AffineMapParts) -> Result<Self> {
        let expected = parts.inputs.checked_mul(parts.offset.len());
        check::part("matrix", "has the wrong length", Some(parts.matrix.len()) != expected)?;
        let unusable = |values: &[f32]| !values.iter().all(|value| value.is_finite());
        check::part("matrix", "holds an unusable number", unusable(&parts.matrix))?;
        check::part("offset", "holds an unusable number", unusable(&parts.offset))?;
        Ok(Self { parts })
    }

    /// The map that takes `mean` to zero and has this matrix, d×K.
    pub(crate) fn about(mean: &[f64], matrix: MatRef<'_, f64>) -> Result<Self> {
        let columns = matrix.col_iter().zip(mean);
        let mut offset = vec![0.0; matrix.nrows()];
        for (column, mean) in columns {
            offset.iter_mut().zip(column.iter()).for_each(|(sum, value)| *sum -= value * mean);
        }
        Self::affine(matrix, &offset)
    }

    /// The map of this matrix, d×K, and offset.
    pub(crate) fn affine(matrix: MatRef<'_, f64>, offset: &[f64]) -> Result<Self> {
        Self::from_parts(AffineMapParts {
            inputs: matrix.ncols(),
            matrix: matrix
                .col_iter()
                .flat_map(|column| column.iter().map(|&v| v as f32).collect::<Vec<_>>())
                .collect(),
            offset: offset.iter().map(|&v| v as f32).collect(),
        })
    }

    /// The parts, borrowed.
    pub fn parts(&self) -> &AffineMapParts {
        &self.parts
    }

    /// Length K of an input.
    pub fn inputs(&self) -> usize {
        self.parts.inputs
    }

    /// Length d of an output.
    pub fn outputs(&self) -> usize {
        self.parts.offset.len()
    }

    /// z of one input `x`, all finite. `single` is working memory.
    pub fn apply_into(&self, x: &[f64], single: &mut Vec<f32>, z: &mut Vec<f64>) -> Result<()> {
        z.clear();
        self.append(x, single, z)
    }

    /// Appends z of one input.
    pub(crate) fn append(&self, x: &[f64], single: &mut Vec<f32>, z: &mut Vec<f64>) -> Result<()> {
        check::length("inputs", self.inputs(), x.len())?;
        single.clear();
        for (row, &value) in x.iter().enumerate() {
            if !check::usable(value) {
                return Err(Error::BadValue { what: "x", row, column: 0, value });
            }
            single.push(value as f32);
        }
        single.extend_from_slice(&self.parts.offset);
        let (x, out) = single.split_at_mut(self.inputs());
        matmul(
            ColMut::from_slice_mut(out).as_mat_mut(),
            Accum::Add,
            MatRef::from_column_major_slice(&self.parts.matrix, self.outputs(), self.inputs()),
            ColRef::from_slice(x).as_mat(),
            1.0,
            Par::Seq,
        );
        z.extend(out.iter().map(|&value| f64::from(value)));
        Ok(())
    }

    /// z of each column of `x`, K×n. The numbers are those of [`apply_into`](Self::apply_into).
    pub fn apply(&self, x: MatRef<'_, f64>) -> Result<Mat<f64>> {
        let (mut single, mut input) = (Vec::new(), Vec::new());
        let (mut z, mut out) = (Vec::new(), Mat::zeros(self.outputs(), x.ncols()));
        for (i, column) in x.col_iter().enumerate() {
            input.clear();
            input.extend(column.iter().copied());
            self.apply_into(&input, &mut single, &mut z)?;
            out.col_as_slice_mut(i).copy_from_slice(&z);
        }
        Ok(out)
    }
}

impl TryFrom<AffineMapParts> for AffineMap {
    type Error = Error;

    fn try_from(parts: AffineMapParts) -> Result<Self> {
        Self::from_parts(parts)
    }
}

impl From<AffineMap> for AffineMapParts {
    fn from(projection: AffineMap) -> Self {
        projection.parts
    }
}
