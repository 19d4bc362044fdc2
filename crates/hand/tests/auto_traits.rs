//! Everything public can be sent to, and shared between, threads.

use phalanx_hand::{
    Ball, Digit, Dof, Error, FingerShape, ForearmShape, HandShape, Link, Motion, Motions,
    PalmShape, Pose, PoseTable, PosedHand, Primitive, Side, ThumbShape, Unit,
};

const fn shared<T: Send + Sync>() {}

macro_rules! shared {
    ($($kind:ty),+ $(,)?) => { $( const _: () = shared::<$kind>(); )+ };
}

// A type that is not makes the tests fail to compile.
shared!(
    Ball,
    Digit,
    Dof,
    Error,
    FingerShape,
    ForearmShape,
    HandShape,
    Link,
    Motion,
    Motions,
    PalmShape,
    Pose,
    PosedHand,
    PoseTable,
    Primitive,
    Side,
    ThumbShape,
    Unit,
);
