//! How any number of samples become one vector.

pub(crate) mod any;
pub(crate) mod encoder;
pub(crate) mod fisher;
pub(crate) mod nearest;
pub(crate) mod scratch;
pub(crate) mod soft_assignment;
pub(crate) mod vlad;
