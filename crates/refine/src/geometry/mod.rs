//! A posed hand against rays: the primitives, what they pass, and what of them is in the same place.

pub(crate) mod bound;
pub(crate) mod correspondence;
pub(crate) mod drawn_term;
pub(crate) mod self_collision;
pub(crate) mod shape_parameters;
pub(crate) mod sphere_hull;
