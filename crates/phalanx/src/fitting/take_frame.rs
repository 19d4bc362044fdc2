//! One moment as all cameras saw it.

use phalanx_hand::Landmarks;
use phalanx_segmentation::Mask;

/// What each camera saw at one time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TakeFrame {
    /// One for each camera: a mask in which hand is over 127, a scaled copy of the camera's image; `None` of
    /// a camera that has none.
    pub masks: Vec<Option<Mask>>,
    /// What a detector saw of the hand, if there is one: for each camera the points in the pixels of its
    /// image; `None` of a camera whose picture they lack in. Empty without a detector.
    pub landmarks: Vec<Option<Landmarks>>,
    /// When that was, s after any moment that all frames of a take share; `None` where nobody knows.
    pub seconds: Option<f64>,
}

impl TakeFrame {
    /// Masks alone, one for each camera.
    pub fn of_masks(masks: Vec<Option<Mask>>) -> Self {
        Self { masks, ..Self::default() }
    }

    /// Landmarks alone, one for each camera.
    pub fn of_landmarks(landmarks: Vec<Option<Landmarks>>) -> Self {
        Self { masks: vec![None; landmarks.len()], landmarks, seconds: None }
    }

    /// The same at a time, s.
    #[must_use]
    pub fn at(self, seconds: f64) -> Self {
        Self { seconds: Some(seconds), ..self }
    }
}
