//! Everything public can be sent to, and shared between, threads.

use phalanx_segmentation::{
    BackgroundModel, BackgroundParams, BackgroundParts, Cleanup, Contour, CropWindow, Error,
    Forearm, ForearmCue, HandDetection, HandDetector, Label, PlainBackground, SceneModel,
    Silhouette, SkinModel, SkinParams, SkinParts, SkinTrainer, Workspace, WristModel, WristTrainer,
};

const fn shared<T: Send + Sync>() {}

macro_rules! shared {
    ($($kind:ty),+ $(,)?) => { $( const _: () = shared::<$kind>(); )+ };
}

// A type that is not makes the tests fail to compile.
shared!(
    BackgroundModel,
    BackgroundParams,
    BackgroundParts,
    Cleanup,
    Contour,
    CropWindow,
    Error,
    ForearmCue,
    Forearm,
    HandDetector,
    Label,
    HandDetection,
    Silhouette,
    SkinModel,
    SkinParams,
    SkinParts,
    SkinTrainer,
    PlainBackground,
    SceneModel,
    Workspace,
    WristModel,
    WristTrainer,
);
