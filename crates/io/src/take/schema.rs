//! The JSON Schema of a take's lines.

use phalanx_hand::{Dof, Unit};
use serde_json::{Map, Value, json};

use crate::take::frames::{FORMAT_VERSION, JOINT_NAMES, LeftOut};
use crate::take::header::FORMAT;

/// The JSON Schema (draft 2020-12) that every line of [`write_json_lines`](super::write_json_lines)
/// keeps to: the first the `header`, each other a `frame`.
pub fn json_schema() -> Value {
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "A line of a take of phalanx (JSON Lines)",
        "description": "The first line is the header, every other line a frame. Angles are in degrees, lengths in millimetres, times in seconds; joints are in the world of the cameras' calibration. A std is a standard deviation; null means that the number was not estimated.",
        "oneOf": [{ "$ref": "#/$defs/header" }, { "$ref": "#/$defs/frame" }],
        "$defs": { "header": header(), "frame": frame() },
    })
}

fn header() -> Value {
    let units = [("angle", "deg"), ("length", "mm"), ("time", "s")];
    object([
        ("format", json!({ "const": FORMAT })),
        ("version", json!({ "const": FORMAT_VERSION })),
        ("units", object(units.map(|(name, unit)| (name, json!({ "const": unit }))))),
        ("model", described(nullable("string"), "The hash of the model file.")),
        ("rate_hz", described(nullable("number"), "The frame rate, if it is one.")),
        ("views", described(list(&json!({ "type": "string" })), "The cameras' names.")),
        (
            "world_from_hand",
            described(
                object(["origin_mm", "x_axis", "y_axis", "z_axis"].map(|name| (name, vector()))),
                "The frame of the hand at rest in the world: X to the thumb's side of a right hand, Y out of the back, Z along the fingers.",
            ),
        ),
        (
            "hand",
            json!({ "type": "object", "description": "The person's hand, as in its TOML file: millimetres and degrees." }),
        ),
    ])
}

fn frame() -> Value {
    let dofs = |value: fn(Dof) -> Value| Dof::ALL.map(|dof| (dof.name(), value(dof)));
    let number = |dof| described(json!({ "type": "number" }), unit(dof));
    let std = |dof| described(json!({ "type": ["number", "null"], "minimum": 0 }), unit(dof));
    let joints = || JOINT_NAMES.map(|name| (name, vector()));
    let unit_interval = json!({ "type": ["number", "null"], "minimum": 0, "maximum": 1 });
    let left_out = LeftOut::ALL.map(|why| Value::from(why.code())).into_iter();
    let left_out: Vec<Value> = left_out.chain([Value::Null]).collect();
    let view = object([
        ("view", json!({ "type": "string" })),
        ("used", json!({ "type": "boolean" })),
        ("overlap", unit_interval.clone()),
        (
            "left_out",
            described(
                json!({ "enum": left_out }),
                "Why a picture that is there had no part: it contradicts the others, or shows nothing where they see the hand.",
            ),
        ),
    ]);
    object([
        ("frame", json!({ "type": "integer", "minimum": 0 })),
        ("time", json!({ "type": "number" })),
        ("pose", or_null(&object(dofs(number)))),
        ("std", or_null(&object(dofs(std)))),
        ("joints_mm", or_null(&object(joints()))),
        ("joints_std_mm", or_null(&object(joints()))),
        ("quality", described(unit_interval, "The lowest overlap of the views that were used.")),
        ("views", list(&view)),
        (
            "doubts",
            described(
                list(&json!({ "type": "string" })),
                "Why not to trust the frame; empty if nothing was found amiss.",
            ),
        ),
    ])
}

fn unit(dof: Dof) -> &'static str {
    match dof.unit() {
        Unit::Angle => "deg",
        Unit::Length => "mm",
    }
}

/// An object with exactly these properties.
fn object<const N: usize>(properties: [(&str, Value); N]) -> Value {
    let names = properties.each_ref().map(|(name, _)| *name).to_vec();
    let properties: Map<String, Value> =
        properties.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
    json!({
        "type": "object",
        "properties": properties,
        "required": names,
        "additionalProperties": false,
    })
}

fn list(items: &Value) -> Value {
    json!({ "type": "array", "items": items })
}

fn vector() -> Value {
    json!({ "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3 })
}

fn nullable(kind: &str) -> Value {
    json!({ "type": [kind, "null"] })
}

fn or_null(value: &Value) -> Value {
    json!({ "anyOf": [value, { "type": "null" }] })
}

fn described(mut value: Value, description: &str) -> Value {
    value["description"] = description.into();
    value
}
