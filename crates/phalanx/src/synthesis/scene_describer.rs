//! Synthetic views: every pose drawn through every camera and described.

use glam::DAffine3;
use phalanx_camera::{Camera, Rig};
use phalanx_hand::{HandShape, Pose};
use phalanx_render::Renderer;
use phalanx_segmentation::{Mask, Silhouette};
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::estimator::observation::Observation;
use crate::features::describer::{Describer, ViewConfig, working_camera};
use crate::images::picture::Picture;
use crate::progress::Progress;
use crate::synthesis::augmentation::make_ragged;
use crate::synthesis::scene::{Scene, SceneSource, SceneView};
use crate::window::Framing;
use crate::window::{DrawnView, DrawnWindows, Window};

/// The shape contexts of one pose: for each camera, its contour points' histograms one after the
/// other.
pub type PoseContexts = Vec<Vec<f32>>;

/// Draws scenes through every camera of a rig and describes the silhouettes, in parallel; the
/// result has one entry per scene, in order.
///
/// # Errors
/// A camera that cannot draw at all; of each scene, that a camera cannot see or describe it.
pub fn describe_each(
    rig: &Rig,
    scenes: &dyn SceneSource,
    view_config: impl Into<ViewConfig>,
    progress: &dyn Progress,
) -> Result<Vec<Result<PoseContexts>>> {
    let describer = SceneDescriber::new(rig, view_config)?;
    progress.begin("render and describe", scenes.count());
    let describe = |describer: &mut SceneDescriber, pose: usize| {
        let contexts = describer.contexts(&scenes.scene(pose));
        progress.step();
        contexts.map_err(|reason| Error::TrainingPose { pose, reason: Box::new(reason) })
    };
    Ok((0..scenes.count()).into_par_iter().map_init(|| describer.clone(), describe).collect())
}

/// Draws a posed hand as one camera's silhouette at
/// [`WORKING_SIZE`](crate::WORKING_SIZE): the middle of a picture that has another shape.
/// [`draw_mask`] draws all that the camera sees.
///
/// # Errors
/// A camera that cannot draw.
pub fn draw_silhouette(
    camera: &Camera,
    hand: &HandShape,
    pose: &Pose,
    rest: &DAffine3,
) -> Result<Mask> {
    draw_mask(&working_camera(camera)?, hand, pose, rest)
}

/// Draws a posed hand as one camera sees it, pixel by pixel of the camera's picture.
///
/// # Errors
/// A camera that cannot draw.
pub fn draw_mask(camera: &Camera, hand: &HandShape, pose: &Pose, rest: &DAffine3) -> Result<Mask> {
    let solids = hand.pose(pose, rest).primitives;
    Renderer::new(camera)
        .and_then(|mut renderer| renderer.silhouette(&solids))
        .map(Mask::from)
        .map_err(|reason| Error::Render { camera: camera.name.clone(), reason })
}

/// Draws scenes and describes their silhouettes, one after another in the same memory.
#[derive(Debug, Clone)]
pub struct SceneDescriber {
    view_config: ViewConfig,
    cameras: Vec<Camera>,
    renderers: Vec<Renderer>,
    drawn: Vec<Mask>,
    describer: Describer,
    windows: DrawnWindows,
    silhouettes: Vec<Silhouette>,
}

impl SceneDescriber {
    /// For the cameras of a rig.
    ///
    /// # Errors
    /// A camera that cannot draw.
    pub fn new(rig: &Rig, view_config: impl Into<ViewConfig>) -> Result<Self> {
        let view_config = view_config.into();
        let drawing = |camera: &Camera| match view_config.framing {
            Framing::Picture => working_camera(camera),
            Framing::Window => Ok(camera.clone()),
        };
        let cameras: Vec<Camera> = rig.cameras.iter().map(drawing).collect::<Result<_>>()?;
        let renderer = |camera: &Camera| {
            Renderer::new(camera)
                .map_err(|reason| Error::Render { camera: camera.name.clone(), reason })
        };
        Ok(Self {
            view_config,
            renderers: cameras.iter().map(renderer).collect::<Result<_>>()?,
            drawn: vec![Mask::default(); cameras.len()],
            describer: Describer::default(),
            windows: match view_config.framing {
                Framing::Picture => DrawnWindows::default(),
                Framing::Window => DrawnWindows::new(&cameras)?,
            },
            silhouettes: vec![Silhouette::default(); cameras.len()],
            cameras,
        })
    }

