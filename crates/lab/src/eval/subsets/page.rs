//! The page of what one model of any cameras comes to.

use std::fmt::Write;

use anyhow::Result;
use comfy_table::{Table, presets};

use super::{Answer, Cost, EVERY, Figures, Row, TESTS};

pub(super) fn body(figures: &Figures) -> Result<String> {
    let mut text = String::from(
        "One model is learnt from all cameras of the desk and asked about some of them, beside a model that is learnt\n\
         from just these (`own`), by the same preset from as many scenes. Errors and standard deviations are means over\n\
         the 21 active angles, degrees; 68 % and 95 % are the shares of angles within as many deviations as should hold\n\
         so many. *Doubted* are answers with any doubt. Every 3rd sample of each test; refined, every 75th.\n",
    );
    for Cost { preset, samples, all_s, any_s, all_bytes, any_bytes } in &figures.costs {
        write!(
            text,
            "\n## {preset}\n\nFrom {samples} scenes. To learn any cameras takes {:.2} of the time of all alone ({any_s:.0} s and {all_s:.0} s \
             of one core), and the file {:.1} MiB in place of {:.1} MiB.\n",
            any_s / all_s,
            mebibytes(*any_bytes),
            mebibytes(*all_bytes)
        )?;
        for (test, (answer, _)) in TESTS.into_iter().flat_map(|test| EVERY.map(|of| (test, of))) {
            let is_meant = |row: &&Row| {
                row.preset == *preset && row.test == test.name() && row.answer == answer
            };
            let name = match answer {
                Answer::Estimated => "",
                Answer::Refined => ", refined",
            };
            let rows = table(figures.rows.iter().filter(is_meant));
            write!(text, "\n`{}`{name}:\n\n{rows}\n", test.name())?;
        }
    }
    Ok(text)
}

fn table<'a>(rows: impl Iterator<Item = &'a Row>) -> Table {
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN).set_header([
        "cameras",
        "error",
        "own",
        "ratio",
        "deviation",
        "own",
        "68 %",
        "own",
        "95 %",
        "own",
        "doubted",
        "own",
    ]);
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    for Row { cameras, any, own, .. } in rows {
        table.add_row([
            cameras.clone(),
            format!("{:.2}", any.error_deg),
            format!("{:.2}", own.error_deg),
            format!("{:.2}", any.error_deg / own.error_deg),
            format!("{:.2}", any.std_deg),
            format!("{:.2}", own.std_deg),
            percent(any.within[0]),
            percent(own.within[0]),
            percent(any.within[1]),
            percent(own.within[1]),
            percent(any.doubted),
            percent(own.doubted),
        ]);
    }
    table
}

fn mebibytes(bytes: usize) -> f64 {
    bytes as f64 / f64::from(1 << 20)
}
