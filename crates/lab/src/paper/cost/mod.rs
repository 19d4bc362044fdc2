//! § 5.4: what every stage costs, and how it grows.

mod growth;
mod stages;

use anyhow::Result;
use serde_json::json;

use super::{Experiment, Figure, Finding, Table, Verdict};
use crate::clock::duration;
use crate::context::Lab;
use crate::figures::chart::{Axis, Chart, Mark, Series};
use growth::{Group, Growth};
use stages::Stages;

pub(crate) const EXPERIMENT: Experiment = Experiment {
    name: "section-5-4",
    place: "§ 5.4",
    title: "the cost",
    claim: "describing the images is the only step of an estimate whose cost grows with the number \
            of cameras; the pose itself takes microseconds, Gaussian kernels more than linear ones \
            and less when they read selected features; in training, clustering is dearest.",
    run,
};

/// A time whose exponent is below this does not grow.
const FLAT: f64 = 0.25;

fn run(lab: &Lab<'_>) -> Result<Finding> {
    lab.progress.begin("time every stage", 2);
    let (stages, halves) = stages::run(lab)?;
    lab.progress.step();
    let groups = growth::run(lab, &halves)?;
    lab.progress.step();
    let [describing, estimating, sharing, estimating_shared] =
        [0, 1, 2, 3].map(|k| groups[0].growths[k].exponent());
    let [lin, gauss, both] = stages.estimate;
    let claims = [
        (0.75..1.25).contains(&describing),
        estimating < FLAT,
        estimating_shared < FLAT,
        lin.max(gauss).max(both) < 1e-4,
        lin < both && both < gauss,
        stages.dearest_fit <= stages.clustering,
    ];
    Ok(Finding {
        verdict: Verdict::of(&claims),
        sentence: format!(
            "Describing what C cameras see takes C^{describing:.2} times as long as one and \
             estimating the pose C^{estimating:.2} times, at 30 centres for each camera; \
             C^{sharing:.2} and C^{estimating_shared:.2} where they share 90; a picture is described \
             in {} and the pose then found in {} by linear kernels, {} by Gaussian ones and {} by \
             those on selected features; clustering the codebooks of {} samples takes {}, the \
             dearest fit {}.",
            duration(stages.describe),
            duration(lin),
            duration(gauss),
            duration(both),
            halves.train.x.ncols(),
            duration(stages.clustering),
            duration(stages.dearest_fit)
        ),
        notes: notes(growth::linear_steps(&halves)?),
        tables: vec![beside_the_paper(&stages), memory(&stages), exponents(&groups)],
        figures: groups.iter().map(figure).collect::<Result<_>>()?,
        json: json(&stages, &groups),
    })
}

/// With the linear fit's steps and ν/m on the fewest and on the most samples.
fn notes([few, many]: [(usize, f64); 2]) -> Vec<String> {
    vec![
        "These are times of a clock: they differ from one computer and from one run to the next, \
         and with what else the computer does. So this experiment's JSON is the only one that does \
         not come out the same twice; performance.md has the figures of a more careful \
         measurement. Estimates are timed on one thread, training on all."
            .to_owned(),
        "The paper's times are those of Matlab on a Pentium 4 at 2.4 GHz. Its 652 ms for three \
         cameras are more than three times 170 ms and 36 µs; it does not say for what."
            .to_owned(),
        "Photographs are of 640 × 480 pixels and decoded; describing one is all from there to the \
         histogram. Against the number of cameras, each camera's own \
         contour is described, and the pose estimated by the Gaussian regressor learnt from those \
         cameras, of as many samples for every number. At 30 centres each the descriptor has 30 \
         numbers more for every camera, which the kernels read; sharing 90 it always has 90. Contour \
         points are evenly spaced by their index in the contour, not by their distance."
            .to_owned(),
        format!(
            "What the linear fit costs follows its steps and not its samples, which are summed up \
             once. Where ν is too strong for all columns asked for to survive, it begins anew at \
             half of it: on the fewest samples it ends at ν/m = {:.4} after {} more steps, on the \
             most at {:.4} after {}.",
            few.1, few.0, many.1, many.0
        ),
    ]
}

