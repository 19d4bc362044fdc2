//! The fitted estimator: from one picture per camera to a pose.

use glam::DVec3;
use phalanx_camera::Rig;
use phalanx_hand::{Dof, HandShape, JOINTS, Pose};
use phalanx_refine::PosePrior;
use phalanx_segmentation::{Mask, Silhouette};

use crate::checking::doubt::ViewDoubt;
use crate::checking::quick_fit::QuickFit;
use crate::checking::usual::Explanation;
use crate::checking::{doubts, redraw};
use crate::error::{Error, Result};
use crate::estimator::error_model::ErrorModel;
use crate::estimator::observation::{Observation, ObservedView};
use crate::estimator::placement::{PlacementErrors, place};
use crate::estimator::regression::FittedRegressor;
use crate::features::describer::OrientationRule;
use crate::features::descriptor;
use crate::features::descriptor::Descriptor;
use crate::images::picture::Picture;
use crate::synthesis::postures;
use crate::window::{Framing, WindowFinder};

/// A pose estimator for one rig and one hand; see [`Training`](crate::Training) for how to get
/// one.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimator {
    rig: Rig,
    hand: HandShape,
    descriptor: Descriptor,
    regression: FittedRegressor,
    errors: Option<ErrorModel>,
}

/// What is known of a hand after looking at it.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// The pose, radians and millimetres.
    pub pose: Pose,
    /// Predictive standard deviation of each number of the pose, in its unit; `None` for a number that
    /// is not estimated, because it did not vary in what was learnt from.
    pub std: [Option<f64>; Dof::COUNT],
    /// The 21 joints in the world, mm.
    pub joints: [DVec3; JOINTS],
    /// What was seen.
    pub observation: Observation,
    /// How well the hand, drawn again, and what each view shows agree: intersection over union, 0 to 1.
    /// None where silhouettes were given without the windows that they are seen in.
    pub overlaps: Vec<f64>,
    /// Why the answer may be wrong. An estimator that has not
    /// [learnt how it errs](Estimator::fit_error_model) does not know which overlaps are usual.
    pub doubts: Vec<ViewDoubt>,
}

