//! Fig. 2: which way to turn shape contexts.

use anyhow::{Context, Result};
use clap::ValueEnum;
use glam::{DAffine3, DQuat};
use phalanx::{ItemRandom, PoseContexts, Scene, describe_each, descriptors};
use phalanx_camera::{Camera, Rig};
use phalanx_hand::{HandShape, Pose};
use phalanx_multiview::Vocabulary;
use phalanx_shape_context::BINS;
use serde_json::json;

use super::{Experiment, Figure, Finding, Table, Verdict};
use crate::chart::{Axis, Chart, Mark, Series};
use crate::data_set::DataSet;
use crate::lab::Lab;
use crate::mosaic::{mosaic, tinted};
use crate::neighbours::nearest_by_chi_squared;
use crate::orientation::Orientation;
use crate::postures::NAMED;
use crate::scene_list::SceneList;

pub(crate) const EXPERIMENT: Experiment = Experiment {
    name: "fig-2",
    place: "Fig. 2",
    title: "which way to turn shape contexts",
    claim: "turned to the hand axis, shape contexts tell silhouettes apart as well as unturned ones \
            do, and go on doing so when the image is turned; unturned ones do not, and once it is \
            turned the tangent and the principal axis are better than they are.",
    run,
};

/// In-plane turns of the camera.
const ROLLS_DEG: [i32; 13] = [-30, -25, -20, -15, -10, -5, 0, 5, 10, 15, 20, 25, 30];
/// Hands that show each posture.
const HANDS: usize = 12;
/// How far their bones and radii differ from the mean hand's.
const SPREAD: f64 = 0.1;
/// By how much their joints are off, degrees.
const HELD_WITHIN_DEG: f64 = 10.0;
/// Every so many poses of `complex` are seen by the codebooks.
const CODEBOOK_STRIDE: usize = 4;
/// Two accuracies this close are taken as equal: two standard errors of a difference.
const EQUAL: f64 = 0.06;

/// What an orientation gets right, one share for each of the rolls.
struct Accuracy {
    name: String,
    orientation: Orientation,
    by_roll: Vec<f64>,
}

fn run(lab: &Lab<'_>) -> Result<Finding> {
    let top = lab.rig.cameras[lab.single()?].name.as_str();
    let rig = lab.rig.select(&[top])?;
    let poses: Vec<Pose> =
        DataSet::stored("complex")?.poses.into_iter().step_by(CODEBOOK_STRIDE).collect();
    let known = |pose: Pose| Scene::nominal(&rig, &lab.hand, pose);
    let trial = Trial {
        codebook: SceneList(poses.into_iter().map(known).collect()),
        gallery: SceneList(NAMED.iter().map(|posture| known(posture.pose())).collect()),
        queries: SceneList(queries(&rig, &lab.hand)),
        rig: &rig,
    };
    let accuracies = Orientation::value_variants()
        .iter()
        .map(|&orientation| trial.accuracy(lab, orientation))
        .collect::<Result<Vec<_>>>()?;
    let (claims, sentence) = judge(&accuracies)?;
    Ok(Finding {
        verdict: Verdict::of(&claims),
        sentence,
        notes: vec![format!(
            "{} postures of the mean hand, seen from above, are told apart by the nearest histogram \
             of votes (χ², {} centres that each orientation learns from complex, which is not \
             turned). The queries are {HANDS} hands in each posture, every bone and radius \
             multiplied by its own factor within 1 ± {SPREAD} and every joint off by up to \
             {HELD_WITHIN_DEG}°; the same hands at every angle. Guessing gives {:.0} %. Shares \
             within {:.0} points are taken as equal: two standard errors of a difference.",
            NAMED.len(),
            Vocabulary::default().centres,
            100.0 / NAMED.len() as f64,
            100.0 * EQUAL
        )],
        tables: vec![table(&accuracies)],
        figures: vec![
            Figure::chart(
                "Postures named rightly when the camera is rolled.",
                &chart(&accuracies),
            )?,
            Figure::picture(
                format!("The postures: {}.", NAMED.map(|posture| posture.name).join(", ")),
                &trial.gallery_sheet()?,
            )?,
        ],
        json: json!({ "rows": rows(&accuracies) }),
    })
}

/// Every posture of every hand at every roll: roll by roll, posture by posture.
fn queries(rig: &Rig, hand: &HandShape) -> Vec<Scene> {
    let at_roll = |roll: i32| {
        NAMED.iter().enumerate().flat_map(move |(class, posture)| {
            (0..HANDS).map(move |number| {
                let mut random = ItemRandom::new(2, (class * HANDS + number) as u64);
                let hand = hand.varied(|| random.between(1.0 - SPREAD, 1.0 + SPREAD));
                let pose = posture.held(HELD_WITHIN_DEG, &mut random);
                let mut scene = Scene::nominal(rig, &hand, pose);
                let turn = rolled(&rig.cameras[0], f64::from(roll).to_radians());
                scene.views[0].rest = turn * scene.views[0].rest;
                scene
            })
        })
    };
    ROLLS_DEG.into_iter().flat_map(at_roll).collect()
}

/// What the world does when a camera is rolled about its optical axis.
fn rolled(camera: &Camera, angle: f64) -> DAffine3 {
    let (centre, axis) = (camera.centre(), camera.extrinsics.rotation.row(2));
    let turn = DQuat::from_axis_angle(axis.normalize(), angle);
    DAffine3::from_rotation_translation(turn, centre - turn * centre)
}

