//! What the cameras showed of a hand.

use phalanx_segmentation::{Forearm, Silhouette};

use crate::window::{Framing, Window};

/// What was seen of a hand, camera by camera in the order of the rig.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// One for each camera.
    pub views: Vec<ObservedView>,
}

/// What one camera showed of a hand.
#[derive(Debug, Clone, PartialEq)]
pub struct ObservedView {
    /// The silhouette as it was described, at [`WORKING_SIZE`](crate::WORKING_SIZE) if it is of a
    /// picture.
    pub silhouette: Silhouette,
    /// The window that the silhouette is seen in, if the estimator looks through windows.
    pub window: Option<Window>,
    /// Width and height of the picture, px; those of the silhouette if no picture was given.
    pub picture: (u32, u32),
}

impl Observation {
    /// Silhouettes without pictures.
    pub fn of_silhouettes(silhouettes: &[Silhouette]) -> Self {
        let view = |silhouette: &Silhouette| ObservedView {
            silhouette: silhouette.clone(),
            window: None,
            picture: silhouette.mask.dimensions(),
        };
        Self { views: silhouettes.iter().map(view).collect() }
    }

    /// Silhouettes that are seen in windows of pictures.
    pub fn through_windows(silhouettes: &[Silhouette], windows: &[Window]) -> Self {
        let view = |(silhouette, window): (&Silhouette, &Window)| ObservedView {
            silhouette: silhouette.clone(),
            window: Some(window.clone()),
            picture: window.picture(),
        };
        Self { views: silhouettes.iter().zip(windows).map(view).collect() }
    }

    /// How the pictures were looked at.
    pub fn framing(&self) -> Framing {
        if self.views.iter().any(|view| view.window.is_some()) {
            Framing::Window
        } else {
            Framing::Picture
        }
    }

    /// The silhouettes.
    pub fn silhouettes(&self) -> impl Iterator<Item = &Silhouette> + Clone {
        self.views.iter().map(|view| &view.silhouette)
    }

    /// Where each view's forearm was found, and by what evidence, at the size of the silhouettes.
    pub fn forearms(&self) -> impl Iterator<Item = &Forearm> {
        self.silhouettes().map(|silhouette| &silhouette.forearm)
    }
}
