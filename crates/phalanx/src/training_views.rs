//! Synthetic views: every pose drawn through every camera and described.

use glam::DAffine3;
use image::GrayImage;
use phalanx_camera::{Camera, Rig};
use phalanx_hand::{HandShape, Pose};
use phalanx_render::Renderer;
use phalanx_segmentation::Silhouette;
use rayon::prelude::*;

use crate::{
    Describer, Error, OrientationRule, Picture, Progress, Result, WORKING_SIZE, working_camera,
};

/// The shape contexts of one pose: for each camera, its contour points' histograms one after the
/// other.
pub type PoseContexts = Vec<Vec<f32>>;

/// Draws `poses` of a hand through every camera of a rig and describes the silhouettes, in
/// parallel; the result has one entry per pose, in order.
///
/// # Errors
/// The first pose, in order, that a camera cannot see or describe.
pub fn describe_poses(
    rig: &Rig,
    hand: &HandShape,
    poses: &[Pose],
    rule: OrientationRule,
    progress: &dyn Progress,
) -> Result<Vec<PoseContexts>> {
    describe_each_pose(rig, hand, poses, rule, progress)?.into_iter().collect()
}

/// [`describe_poses`], with a result for each pose.
///
/// # Errors
/// A camera that cannot draw at all; of each pose, that a camera cannot see or describe it.
pub fn describe_each_pose(
    rig: &Rig,
    hand: &HandShape,
    poses: &[Pose],
    rule: OrientationRule,
    progress: &dyn Progress,
) -> Result<Vec<Result<PoseContexts>>> {
    let cameras = rig.cameras.iter().map(working_camera).collect::<Result<Vec<_>>>()?;
    let views = cameras.iter().map(ViewDescriber::new).collect::<Result<Vec<_>>>()?;
    let rest = rig.volume.rest_frame();
    progress.begin("render and describe", poses.len());
    let describe = |views: &mut Vec<ViewDescriber<'_>>, (pose, numbers): (usize, &Pose)| {
        let solids = hand.pose(numbers, &rest).primitives;
        let contexts: Result<PoseContexts> =
            views.iter_mut().map(|view| view.contexts(&solids, rule)).collect();
        progress.step();
        contexts.map_err(|reason| Error::TrainingPose { pose, reason: Box::new(reason) })
    };
    Ok(poses.par_iter().enumerate().map_init(|| views.clone(), describe).collect())
}

/// Draws a posed hand as one camera's silhouette at [`WORKING_SIZE`].
///
/// # Errors
/// A hand that reaches behind the camera.
pub fn draw_silhouette(
    camera: &Camera,
    hand: &HandShape,
    pose: &Pose,
    rest: &DAffine3,
) -> Result<GrayImage> {
    let camera = working_camera(camera)?;
    let solids = hand.pose(pose, rest).primitives;
    Renderer::new(&camera)
        .and_then(|mut renderer| renderer.silhouette(&solids))
        .map_err(|reason| Error::Render { camera: camera.name.clone(), reason })
}

/// Draws and describes in one camera's memory.
#[derive(Clone)]
struct ViewDescriber<'a> {
    name: &'a str,
    renderer: Renderer,
    drawn: GrayImage,
    describer: Describer,
    silhouette: Silhouette,
}

impl<'a> ViewDescriber<'a> {
    fn new(camera: &'a Camera) -> Result<Self> {
        let name_camera = |reason| Error::Render { camera: camera.name.clone(), reason };
        Ok(Self {
            name: &camera.name,
            renderer: Renderer::new(camera).map_err(name_camera)?,
            drawn: GrayImage::new(WORKING_SIZE.0, WORKING_SIZE.1),
            describer: Describer::default(),
            silhouette: Silhouette::default(),
        })
    }

    fn contexts(
        &mut self,
        solids: &[phalanx_hand::Primitive],
        rule: OrientationRule,
    ) -> Result<Vec<f32>> {
        let camera = || self.name.to_owned();
        self.renderer
            .silhouette_into(solids, &mut self.drawn)
            .map_err(|reason| Error::Render { camera: camera(), reason })?;
        self.describer
            .silhouette(Picture::Mask(&self.drawn), &mut self.silhouette)
            .map_err(|reason| Error::Silhouette { camera: camera(), reason })?;
        self.describer
            .contexts(&self.silhouette, rule)
            .map(|contexts| contexts.values().to_vec())
            .map_err(|reason| Error::ShapeContext { camera: camera(), reason })
    }
}
