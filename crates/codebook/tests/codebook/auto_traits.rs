//! Everything public can be sent to, and shared between, threads.

use phalanx_codebook::{
    AnyEncoder, Codebook, Error, ExpectationMaximisation, Fisher, Fit, FixedRadius,
    GaussianMixture, KMeans, Metric, MiniBatch, MixtureParts, Nearest, Report, Scratch,
    SoftAssignment, SoftHistogram, Vlad,
};

const fn shared<T: Send + Sync>() {}

macro_rules! shared {
    ($($kind:ty),+ $(,)?) => { $( const _: () = shared::<$kind>(); )+ };
}

// A type that is not makes the tests fail to compile.
shared!(
    AnyEncoder,
    Codebook,
    Error,
    ExpectationMaximisation,
    Fisher,
    Fit,
    FixedRadius,
    GaussianMixture,
    KMeans,
    Metric,
    MiniBatch,
    MixtureParts,
    Nearest,
    Report,
    Scratch,
    SoftHistogram,
    Vlad,
    SoftAssignment,
);
