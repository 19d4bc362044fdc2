//! A take to write and read.

use glam::{DAffine3, DMat3, DVec3};
use phalanx_hand::{Dof, HandShape, Pose, PoseTable, Side};
use phalanx_io::take::{FrameView, LeftOut, Take, TakeFrame, TakeHeader};

/// The opening and closing hand of the fixtures at 30 Hz by two cameras; frame 3 is lost, frame 5
/// doubted, one camera left out of frame 7, the hand's turn about X not estimated.
pub(crate) fn open_close(side: Side) -> Take {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/trajectories/open-close.csv");
    let table = PoseTable::read(std::fs::File::open(file).unwrap()).unwrap();
    let header = TakeHeader {
        hand: HandShape { side, ..HandShape::adult() },
        world_from_hand: DAffine3::from_mat3_translation(
            DMat3::from_rotation_x(0.4) * DMat3::from_rotation_z(-1.1),
            DVec3::new(10.0, 250.0, -40.0),
        ),
        views: vec!["side".to_owned(), "top".to_owned()],
        rate_hz: Some(30.0),
        model: Some("3f6c".to_owned()),
    };
    let frames = table.poses.iter().take(40).enumerate().map(|(k, pose)| frame(&header, k, *pose));
    Take { frames: frames.collect(), header }
}

fn frame(header: &TakeHeader, k: usize, mut pose: Pose) -> TakeFrame {
    pose[Dof::ThetaX] = 0.02 * k as f64;
    pose[Dof::TX] = k as f64;
    pose[Dof::WristFlexion] = -0.01 * k as f64;
    let mut std = [Some(0.03); Dof::COUNT];
    std[Dof::ThetaX.index()] = None;
    let estimate = (k != 3).then(|| header.estimate(pose, std));
    let lost = estimate.is_none();
    TakeFrame {
        index: k as u64 + 1,
        time: k as f64 / 30.0,
        estimate,
        views: vec![
            FrameView { used: !lost, overlap: (!lost).then_some(0.93), left_out: None },
            FrameView {
                used: false,
                overlap: None,
                left_out: (k == 7).then_some(LeftOut::Disagrees),
            },
        ],
        doubts: match k {
            3 => vec!["no-hand".to_owned()],
            5 => vec!["few-views".to_owned(), "low-overlap".to_owned()],
            _ => vec![],
        },
    }
}
