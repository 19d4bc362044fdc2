//! The model file.

use std::borrow::Cow;

use phalanx_camera::Rig;
use phalanx_hand::HandShape;
use phalanx_rvm::{GroupedRegressor, Model, ModelParts, PcaMlp, ResidualKde, ResidualKdeParts};
use serde::{Deserialize, Serialize};

use crate::checking::usual::UsualExplanation;
use crate::error::Result;
use crate::estimator::container::Container;
use crate::estimator::error_model::ErrorModel;
use crate::estimator::model::Estimator;
use crate::estimator::placement::PlacementErrors;
use crate::estimator::refined_errors::RefinedErrors;
use crate::estimator::regression::FittedRegressor;
use crate::estimator::subset_regression::SubsetRegression;
use crate::features::descriptor::Descriptor;

const MODEL: Container = Container { what: "model", mark: *b"PHALANX\0", format: 11 };

/// What the payload holds.
#[derive(Serialize, Deserialize)]
struct Payload<'a> {
    rig: Cow<'a, Rig>,
    hand: Cow<'a, HandShape>,
    descriptor: Cow<'a, Descriptor>,
    regression: Stored<'a>,
    errors: Option<StoredErrors<'a>>,
    subsets: Option<StoredSubsets<'a>>,
    refined: Option<Cow<'a, RefinedErrors>>,
}

/// What answers where some of the cameras are missing.
#[derive(Serialize, Deserialize)]
struct StoredSubsets<'a> {
    regression: Cow<'a, SubsetRegression>,
    errors: Vec<StoredErrors<'a>>,
}

/// A model of errors in plain numbers.
#[derive(Serialize, Deserialize)]
struct StoredErrors<'a> {
    residuals: Cow<'a, ResidualKdeParts>,
    usual: Cow<'a, UsualExplanation>,
    placement: Option<PlacementErrors>,
}

impl<'a> StoredErrors<'a> {
    fn of(errors: &'a ErrorModel) -> Self {
        Self {
            residuals: Cow::Borrowed(errors.residuals.parts()),
            usual: Cow::Borrowed(&errors.usual),
            placement: errors.placement,
        }
    }

    fn read(self) -> Result<ErrorModel> {
        Ok(ErrorModel {
            residuals: ResidualKde::from_parts(self.residuals.into_owned())?,
            usual: self.usual.into_owned(),
            placement: self.placement,
        })
    }
}

/// A regression in plain numbers.
#[derive(Serialize, Deserialize)]
enum Stored<'a> {
    Joint(Cow<'a, ModelParts>),
    Projected(Cow<'a, GroupedRegressor>),
    Network(Cow<'a, PcaMlp>),
}

impl Estimator {
    /// The model file's bytes.
    ///
    /// # Errors
    /// None that a fitted estimator can cause; encoding is fallible in form.
    pub fn to_bytes(&self) -> Result<Vec<u8>> {
        let payload = Payload {
            rig: Cow::Borrowed(self.rig()),
            hand: Cow::Borrowed(self.hand()),
            descriptor: Cow::Borrowed(self.descriptor()),
            regression: match self.regressor() {
                FittedRegressor::Joint(model) => Stored::Joint(Cow::Borrowed(model.parts())),
                FittedRegressor::Projected(models) => Stored::Projected(Cow::Borrowed(models)),
                FittedRegressor::Network(own) => Stored::Network(Cow::Borrowed(own)),
            },
            errors: self.error_model().map(StoredErrors::of),
            subsets: self.subsets().map(|subsets| StoredSubsets {
                regression: Cow::Borrowed(&subsets.regression),
                errors: subsets.errors.iter().map(StoredErrors::of).collect(),
            }),
            refined: self.refined_errors().map(Cow::Borrowed),
        };
        MODEL.encode(&payload)
    }

    /// Reads a model file's bytes.
    ///
    /// # Errors
    /// Bytes that are no model, of another format, truncated, corrupt, or whose parts do not
    /// fit each other.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let Payload { rig, hand, descriptor, regression, errors, subsets, refined } =
            MODEL.decode(bytes)?;
        let regression = match regression {
            Stored::Joint(parts) => Model::from_parts(parts.into_owned())?.into(),
            Stored::Projected(models) => FittedRegressor::Projected(models.into_owned()),
            Stored::Network(own) => own.into_owned().into(),
        };
        let (rig, hand) = (rig.into_owned(), hand.into_owned());
        let estimator = Self::from_parts(rig, hand, descriptor.into_owned(), regression)?;
        let estimator = match refined {
            Some(refined) => estimator.with_refined_errors(refined.into_owned())?,
            None => estimator,
        };
        let estimator = match errors {
            Some(errors) => estimator.with_error_model(errors.read()?)?,
            None => estimator,
        };
        let Some(StoredSubsets { regression, errors }) = subsets else { return Ok(estimator) };
        let errors = errors.into_iter().map(StoredErrors::read).collect::<Result<Vec<_>>>()?;
        estimator.with_subsets(Some(regression.into_owned()))?.with_subset_errors(errors)
    }
}
