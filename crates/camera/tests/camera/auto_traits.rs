//! Everything public can be sent to, and shared between, threads.

use phalanx_camera::{
    Camera, Distortion, Error, Extrinsics, Fisheye, Intrinsics, Lens, PixelMap, Ray, Rig,
    Triangulation, ViewAngle, ViewScale, Volume,
};

const fn shared<T: Send + Sync>() {}

macro_rules! shared {
    ($($kind:ty),+ $(,)?) => { $( const _: () = shared::<$kind>(); )+ };
}

// A type that is not makes the tests fail to compile.
shared!(
    Camera,
    Distortion,
    Error,
    Extrinsics,
    Fisheye,
    Intrinsics,
    Lens,
    PixelMap,
    Ray,
    Rig,
    Triangulation,
    ViewAngle,
    ViewScale,
    Volume,
);
