//! What the files of other tools hold, read by a few lines of our own.

use glam::DVec3;
use phalanx_hand::{Dof, Side};
use phalanx_io::export::{
    Axes, CoordinateNames, LengthUnit, Placement, bvh, c3d, deviation_file, frame_rate, glb,
    largest_jitter, motion_file, trc,
};
use phalanx_io::take::Take;

use crate::sample;

const METRES: Placement = Placement { axes: Axes::World, unit: LengthUnit::Metre };

fn take() -> Take {
    sample::open_close(Side::Right)
}

fn rows(text: &str, header: usize) -> Vec<Vec<f64>> {
    let lines = text.lines().skip(header);
    lines.map(|line| line.split_whitespace().map(|cell| cell.parse().unwrap()).collect()).collect()
}

#[test]
fn trc_holds_every_joint_in_the_axes_and_unit_asked_for() {
    let take = take();
    let placement = Placement { axes: "xz-y".parse().unwrap(), ..METRES };
    let text = trc(&take, "take.trc", placement).unwrap();
    let header: Vec<&str> = text.lines().take(6).collect();
    assert_eq!(header[2], "30\t30\t40\t21\tm\t30\t1\t40");
    assert!(header[3].starts_with("Frame#\tTime\twrist\t\t\tthumb_cmc") && header[5].is_empty());
    let rows = rows(&text, 6);
    let joint = take.frames[7].estimate.as_ref().unwrap().joints[20];
    let expected = DVec3::new(joint.x, joint.z, -joint.y) * 1e-3;
    assert!((DVec3::from_slice(&rows[7][2 + 3 * 20..]) - expected).length() < 2e-6);
    assert!(rows[3][2..].iter().all(|cell| cell.is_nan()), "a lost frame keeps its columns");
    assert!(rows.iter().all(|row| row.len() == 2 + 3 * 21));
}

#[test]
fn motion_files_have_the_model_s_names_and_signs_and_the_deviations_beside() {
    let take = take();
    for (names, count, deviation) in [
        (CoordinateNames::Phalanx, 28, "wrist.deviation"),
        (CoordinateNames::OpenSim, 22, "deviation"),
        (CoordinateNames::MyoHand, 22, "deviation"),
    ] {
        let files = [motion_file, deviation_file]
            .map(|file| file(&take, names, LengthUnit::Millimetre).unwrap());
        let header = files[0].lines().position(|line| line == "endheader").unwrap();
        let columns: Vec<&str> = files[0].lines().nth(header + 1).unwrap().split('\t').collect();
        assert_eq!(columns.len(), count + 1);
        assert!(columns.contains(&deviation));
        let [angles, deviations] = files.each_ref().map(|file| {
            let header = file.lines().position(|line| line == "endheader").unwrap();
            rows(file, header + 2)
        });
        let estimate = take.frames[9].estimate.as_ref().unwrap();
        for (k, coordinate) in names.coordinates().iter().enumerate() {
            assert_eq!(columns[k + 1], coordinate.name);
            let expected = coordinate.dof.unit().to_file(estimate.pose[coordinate.dof]);
            // The frame before, 3, was lost.
            assert!((angles[8][k + 1] - coordinate.sign * expected).abs() < 1e-6);
        }
        assert_eq!((angles.len(), deviations.len()), (39, 39), "a lost frame has no row");
        assert!(deviations.iter().flatten().all(|std| *std >= 0.0));
        let all = names.coordinates().iter().all(|coordinate| coordinate.dof != Dof::ThetaX);
        assert_eq!(deviations[0].len(), columns.len() - usize::from(!all));
        let says = files[0].contains("not yet confirmed");
        assert_eq!(says, names != CoordinateNames::Phalanx, "who guesses says so");
    }
}

#[test]
fn bvh_keeps_the_pose_before_where_there_is_none() {
    let text = bvh(&take(), METRES).unwrap();
    assert_eq!(text.matches("JOINT").count(), 16);
    assert_eq!(text.matches("End Site").count(), 5);
    let motion = text.lines().position(|line| line == "MOTION").unwrap();
    let rows = rows(&text, motion + 3);
    assert_eq!((rows.len(), rows[0].len()), (40, 3 + 3 * 17));
    assert_eq!(rows[3], rows[2]);
}

#[test]
fn a_take_without_a_pose_says_so_where_gaps_cannot_be_held() {
    let mut take = take();
    take.frames.iter_mut().for_each(|frame| frame.estimate = None);
    assert!(
        bvh(&take, METRES).unwrap_err().to_string().contains("no frame of the take has a pose")
    );
    assert!(
        glb(&take, METRES).unwrap_err().to_string().contains("no frame of the take has a pose")
    );
    assert!(trc(&take, "t", METRES).is_ok() && c3d(&take, METRES).is_ok());
    take.frames.clear();
    assert!(trc(&take, "t", METRES).is_ok() && c3d(&take, METRES).is_ok());
    assert_eq!((frame_rate(&take), largest_jitter(&take)), (30.0, 0.0));
}

#[test]
fn units_and_axes_that_a_format_lacks_are_refused_by_name() {
    let take = take();
    let centimetres = Placement { unit: LengthUnit::Centimetre, ..METRES };
    assert_eq!(trc(&take, "t", centimetres).unwrap_err().to_string(), "TRC has lengths in mm or m");
    assert_eq!(glb(&take, centimetres).unwrap_err().to_string(), "glTF has lengths in m");
    for name in ["", "x", "xx-x", "yxz", "xyzx", "north"] {
        assert!(name.parse::<Axes>().unwrap_err().to_string().contains("without a mirror"));
    }
    assert!("ell".parse::<LengthUnit>().is_err() && "gait".parse::<CoordinateNames>().is_err());
}

#[test]
fn the_beat_and_how_far_frames_are_from_it_are_told() {
    let mut take = take();
    take.header.rate_hz = None;
    assert!((frame_rate(&take) - 30.0).abs() < 1e-9);
    assert!(largest_jitter(&take) < 1e-9);
    take.frames[5].time += 0.01;
    assert!((largest_jitter(&take) - 0.01).abs() < 1e-9);
}

#[test]
fn too_many_frames_for_c3d_are_refused() {
    let mut take = take();
    let last = take.frames.pop().unwrap();
    take.frames = (0..70_000)
        .map(|k| phalanx_io::take::TakeFrame { index: k, time: k as f64, ..last.clone() })
        .collect();
    let error = c3d(&take, METRES).unwrap_err().to_string();
    assert!(error.contains("65535"), "{error}");
}
