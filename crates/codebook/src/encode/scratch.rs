use crate::distance::support::Support;
use crate::encode::nearest::Rank;

/// The memory that coding needs, kept from one call to the next.
#[derive(Debug, Clone, Default)]
pub struct Scratch {
    pub(crate) support: Support,
    pub(crate) distances: Vec<f32>,
    pub(crate) ranks: Vec<Rank>,
    pub(crate) weights: Vec<f64>,
}
