//! Pictures in and out: decoding, segmenting, drawing over.

pub(crate) mod decode;
pub(crate) mod overlay;
pub(crate) mod picture;
