//! The fitted estimator: from one picture per camera to a pose.

use glam::DVec3;
use image::GrayImage;
use phalanx_camera::Rig;
use phalanx_hand::{Dof, HandShape, JOINTS, Pose};
use phalanx_rvm::ConditionalDensity;
use phalanx_segmentation::{Forearm, Silhouette};

use crate::global_pose::place;
use crate::{
    Descriptor, Error, Framing, OrientationRule, Picture, Regression, Result, Window, WindowFinder,
    descriptor,
};

/// A pose estimator for one rig and one hand; see [`Training`](crate::Training) for how to get
/// one.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimator {
    rig: Rig,
    hand: HandShape,
    descriptor: Descriptor,
    regression: Regression,
    errors: Option<ConditionalDensity>,
}

/// What is known of a hand after looking at it.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// The pose, radians and millimetres.
    pub pose: Pose,
    /// Predictive standard deviation of each number of the pose, in its unit.
    pub std: [f64; Dof::COUNT],
    /// The 21 joints in the world, mm.
    pub joints: [DVec3; JOINTS],
    /// Where each view's forearm was found, and by what evidence, at the working size.
    pub forearms: Vec<Forearm>,
}

/// Memory that one estimate after another uses again.
#[derive(Debug, Default)]
pub struct Workspace {
    silhouettes: Vec<Silhouette>,
    windows: Vec<Window>,
    memory: Memory,
}

/// What a [`Workspace`] keeps besides the silhouettes.
#[derive(Debug, Default)]
struct Memory {
    windows: WindowFinder,
    description: descriptor::Memory,
    x: Vec<f64>,
    regression: phalanx_rvm::Scratch,
}

impl Workspace {
    /// The silhouettes of the last estimate from pictures, in the order of the cameras; of no
    /// meaning if it failed.
    pub fn silhouettes(&self) -> &[Silhouette] {
        &self.silhouettes
    }

    /// The windows that the last silhouettes are seen in, where the estimator looks through windows;
    /// of no meaning if it failed.
    pub fn windows(&self) -> &[Window] {
        &self.windows
    }
}

impl Estimator {
    /// Puts an estimator together.
    ///
    /// # Errors
    /// Parts that do not fit each other: cameras and codebooks, descriptor and regressor.
    pub fn from_parts(
        rig: Rig,
        hand: HandShape,
        descriptor: Descriptor,
        regression: impl Into<Regression>,
    ) -> Result<Self> {
        rig.validate()?;
        hand.validate()?;
        descriptor.check(&rig)?;
        let regression = regression.into();
        for (part, found, expected) in [
            ("regressor inputs", regression.inputs(), descriptor.dim()),
            ("regressor outputs", regression.outputs(), Dof::COUNT),
        ] {
            if found != expected {
                return Err(Error::Mismatch { part, found, expected });
            }
        }
        Ok(Self { rig, hand, descriptor, regression, errors: None })
    }

    /// The same estimator, knowing how its estimates err.
    ///
    /// # Errors
    /// Errors of something other than poses.
    pub fn with_errors(self, errors: ConditionalDensity) -> Result<Self> {
        let (found, expected) = (errors.outputs(), Dof::COUNT);
        if found != expected {
            return Err(Error::Mismatch { part: "numbers in its errors", found, expected });
        }
        Ok(Self { errors: Some(errors), ..self })
    }

    /// The cameras and the volume it was learnt for.
    pub fn rig(&self) -> &Rig {
        &self.rig
    }

    /// The hand it was learnt for.
    pub fn hand(&self) -> &HandShape {
        &self.hand
    }

    /// What it reads of the silhouettes.
    pub fn descriptor(&self) -> &Descriptor {
        &self.descriptor
    }

    /// Which way its shape contexts are turned.
    pub fn orientation(&self) -> OrientationRule {
        self.descriptor.orientation()
    }

    /// Its regressor.
    pub fn regression(&self) -> &Regression {
        &self.regression
    }

    /// How its estimates err, if it has [learnt it](Self::learn_errors).
    pub fn errors(&self) -> Option<&ConditionalDensity> {
        self.errors.as_ref()
    }

