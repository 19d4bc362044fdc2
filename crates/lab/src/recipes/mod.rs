//! How models are trained.

pub(crate) mod merge;
pub(crate) mod preset_name;
pub(crate) mod train;

use anyhow::Result;
use phalanx::{Estimator, Progress, SceneSource, Shard, Training};

use crate::data::sets::Set;

/// An estimator, and how many scenes it learnt from.
pub(crate) struct Trained {
    pub(crate) estimator: Estimator,
    pub(crate) samples: usize,
}

/// Trains on the scenes of a set that can be described and, where there is a fresh set, fits the model of
/// its errors to that.
pub(crate) fn trained(
    training: &Training,
    set: &Set<'_>,
    fresh: Option<&Set<'_>>,
    progress: &dyn Progress,
) -> Result<Trained> {
    let part = training.shard(set.rig, set.hand, set, Shard::WHOLE, progress)?;
    let samples = set.count() - part.losses().count();
    let estimator = part.finish(progress)?;
    let estimator = match fresh {
        Some(fresh) => estimator.fit_error_model(fresh, progress)?,
        None => estimator,
    };
    Ok(Trained { estimator, samples })
}
