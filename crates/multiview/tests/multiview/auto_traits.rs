//! Everything public can be sent to, and shared between, threads.

use phalanx_multiview::{CodebookTrainer, Error, Estimate, PooledEncoder, Scratch, ViewEncoders};

const fn shared<T: Send + Sync>() {}

macro_rules! shared {
    ($($kind:ty),+ $(,)?) => { $( const _: () = shared::<$kind>(); )+ };
}

// A type that is not makes the tests fail to compile.
shared!(ViewEncoders, Error, Estimate, PooledEncoder, Scratch, CodebookTrainer,);
