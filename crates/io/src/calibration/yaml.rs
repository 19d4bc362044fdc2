//! YAML, and OpenCV's dialect of it.

use std::collections::BTreeMap;

use granit_parser::{Event, Parser, ScalarStyle};

use crate::calibration::value::{Map, Value, wrong_names};
use crate::error::{Error, Result};

/// How deep lists and mappings may be nested.
const DEEPEST: usize = 64;

/// The most values that a file may hold, those that are referred to twice counted twice.
const MOST_VALUES: usize = 200_000;

/// Reads the first document of a text. Tags such as `!!opencv-matrix` are passed over.
pub(super) fn parse(text: &str) -> Result<Value> {
    // OpenCV's first line, `%YAML:1.0`, is no directive of YAML.
    let text = match text.strip_prefix("%YAML") {
        Some(rest) => rest.split_once('\n').map_or("", |(_, rest)| rest),
        None => text,
    };
    let mut builder = Builder::default();
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|e| Error::calibration(e.to_string()))?;
        let done = builder
            .take(event)
            .map_err(|what| Error::calibration(format!("{what} at line {}", span.start.line())))?;
        if let Some(value) = done {
            return Ok(value);
        }
    }
    Err(Error::calibration("the file ends before it says anything"))
}

/// A list or mapping that has not ended.
struct Open {
    anchor: usize,
    items: Items,
}

enum Items {
    List(Vec<Value>),
    /// With a key that waits for its value.
    Map(Map, Option<String>),
}

#[derive(Default)]
struct Builder {
    open: Vec<Open>,
    anchors: BTreeMap<usize, (Value, usize)>,
    count: usize,
}

impl Builder {
    /// Takes the next event; the document's value once it is whole.
    fn take(&mut self, event: Event<'_>) -> std::result::Result<Option<Value>, String> {
        match event {
            Event::Scalar(text, style, anchor, _) => {
                let plain = style == ScalarStyle::Plain;
                let is_null = plain && matches!(&*text, "" | "~" | "null" | "Null" | "NULL");
                let value = if is_null { Value::Null } else { Value::Text(text.into_owned()) };
                self.add(value, anchor)
            }
            Event::SequenceStart(_, anchor, _) => self.begin(anchor, Items::List(Vec::new())),
            Event::MappingStart(_, anchor, _) => self.begin(anchor, Items::Map(Map::new(), None)),
            Event::SequenceEnd | Event::MappingEnd => {
                let Some(Open { anchor, items }) = self.open.pop() else { return Ok(None) };
                let value = match items {
                    Items::List(list) => Value::List(list),
                    Items::Map(map, _) => match wrong_names(&map) {
                        Some(what) => return Err(what),
                        None => Value::Map(map),
                    },
                };
                self.add(value, anchor)
            }
            Event::Alias(anchor) => {
                let (value, size) =
                    self.anchors.get(&anchor).cloned().ok_or("an alias of nothing")?;
                self.count += size;
                self.add(value, 0)
            }
            _ => Ok(None),
        }
    }

    fn begin(&mut self, anchor: usize, items: Items) -> std::result::Result<Option<Value>, String> {
        if self.open.len() == DEEPEST {
            return Err(format!("more than {DEEPEST} lists in each other"));
        }
        self.open.push(Open { anchor, items });
        Ok(None)
    }

    fn add(&mut self, value: Value, anchor: usize) -> std::result::Result<Option<Value>, String> {
        self.count += 1;
        if self.count > MOST_VALUES {
            return Err(format!("more than {MOST_VALUES} values"));
        }
        if anchor != 0 {
            let size = size(&value);
            self.count += size;
            self.anchors.insert(anchor, (value.clone(), size));
        }
        let Some(Open { items, .. }) = self.open.last_mut() else { return Ok(Some(value)) };
        match items {
            Items::List(list) => list.push(value),
            Items::Map(map, key) => match (key.take(), value) {
                (Some(name), value) => map.push((name, value)),
                (None, Value::Text(name)) => *key = Some(name),
                (None, _) => return Err("a key that is no word".to_owned()),
            },
        }
        Ok(None)
    }
}

/// How many values a value holds, a long text counted as several.
fn size(value: &Value) -> usize {
    1 + match value {
        Value::Text(text) => text.len() / 32,
        Value::List(list) => list.iter().map(size).sum(),
        Value::Map(map) => map.iter().map(|(_, value)| size(value)).sum(),
        _ => 0,
    }
}