fn beside_the_paper(stages: &Stages) -> Table {
    let header = ["stage", "paper", "here", "faster by"];
    let mut table = Table::new("Times, on three views of the training half of complex.", header);
    for stage in &stages.timed {
        let paper = stage.paper;
        table.row([
            stage.name.to_owned(),
            paper.map_or_else(|| "–".to_owned(), duration),
            duration(stage.here),
            paper.map_or_else(|| "–".to_owned(), |paper| format!("{:.0} ×", paper / stage.here)),
        ]);
    }
    table
}

fn memory(stages: &Stages) -> Table {
    let caption = "Memory: the sizes of the arrays, and the most that the process has held.";
    let mut table = Table::new(caption, ["what", "size"]);
    for held in &stages.held {
        table.row([held.name.clone(), bytes(held.bytes)]);
    }
    table
}

fn bytes(count: usize) -> String {
    let count = count as f64;
    let units = [(1024.0 * 1024.0, "MiB"), (1024.0, "KiB")];
    let (size, unit) = units.into_iter().find(|(size, _)| count >= *size).unwrap_or((1.0, "B"));
    format!("{:.1} {unit}", count / size)
}

fn exponents(groups: &[Group]) -> Table {
    let header = ["grows with", "stage", "from", "to", "at the least", "at the most", "exponent"];
    let caption = "How the stages grow: the time at the smallest and the largest size, and the \
                   exponent of the power law that fits best.";
    let mut table = Table::new(caption, header);
    for (group, growth) in each(groups) {
        let [first, last] = [growth.points[0], growth.points[growth.points.len() - 1]];
        table.row([
            group.with.to_owned(),
            growth.stage.to_owned(),
            format!("{:.0}", first.0),
            format!("{:.0}", last.0),
            duration(first.1),
            duration(last.1),
            format!("{:.2}", growth.exponent()),
        ]);
    }
    table
}

fn each(groups: &[Group]) -> impl Iterator<Item = (&Group, &Growth)> {
    groups.iter().flat_map(|group| group.growths.iter().map(move |growth| (group, growth)))
}

fn figure(group: &Group) -> Result<Figure> {
    let points = || group.growths.iter().flat_map(|growth| &growth.points);
    let (label, unit) =
        if points().any(|point| point.1 > 0.01) { ("time, ms", 1e-3) } else { ("time, µs", 1e-6) };
    let series = |growth: &Growth| {
        let points = growth.points.iter().map(|(size, seconds)| (*size, seconds / unit)).collect();
        Series::new(growth.stage, Mark::LineAndDots, points)
    };
    let chart = Chart {
        x: Axis::logarithmic(group.with),
        y: Axis::logarithmic(label),
        series: group.growths.iter().map(series).collect(),
    };
    let stages: Vec<String> = group
        .growths
        .iter()
        .map(|growth| format!("{} (exponent {:.2})", growth.stage, growth.exponent()))
        .collect();
    Figure::chart(format!("Time against {}: {}.", group.with, stages.join(", ")), &chart)
}

fn json(stages: &Stages, groups: &[Group]) -> serde_json::Value {
    let stage =
        |s: &stages::Stage| json!({ "stage": s.name, "paper_seconds": s.paper, "seconds": s.here });
    let held = |h: &stages::Held| json!({ "held": h.name, "bytes": h.bytes });
    let growth = |(group, growth): (&Group, &Growth)| {
        json!({
            "grows_with": group.with, "stage": growth.stage, "exponent": growth.exponent(),
            "points": growth.points,
        })
    };
    let rows = stages.timed.iter().map(stage).chain(stages.held.iter().map(held));
    json!({ "rows": rows.chain(each(groups).map(growth)).collect::<Vec<_>>() })
}
