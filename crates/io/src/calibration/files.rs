//! Files, parsed and put together.

use phalanx_camera::Rig;

use crate::calibration::colmap;
use crate::calibration::document::Document;
use crate::calibration::field::Field;
use crate::calibration::fields::Fields;
use crate::calibration::layout;
use crate::calibration::record::Record;
use crate::calibration::syntax::Syntax;
use crate::calibration::unit::Unit;
use crate::calibration::value::{Map, Value, get};
use crate::calibration::{biocv, xml, yaml};
use crate::error::{Error, Result};
use crate::source::Source;

/// What one file holds.
enum Content {
    Named(Map),
    Records(Vec<Record>, Unit),
    ColmapCameras(colmap::Cameras),
    ColmapImages(Vec<colmap::Image>),
    Rig(Box<Rig>),
}

/// Reads files that belong together.
pub(super) fn read(files: &[Source<'_>]) -> Result<Document> {
    let mut named = Map::new();
    let mut document = Document::default();
    let (mut colmap_cameras, mut colmap_images) = (None, None);
    for file in files {
        let content = parse(file).map_err(|error| match error {
            Error::Calibration { what } if files.len() > 1 => {
                Error::calibration(format!("{}: {what}", file.name))
            }
            other => other,
        })?;
        match content {
            Content::Named(map) => merge(&mut named, map)?,
            Content::Records(records, unit) => {
                document.records.extend(records);
                document.unit = Some(unit);
            }
            Content::ColmapCameras(cameras) => colmap_cameras = Some(cameras),
            Content::ColmapImages(images) => colmap_images = Some(images),
            Content::Rig(rig) => {
                document.records.extend(rig.cameras.into_iter().map(Record::of_camera));
                (document.volume, document.unit) = (Some(rig.volume), Some(Unit::MILLIMETRE));
            }
        }
    }
    let kinds = [
        !named.is_empty(),
        !document.records.is_empty(),
        colmap_cameras.is_some() || colmap_images.is_some(),
    ];
    if kinds.iter().filter(|&&is_there| is_there).count() > 1 {
        return Err(Error::calibration("the files are of different tools"));
    }
    match (colmap_cameras, colmap_images) {
        (Some(cameras), Some(images)) => colmap::document(&cameras, images),
        (None, None) if named.is_empty() => Ok(document),
        (None, None) => layout::document(&named),
        _ => Err(Error::calibration("COLMAP's cameras.txt and images.txt belong together")),
    }
}

/// The most bytes of a file that are read. Calibrations have some kilobytes.
const MOST_BYTES: usize = 1 << 20;

fn text(file: &Source<'_>) -> Result<String> {
    if file.bytes.len() > MOST_BYTES {
        let megabytes = file.bytes.len() >> 20;
        return Err(Error::calibration(format!("{megabytes} MiB; at most 1 MiB is read")));
    }
    let text = file
        .decoded()
        .ok_or_else(|| Error::calibration("it is no text in UTF-8 or UTF-16: save it as UTF-8"))?;
    if text.trim().is_empty() {
        return Err(Error::calibration("the file is empty"));
    }
    Ok(text)
}

fn parse(file: &Source<'_>) -> Result<Content> {
    let text = text(file)?;
    let value = match Syntax::of(&text)? {
        Syntax::Xml => match xml::parse(&text)? {
            xml::Content::Storage(map) => Value::Map(map),
            xml::Content::Records(records) => {
                return Ok(Content::Records(records, Unit::MILLIMETRE));
            }
        },
        Syntax::ColmapCameras => return colmap::cameras(&text).map(Content::ColmapCameras),
        Syntax::ColmapImages => return colmap::images(&text).map(Content::ColmapImages),
        Syntax::Biocv => {
            let record = biocv::record(file.stem(), &text)?;
            return Ok(Content::Records(vec![record], Unit::MILLIMETRE));
        }
        Syntax::Json => serde_json::from_str(&text).map_err(|e| json_error(&text, &e))?,
        Syntax::Yaml => yaml::parse(&text)?,
        Syntax::Toml => {
            if text.len() > MOST_TOML_BYTES {
                let kilobytes = text.len() >> 10;
                return Err(Error::calibration(format!("{kilobytes} KiB; of TOML, 256 are read")));
            }
            let value: Value = toml::from_str(&text).map_err(|e| toml_error(&text, &e))?;
            if value.as_map().is_some_and(is_rig) {
                return Ok(Content::Rig(Box::new(Rig::from_toml(&text)?)));
            }
            value
        }
    };
    match value {
        Value::Map(map) => layout::lists_by_name(by_name(file, map)).map(Content::Named),
        list @ Value::List(_) => {
            layout::lists_by_name(vec![("cameras".to_owned(), list)]).map(Content::Named)
        }
        _ => Err(Error::calibration("it holds nothing by name")),
    }
}

/// TOML is parsed as a whole first, which takes a hundred times its size.
const MOST_TOML_BYTES: usize = 256 << 10;

/// The parser's words and the line, without the line's text, which may be long.
fn toml_error(text: &str, error: &toml::de::Error) -> Error {
    let before = error.span().and_then(|span| text.get(..span.start)).unwrap_or_default();
    let line = 1 + before.matches('\n').count();
    Error::calibration(format!("line {line}: {}", error.message()))
}

fn is_rig(map: &Map) -> bool {
    get(map, "volume").is_some() && matches!(get(map, "camera"), Some(Value::List(_)))
}

/// A file that holds one camera by the camera's name, or else the file's.
fn by_name(file: &Source<'_>, map: Map) -> Map {
    let is_matrix = |(key, value): &(String, Value)| {
        Field::of(key) == Field::Matrix && value.numbers().is_some_and(|n| n.len() >= 4)
    };
    if !map.iter().any(is_matrix) {
        return map;
    }
    let name = Fields::of(file.name, &map).own_name().unwrap_or_else(|| file.stem().to_owned());
    vec![(name, Value::Map(map))]
}

/// Adds what another file says.
fn merge(into: &mut Map, other: Map) -> Result<()> {
    for (key, value) in other {
        match into.iter_mut().find(|(name, _)| *name == key) {
            None => into.push((key, value)),
            Some((_, Value::Map(old))) if !value.is_matrix() => {
                if let Value::Map(new) = value {
                    merge(old, new)?;
                }
            }
            Some((_, old)) => {
                let is_data = value.numbers().is_some_and(|numbers| numbers.len() > 2);
                if is_data && *old != value {
                    return Err(Error::calibration(format!("`{key}` differs between the files")));
                }
            }
        }
    }
    Ok(())
}

/// The parser's words, but for what they do not name.
fn json_error(text: &str, error: &serde_json::Error) -> Error {
    let line = text.lines().nth(error.line().saturating_sub(1)).unwrap_or_default();
    let is_nan = ["NaN", "Infinity"].iter().any(|word| line.contains(word));
    if is_nan && error.is_syntax() {
        let line = error.line();
        return Error::calibration(format!(
            "line {line}: NaN and Infinity are not JSON, and no calibration: the calibration has failed"
        ));
    }
    Error::calibration(error.to_string())
}