    /// The scene's shape contexts in every camera.
    ///
    /// # Errors
    /// Another number of views than cameras, or one that cannot be seen or described.
    pub fn contexts(&mut self, scene: &Scene) -> Result<PoseContexts> {
        self.see(scene)?;
        let rule = self.view_config.orientation;
        let mut contexts = Vec::with_capacity(self.cameras.len());
        for (camera, silhouette) in self.cameras.iter().zip(&self.silhouettes) {
            let described = self
                .describer
                .contexts(silhouette, rule)
                .map_err(|reason| Error::ShapeContext { camera: camera.name.clone(), reason })?;
            contexts.push(described.values().to_vec());
        }
        Ok(contexts)
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
        self.silhouettes.iter()
    }

    /// The scene's masks, damaged and not cleaned: at [`WORKING_SIZE`](crate::WORKING_SIZE) where whole
    /// pictures are described, and as large as the cameras' pictures where windows are.
    ///
    /// # Errors
    /// Another number of views than cameras.
    pub fn masks(&mut self, scene: &Scene) -> Result<&[Mask]> {
        self.draw(scene)?;
        Ok(&self.drawn)
    }

    /// The scene as an estimator observes it.
    ///
    /// # Errors
    /// Another number of views than cameras, or one that cannot be seen.
    pub fn observation(&mut self, scene: &Scene) -> Result<Observation> {
        let windows = self.see(scene)?;
        Ok(match self.view_config.framing {
            Framing::Picture => Observation::of_silhouettes(&self.silhouettes),
            Framing::Window => Observation::through_windows(&self.silhouettes, &windows),
        })
    }

    /// Sees a scene; returns the windows that it is seen through, if it is.
    pub(crate) fn see(&mut self, scene: &Scene) -> Result<Vec<Window>> {
        match self.view_config.framing {
            Framing::Picture => {
                self.draw(scene)?;
                let views = self.cameras.iter().zip(&self.drawn).zip(&mut self.silhouettes);
                for ((camera, drawn), silhouette) in views {
                    let seen = self.describer.silhouette(Picture::Mask(drawn), silhouette);
                    seen.map_err(|reason| Error::Silhouette {
                        camera: camera.name.clone(),
                        reason,
                    })?;
                }
                Ok(Vec::new())
            }
            Framing::Window => {
                self.check(scene)?;
                let drawn = |view: &SceneView| DrawnView {
                    solids: scene.hand.pose(&scene.pose, &view.rest).primitives,
                    ragged: view.ragged,
                };
                let views: Vec<DrawnView> = scene.views.iter().map(drawn).collect();
                self.windows.silhouettes(&views, &mut self.silhouettes)
            }
        }
    }

    fn check(&self, scene: &Scene) -> Result<()> {
        let (found, expected) = (scene.views.len(), self.cameras.len());
        if found != expected {
            return Err(Error::Mismatch { part: "views of the scene", found, expected });
        }
        Ok(())
    }

    /// Draws the scene in every camera, ragged where it is.
    fn draw(&mut self, scene: &Scene) -> Result<()> {
        self.check(scene)?;
        let renderers = self.renderers.iter_mut().zip(&self.cameras).zip(&mut self.drawn);
        for (((renderer, camera), drawn), view) in renderers.zip(&scene.views) {
            let solids = scene.hand.pose(&scene.pose, &view.rest).primitives;
            renderer
                .silhouette_into(&solids, drawn)
                .map_err(|reason| Error::Render { camera: camera.name.clone(), reason })?;
            if let Some(seed) = view.ragged {
                make_ragged(drawn, seed);
            }
        }
        Ok(())
    }
}
