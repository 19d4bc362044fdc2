//! Pictures in and out: decoding, segmenting, drawing over.

pub(crate) mod decode;
mod jpeg;
pub(crate) mod overlay;
pub(crate) mod picture;
pub(crate) mod segmentation_file;
