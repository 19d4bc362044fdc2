//! Everything public can be sent to, and shared between, threads.

use phalanx_multiview::{Codes, Concatenation, Error, Estimate, Pooled, Scratch, Vocabulary};

const fn shared<T: Send + Sync>() {}

macro_rules! shared {
    ($($kind:ty),+ $(,)?) => { $( const _: () = shared::<$kind>(); )+ };
}

// A type that is not makes the tests fail to compile.
shared!(Codes, Concatenation, Error, Estimate, Pooled, Scratch, Vocabulary,);
