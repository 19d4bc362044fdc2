//! Everything public can be sent to, and shared between, threads.

use phalanx_codebook::{
    AnyCoding, Codebook, Error, ExpectationMaximisation, Fisher, Fit, FixedRadius, GaussianMixture,
    KMeans, Metric, MiniBatch, MixtureParts, Nearest, Report, Scratch, SoftCounts, Vlad, Voting,
};

const fn shared<T: Send + Sync>() {}

macro_rules! shared {
    ($($kind:ty),+ $(,)?) => { $( const _: () = shared::<$kind>(); )+ };
}

// A type that is not makes the tests fail to compile.
shared!(
    AnyCoding,
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
    SoftCounts,
    Vlad,
    Voting,
);
