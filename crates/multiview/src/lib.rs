//! Joins the silhouette descriptors of several cameras
