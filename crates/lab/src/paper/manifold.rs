//! Fig. 3: the first two principal axes of the descriptors.

use anyhow::Result;
use phalanx_hand::Dof;
use serde_json::json;

use super::{Experiment, Figure, Finding, Table, Verdict};
use crate::baselines::principal_axes::PrincipalAxes;
use crate::context::Lab;
use crate::figures::chart::{Axis, Chart, Mark, Series};

pub(crate) const EXPERIMENT: Experiment = Experiment {
    name: "fig-3",
    place: "Fig. 3",
    title: "the manifold of the descriptors",
    claim: "on open-close, the first principal axis of the three-view descriptors follows θ_Z and \
            the second the flexion of the fingers; with one view this cannot be seen.",
    run,
};

/// Which of the seven angles are drawn.
const DRAWN_DEG: [f64; 4] = [0.0, 30.0, 60.0, 90.0];

fn run(lab: &Lab<'_>) -> Result<Finding> {
    let described = lab.open_close()?;
    let header = ["views", "axis", "variance", "|ρ| with θ_Z", "|ρ| with mean flexion"];
    let mut table =
        Table::new("Correlations of the principal axes with what the pose does.", header);
    let (mut figures, mut rows, mut aligned) = (Vec::new(), Vec::new(), Vec::new());
    for (words, views) in lab.one_and_all()? {
        let (_, samples) = described.whole(&views, 0)?;
        let axes = PrincipalAxes::of(samples.x.as_ref())?;
        let (turn, flexion) = (samples.degrees(Dof::ThetaZ), samples.flexion());
        let mut correlations = Vec::new();
        for axis in 0..2 {
            let scores = axes.scores(axis);
            let rho = [&turn, &flexion].map(|truth| correlation(&scores, truth).abs());
            let share = axes.shares[axis];
            table.row([
                words.to_owned(),
                (axis + 1).to_string(),
                format!("{:.0} %", 100.0 * share),
                format!("{:.2}", rho[0]),
                format!("{:.2}", rho[1]),
            ]);
            rows.push(json!({
                "views": views.len(), "axis": axis + 1, "variance_share": share,
                "theta_z_correlation": rho[0], "flexion_correlation": rho[1],
            }));
            correlations.push(rho);
        }
        aligned.push(correlations);
        figures.push(Figure::chart(
            format!("{words}: each colour is one θ_Z, each dot a pose."),
            &scatter(&axes, &turn),
        )?);
    }
    let [one, three] = [&aligned[0], &aligned[1]].map(|rho| Alignment::of(rho));
    let claims = [three.is_clear(), three.turn_axis == 0, !one.is_clear()];
    let mut notes = Vec::new();
    if three.turn_axis != 0 {
        notes.push(
            "The order of the axes follows from how far the motion goes: closing the whole hand changes our \
             silhouettes more than turning it by 90° does, and so comes first."
                .to_owned(),
        );
    }
    Ok(Finding {
        verdict: Verdict::of(&claims),
        sentence: format!("{} {}", three.words("With three views"), one.words("With one view")),
        notes,
        tables: vec![table],
        figures,
        json: json!({ "rows": rows }),
    })
}

/// Which of the first two axes follows θ_Z, the other one following the flexion, and how well.
struct Alignment {
    turn_axis: usize,
    turn: f64,
    flexion: f64,
}

/// A correlation from which on an axis is said to follow something.
const FOLLOWS: f64 = 0.7;

impl Alignment {
    /// The better of both ways; `rho` holds each axis's correlations with θ_Z and with flexion.
    fn of(rho: &[[f64; 2]]) -> Self {
        let way =
            |axis: usize| Self { turn_axis: axis, turn: rho[axis][0], flexion: rho[1 - axis][1] };
        let (first, second) = (way(0), way(1));
        if first.turn + first.flexion >= second.turn + second.flexion { first } else { second }
    }

    fn is_clear(&self) -> bool {
        self.turn >= FOLLOWS && self.flexion >= FOLLOWS
    }

    fn words(&self, views: &str) -> String {
        let [turn, flexion] =
            if self.turn_axis == 0 { ["first", "second"] } else { ["second", "first"] };
        format!(
            "{views} the {turn} axis correlates {:.2} with θ_Z and the {flexion} {:.2} with mean flexion.",
            self.turn, self.flexion
        )
    }
}

/// The samples along the first two axes, in a few colours by θ_Z.
fn scatter(axes: &PrincipalAxes, theta_z: &[f64]) -> Chart {
    let scores = [axes.scores(0), axes.scores(1)];
    let at = |degrees: f64| {
        let near = |i: &usize| (theta_z[*i] - degrees).abs() < 0.5;
        let points = (0..theta_z.len()).filter(near).map(|i| (scores[0][i], scores[1][i]));
        Series::new(format!("{degrees}°"), Mark::Dots, points.collect())
    };
    Chart {
        x: Axis::linear("first principal axis"),
        y: Axis::linear("second principal axis"),
        series: DRAWN_DEG.map(at).into(),
    }
}

/// Pearson's correlation.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let product = |a: &[f64], b: &[f64], mean_a: f64, mean_b: f64| -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - mean_a) * (b - mean_b)).sum()
    };
    product(a, b, mean_a, mean_b)
        / (product(a, a, mean_a, mean_a) * product(b, b, mean_b, mean_b)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::correlation;

    #[test]
    fn a_line_correlates_fully_and_a_bowl_not_at_all() {
        let x = [-1.0, 0.0, 1.0];
        assert!((correlation(&x, &[5.0, 3.0, 1.0]) + 1.0).abs() < 1e-12);
        assert!(correlation(&x, &[1.0, 0.0, 1.0]).abs() < 1e-12);
    }
}
