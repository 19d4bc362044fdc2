//! What is written is read again.

use phalanx_hand::{Dof, Side};
use phalanx_io::take::{
    Take, read_csv, read_json_lines, read_npz, write_csv, write_json_lines, write_npz,
};
use proptest::prelude::*;

use super::strategies;
use crate::{property, sample};

/// That two takes are the same up to so many degrees or millimetres.
fn assert_near(read: &Take, written: &Take, tolerance: f64) {
    assert_eq!(read.header, written.header);
    assert_eq!(read.frames.len(), written.frames.len());
    let near = |a: f64, b: f64| assert!((a - b).abs() <= tolerance, "{a} {b}");
    for (read, written) in read.frames.iter().zip(&written.frames) {
        assert_eq!((read.index, &read.doubts), (written.index, &written.doubts));
        near(read.time, written.time);
        for (read, written) in read.views.iter().zip(&written.views) {
            assert_eq!((read.used, read.left_out), (written.used, written.left_out));
            assert_eq!(read.overlap.is_some(), written.overlap.is_some());
            near(read.overlap.unwrap_or(0.0), written.overlap.unwrap_or(0.0));
        }
        assert_eq!(read.estimate.is_some(), written.estimate.is_some());
        let (Some(read), Some(written)) = (&read.estimate, &written.estimate) else { continue };
        for dof in Dof::ALL {
            near(dof.unit().to_file(read.pose[dof]), dof.unit().to_file(written.pose[dof]));
            let [read, written] = [read, written].map(|estimate| estimate.std[dof.index()]);
            assert_eq!(read.is_some(), written.is_some());
            near(
                dof.unit().to_file(read.unwrap_or(0.0)),
                dof.unit().to_file(written.unwrap_or(0.0)),
            );
        }
        let points = |joints: &[glam::DVec3]| -> Vec<f64> {
            joints.iter().flat_map(glam::DVec3::to_array).collect()
        };
        for (a, b) in points(&read.joints).into_iter().zip(points(&written.joints)) {
            near(a, b);
        }
        assert_eq!(read.joint_std.is_some(), written.joint_std.is_some());
        let [read, written] =
            [read, written].map(|estimate| points(&estimate.joint_std.unwrap_or_default()));
        read.into_iter().zip(written).for_each(|(a, b)| near(a, b));
    }
}

/// Half of the last decimal.
const DECIMALS: f64 = 0.5001e-4;

fn csv(take: &Take) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_csv(take, &mut bytes).unwrap();
    bytes
}

fn json_lines(take: &Take) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_json_lines(take, &mut bytes).unwrap();
    bytes
}

proptest! {
    #![proptest_config(property::cases(64))]

    #[test]
    fn every_form_keeps_every_take(take in strategies::takes()) {
        prop_assert!(take.validate().is_ok());
        if !take.frames.is_empty() {
            assert_near(&read_csv(&csv(&take)[..]).unwrap(), &take, DECIMALS);
        }
        assert_near(&read_json_lines(&json_lines(&take)[..]).unwrap(), &take, DECIMALS);
        assert_near(&read_npz(&write_npz(&take).unwrap()).unwrap(), &take, 1e-9);
    }

    #[test]
    fn damaged_archives_are_refused_or_read_without_a_panic(
        at in any::<prop::sample::Index>(),
        byte in any::<u8>(),
        end in any::<prop::sample::Index>(),
    ) {
        let mut take = sample::open_close(Side::Right);
        take.frames.truncate(2);
        let whole = write_npz(&take).unwrap();
        let mut damaged = whole.clone();
        damaged[at.index(whole.len())] = byte;
        let _ = read_npz(&damaged);
        prop_assert!(read_npz(&whole[..end.index(whole.len())]).is_err());
    }
}

#[test]
fn the_csv_is_a_plain_table() {
    let take = sample::open_close(Side::Right);
    let bytes = csv(&take);
    let mut table = csv::Reader::from_reader(&bytes[..]);
    let names = table.headers().unwrap().clone();
    assert_eq!(&names[0], "frame");
    assert_eq!(&names[2], "thumb.abduction");
    assert_eq!(&names[3], "thumb.abduction_std");
    let rows: Vec<_> = table.records().map(|row| row.unwrap()).collect();
    let cell = |row: usize, name: &str| {
        rows[row][names.iter().position(|other| other == name).unwrap()].to_owned()
    };
    assert_eq!(cell(0, "index.mcp"), "-6.0000");
    assert_eq!(cell(0, "index.mcp_std"), "1.7189");
    assert_eq!(cell(0, "global.theta_x_std"), "");
    assert_eq!(cell(3, "index.mcp"), "");
    assert_eq!(cell(0, "quality"), "0.9300");
    assert_eq!((cell(0, "views"), cell(3, "views")), ("side".to_owned(), String::new()));
    assert_eq!(cell(5, "doubts"), "few-views;low-overlap");
    assert_eq!(
        (cell(7, "left_out"), cell(7, "doubts")),
        ("top:disagrees".to_owned(), String::new())
    );
    assert!(cell(0, "take").starts_with('{') && cell(1, "take").is_empty());
}

#[test]
fn the_columns_may_stand_in_any_order_and_others_beside_them() {
    let take = sample::open_close(Side::Left);
    let bytes = csv(&take);
    let mut table = csv::Reader::from_reader(&bytes[..]);
    let mut turned = csv::Writer::from_writer(Vec::new());
    let names = table.headers().unwrap().clone();
    turned.write_record(std::iter::once("patient").chain(names.iter().rev())).unwrap();
    for row in table.records() {
        let row = row.unwrap();
        turned.write_record(std::iter::once("7").chain(row.iter().rev())).unwrap();
    }
    assert_near(&read_csv(&turned.into_inner().unwrap()[..]).unwrap(), &take, DECIMALS);
}

#[test]
fn the_same_take_has_the_same_bytes() {
    let take = sample::open_close(Side::Right);
    assert_eq!(write_npz(&take).unwrap(), write_npz(&take).unwrap());
}
