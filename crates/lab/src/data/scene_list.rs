//! Scenes that are all at hand.

use phalanx::{Scene, SceneSource};

/// A list of scenes to draw and describe.
pub(crate) struct SceneList(pub(crate) Vec<Scene>);

impl SceneSource for SceneList {
    fn count(&self) -> usize {
        self.0.len()
    }

    fn scene(&self, number: usize) -> Scene {
        self.0[number].clone()
    }
}
