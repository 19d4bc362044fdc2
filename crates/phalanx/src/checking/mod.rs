//! Whether an answer explains what was seen, and if not, why.

pub(crate) mod doubt;
pub(crate) mod doubts;
pub(crate) mod explain;
pub(crate) mod quick_fit;
pub(crate) mod redraw;
pub(crate) mod usual;
