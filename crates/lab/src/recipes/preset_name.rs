//! The presets by name.

use clap::ValueEnum;
use phalanx::Preset;

/// The presets by name.
#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum PresetName {
    /// 4,000 scenes.
    Fast,
    /// 120,000 scenes.
    Default,
    /// 240,000 scenes.
    Best,
}

impl PresetName {
    /// The preset.
    pub(crate) fn preset(self) -> Preset {
        match self {
            Self::Fast => Preset::Fast,
            Self::Default => Preset::Default,
            Self::Best => Preset::Best,
        }
    }
}
