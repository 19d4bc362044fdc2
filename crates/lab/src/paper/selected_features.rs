//! Fig. 7: the few features that linear selection keeps, and which part of the hand they see.

use anyhow::{Context, Result};
use faer::Mat;
use image::{Rgb, RgbImage};
use phalanx::Describer;
use phalanx_codebook::{AnyEncoder, Encoder, Scratch};
use phalanx_rvm::{AgarwalTriggs, Kernel, Stop};
use phalanx_shape_context::BINS;
use serde_json::json;

use super::statistics::Mean;
use super::voting_places::{Place, along_the_hand, places, silhouette};
use super::{Experiment, Figure, Finding, Table, Verdict};
use crate::baselines::principal_axes::PrincipalAxes;
use crate::context::Lab;
use crate::data::described::{Described, vocabulary};
use crate::figures::chart::{Axis, Chart, Mark, Series};
use crate::figures::mosaic::{magnified, mosaic, tinted};

pub(crate) const EXPERIMENT: Experiment = Experiment {
    name: "fig-7",
    place: "Fig. 7",
    title: "the two features that are kept, and what votes for them",
    claim: "of three views' features on open-close, linear selection down to two keeps one of the \
            top view and one of a side view; both centres, and those kept of a single view, belong \
            to contour near the wrist rather than near the finger tips.",
    run,
};

/// Even splits, each with codebooks and a selection of its own.
const SPLITS: u64 = 10;
/// How many features are kept of three views and of one, as in the paper.
const THREE_VIEWS_KEEP: usize = 2;
const ONE_VIEW_KEEPS: usize = 3;
/// About how many shape contexts a scatter shows.
const SCATTERED: usize = 1500;

/// One kept feature: a centre of one camera's codebook.
struct Feature {
    /// Of the rig.
    camera: usize,
    centre: usize,
    encoder: AnyEncoder,
}

/// What one split kept of some views.
struct Selection {
    words: &'static str,
    split: u64,
    kept: Vec<(Feature, Place)>,
    /// Of all centres that might have been kept, how many are near the wrist.
    near_the_wrist: f64,
    /// Centres of each view.
    a_view: usize,
}

fn run(lab: &Lab<'_>) -> Result<Finding> {
    let described = lab.open_close()?;
    let [one, three] = lab.one_and_all()?;
    let along = (0..lab.rig.cameras.len())
        .map(|camera| along_the_hand(lab, described, camera))
        .collect::<Result<Vec<_>>>()?;
    let of_views = |(words, views): &(&'static str, Vec<usize>), keep: usize| {
        (0..SPLITS)
            .map(|split| select(described, &along, words, views, keep, split))
            .collect::<Result<Vec<_>>>()
    };
    let (three, one) = (of_views(&three, THREE_VIEWS_KEEP)?, of_views(&one, ONE_VIEW_KEEPS)?);
    let top = lab.single()?;
    let is_top_and_side = |selection: &&Selection| {
        selection.kept.iter().filter(|(feature, _)| feature.camera == top).count() == 1
    };
    let mixed = three.iter().filter(is_top_and_side).count();
    // Of two features taken blindly; and the standard deviation of the splits' share by chance.
    let [of_top, of_side] = [1, lab.rig.cameras.len() - 1].map(|n| (n * three[0].a_view) as f64);
    let all = of_top + of_side;
    let chance = 2.0 * of_top * of_side / (all * (all - 1.0));
    let deviation = (chance * (1.0 - chance) / three.len() as f64).sqrt();
    let near = [Nearness::of(&three), Nearness::of(&one)];
    let claims = [
        mixed as f64 / three.len() as f64 > chance + 2.0 * deviation,
        near[0].more.is_above(0.0),
        near[1].more.is_above(0.0),
    ];
    let selections: Vec<&Selection> = three.iter().chain(&one).collect();
    let mut figures = vec![silhouettes(lab, described, &three[0])?];
    for (feature, _) in &three[0].kept {
        figures.push(scatter(lab, described, feature)?);
    }
    Ok(Finding {
        verdict: Verdict::of(&claims),
        sentence: format!(
            "In {mixed} of {} splits the two features kept of three views are one of the top and one \
             of a side view (by chance {:.0} ± {:.0} %); {} of the centres kept of three views and {} of one draw their votes \
             from nearer the wrist than the tip, as {:.0} % and {:.0} % of all centres do (in the mean over the splits {:+.0} ± {:.0} and \
             {:+.0} ± {:.0} points more); the votes \
             come from {:.0} mm and {:.0} mm from the wrist, where the mean contour point is {:.0} mm \
             from it.",
            three.len(),
            100.0 * chance,
            100.0 * deviation,
            near[0].kept(),
            near[1].kept(),
            100.0 * near[0].of_all,
            100.0 * near[1].of_all,
            100.0 * near[0].more.value,
            100.0 * near[0].more.standard_error,
            100.0 * near[1].more.value,
            100.0 * near[1].more.standard_error,
            mean_of(&three, |place| place.from_wrist),
            mean_of(&one, |place| place.from_wrist),
            mean_of(&three, |place| place.all_from_wrist),
        ),
        notes: vec![
            "Distances are along the forearm's direction in the camera's image, weighted by the \
             votes over all poses; that from the tips is from the foremost point of each contour, \
             be it a knuckle of a fist. The claims are taken to hold when a larger share of the kept \
             centres than of all is nearer the wrist, by two standard errors over the splits, and when \
             more splits keep one of the top and one of a side view than by chance, by two standard \
             deviations."
                .to_owned(),
            format!(
                "With two features a single selection says little: of two centres taken blindly both \
                 are nearer the wrist with chance {:.0} %.",
                100.0 * near[0].of_all.powi(2)
            ),
        ],
        tables: vec![table(lab, &selections)],
        figures,
        json: json!({ "rows": rows(lab, &selections) }),
    })
}

