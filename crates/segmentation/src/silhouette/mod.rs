//! A hand's silhouette: its contour, and where its forearm ends.

pub(crate) mod contour;
pub(crate) mod extraction;
pub(crate) mod forearm;
pub(crate) mod forearm_end;
