//! How many vectors are compared together.

/// Vectors that are compared together.
pub(crate) const LANES: usize = 16;

/// One number for each vector of a block.
pub(crate) type Lanes = [f32; LANES];
