//! Renders a hand of spheres, cones and generalised cylinders through a calibrated camera
