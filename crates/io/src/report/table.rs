//! The table of a report, before it is text, CSV or a page.

use phalanx_hand::{Digit, Dof};

use crate::report::range_of_motion::{AngleRange, Measured, RangeOfMotion};

/// A take's range of motion with what the take is called.
#[derive(Debug, Clone, Copy)]
pub struct NamedRange<'a> {
    /// The take's name.
    pub name: &'a str,
    /// Its range.
    pub range: &'a RangeOfMotion,
}

/// A table of numbers with deviations, rad.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// What the groups of three columns are: the takes, and their difference.
    pub groups: Vec<String>,
    /// What is said of each take.
    pub notes: Vec<String>,
    /// The rows.
    pub rows: Vec<Row>,
}

/// One angle, or one digit's total.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The angle's or total's name.
    pub name: String,
    /// For each group the smallest, the largest and the range; a total has a range alone, one frame has none.
    pub cells: Vec<[Option<Measured>; 3]>,
}

/// The names of a group's columns.
pub(super) const COLUMNS: [&str; 3] = ["smallest", "largest", "range"];

/// The table of one take, or of two side by side with the second less the first.
pub fn range_table(first: NamedRange<'_>, second: Option<NamedRange<'_>>) -> Table {
    let takes: Vec<NamedRange<'_>> = std::iter::once(first).chain(second).collect();
    let mut groups: Vec<String> = takes.iter().map(|take| take.name.to_owned()).collect();
    if second.is_some() {
        groups.push("difference".to_owned());
    }
    let row = |name: String, of: &dyn Fn(&RangeOfMotion) -> [Option<Measured>; 3]| {
        let mut cells: Vec<_> = takes.iter().map(|take| of(take.range)).collect();
        if let [before, after] = cells[..] {
            let minus = |k: usize| Some(after[k]?.minus(before[k]?));
            cells.push(std::array::from_fn(minus));
        }
        Row { name, cells }
    };
    let angles = first.range.angles.iter().enumerate().map(|(k, _)| {
        row(Dof::ALL[k].name().to_owned(), &|range| {
            let AngleRange { smallest, largest, range: between } = range.angles[k];
            [Some(smallest), Some(largest), of_several(range, between)]
        })
    });
    let totals = Digit::ALL.into_iter().enumerate().map(|(k, digit)| {
        let name = format!("{} total", digit_name(digit));
        row(name, &|range| [None, None, of_several(range, range.totals[k])])
    });
    let notes = takes.iter().map(|NamedRange { name, range }| {
        let counts = if range.counted == 1 { "counts, which has no range" } else { "count" };
        format!("{name}: {} of {} frames {counts}", range.counted, range.frames)
    });
    Table { groups, notes: notes.collect(), rows: angles.chain(totals).collect() }
}

/// What lies between frames: of one frame alone it would be 0 with a deviation.
fn of_several(range: &RangeOfMotion, between: Measured) -> Option<Measured> {
    (range.counted > 1).then_some(between)
}

fn digit_name(digit: Digit) -> &'static str {
    match digit {
        Digit::Thumb => "thumb",
        Digit::Index => "index",
        Digit::Middle => "middle",
        Digit::Ring => "ring",
        Digit::Little => "little",
    }
}
