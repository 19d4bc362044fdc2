//! Points of a hand that a detector saw in each camera's pictures, read from its files.
//!
//! [`read`] tells them apart by what they hold:
//!
//! | written by | form |
//! |---|---|
//! | MediaPipe's hand landmarker, by any script | JSON or JSON Lines: a result, or 21 points, a frame; of one camera, or by camera under `views` |
//! | OpenPose | JSON, a file a frame |
//! | DeepLabCut, Anipose | CSV with the rows `scorer`, `bodyparts` and `coords` |
//! | NumPy | NPY: frames × 21 × 2 or 3, or with the cameras before that |
//! | a table | CSV with the columns `frame`, `joint`, `x_px`, `y_px` and perhaps `confidence` |
//!
//! Points come out in the common order, wrist first, then base to tip of thumb, index, middle, ring and
//! little finger. Those that are not a number are missing.

mod array;
mod candidates;
mod deeplabcut;
mod mediapipe;
mod names;
mod openpose;
mod table;
mod track;

use phalanx_hand::Side;

pub use track::{LandmarkTrack, number_in_name};

use crate::error::{Error, Result};
use crate::source::Source;

/// Reads a file of landmarks of the hand of a `side`: one track for each camera that it holds.
///
/// Frames have the numbers that the file says, of files of one frame the last number of their name, and
/// else 0, 1, … A frame without the hand is missing in its track.
///
/// MediaPipe names a hand's side where it saw several: `multi_handedness` as in a mirror, which these
/// pictures are not, `handedness` as it is. Where no frame shows more than one hand that hand is taken,
/// whatever it is called.
///
/// # Errors
/// A file that is none of the above, or contradicts itself; says where.
///
/// ```
/// use phalanx_hand::Side;
/// use phalanx_io::{Source, landmarks};
///
/// let table = "frame,joint,x_px,y_px\n7,0,104.5,243.3\n7,8,88.0,31.2\n";
/// let file = Source { name: "cam0.csv", bytes: table.as_bytes() };
/// let tracks = landmarks::read(&file, Side::Right)?;
/// let points = &tracks[0].frames[&7];
/// assert_eq!(points[8].map(|tip| tip.at.x), Some(88.0));
/// assert_eq!(points.iter().flatten().count(), 2);
/// # Ok::<(), phalanx_io::Error>(())
/// ```
pub fn read(file: &Source<'_>, side: Side) -> Result<Vec<LandmarkTrack>> {
    let wrong = |what: String| Error::landmarks(file.name, what);
    match file.bytes {
        [] => Err(wrong("the file is empty".to_owned())),
        [0x93, b'N', b'U', b'M', ..] => array::read(file.bytes).map_err(wrong),
        [0x89, b'H', b'D', b'F', ..] => Err(wrong(
            "HDF5 is not read: save it as CSV, with pandas.read_hdf(file).to_csv(…)".to_owned(),
        )),
        [b'P', b'K', ..] => {
            Err(wrong("an archive is not read: save one array of it with numpy.save".to_owned()))
        }
        [0x80, ..] => Err(wrong("a pickle is not read: save its array with numpy.save".to_owned())),
        _ => text(file, side).map_err(wrong),
    }
}

fn text(file: &Source<'_>, side: Side) -> Result<Vec<LandmarkTrack>, String> {
    let text = file.decoded().ok_or("it is neither text nor a NumPy array")?;
    let first = text.lines().find(|line| !line.trim().is_empty()).ok_or("the file is empty")?;
    let stem = file.name.rsplit_once('.').map_or(file.name, |(stem, _)| stem);
    let number = number_in_name(stem);
    match first.trim_start().as_bytes() {
        [b'{', ..] if openpose::is_frame(&text) => openpose::read(&text, side, number),
        [b'{' | b'[', ..] => mediapipe::read(&text, side, number),
        [b's', b'c', b'o', b'r', b'e', b'r', ..] => deeplabcut::read(&text),
        _ if first.contains("frame") && first.contains("joint") => table::read(&text),
        _ => Err("it is not recognised: JSON of MediaPipe or OpenPose, CSV of DeepLabCut or with the columns \
             frame, joint, x_px and y_px, and NumPy arrays are read"
            .to_owned()),
    }
}
