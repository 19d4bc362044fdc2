//! The fitted estimator: from the cameras' pictures to a pose.

use glam::DVec3;
use phalanx_camera::{Camera, Rig};
use phalanx_hand::{Dof, HandShape, JOINTS, Pose};
use phalanx_refine::PosePrior;
use phalanx_segmentation::{Mask, Silhouette};

use crate::checking::doubt::{Cause, ViewDoubt};
use crate::checking::quick_fit::QuickFit;
use crate::checking::usual::Explanation;
use crate::checking::{doubts, redraw};
use crate::error::{Error, Result};
use crate::estimator::error_model::ErrorModel;
use crate::estimator::expert::Expert;
use crate::estimator::observation::{Observation, ObservedView};
use crate::estimator::placement::{PlacementErrors, place};
use crate::estimator::regression::FittedRegressor;
use crate::estimator::subset_regression;
use crate::estimator::subset_regression::SubsetRegression;
use crate::features::describer::OrientationRule;
use crate::features::descriptor;
use crate::features::descriptor::Descriptor;
use crate::images::picture::Picture;
use crate::losses;
use crate::synthesis::postures;
use crate::view_set::ViewSet;
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
    subsets: Option<Subsets>,
}

/// What answers where some of the cameras are missing.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Subsets {
    pub(crate) regression: SubsetRegression,
    /// How the answers of each learnt subset err; empty where that is not known.
    pub(crate) errors: Vec<ErrorModel>,
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
    /// How well the hand, drawn again, and what each view of the observation shows agree: intersection over
    /// union, 0 to 1. None where silhouettes were given without the windows that they are seen in.
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
    subsets: subset_regression::Memory,
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
        Ok(Self { rig, hand, descriptor, regression, errors: None, subsets: None })
    }

    /// The same estimator, answering where some of the cameras are missing too.
    pub(crate) fn with_subsets(self, regression: Option<SubsetRegression>) -> Result<Self> {
        if let Some(regression) = &regression {
            regression.check(&self.descriptor)?;
        }
        let subsets = regression.map(|regression| Subsets { regression, errors: Vec::new() });
        Ok(Self { subsets, ..self })
    }

    /// The same estimator, knowing how its estimates from each learnt subset of the cameras err.
    pub(crate) fn with_subset_errors(mut self, errors: Vec<ErrorModel>) -> Result<Self> {
        let Some(subsets) = &mut self.subsets else { return Ok(self) };
        if errors.is_empty() {
            return Ok(self);
        }
        subsets.errors = errors;
        let learnt = ViewSet::learnt(self.rig.cameras.len());
        let errors = self.subsets.iter().flat_map(|subsets| &subsets.errors);
        let found = errors.clone().count();
        if found != learnt.len() {
            let (part, expected) = ("errors of subsets", learnt.len());
            return Err(Error::Mismatch { part, found, expected });
        }
        for (errors, subset) in errors.zip(learnt) {
            self.check_errors(errors, subset.count())?;
        }
        Ok(self)
    }

    /// The same estimator, knowing how its estimates err.
    ///
    /// # Errors
    /// Errors of something other than poses, of another number of views, or of another framing.
    pub fn with_error_model(self, errors: ErrorModel) -> Result<Self> {
        self.check_errors(&errors, self.rig.cameras.len())?;
        Ok(Self { errors: Some(errors), ..self })
    }

    fn check_errors(&self, errors: &ErrorModel, views: usize) -> Result<()> {
        let placed = usize::from(self.framing() == Framing::Window);
        for (part, found, expected) in [
            ("numbers in its errors", errors.residuals.outputs(), Dof::COUNT),
            ("errors of where hands are", errors.placement.iter().len(), placed),
        ] {
            if found != expected {
                return Err(Error::Mismatch { part, found, expected });
            }
        }
        errors.usual.check(views)?;
        errors.placement.iter().try_for_each(PlacementErrors::check)
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

    /// What answers where some of the cameras are missing, if it was learnt.
    pub(crate) fn subsets(&self) -> Option<&Subsets> {
        self.subsets.as_ref()
    }

    /// Estimates the pose from the cameras' pictures, in the order of the rig. Pictures may be missing
    /// (`None`), and a view in which no hand is found counts as missing too, which is a
    /// [doubt](Cause::NotSeen); at least one must show the hand.
    ///
    /// Presets learn to answer any cameras, a rig of more than four those of the largest learnt subset: all,
    /// all but one, two or one. By other regressors every camera's view is needed.
    ///
    /// # Errors
    /// Another number of pictures, a picture of another shape than its camera's image, or no hand in any,
    /// or in one that is needed.
    pub fn estimate<'p, P>(&self, pictures: &[P], workspace: &mut Workspace) -> Result<Estimate>
    where
        P: Into<Option<Picture<'p>>> + Copy,
    {
        self.check_count(pictures.len())?;
        let pictures = pictures.iter().map(|&picture| picture.into()).enumerate();
        let mut given: Vec<(usize, Picture<'p>)> =
            pictures.filter_map(|(view, picture)| Some((view, picture?))).collect();
        for &(view, picture) in &given {
            self.check_shape(view, picture.size())?;
        }
        if given.is_empty() {
            return Err(self.wrong_count(0));
        }
        let mut not_seen = Vec::new();
        let mut first = None;
        loop {
            let error = match self.estimate_given(&given, workspace) {
                Ok(mut estimate) => {
                    estimate.doubts.extend(not_seen);
                    estimate.doubts.sort_by_key(|doubt| doubt.view);
                    return Ok(estimate);
                }
                Err(error) => error,
            };
            let Some(doubt) = self.not_seen(&error).filter(|_| self.subsets.is_some()) else {
                return Err(error);
            };
            given.retain(|(view, _)| *view != doubt.view);
            not_seen.push(doubt);
            let error = first.get_or_insert(error);
            if given.is_empty() {
                return Err(std::mem::replace(error, Error::NoHand));
            }
        }
    }

    /// The doubt about a view for which an estimate failed, if that is because it shows no hand.
    fn not_seen(&self, error: &Error) -> Option<ViewDoubt> {
        let (camera, reason) = losses::not_seen(error)?;
        let view = self.rig.cameras.iter().position(|known| known.name == camera)?;
        Some(ViewDoubt { view, cause: Cause::NotSeen(reason) })
    }

    /// Estimates the pose from the pictures of some cameras, by their numbers.
    fn estimate_given(
        &self,
        pictures: &[(usize, Picture<'_>)],
        workspace: &mut Workspace,
    ) -> Result<Estimate> {
        let observation = match self.framing() {
            Framing::Picture => self.see_whole(pictures, workspace)?,
            Framing::Window => self.see_through_windows(pictures, workspace)?,
        };
        self.estimate_observation(observation, workspace)
    }

    /// The silhouettes of whole pictures.
    fn see_whole(
        &self,
        pictures: &[(usize, Picture<'_>)],
        workspace: &mut Workspace,
    ) -> Result<Observation> {
        let describer = &mut workspace.description.describer;
        let see = |&(camera, picture): &(usize, Picture<'_>)| {
            let mut silhouette = Silhouette::default();
            describer
                .silhouette(picture, &mut silhouette)
                .map_err(|reason| Error::Silhouette { camera: self.camera(camera), reason })?;
            Ok(ObservedView { camera, silhouette, window: None, picture: picture.size() })
        };
        Ok(Observation { views: pictures.iter().map(see).collect::<Result<_>>()? })
    }

    /// The silhouettes of the hand in windows of pictures.
    fn see_through_windows(
        &self,
        pictures: &[(usize, Picture<'_>)],
        workspace: &mut Workspace,
    ) -> Result<Observation> {
        let mask = |&(camera, picture): &(usize, Picture<'_>)| {
            let mask = picture.mask();
            mask.map_err(|reason| Error::Silhouette { camera: self.camera(camera), reason })
        };
        let masks = pictures.iter().map(mask).collect::<Result<Vec<Mask>>>()?;
        let cameras: Vec<Camera> =
            pictures.iter().map(|(camera, _)| self.rig.cameras[*camera].clone()).collect();
        let windows = workspace.windows.find(&cameras, &masks, None)?;
        let mut silhouettes = vec![Silhouette::default(); windows.len()];
        workspace.windows.silhouettes(&windows, &mut silhouettes)?;
        let views = silhouettes.into_iter().zip(windows).zip(pictures);
        let view = |((silhouette, window), (camera, picture)): ((_, _), &(usize, Picture<'_>))| {
            ObservedView {
                camera: *camera,
                silhouette,
                window: Some(window),
                picture: picture.size(),
            }
        };
        Ok(Observation { views: views.map(view).collect() })
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
        self.check_count(silhouettes.len())?;
        self.estimate_observation(Observation::of_silhouettes(silhouettes), workspace)
    }

    /// Estimates the pose from what was seen already, by some of the cameras. Where the views have windows,
    /// these tell position, θ_X and θ_Y, which what is seen through a window does not tell.
    ///
    /// # Errors
    /// No view, or of cameras that were not [learnt](Self::estimate) to answer from, a silhouette that
    /// cannot be described, or windows as of [`initial_global`](crate::initial_global).
    pub fn estimate_observation(
        &self,
        observation: Observation,
        workspace: &mut Workspace,
    ) -> Result<Estimate> {
        let expert = self.expert(&observation)?;
        self.describe(&observation, workspace)?;
        let estimate = self.answer(expert, observation, workspace)?;
        self.checked(&self.hand, estimate)
    }

    /// Describes what was seen, in the workspace.
    pub(crate) fn describe(
        &self,
        observation: &Observation,
        workspace: &mut Workspace,
    ) -> Result<()> {
        let Workspace { description, x, .. } = workspace;
        let views = observation.views.iter().map(|view| (view.camera, &view.silhouette));
        self.descriptor.describe(&self.rig, views, description, x)
    }

    /// An expert's answer to what was seen and is described in the workspace, unchecked.
    pub(crate) fn answer(
        &self,
        expert: Expert<'_>,
        observation: Observation,
        workspace: &mut Workspace,
    ) -> Result<Estimate> {
        let (pose, std) = regress(expert, workspace)?;
        let joints = self.hand.pose(&pose, &self.rig.volume.rest_frame()).joints;
        let (overlaps, doubts) = (Vec::new(), Vec::new());
        let estimate = Estimate { pose, std, joints, observation, overlaps, doubts };
        match estimate.observation.framing() {
            Framing::Picture => Ok(estimate),
            Framing::Window => {
                let learnt = expert.errors.and_then(|errors| errors.placement);
                let errors =
                    learnt.unwrap_or_else(|| PlacementErrors::of_anywhere(&self.rig.volume));
                place(&self.rig, &self.hand, &errors, estimate)
            }
        }
    }

    /// What answers for the cameras of an observation.
    pub(crate) fn expert(&self, observation: &Observation) -> Result<Expert<'_>> {
        let cameras = self.rig.cameras.len();
        let views = &observation.views;
        let is_in_order = views.is_sorted_by(|one, next| one.camera < next.camera);
        if !is_in_order || views.last().is_none_or(|last| last.camera >= cameras) {
            return Err(self.wrong_count(views.len()));
        }
        if views.len() == cameras {
            return Ok(Expert::of_all(&self.regression, cameras, self.errors.as_ref()));
        }
        self.subset_expert(observation.cameras()).ok_or_else(|| {
            let missing = (0..cameras).find(|view| views.iter().all(|seen| seen.camera != *view));
            Error::MissingCamera { camera: self.camera(missing.unwrap_or_default()) }
        })
    }

    /// What answers for some cameras: for the largest learnt subset of them, of equal ones the first.
    fn subset_expert(&self, seen: ViewSet) -> Option<Expert<'_>> {
        let Subsets { regression, errors } = self.subsets.as_ref()?;
        let cameras = self.rig.cameras.len();
        let within = ViewSet::learnt(cameras).into_iter().enumerate();
        let within = within.filter(|(_, subset)| subset.is_within(seen));
        let largest = within.rev().max_by_key(|(_, subset)| subset.count())?;
        Some(Expert::of_subset(regression, cameras, largest, errors.get(largest.0)))
    }

    /// An estimate of a hand with what it has in common with what was seen, and with the doubts that follow.
    pub(crate) fn checked(&self, hand: &HandShape, mut estimate: Estimate) -> Result<Estimate> {
        let mut short = Vec::new();
        if estimate.observation.framing() == self.framing() {
            estimate.overlaps = self.overlaps(hand, &estimate)?;
            let expert = self.expert(&estimate.observation)?;
            if expert.errors.is_some() {
                short = expert.short(&estimate.observation, &self.explanation(hand, &estimate)?);
            }
        }
        let mut doubts = doubts::of(&self.rig, &short, &estimate);
        let is_not_seen = |doubt: &&ViewDoubt| matches!(doubt.cause, Cause::NotSeen(_));
        doubts.extend(estimate.doubts.iter().filter(is_not_seen));
        doubts.sort_by_key(|doubt| doubt.view);
        estimate.doubts = doubts;
        Ok(estimate)
    }

    /// What an estimated hand and each view have in common.
    pub(crate) fn overlaps(&self, hand: &HandShape, estimate: &Estimate) -> Result<Vec<f64>> {
        let (cameras, rest) = (&self.rig.cameras, self.rig.volume.rest_frame());
        redraw::overlaps(cameras, hand, &rest, &estimate.pose, &estimate.observation)
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

    fn camera(&self, view: usize) -> String {
        self.rig.cameras[view].name.clone()
    }

    fn check_count(&self, found: usize) -> Result<()> {
        let cameras = self.rig.cameras.len();
        if found == cameras {
            return Ok(());
        }
        Err(self.wrong_count(found))
    }

    fn wrong_count(&self, found: usize) -> Error {
        let cameras = (0..self.rig.cameras.len()).map(|view| self.camera(view)).collect();
        Error::PictureCount { cameras, found }
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
}

/// What an expert says of the descriptor in the workspace.
fn regress(
    expert: Expert<'_>,
    workspace: &mut Workspace,
) -> Result<(Pose, [Option<f64>; Dof::COUNT])> {
    let Workspace { x, subsets, regression, .. } = workspace;
    let (mut pose, mut std) = (Pose::REST, [0.0; Dof::COUNT]);
    expert.predict_into(x, (subsets, regression), &mut pose.0, &mut std)?;
    for dof in Dof::ALL {
        let (value, std) = (pose[dof], std[dof.index()]);
        if !value.is_finite() || std.is_nan() {
            let value = if value.is_finite() { std } else { value };
            return Err(Error::Overflow { dof: dof.name(), value });
        }
    }
    Ok((pose, std.map(known)))
}

/// A regressor's standard deviation, if it knows one: it is infinite, or 0 in the models of old, where
/// the training poses did not vary.
pub(crate) fn known(std: f64) -> Option<f64> {
    (std > 0.0 && std.is_finite()).then_some(std)
}
