//! Hand files and pose files.

use phalanx_hand::{Dof, Error, HandShape, Pose, PoseTable, write_poses};

fn read(text: &str) -> Result<PoseTable, Error> {
    PoseTable::read(text.as_bytes())
}

#[test]
fn shape_survives_its_file() {
    let shape = HandShape::adult();
    assert_eq!(HandShape::from_toml(&shape.to_toml()).unwrap(), shape);
}

#[test]
fn impossible_shapes_are_refused_by_name() {
    let mut shape = HandShape::adult();
    shape.ring.lengths_mm[1] = f64::NAN;
    let error = HandShape::from_toml(&shape.to_toml()).unwrap_err();
    assert!(error.to_string().contains("ring.lengths_mm[1]"), "{error}");
    assert!(HandShape::from_toml("side = \"right\"").is_err());
}

#[test]
fn poses_survive_their_file_and_absent_columns_are_zero() {
    let mut pose = Pose::REST;
    pose[Dof::IndexPip] = 60_f64.to_radians();
    pose[Dof::TZ] = -12.5;
    let mut bytes = Vec::new();
    write_poses(&mut bytes, &[pose, Pose::REST], &[Dof::IndexPip, Dof::TZ]).unwrap();
    let table = PoseTable::read(bytes.as_slice()).unwrap();
    assert_eq!(table.frames, Some(vec!["0".to_owned(), "1".to_owned()]));
    assert_eq!(table.warnings, Vec::<String>::new());
    for (read, written) in table.poses.iter().zip([pose, Pose::REST]) {
        for dof in Dof::ALL {
            assert!((read[dof] - written[dof]).abs() < 1e-9, "{dof}");
        }
    }
}

#[test]
fn bad_pose_files_are_refused_by_name() {
    assert!(matches!(read("index.pip,index.pipe\n1,2\n"), Err(Error::UnknownDof { .. })));
    assert!(matches!(read("index.pip,index.pip\n1,2\n"), Err(Error::RepeatedColumn { .. })));
    assert!(matches!(read("frame,time\n1,2\n"), Err(Error::NoColumn { .. })));
    assert!(matches!(read(""), Err(Error::NoPoses { .. })));
    assert!(matches!(read("index.pip\n"), Err(Error::NoPoses { .. })));
    assert!(matches!(read("index.pip\nNaN\n"), Err(Error::BadCell { row: 1, .. })));
    assert!(matches!(read("index.pip,index.dip\n1\n"), Err(Error::Csv(_))));
}

#[test]
fn the_table_of_a_take_is_read_with_deviations_and_lost_frames_left_out() {
    let table = "frame,time,index.pip,index.pip_std,wrist_x,wrist_x_std,a,b,c\n\
                 0,0,30,2,1,1,,,\n1,0.1,,,,,,,\n2,0.2,60,2,1,1,,,\n";
    let table = read(table).unwrap();
    let degrees: Vec<f64> =
        table.poses.iter().map(|pose| pose[Dof::IndexPip].to_degrees().round()).collect();
    assert_eq!(degrees, [30.0, 60.0]);
    assert_eq!(table.frames, Some(vec!["0".to_owned(), "2".to_owned()]));
    let [others, empty] = &table.warnings[..] else { panic!("{:?}", table.warnings) };
    assert_eq!(
        others,
        "columns passed over: 'time', 'wrist_x', 'wrist_x_std', 'a', 'b' and 1 more"
    );
    assert_eq!(empty, "1 rows without a pose are left out");
    assert!(matches!(read("index.pip_stdev\n1\n"), Err(Error::UnknownDof { .. })));
    assert!(matches!(read("index.pip,index.dip\n1,\n"), Err(Error::BadCell { row: 1, .. })));
    assert!(matches!(read("index.pip,index.dip\n,\n"), Err(Error::NoPoses { .. })));
}

#[test]
fn odd_values_are_kept_with_a_warning() {
    let table = read("index.pip,index.mcp,index.abduction,note\n150,90,15,7\n").unwrap();
    assert!((table.poses[0][Dof::IndexPip].to_degrees() - 150.0).abs() < 1e-9);
    let warnings = table.warnings.join("; ");
    assert!(warnings.contains("index.pip (1)"), "{warnings}");
    assert!(warnings.contains("index.abduction (1)"), "a bent knuckle spreads less: {warnings}");
    assert!(warnings.contains("note"), "{warnings}");
}

#[test]
fn what_a_spreadsheet_makes_of_a_file_is_named() {
    let utf16: Vec<u8> =
        "\u{feff}index.pip\n3\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    for (bytes, words) in [
        (&b"index.pip;index.dip\n1,5;2\n"[..], "separated by ';': separate them by commas"),
        (b"index.pip\tindex.dip\n1\t2\n", "separated by '\\t'"),
        (b"sep=,\nindex.pip\n3\n", "the first line, 'sep=,', names no column of a pose"),
        (b"index_pip,index_dip\n1,2\n", "the first line, 'index_pip,index_dip', names no column"),
        (b"index.pip,index.dip\n1,2\n3\n", "line 3 has 1 cells, lines before it have 2"),
        (&utf16, "line 1 is not UTF-8: save the file as UTF-8"),
    ] {
        let error = PoseTable::read(bytes).unwrap_err();
        let said = error.to_string();
        assert!(said.contains(words) && !said.contains("CSV error"), "no '{words}' in: {said}");
        assert!(std::error::Error::source(&error).is_none(), "said twice where causes are listed");
    }
    let commented = read("# by glove 3\nindex.pip\n30\n").unwrap();
    assert_eq!(commented.poses.len(), 1);
}

#[test]
fn radians_are_told_from_degrees() {
    let warned = |text: &str| read(text).unwrap().warnings.join("; ").contains("radians");
    assert!(warned("index.mcp,index.pip,global.t_x\n0,0,40\n-0.4,1.57,41\n"));
    assert!(!warned("index.mcp,index.pip\n0,0\n-0.4,57\n"), "one angle is enough");
    assert!(!warned("index.pip\n0\n"), "a hand at rest");
}
