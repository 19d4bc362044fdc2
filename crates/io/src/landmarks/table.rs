//! A table with a row a point: `frame`, `joint`, `x_px`, `y_px` and perhaps `confidence`.

use std::collections::BTreeMap;

use phalanx_hand::{JOINTS, Landmarks};

use crate::commas;
use crate::landmarks::names;
use crate::landmarks::track::{LandmarkTrack, landmark, number_in_name};

pub(super) fn read(text: &str) -> Result<Vec<LandmarkTrack>, String> {
    let mut csv = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
    let header = csv.headers().map_err(|error| error.to_string())?.clone();
    commas::check(&header)?;
    let find = |names: &[&str]| header.iter().position(|column| names.contains(&column));
    let column = |names: &[&str]| {
        find(names).ok_or_else(|| format!("the column '{}' is absent", names.join("' or '")))
    };
    let (frame, joint) = (column(&["frame"])?, column(&["joint"])?);
    let (x, y) = (column(&["x_px", "x"])?, column(&["y_px", "y"])?);
    let confidence = find(&["confidence", "likelihood", "score"]);
    let mut frames: BTreeMap<u64, (Landmarks, [bool; JOINTS])> = BTreeMap::new();
    for record in csv.records() {
        let record = record.map_err(|error| error.to_string())?;
        let line = record.position().map_or(0, csv::Position::line);
        let wrong = |column: usize, what: &str| {
            let text = &record[column];
            format!("line {line}, column '{}': '{}' {what}", &header[column], text.escape_debug())
        };
        let number = |column: usize| match &record[column] {
            "" => Ok(f64::NAN),
            text => text.parse().map_err(|_| wrong(column, "is no number")),
        };
        let frame_number =
            number_in_name(&record[frame]).ok_or_else(|| wrong(frame, "has no frame's number"))?;
        let place = names::joint(&record[joint])
            .ok_or_else(|| wrong(joint, "is none of the joints, 0 to 20"))?;
        let sure = confidence.map_or(Ok(1.0), number)?;
        let (points, is_said) =
            frames.entry(frame_number).or_insert(([None; JOINTS], [false; JOINTS]));
        if std::mem::replace(&mut is_said[place], true) {
            return Err(format!("line {line}: joint {place} of frame {frame_number} comes twice"));
        }
        points[place] = landmark(number(x)?, number(y)?, sure);
    }
    let frames = frames.into_iter().map(|(number, (points, _))| (Some(number), Some(points)));
    Ok(vec![LandmarkTrack::of(None, frames)?])
}
