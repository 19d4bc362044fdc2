//! Everything public can be sent to, and shared between, threads.

use phalanx_render::{Appearance, Background, DepthMap, Error, Renderer, Supersampling};

const fn shared<T: Send + Sync>() {}

macro_rules! shared {
    ($($kind:ty),+ $(,)?) => { $( const _: () = shared::<$kind>(); )+ };
}

// A type that is not makes the tests fail to compile.
shared!(Appearance, Background, DepthMap, Error, Renderer, Supersampling,);
