//! The table of a report as text, as CSV, and as a page to print.

use serde_json::json;

use crate::error::Result;
use crate::error::unwritten;
use crate::page::html::{escape, fill};
use crate::report::range_of_motion::Measured;
use crate::report::table::{COLUMNS, Row, Table};

/// The width of a cell as text.
const CELL: usize = 15;

/// The table as text for a terminal, degrees.
pub fn to_text(table: &Table) -> String {
    let mut lines = table.notes.clone();
    lines.push("Degrees; ± is a standard deviation.".to_owned());
    lines.push(String::new());
    let width = COLUMNS.len() * CELL;
    let groups = table.groups.iter().map(|group| format!("{:>width$}", cut(group, width - 2)));
    lines.push(format!("{:16}{}", "", groups.collect::<Vec<_>>().concat()));
    let columns = COLUMNS.map(|column| format!("{column:>CELL$}")).concat();
    lines.push(format!("{:16}{}", "", columns.repeat(table.groups.len())));
    for Row { name, cells } in &table.rows {
        let cells = cells.iter().flatten().map(|cell| format!("{:>CELL$}", short(*cell)));
        lines.push(format!("{name:16}{}", cells.collect::<Vec<_>>().concat()));
    }
    lines.push(String::new());
    lines.join("\n")
}

/// The end of a text, which tells files of one folder apart.
fn cut(text: &str, most: usize) -> String {
    let plain: String = text.chars().filter(|letter| !letter.is_control()).collect();
    let count = plain.chars().count();
    if count <= most {
        return plain;
    }
    std::iter::once('…').chain(plain.chars().skip(count - most + 1)).collect()
}

/// A cell for people, degrees.
pub(crate) fn short(cell: Option<Measured>) -> String {
    let Some(Measured { value, std }) = cell else { return String::new() };
    // Adding 0 takes the sign from a rounded −0.
    let value = (10.0 * value.to_degrees()).round() / 10.0 + 0.0;
    match std {
        Some(std) => format!("{value:.1} ± {:.1}", std.to_degrees()),
        None => format!("{value:.1}"),
    }
}

/// The table as CSV, degrees, each number's deviation beside it.
///
/// # Errors
/// None that memory does not give.
pub fn to_csv(table: &Table) -> Result<Vec<u8>> {
    let mut csv = csv::Writer::from_writer(Vec::new());
    let names = table.groups.iter().flat_map(|group| {
        COLUMNS
            .iter()
            .flat_map(move |column| [format!("{group}.{column}"), format!("{group}.{column}_std")])
    });
    let header: Vec<String> = std::iter::once("angle".to_owned()).chain(names).collect();
    csv.write_record(header).map_err(|error| unwritten(&error))?;
    for Row { name, cells } in &table.rows {
        let cells = cells.iter().flatten().flat_map(|cell| {
            let numbers = [cell.map(|cell| cell.value), cell.and_then(|cell| cell.std)];
            numbers
                .map(|number| number.map_or_else(String::new, |n| format!("{:.4}", n.to_degrees())))
        });
        let row: Vec<String> = std::iter::once(name.clone()).chain(cells).collect();
        csv.write_record(row).map_err(|error| unwritten(&error))?;
    }
    csv.into_inner().map_err(|error| unwritten(&error))
}

/// The table as JSON: its `notes`, the `unit` (`deg`), and `rows`, each with its `angle` and for each of the
/// `takes` (and the difference of two) its cells by name, a `value` and its `std`; null where there is none.
pub fn to_json(table: &Table) -> serde_json::Value {
    let number = |cell: Measured| json!({ "value": cell.value.to_degrees(), "std": cell.std.map(f64::to_degrees) });
    let group = |(name, cells): (&String, &[Option<Measured>; COLUMNS.len()])| {
        let cells = COLUMNS.iter().zip(cells).map(|(column, cell)| {
            ((*column).to_owned(), cell.map_or(serde_json::Value::Null, number))
        });
        let mut group: serde_json::Map<_, _> = cells.collect();
        group.insert("of".to_owned(), name.as_str().into());
        group
    };
    let row = |Row { name, cells }: &Row| {
        let groups: Vec<_> = table.groups.iter().zip(cells).map(group).collect();
        json!({ "angle": name, "groups": groups })
    };
    let rows: Vec<_> = table.rows.iter().map(row).collect();
    json!({ "notes": table.notes, "unit": "deg", "rows": rows })
}

/// The table as a page to print: one HTML file, no script, nothing from elsewhere.
pub fn print_page(table: &Table) -> String {
    let groups = table.groups.iter().map(|group| {
        format!("<th colspan=\"{}\" scope=\"colgroup\">{}</th>", COLUMNS.len(), escape(group))
    });
    let columns = COLUMNS.map(|column| format!("<th scope=\"col\">{column}</th>")).concat();
    let rows = table.rows.iter().map(|Row { name, cells }| {
        let cells = cells.iter().flatten().map(|cell| format!("<td>{}</td>", short(*cell)));
        format!("<tr><th scope=\"row\">{name}</th>{}</tr>\n", cells.collect::<Vec<_>>().concat())
    });
    let notes = table.notes.iter().map(|note| format!("<p>{}</p>\n", escape(note)));
    fill(
        include_str!("print.html"),
        &[
            ("groups", &groups.collect::<Vec<_>>().concat()),
            ("columns", &columns.repeat(table.groups.len())),
            ("rows", &rows.collect::<Vec<_>>().concat()),
            ("notes", &notes.collect::<Vec<_>>().concat()),
        ],
    )
}