/// What all orientations are tried on.
struct Trial<'a> {
    rig: &'a Rig,
    codebook: SceneList,
    gallery: SceneList,
    queries: SceneList,
}

impl Trial<'_> {
    fn accuracy(&self, lab: &Lab<'_>, orientation: Orientation) -> Result<Accuracy> {
        let contexts = |scenes: &SceneList| -> Result<Vec<PoseContexts>> {
            let described = describe_each(self.rig, scenes, orientation.rule(), lab.progress)?;
            Ok(described.into_iter().collect::<phalanx::Result<_>>()?)
        };
        let codebooks = Vocabulary::default().fit(&contexts(&self.codebook)?, BINS)?;
        let gallery = descriptors(&codebooks, &contexts(&self.gallery)?)?;
        let queries = descriptors(&codebooks, &contexts(&self.queries)?)?;
        let found = nearest_by_chi_squared(gallery.as_ref(), queries.as_ref());
        let share_right = |found: &[usize]| {
            let right = found.iter().enumerate().filter(|(query, class)| query / HANDS == **class);
            right.count() as f64 / found.len() as f64
        };
        let value = orientation.to_possible_value().context("an orientation without a name")?;
        Ok(Accuracy {
            name: value.get_name().replace('_', " "),
            orientation,
            by_roll: found.chunks(NAMED.len() * HANDS).map(share_right).collect(),
        })
    }

    fn gallery_sheet(&self) -> Result<image::RgbImage> {
        let drawn = |scene: &Scene| {
            let (camera, rest) = (&self.rig.cameras[0], &scene.views[0].rest);
            let mask = phalanx::draw_silhouette(camera, &scene.hand, &scene.pose, rest)?;
            Ok(tinted(&mask, [235, 235, 235]))
        };
        let panels = self.gallery.0.iter().map(drawn).collect::<Result<Vec<_>>>()?;
        Ok(mosaic(&panels, 4, 6))
    }
}

impl Accuracy {
    /// The mean over the rolls whose size is within a range, degrees.
    fn at(&self, rolls: std::ops::RangeInclusive<i32>) -> f64 {
        let of = self.by_roll.iter().zip(ROLLS_DEG).filter(|(_, roll)| rolls.contains(&roll.abs()));
        let chosen: Vec<f64> = of.map(|(share, _)| *share).collect();
        chosen.iter().sum::<f64>() / chosen.len() as f64
    }
}

/// The paper's four claims, and what was seen.
fn judge(accuracies: &[Accuracy]) -> Result<([bool; 5], String)> {
    let of = |orientation| {
        let found = accuracies.iter().find(|accuracy| accuracy.orientation == orientation);
        found.context("an orientation was not tried")
    };
    let [image, hand] = [of(Orientation::ImageAxes)?, of(Orientation::HandAxis)?];
    let [tangent, principal] = [of(Orientation::Tangent)?, of(Orientation::PrincipalAxis)?];
    let turned = |accuracy: &Accuracy| accuracy.at(20..=30);
    let claims = [
        turned(image) < image.at(0..=0) - EQUAL,
        hand.at(0..=0) >= image.at(0..=0) - EQUAL,
        turned(hand) >= hand.at(0..=0) - EQUAL,
        turned(tangent) > turned(image) + EQUAL,
        turned(principal) > turned(image) + EQUAL,
    ];
    let said = |accuracy: &Accuracy| {
        format!("{:.0} % and {:.0} %", 100.0 * accuracy.at(0..=0), 100.0 * turned(accuracy))
    };
    let sentence = format!(
        "Unturned and turned by 20° to 30°, the image axes name {} rightly, the hand axis {}, the \
         tangent {}, the principal axis {}.",
        said(image),
        said(hand),
        said(tangent),
        said(principal)
    );
    Ok((claims, sentence))
}

/// The ranges of angles that the table shows.
const SHOWN_DEG: [(&str, std::ops::RangeInclusive<i32>); 4] =
    [("0°", 0..=0), ("± 10°", 10..=10), ("± 20°", 20..=20), ("± 30°", 30..=30)];

fn table(accuracies: &[Accuracy]) -> Table {
    let header = ["orientation"].into_iter().chain(SHOWN_DEG.iter().map(|(words, _)| *words));
    let mut table = Table::new("Postures named rightly, by the camera's roll.", header);
    for accuracy in accuracies {
        let shares = SHOWN_DEG.map(|(_, rolls)| format!("{:.0} %", 100.0 * accuracy.at(rolls)));
        table.row([accuracy.name.clone()].into_iter().chain(shares));
    }
    table
}

fn chart(accuracies: &[Accuracy]) -> Chart {
    let series = |accuracy: &Accuracy| {
        let shares = accuracy.by_roll.iter().map(|share| 100.0 * share);
        let points = ROLLS_DEG.into_iter().map(f64::from).zip(shares).collect();
        Series::new(&accuracy.name, Mark::LineAndDots, points)
    };
    Chart {
        x: Axis::linear("roll of the camera, degrees"),
        y: Axis::from_zero("named rightly, %"),
        series: accuracies.iter().map(series).collect(),
    }
}

fn rows(accuracies: &[Accuracy]) -> Vec<serde_json::Value> {
    let of_orientation = |accuracy: &Accuracy| {
        let row = |(roll, share): (i32, &f64)| json!({ "orientation": accuracy.name, "roll_deg": roll, "accuracy": share });
        ROLLS_DEG.into_iter().zip(&accuracy.by_roll).map(row).collect::<Vec<_>>()
    };
    accuracies.iter().flat_map(of_orientation).collect()
}
