//! DeepLabCut's CSV, which Anipose takes too: rows that name scorer, body parts and coordinates, then a
//! row a frame.

use csv::StringRecord;
use phalanx_hand::JOINTS;

use crate::landmarks::names::joint;
use crate::landmarks::track::{LandmarkTrack, landmark, number_in_name};

/// Where a joint's three numbers stand.
#[derive(Debug, Clone, Copy, Default)]
struct Columns {
    x: Option<usize>,
    y: Option<usize>,
    likelihood: Option<usize>,
}

pub(super) fn read(text: &str) -> Result<Vec<LandmarkTrack>, String> {
    let mut csv = csv::ReaderBuilder::new()
        .has_headers(false)
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let mut rows = csv.records();
    let mut row = || -> Result<Option<StringRecord>, String> {
        rows.next().transpose().map_err(|error| error.to_string())
    };
    let mut parts = None;
    let columns = loop {
        let named = row()?.ok_or("it ends before the row `coords`")?;
        match &named[0] {
            "scorer" => {}
            "individuals" => one_individual(&named)?,
            "bodyparts" => parts = Some(named),
            "coords" => break columns(&parts.ok_or("the row `bodyparts` is absent")?, &named)?,
            other => {
                return Err(format!("'{}' stands before the row `coords`", other.escape_debug()));
            }
        }
    };
    let mut frames = Vec::new();
    while let Some(record) = row()? {
        let line = record.position().map_or(0, csv::Position::line);
        let number = number_in_name(record.get(0).unwrap_or_default())
            .ok_or_else(|| format!("line {line}: its first cell has no frame's number"))?;
        let cell = |column: Option<usize>, absent: f64| match column {
            None => Ok(absent),
            Some(column) => match record.get(column).unwrap_or_default() {
                "" => Ok(f64::NAN),
                text => text.parse().map_err(|_| {
                    format!(
                        "line {line}, column {}: '{}' is no number",
                        column + 1,
                        text.escape_debug()
                    )
                }),
            },
        };
        let mut points = [None; JOINTS];
        for (point, Columns { x, y, likelihood }) in points.iter_mut().zip(&columns) {
            *point = landmark(cell(*x, f64::NAN)?, cell(*y, f64::NAN)?, cell(*likelihood, 1.0)?);
        }
        frames.push((Some(number), Some(points)));
    }
    Ok(vec![LandmarkTrack::of(None, frames)?])
}

fn one_individual(named: &StringRecord) -> Result<(), String> {
    let mut names = named.iter().skip(1);
    let first = names.next();
    if names.any(|name| Some(name) != first) {
        return Err("it holds several individuals: save the columns of one".to_owned());
    }
    Ok(())
}

fn columns(parts: &StringRecord, coordinates: &StringRecord) -> Result<[Columns; JOINTS], String> {
    let mut columns = [Columns::default(); JOINTS];
    for (column, (part, coordinate)) in parts.iter().zip(coordinates).enumerate().skip(1) {
        let Some(joint) = joint(part) else { continue };
        let own = match coordinate {
            "x" => &mut columns[joint].x,
            "y" => &mut columns[joint].y,
            "likelihood" => &mut columns[joint].likelihood,
            _ => continue,
        };
        if own.replace(column).is_some() {
            return Err(format!(
                "two body parts are joint {joint}, the second '{}'",
                part.escape_debug()
            ));
        }
    }
    if columns.iter().all(|own| own.x.is_none() || own.y.is_none()) {
        return Err(
            "none of its body parts is known: call them wrist, thumb_cmc, …_mcp, …_ip, …_tip, \
                    index_mcp, …_pip, …_dip, …_tip and so on, or 0 to 20"
                .to_owned(),
        );
    }
    Ok(columns)
}
