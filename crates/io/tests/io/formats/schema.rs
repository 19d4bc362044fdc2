//! The published JSON Schema is the one that the code has.

use phalanx_io::take::json_schema;

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/reference/take.schema.json");

#[test]
fn the_published_schema_is_in_step() {
    let schema = serde_json::to_string_pretty(&json_schema()).unwrap() + "\n";
    if std::env::var_os("PHALANX_REGENERATE").is_some() {
        std::fs::write(FILE, &schema).unwrap();
    }
    let published = std::fs::read_to_string(FILE).unwrap_or_default();
    assert!(published == schema, "PHALANX_REGENERATE=1 cargo test -p phalanx-io writes it anew");
}
