//! What is wrong is said, with the place.

use phalanx_hand::Side;
use phalanx_io::Source;
use phalanx_io::landmarks::read;

#[track_caller]
fn refused(bytes: &[u8], says: &str) {
    let error = read(&Source { name: "cam0.file", bytes }, Side::Right).unwrap_err().to_string();
    assert!(error.starts_with("landmarks: cam0.file: "), "{error}");
    assert!(error.contains(says), "{error}");
}

#[test]
fn other_files_are_refused_by_name() {
    refused(b"", "empty");
    refused(b"\n \n", "empty");
    refused(b"hello", "not recognised");
    refused(b"\x89HDF\r\n\x1a\n", "to_csv");
    refused(b"PK\x03\x04", "numpy.save");
    refused(b"\x80\x04\x95", "pickle");
    refused(b"\xff\x00\xfa", "neither text");
}

#[test]
fn json_is_refused_with_its_place() {
    refused(b"[[[1, 2], [3, 4]]]", "frame 0 of the file: 2 points, not the 21");
    refused(
        b"[\n  {\"hand_landmarks\": [[{\"x\": NaN",
        "expected value at line 2 column 30; a point that is not seen is null",
    );
    refused(b"[{\"hand_landmarks\": 3}]", "line 1, column 23: what ends here is no frame");
    refused(b"{\"people\": [{\"hand_right_keypoints_2d\": [1, 2, 3, 4]}]}", "person 0");
    let hand = format!("[{}]", vec!["[0.1, 0.2]"; 21].join(","));
    let two = format!("[{{\"hand_landmarks\": [{hand}, {hand}]}}]");
    refused(two.as_bytes(), "does not say which is left");
    let named = format!("[{{\"hand_landmarks\": [{hand}], \"handedness\": [\"Up\"]}}]");
    refused(named.as_bytes(), "'Up' is neither Left nor Right");
    let twice = format!(
        "[{{\"frame\": 3, \"landmarks\": {hand}}}, {{\"frame\": 3, \"landmarks\": {hand}}}]"
    );
    refused(twice.as_bytes(), "frame 3 comes twice");
    let some = format!("[{{\"frame\": 3, \"landmarks\": {hand}}}, {{\"landmarks\": {hand}}}]");
    refused(some.as_bytes(), "some frames have a number");
}

#[test]
fn tables_are_refused_with_their_line() {
    let table = |rows: &str| format!("frame,joint,x_px,y_px\n{rows}");
    refused(b"frame,joint,x_px\n", "'y_px' or 'y' is absent");
    refused(b"frame;joint;x_px;y_px\n0;1;1,5;2\n", "separated by ';': separate them by commas");
    refused(table("0,21,1,1\n").as_bytes(), "line 2, column 'joint': '21'");
    refused(table("0,1,1,1\n0,2,a,1\n").as_bytes(), "line 3, column 'x_px': 'a' is no number");
    refused(table("0,1,1,1\n0,1,2,2\n").as_bytes(), "line 3: joint 1 of frame 0 comes twice");
    refused(table("a,1,1,1\n").as_bytes(), "column 'frame'");
    let parts =
        |part: &str, rows: &str| format!("scorer,n,n\nbodyparts,{part},{part}\ncoords,x,y\n{rows}");
    refused(parts("nose", "").as_bytes(), "none of its body parts is known");
    refused(parts("wrist", "0,1,b\n").as_bytes(), "line 4, column 3: 'b'");
    refused(parts("wrist", "x,1,2\n").as_bytes(), "line 4");
    refused(
        b"scorer,n,n\nindividuals,a,b\nbodyparts,wrist,wrist\ncoords,x,y\n",
        "several individuals",
    );
    refused(b"scorer,n,n\n", "ends before the row `coords`");
}

#[test]
fn arrays_are_refused_by_their_shape() {
    let array = |shape: &str, numbers: &[f64]| {
        let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({shape}), }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend(u16::try_from(header.len()).unwrap().to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        bytes
    };
    refused(&array("1, 20, 2", &[0.0; 40]), "its shape is [1, 20, 2]");
    refused(&array("1, 21, 2", &[0.0; 41]), "bytes");
    refused(&array("1, 21, 3", &[7.0; 63]), "frame 0: a point's third number is 7");
    refused(&array("0, 21, 2", &[]), "no frame");
}
