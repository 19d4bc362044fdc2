//! From a photograph of a bare hand to its silhouette and ordered contour
