//! Range of motion, and a take beside a reference.

use glam::DVec3;
use phalanx_hand::{Dof, Side};
use phalanx_io::evaluation::{Clock, LEVELS, evaluate, lag, read_csv, read_motion_file, read_trc};
use phalanx_io::export::{
    CoordinateNames, LengthUnit, Placement, deviation_file, motion_file, trc,
};
use phalanx_io::report::{
    FrameChoice, NamedRange, RangeOfMotion, print_page, range_table, to_csv, to_text,
};
use phalanx_io::take::{Take, write_csv};

use crate::sample;

fn take() -> Take {
    sample::open_close(Side::Right)
}

/// A take of which one angle alone moves, −10°, 20°, 80° and, doubted, 170°.
fn four_angles() -> Take {
    let mut take = take();
    take.frames.retain(|frame| frame.estimate.is_some());
    take.frames.truncate(4);
    for (frame, degrees) in take.frames.iter_mut().zip([-10.0_f64, 20.0, 80.0, 170.0]) {
        let estimate = frame.estimate.as_mut().unwrap();
        estimate.pose = phalanx_hand::Pose::REST;
        estimate.pose[Dof::IndexPip] = degrees.to_radians();
        estimate.std = [Some(1_f64.to_radians()); Dof::COUNT];
        frame.doubts = if degrees > 100.0 { vec!["blur".to_owned()] } else { vec![] };
    }
    take
}

