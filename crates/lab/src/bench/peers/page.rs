//! The rows as a page.

use std::fmt::Write;

use super::programs::Peers;
use super::row::{Figure, Row, Target, Verdict};

/// The page, which says what of it was missed.
pub(crate) fn body(rows: &[Row], peers: &Peers) -> String {
    let packages: Vec<String> = peers
        .versions()
        .into_iter()
        .map(|(name, version)| format!("{name} {}", version.unwrap_or("missing".to_owned())))
        .collect();
    let count = |verdict| rows.iter().filter(|row| row.verdict() == verdict).count();
    format!(
        "The best packages that do the same, and ours, on the same data in one run, one thread each,\n\
         in turns. Times are CPU time, medians of three runs or more. Evidence is in nats, of\n\
         standardised targets, at each fit's own precisions and noise, a flat bias integrated out.\n\
         The Gaussian process has one width for all inputs, ours one for each. An iteration of K-means of\n\
         ours leaves out what comes before the first; the peers' share it out, which for faiss, whose first\n\
         centres are drawn blindly, is next to nothing.\n\n\
         {}.\n\n\
         {} of the targets are met, {} missed, {} skipped for want of a peer.\n\n{}",
        packages.join(", "),
        count(Verdict::Met),
        count(Verdict::Missed),
        count(Verdict::Skipped),
        table(rows),
    )
}

fn table(rows: &[Row]) -> String {
    let mut table = String::from(
        "| work | figure | peer | theirs | ours | ours / theirs | target | |\n\
         |---|---|---|--:|--:|--:|---|---|\n",
    );
    for row in rows {
        let ratio = row.ratio().map_or_else(String::new, |ratio| format!("{ratio:.3}"));
        let [theirs, ours] = [&row.theirs, &row.ours].map(|f| figure(f, row.unit));
        let verdict = match row.verdict() {
            Verdict::Met => "met",
            Verdict::Missed => "**missed**",
            Verdict::Skipped => "skipped",
            Verdict::Open => "",
        };
        writeln!(
            table,
            "| {} | {} | {} | {theirs} | {ours} | {ratio} | {} | {verdict} |",
            row.work,
            row.figure,
            row.peer,
            target(row.target, row.unit),
        )
        .expect("a string takes everything");
    }
    table
}

fn figure(figure: &Figure, unit: &str) -> String {
    match figure {
        Figure::Value(value) => with_unit(&digits(*value), unit),
        Figure::Skipped(reason) => format!("skipped: {}", reason.replace(['|', '\n'], " ")),
        Figure::None => "–".to_owned(),
    }
}

fn target(target: Target, unit: &str) -> String {
    match target {
        Target::Open => String::new(),
        Target::AtMost(most) => format!("≤ {}", with_unit(&most.to_string(), unit)),
        Target::AtMostTheirs(1.0) => "≤ theirs".to_owned(),
        Target::AtMostTheirs(factor) => format!("≤ {} × theirs", digits(factor)),
        Target::BelowTheirs => "< theirs".to_owned(),
        Target::NotLowerBy(fraction) => format!("≥ theirs − {} %", 100.0 * fraction),
    }
}

fn with_unit(number: &str, unit: &str) -> String {
    match unit {
        "" => number.to_owned(),
        "°" => format!("{number}°"),
        _ => format!("{number} {unit}"),
    }
}

/// Whole numbers as such; others with four digits.
fn digits(value: f64) -> String {
    if value.fract() == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let before = value.abs().log10().floor() as i32 + 1;
    format!("{value:.*}", usize::try_from(4 - before).unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits() {
        let printed = [165.0, 0.038_261, 31.423, -1234.56, 0.333_333].map(digits);
        assert_eq!(printed, ["165", "0.03826", "31.42", "-1235", "0.3333"]);
    }

    #[test]
    fn a_line_says_what_was_missed_and_why_something_is_skipped() {
        let row = |theirs, ours, target| Row {
            work: "work".to_owned(),
            figure: "time",
            unit: "ms",
            peer: "peer",
            theirs,
            ours: Figure::Value(ours),
            target,
        };
        let rows = [
            row(Figure::Value(4.0), 0.5, Target::AtMost(0.2)),
            row(Figure::Skipped("no | python".to_owned()), 0.5, Target::BelowTheirs),
        ];
        let table = table(&rows);
        assert!(table.contains("| 4 ms | 0.5000 ms | 0.125 | ≤ 0.2 ms | **missed** |"), "{table}");
        assert!(table.contains("| skipped: no   python | 0.5000 ms |  | < theirs | skipped |"));
    }
}
