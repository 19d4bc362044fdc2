//! How long answers may wait.

use serde::{Deserialize, Serialize};

/// How long an answer may wait for what comes after it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Delay {
    /// Each frame is answered from itself and those before it.
    None,
    /// Each frame is answered once the next one is there, in its light.
    #[default]
    OneFrame,
}
