//! Synthetic views: every pose drawn through every camera and described.

use glam::DAffine3;
use image::GrayImage;
use phalanx_camera::{Camera, Rig};
use phalanx_hand::{HandShape, Pose};
use phalanx_render::Renderer;
use phalanx_segmentation::Silhouette;
use rayon::prelude::*;

use crate::damage::make_ragged;
use crate::{
    Describer, Error, NominalScenes, OrientationRule, Picture, Progress, Result, Scene, Scenes,
    View, WORKING_SIZE, working_camera,
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
    describe_each(rig, &NominalScenes { rig, hand, poses }, rule, progress)?.into_iter().collect()
}

/// Draws scenes through every camera of a rig and describes the silhouettes, in parallel; the
/// result has one entry per scene, in order.
///
/// # Errors
/// A camera that cannot draw at all; of each scene, that a camera cannot see or describe it.
pub fn describe_each(
    rig: &Rig,
    scenes: &dyn Scenes,
    rule: OrientationRule,
    progress: &dyn Progress,
) -> Result<Vec<Result<PoseContexts>>> {
    let describer = SceneDescriber::new(rig, rule)?;
    progress.begin("render and describe", scenes.count());
    let describe = |describer: &mut SceneDescriber, pose: usize| {
        let contexts = describer.contexts(&scenes.scene(pose));
        progress.step();
        contexts.map_err(|reason| Error::TrainingPose { pose, reason: Box::new(reason) })
    };
    Ok((0..scenes.count()).into_par_iter().map_init(|| describer.clone(), describe).collect())
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

/// Draws scenes and describes their silhouettes, one after another in the same memory.
#[derive(Debug, Clone)]
pub struct SceneDescriber {
    rule: OrientationRule,
    views: Vec<ViewDescriber>,
}

/// What one camera sees.
#[derive(Debug, Clone)]
struct ViewDescriber {
    name: String,
    renderer: Renderer,
    drawn: GrayImage,
    describer: Describer,
    silhouette: Silhouette,
}

impl SceneDescriber {
    /// For the cameras of a rig.
    ///
    /// # Errors
    /// A camera that cannot draw.
    pub fn new(rig: &Rig, rule: OrientationRule) -> Result<Self> {
        let views = rig.cameras.iter().map(ViewDescriber::new).collect::<Result<_>>()?;
        Ok(Self { rule, views })
    }

    /// The scene's shape contexts in every camera.
    ///
    /// # Errors
    /// Another number of views than cameras, or one that cannot be seen or described.
    pub fn contexts(&mut self, scene: &Scene) -> Result<PoseContexts> {
        self.see(scene)?;
        self.views.iter_mut().map(|view| view.contexts(self.rule)).collect()
    }

    /// The scene's silhouettes in every camera, as they are described: damaged, and cleaned again.
    ///
    /// # Errors
    /// Another number of views than cameras, or one that cannot be seen.
    pub fn silhouettes<'a>(
        &'a mut self,
        scene: &Scene,
    ) -> Result<impl Iterator<Item = &'a Silhouette> + use<'a>> {
        self.see(scene)?;
        Ok(self.seen())
    }

    /// The silhouettes of the scene last seen.
    pub(crate) fn seen(&self) -> impl Iterator<Item = &Silhouette> + Clone {
        self.views.iter().map(|view| &view.silhouette)
    }

    pub(crate) fn see(&mut self, scene: &Scene) -> Result<()> {
        let (found, expected) = (scene.views.len(), self.views.len());
        if found != expected {
            return Err(Error::Mismatch { part: "views of the scene", found, expected });
        }
        let mut views = self.views.iter_mut().zip(&scene.views);
        views.try_for_each(|(describer, view)| describer.see(scene, view))
    }
}

impl ViewDescriber {
    fn new(camera: &Camera) -> Result<Self> {
        let name_camera = |reason| Error::Render { camera: camera.name.clone(), reason };
        Ok(Self {
            name: camera.name.clone(),
            renderer: Renderer::new(&working_camera(camera)?).map_err(name_camera)?,
            drawn: GrayImage::new(WORKING_SIZE.0, WORKING_SIZE.1),
            describer: Describer::default(),
            silhouette: Silhouette::default(),
        })
    }

    fn see(&mut self, scene: &Scene, view: &View) -> Result<()> {
        let camera = || self.name.clone();
        let solids = scene.hand.pose(&scene.pose, &view.rest).primitives;
        self.renderer
            .silhouette_into(&solids, &mut self.drawn)
            .map_err(|reason| Error::Render { camera: camera(), reason })?;
        if let Some(seed) = view.ragged {
            make_ragged(&mut self.drawn, seed);
        }
        self.describer
            .silhouette(Picture::Mask(&self.drawn), &mut self.silhouette)
            .map_err(|reason| Error::Silhouette { camera: camera(), reason })
    }

    fn contexts(&mut self, rule: OrientationRule) -> Result<Vec<f32>> {
        self.describer
            .contexts(&self.silhouette, rule)
            .map(|contexts| contexts.values().to_vec())
            .map_err(|reason| Error::ShapeContext { camera: self.name.clone(), reason })
    }
}
