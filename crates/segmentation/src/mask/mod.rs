//! Masks of one byte a pixel: votes of neighbours, connected components, sizes.

pub(crate) mod cleanup;
pub(crate) mod components;
pub(crate) mod majority;
pub(crate) mod morphology;
pub(crate) mod resample;
