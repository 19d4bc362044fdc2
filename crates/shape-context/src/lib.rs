//! Log-polar shape contexts of planar contours, in five orientations
