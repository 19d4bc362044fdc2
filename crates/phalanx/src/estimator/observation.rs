//! What the cameras showed of a hand.

use phalanx_camera::Camera;
use phalanx_refine::SilhouetteObservation;
use phalanx_segmentation::{Forearm, Silhouette};

use crate::error::Result;
use crate::features::describer::working_camera;
use crate::view_set::ViewSet;
use crate::window::{Framing, Window};

/// What was seen of a hand, camera by camera in the order of the rig.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// One for each camera that showed it.
    pub views: Vec<ObservedView>,
}

/// What one camera showed of a hand.
#[derive(Debug, Clone, PartialEq)]
pub struct ObservedView {
    /// The number of the camera in the rig.
    pub camera: usize,
    /// The silhouette as it was described, at [`WORKING_SIZE`](crate::WORKING_SIZE) if it is of a
    /// picture.
    pub silhouette: Silhouette,
    /// The window that the silhouette is seen in, if the estimator looks through windows.
    pub window: Option<Window>,
    /// Width and height of the picture, px; those of the silhouette if no picture was given.
    pub picture: (u32, u32),
}

impl ObservedView {
    /// The camera whose whole picture the silhouette is, of a view of this camera of the rig.
    ///
    /// # Errors
    /// A camera without a window of the working size's shape.
    pub fn seeing(&self, camera: &Camera) -> Result<Camera> {
        if let Some(window) = &self.window {
            return Ok(window.camera.clone());
        }
        let camera = working_camera(camera)?;
        let (width, height) = self.silhouette.mask.dimensions();
        Ok(camera.with_intrinsics(camera.intrinsics.resized(width, height)))
    }

    /// What the silhouette tells of the pose.
    ///
    /// # Errors
    /// A silhouette without a border, or a camera as of [`seeing`](Self::seeing).
    pub fn evidence(&self, camera: &Camera) -> Result<SilhouetteObservation> {
        match &self.window {
            Some(window) => window.evidence(&self.silhouette),
            None => Ok(SilhouetteObservation::new(&self.seeing(camera)?, &self.silhouette.mask)?),
        }
    }
}

impl Observation {
    /// Silhouettes without pictures, one for each camera.
    pub fn of_silhouettes(silhouettes: &[Silhouette]) -> Self {
        let view = |(camera, silhouette): (usize, &Silhouette)| ObservedView {
            camera,
            silhouette: silhouette.clone(),
            window: None,
            picture: silhouette.mask.dimensions(),
        };
        Self { views: silhouettes.iter().enumerate().map(view).collect() }
    }

    /// Silhouettes that are seen in windows of pictures, one for each camera.
    pub fn through_windows(silhouettes: &[Silhouette], windows: &[Window]) -> Self {
        let view = |(camera, (silhouette, window)): (usize, (&Silhouette, &Window))| ObservedView {
            camera,
            silhouette: silhouette.clone(),
            window: Some(window.clone()),
            picture: window.picture(),
        };
        Self { views: silhouettes.iter().zip(windows).enumerate().map(view).collect() }
    }

    /// How the pictures were looked at.
    pub fn framing(&self) -> Framing {
        if self.views.iter().any(|view| view.window.is_some()) {
            Framing::Window
        } else {
            Framing::Picture
        }
    }

    /// What is left of it where only some cameras look on.
    pub(crate) fn seen_by(&self, cameras: ViewSet) -> Self {
        let left = self.views.iter().filter(|view| cameras.contains(view.camera));
        Self { views: left.cloned().collect() }
    }

    /// The cameras that showed the hand.
    pub(crate) fn cameras(&self) -> ViewSet {
        ViewSet::of(self.views.iter().map(|view| view.camera))
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