    /// Estimates the pose from one picture per camera, in the order of the rig's cameras.
    ///
    /// # Errors
    /// Another number of pictures, a picture of another shape than its camera's image, or no
    /// hand in one.
    pub fn estimate(
        &self,
        pictures: &[Picture<'_>],
        workspace: &mut Workspace,
    ) -> Result<Estimate> {
        self.check_count(pictures.len())?;
        for (view, picture) in pictures.iter().enumerate() {
            self.check_shape(view, picture.size())?;
        }
        let Workspace { silhouettes, windows, memory } = workspace;
        silhouettes.resize_with(pictures.len(), Silhouette::default);
        windows.clear();
        match self.descriptor.sight().framing {
            Framing::Picture => self.see_whole(pictures, silhouettes, memory)?,
            Framing::Window => {
                let masks = self.masks(pictures)?;
                *windows = memory.windows.find(&self.rig.cameras, &masks, None)?;
                memory.windows.silhouettes(windows, silhouettes)?;
            }
        }
        let estimate = self.look_at(silhouettes, memory)?;
        match self.descriptor.sight().framing {
            Framing::Picture => Ok(estimate),
            Framing::Window => self.place(estimate, windows),
        }
    }

    /// An estimate with the hand where the windows show it that the silhouettes were seen in:
    /// position, θ_X and θ_Y, which what is seen through a window does not tell. Estimates from
    /// pictures are placed already.
    ///
    /// # Errors
    /// As of [`initial_global`](crate::initial_global).
    pub fn place(&self, estimate: Estimate, windows: &[Window]) -> Result<Estimate> {
        place(&self.rig, &self.hand, estimate, windows)
    }

    /// The silhouettes of whole pictures.
    fn see_whole(
        &self,
        pictures: &[Picture<'_>],
        silhouettes: &mut [Silhouette],
        memory: &mut Memory,
    ) -> Result<()> {
        for ((view, &picture), silhouette) in pictures.iter().enumerate().zip(silhouettes) {
            memory
                .description
                .describer
                .silhouette(picture, silhouette)
                .map_err(|reason| Error::Silhouette { camera: self.camera(view), reason })?;
        }
        Ok(())
    }

    /// The raw masks of pictures, as large as they are.
    fn masks(&self, pictures: &[Picture<'_>]) -> Result<Vec<GrayImage>> {
        let mask = |(view, picture): (usize, &Picture<'_>)| {
            picture.mask().map_err(|reason| Error::Silhouette { camera: self.camera(view), reason })
        };
        pictures.iter().enumerate().map(mask).collect()
    }

    /// Estimates the pose from one silhouette per camera, of any size, in the order of the rig's
    /// cameras.
    ///
    /// # Errors
    /// Another number of silhouettes, or one that cannot be described.
    pub fn estimate_silhouettes(
        &self,
        silhouettes: &[Silhouette],
        workspace: &mut Workspace,
    ) -> Result<Estimate> {
        self.check_count(silhouettes.len())?;
        self.look_at(silhouettes, &mut workspace.memory)
    }

    /// The estimate from one silhouette per camera.
    fn look_at(&self, silhouettes: &[Silhouette], memory: &mut Memory) -> Result<Estimate> {
        let Memory { description, x, .. } = memory;
        self.descriptor.describe(&self.rig, silhouettes.iter(), description, x)?;
        let (pose, std) = self.regress(memory)?;
        let joints = self.hand.pose(&pose, &self.rig.volume.rest_frame()).joints;
        let forearms = silhouettes.iter().map(|silhouette| silhouette.forearm).collect();
        Ok(Estimate { pose, std, joints, forearms })
    }

    fn camera(&self, view: usize) -> String {
        self.rig.cameras[view].name.clone()
    }

    fn check_count(&self, found: usize) -> Result<()> {
        let cameras = self.rig.cameras.len();
        if found == cameras {
            return Ok(());
        }
        Err(Error::PictureCount { cameras: (0..cameras).map(|v| self.camera(v)).collect(), found })
    }

    /// The picture must be a scaled copy of the camera's image, to within a pixel.
    fn check_shape(&self, view: usize, found: (u32, u32)) -> Result<()> {
        let intrinsics = &self.rig.cameras[view].intrinsics;
        let expected = (intrinsics.width, intrinsics.height);
        let height = f64::from(found.0) * f64::from(expected.1) / f64::from(expected.0);
        if (height - f64::from(found.1)).abs() <= 1.0 {
            return Ok(());
        }
        Err(Error::PictureShape { camera: self.camera(view), found, expected })
    }

    fn regress(&self, memory: &mut Memory) -> Result<(Pose, [f64; Dof::COUNT])> {
        let Memory { x, regression, .. } = memory;
        let (mut pose, mut std) = (Pose::REST, [0.0; Dof::COUNT]);
        self.regression.predict_into(x, regression, &mut pose.0, &mut std)?;
        for dof in Dof::ALL {
            let numbers = [pose[dof], std[dof.index()]];
            if let Some(&value) = numbers.iter().find(|number| !number.is_finite()) {
                return Err(Error::Overflow { dof: dof.name(), value });
            }
        }
        Ok((pose, std))
    }
}
