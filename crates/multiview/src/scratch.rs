//! Working memory.

/// Memory that describing one sample after another uses again.
#[derive(Debug, Clone, Default)]
pub struct Scratch {
    pub(crate) coding: phalanx_codebook::Scratch,
    /// All views' shape contexts, one after the other.
    pub(crate) pool: Vec<f32>,
}