/// Memory that one estimate after another uses again. It holds nothing to be read.
#[derive(Debug, Default)]
pub struct Workspace {
    windows: WindowFinder,
    description: descriptor::Memory,
    x: Vec<f64>,
    regression: phalanx_rvm::Scratch,
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
        regression: impl Into<FittedRegressor>,
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
    /// Errors of something other than poses, of another number of views, or of another framing.
    pub fn with_error_model(self, errors: ErrorModel) -> Result<Self> {
        let placed = usize::from(self.framing() == Framing::Window);
        for (part, found, expected) in [
            ("numbers in its errors", errors.residuals.outputs(), Dof::COUNT),
            ("errors of where hands are", errors.placement.iter().len(), placed),
        ] {
            if found != expected {
                return Err(Error::Mismatch { part, found, expected });
            }
        }
        errors.usual.check(self.rig.cameras.len())?;
        errors.placement.iter().try_for_each(PlacementErrors::check)?;
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

    /// What of the pictures it looks at.
    pub fn framing(&self) -> Framing {
        self.descriptor.view_config().framing
    }

    /// Its regressor.
    pub fn regressor(&self) -> &FittedRegressor {
        &self.regression
    }

    /// How its estimates err, if it has [learnt it](Self::fit_error_model).
    pub fn error_model(&self) -> Option<&ErrorModel> {
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
        let observation = match self.framing() {
            Framing::Picture => self.see_whole(pictures, workspace)?,
            Framing::Window => self.see_through_windows(pictures, workspace)?,
        };
        self.estimate_observation(observation, workspace)
    }

    /// The silhouettes of whole pictures.
    fn see_whole(
        &self,
        pictures: &[Picture<'_>],
        workspace: &mut Workspace,
    ) -> Result<Observation> {
        let describer = &mut workspace.description.describer;
        let see = |(view, picture): (usize, &Picture<'_>)| {
            let mut silhouette = Silhouette::default();
            describer
                .silhouette(*picture, &mut silhouette)
                .map_err(|reason| Error::Silhouette { camera: self.camera(view), reason })?;
            Ok(ObservedView { silhouette, window: None, picture: picture.size() })
        };
        let views = pictures.iter().enumerate().map(see).collect::<Result<_>>()?;
        Ok(Observation { views })
    }

    /// The silhouettes of the hand in windows of pictures.
    fn see_through_windows(
        &self,
        pictures: &[Picture<'_>],
        workspace: &mut Workspace,
    ) -> Result<Observation> {
        let masks = self.masks(pictures)?;
        let windows = workspace.windows.find(&self.rig.cameras, &masks, None)?;
        let mut silhouettes = vec![Silhouette::default(); windows.len()];
        workspace.windows.silhouettes(&windows, &mut silhouettes)?;
        let views = silhouettes.into_iter().zip(windows).zip(pictures);
        let view = |((silhouette, window), picture): ((_, _), &Picture<'_>)| ObservedView {
            silhouette,
            window: Some(window),
            picture: picture.size(),
        };
        Ok(Observation { views: views.map(view).collect() })
    }

    /// The raw masks of pictures, as large as they are.
    fn masks(&self, pictures: &[Picture<'_>]) -> Result<Vec<Mask>> {
        let mask = |(view, picture): (usize, &Picture<'_>)| {
            picture.mask().map_err(|reason| Error::Silhouette { camera: self.camera(view), reason })
        };
        pictures.iter().enumerate().map(mask).collect()
    }

    /// Estimates the pose from one silhouette per camera, of any size, in the order of the rig's
    /// cameras. Where they are seen through windows is not known, nor then where the hand is: see
    /// [`estimate_observation`](Self::estimate_observation).
    ///
    /// # Errors
    /// Another number of silhouettes, or one that cannot be described.
    pub fn estimate_silhouettes(
        &self,
        silhouettes: &[Silhouette],
        workspace: &mut Workspace,
    ) -> Result<Estimate> {
        self.estimate_observation(Observation::of_silhouettes(silhouettes), workspace)
    }

    /// Estimates the pose from what was seen already. Where the views have windows, these tell
    /// position, θ_X and θ_Y, which what is seen through a window does not tell.
    ///
    /// # Errors
    /// Another number of views, a silhouette that cannot be described, or windows as of
    /// [`initial_global`](crate::initial_global).
    pub fn estimate_observation(
        &self,
        observation: Observation,
        workspace: &mut Workspace,
    ) -> Result<Estimate> {
        self.check_count(observation.views.len())?;
        let Workspace { description, x, .. } = workspace;
        self.descriptor.describe(&self.rig, observation.silhouettes(), description, x)?;
        let (pose, std) = self.regress(workspace)?;
        let joints = self.hand.pose(&pose, &self.rig.volume.rest_frame()).joints;
        let (overlaps, doubts) = (Vec::new(), Vec::new());
        let estimate = Estimate { pose, std, joints, observation, overlaps, doubts };
        let estimate = match estimate.observation.framing() {
            Framing::Picture => estimate,
            Framing::Window => place(&self.rig, &self.hand, &self.placement_errors(), estimate)?,
        };
        self.checked(&self.hand, estimate)
    }

    /// An estimate of a hand with what it has in common with what was seen, and with the doubts that follow.
    pub(crate) fn checked(&self, hand: &HandShape, mut estimate: Estimate) -> Result<Estimate> {
        let Estimate { pose, observation, .. } = &estimate;
        let mut short = Vec::new();
        if observation.framing() == self.framing() {
            let (cameras, rest) = (&self.rig.cameras, self.rig.volume.rest_frame());
            estimate.overlaps = redraw::overlaps(cameras, hand, &rest, pose, observation)?;
            if let Some(errors) = &self.errors {
                short = errors.usual.short(&self.explanation(hand, &estimate)?);
            }
        }
        estimate.doubts = doubts::of(&self.rig, &short, &estimate);
        Ok(estimate)
    }

    /// How well an estimate of a hand explains what was seen.
    pub(crate) fn explanation(&self, hand: &HandShape, estimate: &Estimate) -> Result<Explanation> {
        let Estimate { pose, std, observation, overlaps, .. } = estimate;
        let rest = self.rig.volume.rest_frame();
        let std = std.map(Option::unwrap_or_default);
        let prior = PosePrior::independent(*pose, &std)?.product(postures::coupled())?;
        let fit = QuickFit::new(&self.rig.cameras, rest, observation);
        let fitted = fit.best(hand, &[*prior.mean()], &prior)?;
        let borders = fitted.map_or_else(|| vec![0.0; overlaps.len()], |fitted| fitted.borders);
        Ok(Explanation { overlaps: overlaps.clone(), borders })
    }

    fn placement_errors(&self) -> PlacementErrors {
        let learnt = self.errors.as_ref().and_then(|errors| errors.placement);
        learnt.unwrap_or_else(|| PlacementErrors::of_anywhere(&self.rig.volume))
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

    fn regress(&self, workspace: &mut Workspace) -> Result<(Pose, [Option<f64>; Dof::COUNT])> {
        let Workspace { x, regression, .. } = workspace;
        let (mut pose, mut std) = (Pose::REST, [0.0; Dof::COUNT]);
        self.regression.predict_into(x, regression, &mut pose.0, &mut std)?;
        for dof in Dof::ALL {
            let (value, std) = (pose[dof], std[dof.index()]);
            if !value.is_finite() || std.is_nan() {
                let value = if value.is_finite() { std } else { value };
                return Err(Error::Overflow { dof: dof.name(), value });
            }
        }
        Ok((pose, std.map(known)))
    }
}

/// A regressor's standard deviation, if it knows one: it is infinite, or 0 in the models of old, where
/// the training poses did not vary.
pub(crate) fn known(std: f64) -> Option<f64> {
    (std > 0.0 && std.is_finite()).then_some(std)
}
