//! Which cameras an estimator answers from.

use serde::{Deserialize, Serialize};

/// Which cameras an estimator answers from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Cameras {
    /// Any of the rig's, if it is learnt with a [`LearntMetric`](crate::LearntMetric) or a
    /// [`NetworkTraining`](crate::NetworkTraining); else all. It is the same estimator of all.
    #[default]
    Any,
    /// All of them, and no fewer. That is learnt in less time.
    All,
}
