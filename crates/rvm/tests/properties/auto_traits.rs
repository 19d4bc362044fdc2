//! Everything public can be sent to, and shared between, threads.

use phalanx_rvm::{
    Basis, Block, AgarwalTriggs, TwoStageSelection, BasisSpec, Components, ConditionalDensity,
    ConditionalDensityParts, PredictiveDeviation, Error, Factor, Fit, OrthogonalLeastSquares, GradientMetric,
    Group, AugmentedRvm, Hypothesis, Kernel, KernelRidge, Regularisation, ArdRvm, Metric, Model,
    ModelParts, MultiOutputRvm, Mlp, PcaMlp, MlpParts, NystromRidge, NystromRegularisation,
    MlpTrainer, PilotSample, Posterior, Progress, Projected, Projection, ProjectionParts, Regressor,
    Report, Ridge, Scratch, Standardiser, Stop, SufficientStatistics, SufficientStatisticsParts, LengthScales, RelevanceVectorMachine, Trace, Bandwidth,
};

const fn shared<T: Send + Sync>() {}

macro_rules! shared {
    ($($kind:ty),+ $(,)?) => { $( const _: () = shared::<$kind>(); )+ };
}

// A type that is not makes the tests fail to compile.
shared!(
    Box<dyn Regressor>,
    Basis,
    Block,
    AgarwalTriggs,
    TwoStageSelection,
    BasisSpec,
    Components,
    ConditionalDensity,
    ConditionalDensityParts,
    PredictiveDeviation,
    Error,
    Factor,
    Fit,
    Fit<Mlp>,
    OrthogonalLeastSquares,
    GradientMetric,
    Group,
    AugmentedRvm,
    Hypothesis,
    Kernel,
    KernelRidge,
    Regularisation,
    ArdRvm,
    Metric,
    Model,
    ModelParts,
    MultiOutputRvm,
    Mlp,
    PcaMlp,
    MlpParts,
    NystromRidge,
    NystromRegularisation,
    MlpTrainer,
    PilotSample<'static>,
    Posterior,
    Progress,
    Projected,
    Projection,
    ProjectionParts,
    Report,
    Ridge,
    Scratch,
    Standardiser,
    Stop,
    SufficientStatistics,
    SufficientStatisticsParts,
    LengthScales,
    RelevanceVectorMachine,
    Trace,
    Bandwidth,
);
