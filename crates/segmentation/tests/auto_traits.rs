//! Everything public can be sent to, and shared between, threads.

use phalanx_segmentation::{
    BackgroundModel, BackgroundParams, BackgroundParts, Cleanup, Contour, CropWindow, Error,
    Evidence, Forearm, HandFinder, Label, LocatedHand, Silhouette, SkinModel, SkinParams,
    SkinParts, SkinTrainer, Wall, Workspace, WristModel, WristTrainer,
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
    Evidence,
    Forearm,
    HandFinder,
    Label,
    LocatedHand,
    Silhouette,
    SkinModel,
    SkinParams,
    SkinParts,
    SkinTrainer,
    Wall,
    Workspace,
    WristModel,
    WristTrainer,
);
