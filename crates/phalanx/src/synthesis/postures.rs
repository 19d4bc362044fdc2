//! How the angles of a hand go together.

use std::sync::LazyLock;

use phalanx_hand::{Pose, sample_pose};
use phalanx_refine::PosePrior;

use crate::synthesis::rng::ItemRng;

/// Poses from the prior that tell how angles go together.
const POSTURES: u64 = 2000;

static COUPLED: LazyLock<PosePrior> = LazyLock::new(|| {
    let pose = |item| {
        let mut random = ItemRng::new(0, item);
        sample_pose(|| random.uniform())
    };
    let postures: Vec<Pose> = (0..POSTURES).map(pose).collect();
    PosePrior::of_poses(&postures).expect("poses of the prior differ")
});

/// The angles of the fingers as in the coupled prior ([`phalanx_hand::sample_pose`]).
pub(crate) fn coupled() -> &'static PosePrior {
    &COUPLED
}
