//! What cameras saw: a silhouette, its boundary, and the nearest place of the boundary to each pixel; a
//! detector's landmarks.

pub(crate) mod boundary;
pub(crate) mod distance_transform;
pub(crate) mod evidence;
pub(crate) mod landmarks;
pub(crate) mod silhouette;
#[cfg(test)]
mod tests;