#[test]
fn the_range_is_that_of_the_trusted_frames_with_deviations() {
    let range = RangeOfMotion::of(&four_angles(), FrameChoice::Trusted).unwrap();
    assert_eq!((range.counted, range.frames), (3, 4));
    let index = &range.angles[Dof::IndexPip.index()];
    let degrees = |measured: phalanx_io::report::Measured| {
        [measured.value, measured.std.unwrap()].map(f64::to_degrees)
    };
    let near = |a: [f64; 2], b: [f64; 2]| assert!((a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-9);
    near(degrees(index.smallest), [-10.0, 1.0]);
    near(degrees(index.range), [90.0, 2_f64.sqrt()]);
    // Stretching beyond straight does not count: 80° + 0 + 0, less 0.
    near(degrees(range.totals[1]), [80.0, 6_f64.sqrt()]);
    let all = RangeOfMotion::of(&four_angles(), FrameChoice::All).unwrap();
    near(degrees(all.angles[Dof::IndexPip.index()].largest), [170.0, 1.0]);
    let mut none = four_angles();
    none.frames.iter_mut().for_each(|frame| frame.doubts = vec!["blur".to_owned()]);
    assert!(RangeOfMotion::of(&none, FrameChoice::Trusted).is_none());
}

#[test]
fn one_frame_has_no_range() {
    let mut take = four_angles();
    take.frames.truncate(1);
    let range = RangeOfMotion::of(&take, FrameChoice::Trusted).unwrap();
    let table = range_table(NamedRange { name: "still", range: &range }, None);
    let [angle, total] = ["index.pip", "index total"]
        .map(|name| table.rows.iter().find(|row| row.name == name).unwrap().cells[0]);
    assert!(angle[0].is_some() && angle[1].is_some() && angle[2].is_none(), "{angle:?}");
    assert!(total[2].is_none(), "{total:?}");
    assert_eq!(table.notes, ["still: 1 of 1 frames counts, which has no range"]);
}

#[test]
fn two_takes_stand_side_by_side_in_every_form() {
    let mut after = four_angles();
    after.frames[2].estimate.as_mut().unwrap().pose[Dof::IndexPip] = 95_f64.to_radians();
    let ranges =
        [four_angles(), after].map(|take| RangeOfMotion::of(&take, FrameChoice::Trusted).unwrap());
    let [before, after] = &ranges;
    let named = |name, range| NamedRange { name, range };
    let table = range_table(named("<b>before", before), Some(named("after", after)));
    let text = to_text(&table);
    let line = text.lines().find(|line| line.starts_with("index.pip")).unwrap();
    assert!(line.contains("105.0 ± 1.4") && line.ends_with("15.0 ± 2.0"), "{line}");
    let csv = String::from_utf8(to_csv(&table).unwrap()).unwrap();
    assert!(csv.starts_with("angle,<b>before.smallest,<b>before.smallest_std,"));
    let row = csv.lines().find(|line| line.starts_with("index.pip")).unwrap();
    assert!(row.ends_with("15.0000,2.0000"), "{row}");
    let page = print_page(&table);
    assert!(page.contains("&lt;b&gt;before") && !page.contains("<b>") && !page.contains("{{"));
    assert_eq!(page.matches("<tr>").count(), 2 + 22 + 5);
}

#[test]
fn every_kind_of_reference_agrees_with_the_take_it_was_made_of() {
    let take = take();
    let mut csv = Vec::new();
    write_csv(&take, &mut csv).unwrap();
    let motion = |names| motion_file(&take, names, LengthUnit::Millimetre).unwrap();
    let references = [
        read_csv(&csv[..]).unwrap(),
        read_trc(&trc(&take, "t", Placement::WORLD).unwrap()).unwrap(),
        read_motion_file(&motion(CoordinateNames::Phalanx)).unwrap(),
        read_motion_file(&motion(CoordinateNames::OpenSim)).unwrap(),
        read_motion_file(&motion(CoordinateNames::MyoHand)).unwrap(),
    ];
    for reference in references {
        let evaluation = evaluate(&take, &reference, 0.0);
        assert_eq!((evaluation.matched, evaluation.unmatched), (39, 0));
        let numbers = evaluation.dofs.iter().map(|scores| (scores.count, scores.rms));
        let joints = evaluation.joints.iter().map(|scores| (scores.count, scores.rms));
        let compared: Vec<_> = numbers.chain(joints).filter(|(count, _)| *count > 0).collect();
        assert!(compared.len() >= 21);
        assert!(compared.iter().all(|&(count, rms)| rms < 2e-4 && count == 39));
    }
}

#[test]
fn errors_and_coverage_are_counted() {
    let take = take();
    let mut csv = Vec::new();
    write_csv(&take, &mut csv).unwrap();
    let mut reference = read_csv(&csv[..]).unwrap();
    // Half of the truths 0.8 deviations off, half 3; the deviation is 0.03 rad.
    for (k, pose) in reference.poses.iter_mut().enumerate() {
        pose[Dof::IndexPip.index()] -= if k % 2 == 0 { 0.024 } else { 0.09 };
    }
    let evaluation = evaluate(&take, &reference, 0.0);
    let scores = &evaluation.dofs[Dof::IndexPip.index()];
    let near = f64::from(20) / 39.0;
    assert!((scores.bias[0] - (near * 0.024 + (1.0 - near) * 0.09)).abs() < 1e-5);
    for ((level, _), share) in LEVELS.iter().zip(scores.coverage) {
        let expected = if *level >= 0.60 { near } else { 0.0 };
        assert!((share - expected).abs() < 1e-9, "{level}: {share}");
    }
    assert_eq!(evaluation.dofs[Dof::ThetaX.index()].promised, 0, "it has no deviation");
    // A joint that is said to be beside where it was.
    let beside = DVec3::new(2.0, -3.0, 6.0);
    reference.joints.iter_mut().for_each(|joints| joints[8] -= beside);
    let scores = &evaluate(&take, &reference, 0.0).joints[8];
    assert!(DVec3::from(scores.bias).distance(beside) < 1e-3 && (scores.mean - 7.0).abs() < 1e-3);
}

#[test]
fn the_lag_is_found_to_a_part_of_a_frame() {
    let mut take = take();
    take.frames.retain(|frame| frame.estimate.is_some());
    // A motion that does not repeat itself.
    for frame in &mut take.frames {
        let estimate = frame.estimate.as_mut().unwrap();
        estimate.pose[Dof::IndexPip] = (9.0 * frame.time + 4.0 * frame.time.powi(2)).sin();
    }
    let mut csv = "time,index.pip\n".to_owned();
    for k in 0..200 {
        let time = f64::from(k) * 0.01;
        let early = time + 0.05;
        let angle = (9.0 * early + 4.0 * early.powi(2)).sin().to_degrees();
        csv += &[time.to_string(), angle.to_string()].join(",");
        csv.push('\n');
    }
    let reference = read_csv(csv.as_bytes()).unwrap();
    let lag = lag(&take, &reference).unwrap();
    assert!((lag.seconds - 0.05).abs() < 0.008 && lag.correlation > 0.95, "{lag:?}");
    let aligned = evaluate(&take, &reference, lag.seconds);
    let as_it_is = evaluate(&take, &reference, 0.0);
    let rms = |evaluation: &phalanx_io::evaluation::Evaluation| {
        evaluation.dofs[Dof::IndexPip.index()].rms
    };
    assert!(rms(&aligned) < 0.3 * rms(&as_it_is));
}

#[test]
fn references_that_are_none_are_refused_with_what_to_do() {
    let csv = |text: &str| read_csv(text.as_bytes()).unwrap_err().to_string();
    assert!(csv("index.pip\n3\n").contains("neither a column 'time' nor 'frame'"));
    assert!(csv("time,knee\n0,3\n").contains("such as 'index.pip'"));
    assert!(csv("time\tindex.pip\n0\t3\n").contains("separated by '\\t'"));
    assert!(csv("time,index.pip\n0,3\n0,4\n").contains("do not ascend"));
    assert!(csv("time,index.pip\n0,x\n").contains("'x' is not a number"));
    assert!(csv("time,index.pip\n").contains("no row"));
    assert!(read_trc("frame").unwrap_err().to_string().contains("PathFileType"));
    assert!(read_motion_file("time").unwrap_err().to_string().contains("endheader"));
    let unknown = "endheader\ntime\tknee\n0\t1\n";
    assert!(read_motion_file(unknown).unwrap_err().to_string().contains("known name"));
    let by_frame = read_csv("frame,index.pip\n1,-6\n".as_bytes()).unwrap();
    assert_eq!(by_frame.clock, Clock::Frame);
    assert!(lag(&take(), &by_frame).is_none());
    let steady: String = (0..60)
        .map(|k| [f64::from(k) / 30.0, f64::from(k)].map(|n| n.to_string()).join(",") + "\n")
        .collect();
    let steady = read_csv(("time,index.pip\n".to_owned() + &steady).as_bytes()).unwrap();
    assert!(lag(&take(), &steady).is_none(), "a steady motion has no lag");
    assert_eq!(evaluate(&take(), &by_frame, 0.0).matched, 1);
    assert!(csv("frame,joint,x_mm,y_mm\n0,0,1,2\n").contains("no columns x, y, z"));
    assert!(csv("frame,joint,x,y,z\n0,21,1,2,3\n").contains("'21' is no joint"));
    assert!(csv("frame,joint,x,y,z\n0,8,1,2,3\n0,index_tip,1,2,3\n").contains("stands twice"));
    let sto = deviation_file(&take(), CoordinateNames::Phalanx, LengthUnit::Millimetre).unwrap();
    assert!(read_motion_file(&sto).is_ok());
}

/// A row a joint says what a row an instant says: by name or number, mm or m, in any order.
#[test]
fn a_reference_may_have_a_row_a_joint() {
    let wide = "frame,wrist_x,wrist_y,wrist_z,index_tip_x,index_tip_y,index_tip_z\n\
                0,1,2,3,4,5,6\n2,7,8,9,,,\n";
    let wide = read_csv(wide.as_bytes()).unwrap();
    for long in [
        "frame,joint,x_mm,y_mm,z_mm\n0,0,1,2,3\n0,8,4,5,6\n2,0,7,8,9\n",
        "joint,x,y,z,frame\nindex_tip,4,5,6,0\nwrist,7,8,9,2\nwrist,1,2,3,0\n",
        "frame,joint,x_m,y_m,z_m\n0,0,0.001,0.002,0.003\n2,0,0.007,0.008,0.009\n0,8,0.004,0.005,0.006\n",
    ] {
        let long = read_csv(long.as_bytes()).unwrap();
        assert_eq!((long.clock, &long.instants), (Clock::Frame, &wide.instants));
        for (long, wide) in long.joints.iter().flatten().zip(wide.joints.iter().flatten()) {
            let is_same = long.distance(*wide) < 1e-9 || long.is_nan() && wide.is_nan();
            assert!(is_same, "{long} {wide}");
        }
    }
}
