//! What TOML, YAML, JSON and OpenCV's XML hold, in one form.

use std::collections::BTreeSet;
use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, Error as _, MapAccess, SeqAccess, Visitor};

/// Named values, in the file's order.
pub(super) type Map = Vec<(String, Value)>;

/// Cameras by name, each with its named values.
pub(super) type Sections = Vec<(String, Map)>;

/// A value of a calibration.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Null,
    Bool(bool),
    Number(f64),
    /// Words; also numbers in YAML and XML, so that a camera called 01 keeps its name.
    Text(String),
    List(Vec<Value>),
    Map(Map),
}

impl Value {
    pub(super) fn as_map(&self) -> Option<&Map> {
        match self {
            Self::Map(map) => Some(map),
            _ => None,
        }
    }

    pub(super) fn as_bool(&self) -> Option<bool> {
        match self {
            Self::Bool(bool) => Some(*bool),
            Self::Number(number) => Some(*number != 0.0),
            Self::Text(text) => match text.to_ascii_lowercase().as_str() {
                "true" | "1" | "yes" => Some(true),
                "false" | "0" | "no" => Some(false),
                _ => None,
            },
            _ => None,
        }
    }

    /// A word, or a number as it would be printed.
    pub(super) fn as_text(&self) -> Option<String> {
        match self {
            Self::Text(text) => Some(text.clone()),
            Self::Number(number) => Some(number.to_string()),
            _ => None,
        }
    }

    /// All numbers, whatever lists they are in: NumPy's `tolist()` nests, OpenCV names rows and
    /// columns. `None` where something is no number.
    pub(super) fn numbers(&self) -> Option<Vec<f64>> {
        let mut numbers = Vec::new();
        self.append_numbers(&mut numbers).then_some(numbers)
    }

    fn append_numbers(&self, numbers: &mut Vec<f64>) -> bool {
        match self {
            Self::Number(number) => {
                numbers.push(*number);
                true
            }
            Self::Text(text) => text.split_whitespace().all(|word| match word.parse() {
                Ok(number) => {
                    numbers.push(number);
                    true
                }
                Err(_) => false,
            }),
            Self::List(list) => list.iter().all(|value| value.append_numbers(numbers)),
            Self::Map(map) => match map.iter().find(|(key, _)| key == "data") {
                Some((_, data)) => data.append_numbers(numbers),
                None => false,
            },
            Self::Null | Self::Bool(_) => false,
        }
    }

    /// Whether this is a matrix as OpenCV writes it.
    pub(super) fn is_matrix(&self) -> bool {
        self.as_map().is_some_and(|map| map.iter().any(|(key, _)| key == "data"))
    }
}

/// The value of a key.
pub(super) fn get<'a>(map: &'a Map, key: &str) -> Option<&'a Value> {
    map.iter().find(|(name, _)| name == key).map(|(_, value)| value)
}

/// The most names at one place: more than all cameras that are read can have.
const MOST_NAMES: usize = 4096;

/// What is wrong with the names at one place: one that stands twice, or too many of them.
pub(super) fn wrong_names(map: &Map) -> Option<String> {
    if map.len() > MOST_NAMES {
        return Some(format!("{} names at one place; at most {MOST_NAMES} are read", map.len()));
    }
    repeated_name(map).map(|name| format!("`{name}` stands twice"))
}

/// A name that stands twice.
pub(super) fn repeated_name(map: &Map) -> Option<&str> {
    let mut seen = BTreeSet::new();
    map.iter().map(|(name, _)| name.as_str()).find(|name| !seen.insert(*name))
}

impl<'de> Deserialize<'de> for Value {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(AnyValue)
    }
}

struct AnyValue;

impl<'de> Visitor<'de> for AnyValue {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value")
    }

    fn visit_bool<E>(self, bool: bool) -> Result<Value, E> {
        Ok(Value::Bool(bool))
    }

    fn visit_i64<E>(self, number: i64) -> Result<Value, E> {
        Ok(Value::Number(number as f64))
    }

    fn visit_u64<E>(self, number: u64) -> Result<Value, E> {
        Ok(Value::Number(number as f64))
    }

    fn visit_f64<E>(self, number: f64) -> Result<Value, E> {
        Ok(Value::Number(number))
    }

    fn visit_str<E>(self, text: &str) -> Result<Value, E> {
        Ok(Value::Text(text.to_owned()))
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Value, A::Error> {
        let mut list = Vec::new();
        while let Some(item) = items.next_element()? {
            list.push(item);
        }
        Ok(Value::List(list))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut map = Map::new();
        while let Some(entry) = entries.next_entry()? {
            map.push(entry);
        }
        match wrong_names(&map) {
            Some(what) => Err(A::Error::custom(what)),
            None => Ok(Value::Map(map)),
        }
    }
}
