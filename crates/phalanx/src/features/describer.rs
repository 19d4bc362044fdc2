//! From one camera's picture to its shape contexts (§ 2 of the paper).

use phalanx_camera::{Camera, Intrinsics};
use phalanx_segmentation::{
    Cleanup, CropWindow, MIN_SIDE, Mask, Silhouette, clean_into, downsample, downsample_mask,
};
use phalanx_shape_context::{Descriptors, Orientation, ShapeContexts};
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::features::outline::{chain, trace_outline};
use crate::images::picture::Picture;
use crate::window::framing::Framing;

/// The size at which pictures are described, width and height: the paper's 90 × 120 pixels.
pub const WORKING_SIZE: (u32, u32) = (120, 90);

/// Which way shape contexts are turned; the rules of
/// [`Orientation`], without what a contour adds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[non_exhaustive]
pub enum OrientationRule {
    /// The image's axes.
    ImageAxes,
    /// The contour's tangent at each point.
    Tangent,
    /// The line to the contour's centroid at each point.
    Centroid,
    /// The contour's principal axis.
    PrincipalAxis,
    /// From the forearm's end to the hand's tip: the paper's rule.
    HandAxis,
    /// The forearm's axis, by its two sides. The contour's points are then taken at equal steps and
    /// ahead of a cut squarely across the forearm, so that a rolled camera sees the same ones.
    #[default]
    ForearmAxis,
}

/// How pictures are looked at. Whoever asks for an [`OrientationRule`] alone gets whole pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct ViewConfig {
    /// Which way shape contexts are turned.
    pub orientation: OrientationRule,
    /// What of the pictures is described.
    pub framing: Framing,
}

impl From<OrientationRule> for ViewConfig {
    fn from(orientation: OrientationRule) -> Self {
        Self { orientation, framing: Framing::default() }
    }
}

impl OrientationRule {
    /// The points that are described, and their orientation.
    fn of<'a>(
        self,
        silhouette: &'a Silhouette,
        outline: &'a mut Vec<[f64; 2]>,
    ) -> Result<(&'a [[f64; 2]], Orientation), phalanx_shape_context::Error> {
        let orientation = match self {
            Self::ImageAxes => Orientation::ImageAxes,
            Self::Tangent => Orientation::Tangent { chain: chain(silhouette) },
            Self::Centroid => Orientation::Centroid,
            Self::PrincipalAxis => Orientation::PrincipalAxis,
            Self::HandAxis => Orientation::HandAxis { forearm_end: silhouette.forearm.end },
            Self::ForearmAxis => {
                let direction = trace_outline(silhouette, outline)?.direction;
                return Ok((outline, Orientation::ForearmAxis { direction }));
            }
        };
        Ok((&silhouette.contour.points, orientation))
    }
}

/// The camera as it sees pictures brought to [`WORKING_SIZE`]: the centred window of the right
/// shape, scaled.
///
/// # Errors
/// What the camera says of the window.
pub fn working_camera(camera: &Camera) -> Result<Camera> {
    let Intrinsics { width, height, .. } = camera.intrinsics;
    let window = CropWindow::centred((width, height), WORKING_SIZE)
        .map_err(|reason| Error::Silhouette { camera: camera.name.clone(), reason })?;
    let cropped = camera.intrinsics.cropped(window.x, window.y, window.width, window.height)?;
    Ok(camera.with_intrinsics(cropped.resized(WORKING_SIZE.0, WORKING_SIZE.1)))
}

/// Describes one picture after another in the same memory.
#[derive(Debug, Clone, Default)]
pub struct Describer {
    cleaning: phalanx_segmentation::Workspace,
    cleaned: Mask,
    outline: Vec<[f64; 2]>,
    contexts: ShapeContexts,
}

impl Describer {
    /// The silhouette of a picture: brought to [`WORKING_SIZE`] by its centred window of that
    /// shape, segmented, cleaned, traced. After an error its content means nothing.
    ///
    /// # Errors
    /// A side shorter than [`MIN_SIDE`], no hand, no contour, no forearm: as
    /// [`phalanx_segmentation::Error`] names them.
    pub fn silhouette(
        &mut self,
        picture: Picture<'_>,
        silhouette: &mut Silhouette,
    ) -> Result<(), phalanx_segmentation::Error> {
        let (width, height) = picture.size();
        if width.min(height) < MIN_SIDE {
            let minimum = MIN_SIDE;
            return Err(phalanx_segmentation::Error::ImageTooSmall { width, height, minimum });
        }
        let (width, height) = WORKING_SIZE;
        let mask = match picture {
            Picture::Mask(mask) => downsample_mask(mask, width, height)?,
            Picture::Photograph(image, segmenter) => {
                segmenter.segment(&downsample(image, width, height)?)?
            }
        };
        self.silhouette_of_mask(&mask, silhouette)
    }

    /// The silhouette of a raw mask of any size, as it is: cleaned and traced. After an error its
    /// content means nothing.
    ///
    /// # Errors
    /// No hand, no contour, no forearm: as [`phalanx_segmentation::Error`] names them.
    pub fn silhouette_of_mask(
        &mut self,
        mask: &Mask,
        silhouette: &mut Silhouette,
    ) -> Result<(), phalanx_segmentation::Error> {
        clean_into(mask, &Cleanup::default(), &mut self.cleaning, &mut self.cleaned)?;
        silhouette.extract_into(&self.cleaned, &mut self.cleaning)
    }

    /// The shape contexts of a silhouette's contour points: its pixels, or what
    /// [`OrientationRule::ForearmAxis`] takes instead.
    ///
    /// # Errors
    /// A contour that is too short, or whose orientation is undefined.
    pub fn contexts(
        &mut self,
        silhouette: &Silhouette,
        rule: OrientationRule,
    ) -> Result<Descriptors<'_>, phalanx_shape_context::Error> {
        let (points, orientation) = rule.of(silhouette, &mut self.outline)?;
        self.contexts.compute(points, orientation)
    }
}
