//! Everything public can be sent to, and shared between, threads.

use phalanx_rvm::{
    Basis, FeatureBlock, AgarwalTriggs, TwoStageSelection, BasisSpec, BlockPca, ResidualKde,
    ResidualKdeParts, PredictiveDeviation, Error, CholeskyFactor, Fit, OrthogonalLeastSquares, ExpectedGradientOuterProduct,
    TargetGroup, AugmentedRvm, Hypothesis, Kernel, KernelRidge, Regularisation, ArdRvm, LearnedMetric, Model,
    ModelParts, MultiOutputRvm, Mlp, PcaMlp, MlpParts, NystromRidge, NystromRegularisation,
    MlpTrainer, PilotSample, Posterior, Progress, GroupedRegressor, AffineMap, AffineMapParts, Regressor,
    Report, Ridge, Scratch, StandardScaler, Stop, SufficientStatistics, SufficientStatisticsParts, LengthScales, RelevanceVectorMachine, Trace, Bandwidth,
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
