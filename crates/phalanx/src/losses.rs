//! Scenes that a training could not use, and why.

use std::collections::BTreeMap;
use std::fmt::{self, Display, Formatter};

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

/// Scenes that a training could not use, by camera and reason.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Losses(BTreeMap<(String, LossReason), Loss>);

/// Why a scene cannot be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[non_exhaustive]
pub enum LossReason {
    /// The hand cannot be drawn.
    NotDrawn,
    /// There is no hand in the picture, or no contour of it.
    NoHand,
    /// The forearm cannot be told from the fingers.
    NoForearm,
    /// There is no window on the hand.
    NoWindow,
    /// The contour has no shape contexts.
    NoShapeContexts,
    /// Anything else.
    Other,
}

/// Scenes that one camera loses for one reason.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Loss {
    scenes: usize,
    /// The first of them, and what was wrong with it.
    first: usize,
    message: String,
}

impl Losses {
    /// The largest share of scenes that a training may lose. Beyond it what is learnt from is no longer
    /// what was asked for; drawn hands before sensible cameras lose some in a thousand.
    pub const MOST: f64 = 0.05;

    /// How many scenes are lost.
    pub fn count(&self) -> usize {
        self.0.values().fold(0, |sum, loss| sum.saturating_add(loss.scenes))
    }

    /// The camera, the reason and the number of scenes of each kind of loss; no camera where it is none
    /// that loses them.
    pub fn iter(&self) -> impl Iterator<Item = (&str, LossReason, usize)> {
        self.0.iter().map(|((camera, reason), loss)| (camera.as_str(), *reason, loss.scenes))
    }

    /// The first scene that is lost, and why.
    pub fn first(&self) -> Option<(usize, &str)> {
        let first = self.0.values().min_by_key(|loss| loss.first)?;
        Some((first.first, &first.message))
    }

    /// One more scene that is lost.
    pub(crate) fn add(&mut self, scene: usize, error: &Error) {
        let error = match error {
            Error::TrainingPose { reason, .. } => reason,
            error => error,
        };
        let (camera, reason) = kind(error);
        let loss = Loss { scenes: 1, first: scene, message: error.to_string() };
        self.join((camera.to_owned(), reason), loss);
    }

    /// The losses of another part of the same training.
    pub(crate) fn merge(&mut self, other: Self) {
        for (kind, loss) in other.0 {
            self.join(kind, loss);
        }
    }

    fn join(&mut self, kind: (String, LossReason), other: Loss) {
        let Some(loss) = self.0.get_mut(&kind) else {
            self.0.insert(kind, other);
            return;
        };
        loss.scenes = loss.scenes.saturating_add(other.scenes);
        if other.first < loss.first {
            (loss.first, loss.message) = (other.first, other.message);
        }
    }

    /// Refuses losses of more than [`MOST`](Self::MOST) of so many scenes.
    pub(crate) fn check(&self, scenes: usize) -> Result<()> {
        let lost = self.count();
        if lost as f64 <= Self::MOST * scenes as f64 {
            return Ok(());
        }
        Err(Error::TooManyLost { lost, scenes, most: Self::MOST, losses: self.to_string() })
    }
}

/// The camera that shows no hand which could be described, and why it is taken not to, if that is the error.
pub(crate) fn not_seen(error: &Error) -> Option<(&str, LossReason)> {
    use phalanx_segmentation::Error as Segmentation;
    let is_of_picture = matches!(
        error,
        Error::Silhouette {
            reason: Segmentation::ImageTooSmall { .. } | Segmentation::SizeMismatch { .. },
            ..
        }
    );
    match kind(error) {
        (_, LossReason::NotDrawn | LossReason::Other) => None,
        _ if is_of_picture => None,
        not_seen => Some(not_seen),
    }
}

fn kind(error: &Error) -> (&str, LossReason) {
    use phalanx_segmentation::Error as Segmentation;
    match error {
        Error::Render { camera, .. } => (camera, LossReason::NotDrawn),
        Error::Silhouette { camera, reason: Segmentation::NoForearm { .. } } => {
            (camera, LossReason::NoForearm)
        }
        Error::Silhouette { camera, .. } => (camera, LossReason::NoHand),
        Error::NoWindow { camera, .. } => (camera, LossReason::NoWindow),
        Error::ShapeContext { camera, .. } => (camera, LossReason::NoShapeContexts),
        _ => ("", LossReason::Other),
    }
}

impl Display for LossReason {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::NotDrawn => "the hand cannot be drawn",
            Self::NoHand => "no hand in the picture",
            Self::NoForearm => "the forearm cannot be told from the fingers",
            Self::NoWindow => "no window on the hand",
            Self::NoShapeContexts => "no shape contexts",
            Self::Other => "the scene is unusable",
        })
    }
}

/// Each kind of loss with its first scene, most scenes first.
impl Display for Losses {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        let mut all: Vec<_> = self.0.iter().collect();
        all.sort_by_key(|(_, loss)| std::cmp::Reverse(loss.scenes));
        for (k, ((camera, reason), Loss { scenes, first, message })) in all.into_iter().enumerate()
        {
            let separator = if k == 0 { "" } else { "; " };
            let camera =
                if camera.is_empty() { String::new() } else { format!("camera '{camera}': ") };
            write!(out, "{separator}{camera}{reason} in {scenes} (scene {first}: {message})")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lost(scene: usize, camera: &str) -> Losses {
        let reason = phalanx_segmentation::Error::NoHand;
        let error = Error::Silhouette { camera: camera.to_owned(), reason };
        let mut losses = Losses::default();
        losses.add(scene, &Error::TrainingPose { pose: scene, reason: Box::new(error) });
        losses
    }

    #[test]
    fn losses_are_counted_by_camera_in_any_order() {
        let parts = [lost(9, "top"), lost(4, "side"), lost(2, "top")];
        let merged = |order: [usize; 3]| {
            order.iter().fold(Losses::default(), |mut losses, &part| {
                losses.merge(parts[part].clone());
                losses
            })
        };
        let losses = merged([0, 1, 2]);
        assert_eq!(losses, merged([2, 1, 0]));
        let kinds: Vec<_> = losses.iter().collect();
        assert_eq!(kinds, [("side", LossReason::NoHand, 1), ("top", LossReason::NoHand, 2)]);
        let text = losses.to_string();
        assert!(text.starts_with("camera 'top': no hand in the picture in 2 (scene 2: "), "{text}");
    }

    #[test]
    fn one_in_twenty_is_borne_and_more_is_not() {
        let mut losses = lost(0, "top");
        assert!(losses.check(20).is_ok());
        losses.merge(lost(1, "top"));
        let message = losses.check(39).unwrap_err().to_string();
        assert!(message.starts_with("2 of 39 training scenes cannot be used"), "{message}");
    }
}