/// Selects features on the training half of one split, and finds out where their votes are from.
fn select(
    described: &Described,
    along: &[Vec<Vec<f64>>],
    words: &'static str,
    views: &[usize],
    keep: usize,
    split: u64,
) -> Result<Selection> {
    let halves = described.halves(views, split)?;
    let bridges = AgarwalTriggs {
        kernel: Kernel::Linear,
        stop: Stop::Count(keep),
        ..AgarwalTriggs::default()
    };
    let fit = bridges.fit(halves.train.x.as_ref(), halves.train.y.as_ref())?;
    let mut features = Vec::new();
    for (&camera, encoder) in views.iter().zip(halves.codebooks.views()) {
        let places = places(described, camera, &along[camera], encoder)?;
        features.extend(
            places.into_iter().enumerate().map(|(centre, place)| {
                (Feature { camera, centre, encoder: encoder.clone() }, place)
            }),
        );
    }
    let a_view = features.len() / views.len();
    let near = features.iter().filter(|(_, place)| place.is_near_the_wrist()).count();
    let near_the_wrist = near as f64 / features.len() as f64;
    let selected = fit.model.selected_features();
    let kept = features.into_iter().enumerate().filter(|(k, _)| selected.contains(k));
    let kept = kept.map(|(_, feature)| feature).collect();
    Ok(Selection { words, split, kept, near_the_wrist, a_view })
}

impl Feature {
    /// The part of each contour point's vote that this centre gets, 0 to 1.
    fn votes(&self, contexts: &[f32]) -> Result<Vec<f64>> {
        let (mut scratch, mut all) = (Scratch::default(), vec![0.0; self.encoder.dim()]);
        let vote = |context: &[f32]| {
            self.encoder.encode(context, &mut scratch, &mut all)?;
            Ok(all[self.centre])
        };
        contexts.chunks(BINS).map(vote).collect()
    }
}

/// How many features are near the wrist rather than the tip.
struct Nearness {
    near: usize,
    kept: usize,
    /// Share of all features that are.
    of_all: f64,
    /// By how much the kept ones' share is above it, over the splits.
    more: Mean,
}

impl Nearness {
    fn of(selections: &[Selection]) -> Self {
        let near = |selection: &Selection| {
            selection.kept.iter().filter(|(_, place)| place.is_near_the_wrist()).count()
        };
        let more = |selection: &Selection| {
            near(selection) as f64 / selection.kept.len() as f64 - selection.near_the_wrist
        };
        let of_all = selections.iter().map(|selection| selection.near_the_wrist).sum::<f64>();
        Self {
            near: selections.iter().map(near).sum(),
            kept: selections.iter().map(|selection| selection.kept.len()).sum(),
            of_all: of_all / selections.len() as f64,
            more: Mean::of(&selections.iter().map(more).collect::<Vec<_>>()),
        }
    }

    fn kept(&self) -> String {
        format!("{} of {}", self.near, self.kept)
    }
}

fn mean_of(selections: &[Selection], figure: fn(&Place) -> f64) -> f64 {
    let figures = || selections.iter().flat_map(|s| s.kept.iter().map(|(_, place)| figure(place)));
    figures().sum::<f64>() / figures().count() as f64
}

fn table(lab: &Lab<'_>, selections: &[&Selection]) -> Table {
    let header =
        ["views", "split", "camera", "centre", "from the wrist, mm", "from the tip, mm", "all, mm"];
    let mut table = Table::new(
        "The features kept, and how far the contour points that vote for them are from the wrist \
         and from the foremost point; all contour points from the wrist.",
        header,
    );
    for selection in selections {
        for (feature, place) in &selection.kept {
            table.row([
                selection.words.to_owned(),
                (selection.split + 1).to_string(),
                lab.rig.cameras[feature.camera].name.replace('_', " "),
                feature.centre.to_string(),
                format!("{:.0}", place.from_wrist),
                format!("{:.0}", place.from_tip),
                format!("{:.0}", place.all_from_wrist),
            ]);
        }
    }
    table
}

