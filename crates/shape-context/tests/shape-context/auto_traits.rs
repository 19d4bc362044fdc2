//! Everything public can be sent to, and shared between, threads.

use phalanx_shape_context::{
    Axis, Binning, Chain, Descriptors, Error, ForearmAxis, Matcher, Matching, Orientation,
    ShapeContexts,
};

const fn shared<T: Send + Sync>() {}

macro_rules! shared {
    ($($kind:ty),+ $(,)?) => { $( const _: () = shared::<$kind>(); )+ };
}

// A type that is not makes the tests fail to compile.
shared!(
    Axis,
    Binning,
    Chain,
    Descriptors<'static>,
    Error,
    ForearmAxis,
    Matcher,
    Matching<'static>,
    Orientation,
    ShapeContexts,
);
