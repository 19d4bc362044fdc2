//! All that was seen in one frame.

use phalanx_camera::Camera;

use crate::observation::landmarks::LandmarkObservation;
use crate::observation::silhouette::SilhouetteObservation;

/// What was seen in one frame: silhouettes, landmarks, or both. Each view of either counts for itself, so that
/// one that contradicts the others counts less, whatever else its camera saw.
#[derive(Debug, Clone, Copy, Default)]
pub struct Evidence<'a> {
    /// A silhouette for each camera that has one.
    pub silhouettes: &'a [SilhouetteObservation],
    /// The points of each camera that has some.
    pub landmarks: &'a [LandmarkObservation],
}

impl Evidence<'_> {
    /// Whether there is nothing.
    pub fn is_empty(&self) -> bool {
        self.views() == 0
    }

    /// How many views of either kind there are.
    pub(crate) fn views(&self) -> usize {
        self.silhouettes.len() + self.landmarks.len()
    }

    /// The cameras, each with the view that stands for its place.
    pub(crate) fn cameras(&self) -> impl Iterator<Item = (usize, &Camera)> {
        let of_silhouettes = self.silhouettes.iter().map(SilhouetteObservation::camera).enumerate();
        let first = self.silhouettes.len();
        let own = move |k: &usize| self.place_of(*k) == first + k;
        let of_landmarks = (0..self.landmarks.len()).filter(own);
        of_silhouettes.chain(of_landmarks.map(move |k| (first + k, self.landmarks[k].camera())))
    }

    /// Which view stands for the place of the camera of some landmarks: that of its silhouette, or their
    /// own, which come after the silhouettes'.
    pub(crate) fn place_of(&self, landmarks: usize) -> usize {
        let name = &self.landmarks[landmarks].camera().name;
        let silhouette = self.silhouettes.iter().position(|seen| seen.camera().name == *name);
        silhouette.unwrap_or(self.silhouettes.len() + landmarks)
    }
}

impl<'a> From<&'a [SilhouetteObservation]> for Evidence<'a> {
    fn from(silhouettes: &'a [SilhouetteObservation]) -> Self {
        Self { silhouettes, landmarks: &[] }
    }
}

impl<'a> From<&'a Vec<SilhouetteObservation>> for Evidence<'a> {
    fn from(silhouettes: &'a Vec<SilhouetteObservation>) -> Self {
        Self::from(silhouettes.as_slice())
    }
}

impl<'a> From<&'a [LandmarkObservation]> for Evidence<'a> {
    fn from(landmarks: &'a [LandmarkObservation]) -> Self {
        Self { silhouettes: &[], landmarks }
    }
}

impl<'a> From<&'a Vec<LandmarkObservation>> for Evidence<'a> {
    fn from(landmarks: &'a Vec<LandmarkObservation>) -> Self {
        Self::from(landmarks.as_slice())
    }
}
