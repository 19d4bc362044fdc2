//! Everything public can be sent to, and shared between, threads.

use phalanx_rvm::{
    AffineMap, AffineMapParts, AgarwalTriggs, ArdRvm, AugmentedRvm, Bandwidth, Basis, BasisSpec,
    BlockPca, CholeskyFactor, Error, ExpectedGradientOuterProduct, FeatureBlock, Fit,
    GroupedRegressor, Hypothesis, Kernel, KernelRidge, LearnedMetric, LengthScales, Mlp, MlpParts,
    MlpTrainer, Model, ModelParts, MultiOutputRvm, NystromRegularisation, NystromRidge,
    OrthogonalLeastSquares, PcaMlp, PilotSample, Posterior, PredictiveDeviation, Progress,
    Regressor, Regularisation, RelevanceVectorMachine, Report, ResidualKde, ResidualKdeParts,
    Ridge, Scratch, StandardScaler, Stop, SufficientStatistics, SufficientStatisticsParts,
    TargetGroup, Trace, TwoStageSelection,
};

const fn shared<T: Send + Sync>() {}

macro_rules! shared {
    ($($kind:ty),+ $(,)?) => { $( const _: () = shared::<$kind>(); )+ };
}

// A type that is not makes the tests fail to compile.
shared!(
    Box<dyn Regressor>,
    Basis,
    FeatureBlock,
    AgarwalTriggs,
    TwoStageSelection,
    BasisSpec,
    BlockPca,
    ResidualKde,
    ResidualKdeParts,
    PredictiveDeviation,
    Error,
    CholeskyFactor,
    Fit,
    Fit<Mlp>,
    OrthogonalLeastSquares,
    ExpectedGradientOuterProduct,
    TargetGroup,
    AugmentedRvm,
    Hypothesis,
    Kernel,
    KernelRidge,
    Regularisation,
    ArdRvm,
    LearnedMetric,
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
    GroupedRegressor,
    AffineMap,
    AffineMapParts,
    Report,
    Ridge,
    Scratch,
    StandardScaler,
    Stop,
    SufficientStatistics,
    SufficientStatisticsParts,
    LengthScales,
    RelevanceVectorMachine,
    Trace,
    Bandwidth,
);
