//! What made a training part, which may decide its last bits.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The version of this crate and the vector instructions of a machine. Parts of unlike makers can be merged,
/// but sums are then rounded in unlike ways, and the model may differ in its last bits from that of one run.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Maker {
    version: String,
    architecture: String,
    instructions: Vec<String>,
}

impl Maker {
    /// This program on this machine.
    pub fn here() -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            architecture: std::env::consts::ARCH.to_owned(),
            instructions: instructions().into_iter().map(str::to_owned).collect(),
        }
    }
}

/// Those that linear algebra chooses its kernels by.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
fn instructions() -> Vec<&'static str> {
    let all = [
        ("sse4.1", is_x86_feature_detected!("sse4.1")),
        ("avx2", is_x86_feature_detected!("avx2")),
        ("fma", is_x86_feature_detected!("fma")),
        ("avx512f", is_x86_feature_detected!("avx512f")),
    ];
    all.into_iter().filter(|(_, has)| *has).map(|(name, _)| name).collect()
}

#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
fn instructions() -> Vec<&'static str> {
    Vec::new()
}

impl fmt::Display for Maker {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { version, architecture, instructions } = self;
        write!(f, "phalanx {version} on {architecture}")?;
        instructions.iter().try_for_each(|name| write!(f, " {name}"))
    }
}
