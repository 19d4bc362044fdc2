//! The fitted regressor of an estimator.
use phalanx_rvm::Regressor as _;
use phalanx_rvm::{GroupedRegressor, Model, PcaMlp, Scratch};

/// A fitted regressor from descriptors to poses.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum FittedRegressor {
    /// One model of all numbers of the pose.
    Joint(Box<Model>),
    /// A model for each digit, with a distance of its own.
    Projected(GroupedRegressor),
    /// A network of all numbers of the pose, on the descriptor's principal components.
    Network(Box<PcaMlp>),
}

impl From<Model> for FittedRegressor {
    fn from(model: Model) -> Self {
        Self::Joint(Box::new(model))
    }
}

impl From<GroupedRegressor> for FittedRegressor {
    fn from(projected: GroupedRegressor) -> Self {
        Self::Projected(projected)
    }
}

impl From<PcaMlp> for FittedRegressor {
    fn from(network: PcaMlp) -> Self {
        Self::Network(Box::new(network))
    }
}

impl FittedRegressor {
    /// The models, of all numbers of the pose or of a group of them each; none of a network.
    pub fn models(&self) -> &[Model] {
        match self {
            Self::Joint(model) => std::slice::from_ref(model),
            Self::Projected(projected) => projected.models(),
            Self::Network(_) => &[],
        }
    }

    /// Length of a descriptor.
    pub fn inputs(&self) -> usize {
        match self {
            Self::Joint(model) => model.inputs(),
            Self::Projected(projected) => projected.inputs(),
            Self::Network(own) => own.inputs(),
        }
    }

    /// Length of a pose.
    pub fn outputs(&self) -> usize {
        match self {
            Self::Network(own) => own.outputs(),
            _ => self.models().iter().map(Model::outputs).sum(),
        }
    }

    /// How many numbers of the descriptor it reads.
    pub fn features(&self) -> usize {
        match self {
            Self::Joint(model) => model.selected_features().len(),
            Self::Projected(projected) => projected.inputs(),
            Self::Network(own) => own.inputs(),
        }
    }

    /// How many training samples it keeps.
    pub fn kept_samples(&self) -> usize {
        self.models().iter().map(|model| model.kept_samples().len()).max().unwrap_or(0)
    }

    /// Mean and standard deviation of the pose for one descriptor; infinite where the samples tell none.
    pub(crate) fn predict_into(
        &self,
        x: &[f64],
        scratch: &mut Scratch,
        mean: &mut [f64],
        std: &mut [f64],
    ) -> phalanx_rvm::Result<()> {
        match self {
            Self::Joint(model) => model.predict_into(x, scratch, mean, std),
            Self::Projected(projected) => projected.predict_into(x, scratch, mean, std),
            Self::Network(own) => own.predict_into(x, scratch, mean, std),
        }
    }
}
