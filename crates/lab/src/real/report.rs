//! The rows as a table.

use comfy_table::{Table, presets};

use super::row::Row;

const HEADER: [&str; 14] = [
    "take",
    "cameras",
    "input",
    "method",
    "refused, doubted",
    "joints mm: mean / median / 95 %",
    "states",
    "bone angles (constant)",
    "overlap: mean, least ≥ .88",
    "reprojection: median / 90 %",
    "by view",
    "within 50 / 68 / 95 %",
    "± mm",
    "ms: median / 95 %",
];

/// A row, and the median reprojection in each view, if there are landmarks.
pub struct Line {
    /// The row.
    pub row: Row,
    /// In the order of the cameras used.
    pub reprojection_by_view: Vec<Option<f64>>,
}

/// A Markdown table of rows.
pub fn table(lines: &[Line]) -> String {
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN).set_header(HEADER).add_rows(lines.iter().map(cells));
    format!("{table}\n")
}

fn cells(Line { row, reprojection_by_view }: &Line) -> [String; HEADER.len()] {
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    let or_dash = |cell: Option<String>| cell.unwrap_or_else(|| "–".to_owned());
    let by_view = reprojection_by_view.iter().map(|median| or_dash(median.map(percent)));
    [
        row.take.clone(),
        row.cameras.join(" "),
        row.input.to_owned(),
        row.method.to_owned(),
        format!("{}, {} of {}", row.refused, row.doubted, row.frames),
        or_dash(
            row.joints_mm.map(|mm| format!("{:.1} / {:.1} / {:.1}", mm.mean, mm.median, mm.p95)),
        ),
        or_dash(row.states.map(|states| {
            let share = states.right as f64 / states.of as f64;
            format!("{} ({} of {})", percent(share), states.right, states.of)
        })),
        or_dash(
            row.bone_angles_deg
                .zip(row.best_constant_deg)
                .map(|(ours, constant)| format!("{ours:.1}° ({constant:.1}°)")),
        ),
        or_dash(row.iou.map(|iou| format!("{:.3}, {}", iou.mean, percent(iou.least_above_088)))),
        or_dash(
            row.reprojection
                .map(|errors| format!("{} / {}", percent(errors.median), percent(errors.p90))),
        ),
        by_view.collect::<Vec<_>>().join(" "),
        or_dash(
            row.coverage
                .map(|c| format!("{:.2} / {:.2} / {:.2}", c.half, c.one_sigma, c.two_sigma)),
        ),
        or_dash(row.std_mm.map(|mm| format!("{mm:.1}"))),
        or_dash(row.ms.map(|ms| format!("{:.1} / {:.1}", ms.median, ms.p95))),
    ]
}
