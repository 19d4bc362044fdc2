//! Takes of all kinds.

use glam::{DAffine3, DVec3};
use phalanx_hand::{HandShape, Pose, Side};
use phalanx_io::take::{FrameView, LeftOut, Take, TakeFrame, TakeHeader};
use proptest::prelude::*;

/// Takes of all kinds, within what files hold.
pub(crate) fn takes() -> impl Strategy<Value = Take> {
    let name = "[a-zA-Z0-9_ <>\"',.&ü-]{0,12}[a-z]";
    let name = name.prop_filter("no space at the start", |name: &String| !name.starts_with(' '));
    let views = prop::collection::btree_set(name.clone(), 0..4);
    (views, any::<bool>(), prop::option::of(1.0..240.0_f64), prop::option::of("[0-9a-f]{8}"))
        .prop_flat_map(move |(views, left, rate_hz, model)| {
            let header = TakeHeader {
                hand: HandShape {
                    side: if left { Side::Left } else { Side::Right },
                    ..HandShape::adult()
                },
                world_from_hand: DAffine3::from_translation(DVec3::new(1.5, -2.25, 600.0)),
                views: views.into_iter().collect(),
                rate_hz,
                model,
            };
            let frames = prop::collection::vec(frames(header.clone(), name.clone()), 0..6);
            (Just(header), frames)
        })
        .prop_map(|(header, mut frames)| {
            for (k, frame) in frames.iter_mut().enumerate() {
                frame.index = 3 * k as u64;
                frame.time = k as f64 * 0.04 - 1.0;
            }
            Take { header, frames }
        })
}

fn frames(
    header: TakeHeader,
    code: impl Strategy<Value = String>,
) -> impl Strategy<Value = TakeFrame> {
    let numbers = prop::array::uniform28(-1.5..1.5_f64);
    let std = prop::array::uniform28(prop::option::of(0.0..0.5_f64));
    let left_out = prop::option::of(prop::sample::select(LeftOut::ALL.to_vec()));
    let view = (any::<bool>(), prop::option::of(0.0..=1.0_f64), left_out);
    let views = prop::collection::vec(view, header.views.len());
    let doubts = prop::collection::btree_set(code, 0..3);
    (prop::option::of((numbers, std)), views, doubts).prop_map(move |(estimate, views, doubts)| {
        TakeFrame {
            index: 0,
            time: 0.0,
            estimate: estimate.map(|(numbers, std)| header.estimate(Pose(numbers), std)),
            views: views
                .into_iter()
                .map(|(used, overlap, left_out)| FrameView { used, overlap, left_out })
                .collect(),
            doubts: doubts.into_iter().collect(),
        }
    })
}
