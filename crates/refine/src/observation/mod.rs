//! What a camera saw: a silhouette, its boundary, and the nearest place of the boundary to each pixel.

pub(crate) mod boundary;
pub(crate) mod distance_transform;
pub(crate) mod silhouette;
#[cfg(test)]
mod tests;
