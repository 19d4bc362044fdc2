//! Everything public can be sent to, and shared between, threads.

use phalanx_hand::{
    Bone, Digit, Dof, Error, FingerShape, ForearmShape, HandShape, PalmShape, Pose, PoseTable,
    PosedHand, Primitive, Side, Sphere, ThumbShape, Twist, Twists, Unit,
};

const fn shared<T: Send + Sync>() {}

macro_rules! shared {
    ($($kind:ty),+ $(,)?) => { $( const _: () = shared::<$kind>(); )+ };
}

// A type that is not makes the tests fail to compile.
shared!(
    Sphere,
    Digit,
    Dof,
    Error,
    FingerShape,
    ForearmShape,
    HandShape,
    Bone,
    Twist,
    Twists,
    PalmShape,
    Pose,
    PosedHand,
    PoseTable,
    Primitive,
    Side,
    ThumbShape,
    Unit,
);