fn rows(lab: &Lab<'_>, selections: &[&Selection]) -> Vec<serde_json::Value> {
    let of_selection = |selection: &&Selection| {
        let row = |(feature, place): &(Feature, Place)| {
            json!({
                "views": selection.words, "split": selection.split,
                "camera": lab.rig.cameras[feature.camera].name, "centre": feature.centre,
                "from_wrist_mm": place.from_wrist, "from_tip_mm": place.from_tip,
                "all_points_from_wrist_mm": place.all_from_wrist,
            })
        };
        selection.kept.iter().map(row).collect::<Vec<_>>()
    };
    selections.iter().flat_map(of_selection).collect()
}

/// A pose in the cameras of the kept features, with the points that vote for each: the pose in
/// which the one with fewer votes has most.
fn silhouettes(lab: &Lab<'_>, described: &Described, selection: &Selection) -> Result<Figure> {
    let mut most = (0.0, 0);
    for (pose, contexts) in described.contexts.iter().enumerate() {
        let mut fewest = f64::INFINITY;
        for (feature, _) in &selection.kept {
            let votes = feature.votes(&contexts[feature.camera])?;
            fewest = fewest.min(votes.iter().sum::<f64>() / votes.len() as f64);
        }
        if fewest > most.0 {
            most = (fewest, pose);
        }
    }
    let (_, shown) = most;
    let panels = selection.kept.iter().map(|(feature, _)| {
        let (camera, rest) = (&lab.rig.cameras[feature.camera], lab.rig.volume.rest_frame());
        let pose = &described.poses[shown];
        let silhouette = silhouette(camera, &lab.hand, pose, &rest, &mut Describer::default())?;
        let votes = feature.votes(&described.contexts[shown][feature.camera])?;
        let mut panel = tinted(&silhouette.mask, [92, 104, 118]);
        let equal_share = 1.0 / vocabulary(selection.split).assignment.neighbours as f64;
        for (&[x, y], vote) in silhouette.contour.points.iter().zip(votes) {
            let colour = if vote > equal_share { [255, 60, 60] } else { [235, 235, 235] };
            panel.put_pixel(x as u32, y as u32, Rgb(colour));
        }
        Ok(magnified(&panel, 4))
    });
    let panels = panels.collect::<Result<Vec<RgbImage>>>()?;
    let names = selection.kept.iter().map(|(feature, _)| &lab.rig.cameras[feature.camera].name);
    let names: Vec<String> = names.map(|name| name.replace('_', " ")).collect();
    Figure::picture(
        format!(
            "A pose of open-close as the cameras of the first split's two features see it ({}); red: \
             contour points whose vote goes to the kept centre by more than an equal share.",
            names.join(", ")
        ),
        &mosaic(&panels, 2, 8),
    )
}

/// A camera's shape contexts and centres along their first two principal axes.
fn scatter(lab: &Lab<'_>, described: &Described, feature: &Feature) -> Result<Figure> {
    let of_camera = || {
        let of_pose = |seen: &Vec<Vec<f32>>| seen[feature.camera].len() / BINS;
        described.contexts.iter().map(of_pose).sum::<usize>()
    };
    let stride = (of_camera() / SCATTERED).max(1);
    let contexts = described.contexts.iter().flat_map(|seen| seen[feature.camera].chunks(BINS));
    let contexts: Vec<&[f32]> = contexts.step_by(stride).collect();
    let codebook = feature.encoder.codebook().context("votes have a codebook")?;
    let centres: Vec<&[f32]> = codebook.centres().chunks(BINS).collect();
    let all: Vec<&[f32]> = contexts.iter().chain(&centres).copied().collect();
    let axes =
        PrincipalAxes::of(Mat::from_fn(BINS, all.len(), |k, i| f64::from(all[i][k])).as_ref())?;
    let [x, y] = [axes.scores(0), axes.scores(1)];
    let at = |i: usize| (x[i], y[i]);
    let first = contexts.len();
    let chosen = first + feature.centre;
    let others = (first..all.len()).filter(|&i| i != chosen).map(at).collect();
    let chart = Chart {
        x: Axis::linear("first principal axis of the contexts"),
        y: Axis::linear("second principal axis"),
        series: vec![
            Series::new("contexts", Mark::Dots, (0..first).map(at).collect()),
            Series::new("centres", Mark::Discs, others),
            Series::new("the kept one", Mark::Discs, vec![at(chosen)]),
        ],
    };
    let name = lab.rig.cameras[feature.camera].name.replace('_', " ");
    Figure::chart(
        format!("Shape contexts of the camera '{name}' and the centres of its codebook."),
        &chart,
    )
}
