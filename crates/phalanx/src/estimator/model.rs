//! The fitted estimator: what it was learnt for, and the parts that answer.

use phalanx_camera::Rig;
use phalanx_hand::{Dof, HandShape};

use crate::error::{Error, Result};
use crate::estimator::error_model::ErrorModel;
use crate::estimator::expert::Expert;
use crate::estimator::observation::Observation;
use crate::estimator::placement::PlacementErrors;
use crate::estimator::refined_errors::RefinedErrors;
use crate::estimator::regression::FittedRegressor;
use crate::estimator::subset_regression::SubsetRegression;
use crate::features::describer::OrientationRule;
use crate::features::descriptor::Descriptor;
use crate::view_set::ViewSet;
use crate::window::Framing;

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
    refined: Option<RefinedErrors>,
}

/// What answers where some of the cameras are missing.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Subsets {
    pub(crate) regression: SubsetRegression,
    /// How the answers of each learnt subset err; empty where that is not known.
    pub(crate) errors: Vec<ErrorModel>,
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
        Ok(Self { rig, hand, descriptor, regression, errors: None, subsets: None, refined: None })
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

    /// The same estimator, knowing how its refined estimates err.
    ///
    /// # Errors
    /// Scales that are none.
    pub fn with_refined_errors(self, refined: RefinedErrors) -> Result<Self> {
        refined.check()?;
        Ok(Self { refined: Some(refined), ..self })
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

    /// How its refined estimates err, if it has [learnt it](Self::fit_refined_errors).
    pub fn refined_errors(&self) -> Option<&RefinedErrors> {
        self.refined.as_ref()
    }

    /// What answers where some of the cameras are missing, if it was learnt.
    pub(crate) fn subsets(&self) -> Option<&Subsets> {
        self.subsets.as_ref()
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

    pub(crate) fn camera(&self, view: usize) -> String {
        self.rig.cameras[view].name.clone()
    }

    pub(crate) fn check_count(&self, found: usize) -> Result<()> {
        let cameras = self.rig.cameras.len();
        if found == cameras {
            return Ok(());
        }
        Err(self.wrong_count(found))
    }

    pub(crate) fn wrong_count(&self, found: usize) -> Error {
        let cameras = (0..self.rig.cameras.len()).map(|view| self.camera(view)).collect();
        Error::PictureCount { cameras, found }
    }
}
