//! Fig. 4 on photographs: whether the nearest posture has the same digits out.

use std::path::Path;

use anyhow::Result;
use image::{RgbImage, imageops};
use phalanx::{
    Describer, ItemRng, OrientationRule, Scene, describe_each, descriptors, draw_silhouette,
};
use phalanx_camera::Rig;
use phalanx_hand::{Digit, Dof, HandShape, Side};
use phalanx_multiview::{CodebookTrainer, ViewEncoders};
use phalanx_segmentation::{Mask, Silhouette, SkinModel};
use phalanx_shape_context::BINS;
use rayon::prelude::*;
use serde_json::json;

use super::{Figure, Table};
use crate::baselines::neighbours::nearest_by_chi_squared;
use crate::context::Lab;
use crate::data::photographs;
use crate::data::postures::{Out, all_ways_out, with_digits_out};
use crate::data::saturation;
use crate::data::scene_list::SceneList;
use crate::figures::mosaic::{mosaic, tinted};

/// Random postures of each of the 32 ways to stretch digits out.
const EACH: usize = 48;
/// How much of the forearm the photographs show, mm.
const FOREARM_MM: f64 = 35.0;

/// Which digits are out when 0 to 9 are signed, thumb first, as the photographs show: from 6 to 9
/// the thumb holds the little, ring, middle and index finger in turn, and in 0 all of them.
const SIGNED: [Out; 10] = [
    [false, false, false, false, false],
    [false, true, false, false, false],
    [false, true, true, false, false],
    [true, true, true, false, false],
    [false, true, true, true, true],
    [true, true, true, true, true],
    [false, true, true, true, false],
    [false, true, true, false, true],
    [false, true, false, true, true],
    [false, false, true, true, true],
];

/// What the photographs say.
pub(super) struct Photographed {
    /// Whether the neighbour is nearer to always having the same digits out than guessing is.
    pub(super) holds: bool,
    pub(super) sentence: String,
    pub(super) note: String,
    pub(super) tables: Vec<Table>,
    pub(super) figure: Figure,
    pub(super) rows: Vec<serde_json::Value>,
}

/// Pictures of each sign that the model draws of itself, to tell causes apart.
const DRAWN: usize = 24;

/// A photograph of a signed digit.
struct Photograph {
    signed: usize,
    image: RgbImage,
}

/// How the hand is found in a photograph.
type Segment = fn(&RgbImage) -> Option<Mask>;

pub(super) fn run(lab: &Lab<'_>, folder: &Path) -> Result<Photographed> {
    let photographs = load(folder)?;
    let gallery = Gallery::draw(lab)?;
    let masks: [(&str, Segment); 2] = [
        ("saturation", saturation::reference_mask),
        ("skin colour", |image| Some(SkinModel::builtin().classify(image))),
    ];
    let signs: Vec<usize> = photographs.iter().map(|photograph| photograph.signed).collect();
    let (mut scores, mut answers) = (Vec::new(), Vec::new());
    for (name, segment) in masks {
        let found = gallery.neighbours(&photographs, segment)?;
        scores.push((name, gallery.score(&signs, &found)));
        answers.push(found);
    }
    let guess = Score::of_guessing(&signs);
    let drawn = gallery.score_of_drawn(lab)?;
    let mut table = Table::new(
        "Digits out in the nearest posture, single view; a picture without a contour counts as \
         wrong. Last, pictures that the hand model draws of the same signs.",
        ["mask", "pictures", "all five right", "of five", "without a contour"],
    );
    let others = [("the most common answer", &guess), ("drawn by the model", &drawn)];
    let all = || scores.iter().map(|(name, score)| (*name, score)).chain(others);
    for (name, score) in all() {
        table.row([
            name.to_owned(),
            score.pictures.to_string(),
            format!("{:.1} %", 100.0 * score.all_five),
            format!("{:.2}", score.digits.iter().sum::<f64>()),
            score.lost.to_string(),
        ]);
    }
    let (_, best) = &scores[0];
    let sentence = format!(
        "of {} photographs {:.0} % have the same five digits out as their neighbour, {:.2} of five \
         digits in the mean, where the most common answers get {:.0} % and {:.2}",
        photographs.len(),
        100.0 * best.all_five,
        best.digits.iter().sum::<f64>(),
        100.0 * guess.all_five,
        guess.digits.iter().sum::<f64>()
    );
    let rows = all().map(|(mask, score)| score.json(mask)).collect();
    let note = format!(
        "Of the same ten signs drawn by the model itself, of other hands and postures than in the \
         gallery, {:.0} % have all five digits right: what is missing there is beyond one view and \
         one neighbour among all 32 ways to stretch digits out. Between that and the photographs' \
         {:.0} % lie what real hands differ by from the model's, what masks differ by, and how \
         likely people hold their fingers as the gallery's random postures do.",
        100.0 * drawn.all_five,
        100.0 * best.all_five
    );
    Ok(Photographed {
        holds: best.all_five > f64::midpoint(guess.all_five, 1.0),
        sentence,
        note,
        tables: vec![table, by_digit(best, &guess), by_sign(best)],
        figure: gallery.sheet(&photographs, &answers[0])?,
        rows,
    })
}

/// The photographs of the folders 0 to 9.
fn load(folder: &Path) -> Result<Vec<Photograph>> {
    let mut photographs = Vec::new();
    for signed in 0..SIGNED.len() {
        let found = photographs::below(&folder.join(signed.to_string()))?;
        photographs.extend(found.into_iter().map(|(_, image)| Photograph { signed, image }));
    }
    Ok(photographs)
}

/// Random postures of every way to stretch digits out, as the photographs would show them.
struct Gallery {
    rig: Rig,
    /// Whose palm the photographs show.
    hand: HandShape,
    scenes: SceneList,
    out: Vec<Out>,
    codebooks: ViewEncoders,
    x: faer::Mat<f64>,
}

impl Gallery {
    fn draw(lab: &Lab<'_>) -> Result<Self> {
        let rig = photographs::framed(FOREARM_MM)?;
        // Palms of right hands have the silhouettes of left hands seen from above.
        let hand = HandShape { side: Side::Left, ..lab.hand.clone() };
        let out: Vec<Out> = all_ways_out().flat_map(|out| [out; EACH]).collect();
        let scenes = scenes(&rig, &hand, &out, 9);
        let contexts = describe_each(&rig, &scenes, OrientationRule::HandAxis, lab.progress)?;
        let contexts = contexts.into_iter().collect::<phalanx::Result<Vec<_>>>()?;
        let codebooks = CodebookTrainer::default().fit(&contexts, BINS)?;
        let x = descriptors(&codebooks, &contexts)?;
        Ok(Self { rig, hand, scenes, out, codebooks, x })
    }

    /// For each photograph its neighbour, by its number; `None` where there is no contour.
    fn neighbours(
        &self,
        photographs: &[Photograph],
        segment: Segment,
    ) -> Result<Vec<Option<usize>>> {
        let contexts: Vec<Option<[Vec<f32>; 1]>> = photographs
            .par_iter()
            .map_init(Describer::default, |describer, photograph| {
                let mask = segment(&photograph.image)?;
                let mut silhouette = Silhouette::default();
                describer.silhouette_of_mask(&mask, &mut silhouette).ok()?;
                let contexts = describer.contexts(&silhouette, OrientationRule::HandAxis).ok()?;
                Some([contexts.values().to_vec()])
            })
            .collect();
        let seen: Vec<&[Vec<f32>; 1]> = contexts.iter().flatten().collect();
        let mut found = self.nearest(&seen)?.into_iter();
        Ok(contexts.iter().map(|seen| seen.as_ref().and_then(|_| found.next())).collect())
    }

    fn nearest<S: AsRef<[Vec<f32>]> + Sync>(&self, contexts: &[S]) -> Result<Vec<usize>> {
        let queries = descriptors(&self.codebooks, contexts)?;
        Ok(nearest_by_chi_squared(self.x.as_ref(), queries.as_ref()))
    }

    fn score(&self, signs: &[usize], neighbours: &[Option<usize>]) -> Score {
        let out = |&neighbour: &Option<usize>| neighbour.map(|number| self.out[number]);
        Score::of(signs, neighbours.iter().map(out))
    }

    /// Of pictures that the model draws of the ten signs.
    fn score_of_drawn(&self, lab: &Lab<'_>) -> Result<Score> {
        let signs: Vec<usize> = (0..SIGNED.len()).flat_map(|sign| [sign; DRAWN]).collect();
        let out: Vec<Out> = signs.iter().map(|&sign| SIGNED[sign]).collect();
        let scenes = scenes(&self.rig, &self.hand, &out, 10);
        let contexts = describe_each(&self.rig, &scenes, OrientationRule::HandAxis, lab.progress)?;
        let contexts = contexts.into_iter().collect::<phalanx::Result<Vec<_>>>()?;
        let found: Vec<_> = self.nearest(&contexts)?.into_iter().map(Some).collect();
        Ok(self.score(&signs, &found))
    }

    /// The middle photograph of each sign over its neighbour.
    fn sheet(&self, photographs: &[Photograph], answers: &[Option<usize>]) -> Result<Figure> {
        const COLUMNS: usize = 5;
        let mut pairs = Vec::new();
        for signed in 0..SIGNED.len() {
            let of_sign = |i: &usize| photographs[*i].signed == signed;
            let places: Vec<usize> = (0..photographs.len()).filter(of_sign).collect();
            let middle = places.len() / 2;
            let answered = (0..places.len()).filter_map(|k| answers[places[k]].map(|a| (k, a)));
            let Some((shown, answer)) = answered.min_by_key(|(k, _)| k.abs_diff(middle)) else {
                continue;
            };
            let scene = &self.scenes.0[answer];
            let (camera, rest) = (&self.rig.cameras[0], &scene.views[0].rest);
            let mask = draw_silhouette(camera, &scene.hand, &scene.pose, rest)?;
            // The fingers point upwards in the photographs, and to the right in the view.
            let upright = Mask::from(imageops::rotate270(&*mask));
            pairs
                .push((photographs[places[shown]].image.clone(), tinted(&upright, [86, 180, 233])));
        }
        let rows = pairs.chunks(COLUMNS).flat_map(|row| {
            let (photographs, neighbours): (Vec<_>, Vec<_>) = row.iter().cloned().unzip();
            photographs.into_iter().chain(neighbours)
        });
        Figure::picture(
            "Signs 0 to 4, then 5 to 9: of each the middle photograph that has a contour, where one \
             has, and the nearest posture below it.",
            &mosaic(&rows.collect::<Vec<RgbImage>>(), COLUMNS as u32, 6),
        )
    }
}

/// Random postures with these digits out, each of another hand, as the photographs would show it.
fn scenes(rig: &Rig, hand: &HandShape, out: &[Out], seed: u64) -> SceneList {
    let scene = |(number, out): (usize, &Out)| {
        let mut random = ItemRng::new(seed, number as u64);
        let hand = hand.scaled(|| random.between(0.9, 1.1));
        let mut pose = with_digits_out(*out, &mut random);
        pose[Dof::ThetaX] = random.between(-15.0, 15.0).to_radians();
        pose[Dof::ThetaZ] = random.between(-25.0, 25.0).to_radians();
        pose[Dof::TZ] = random.between(-25.0, 25.0);
        Scene::nominal(rig, &hand, pose)
    };
    SceneList(out.iter().enumerate().map(scene).collect())
}

/// Shares of answers that are right.
struct Score {
    pictures: usize,
    all_five: f64,
    /// Of each digit of the hand, thumb first.
    digits: [f64; 5],
    /// All five, of each sign.
    signs: [f64; 10],
    /// Photographs without an answer.
    lost: usize,
}

impl Score {
    fn of(signs: &[usize], answers: impl Iterator<Item = Option<Out>>) -> Self {
        let (mut all_five, mut digits, mut lost) = (0.0, [0.0; 5], 0);
        let (mut by_sign, mut count) = ([0.0; 10], [0.0; 10]);
        for (&sign, answer) in signs.iter().zip(answers) {
            let truth = SIGNED[sign];
            count[sign] += 1.0;
            let Some(answer) = answer else {
                lost += 1;
                continue;
            };
            let right = f64::from(u8::from(answer == truth));
            all_five += right;
            by_sign[sign] += right;
            for (digit, (answer, truth)) in digits.iter_mut().zip(answer.into_iter().zip(truth)) {
                *digit += f64::from(u8::from(answer == truth));
            }
        }
        let total = signs.len() as f64;
        Self {
            pictures: signs.len(),
            all_five: all_five / total,
            digits: digits.map(|right| right / total),
            signs: std::array::from_fn(|sign| by_sign[sign] / count[sign]),
            lost,
        }
    }

    /// Of giving the most common answer without looking: of all five digits for the first figure,
    /// of each digit for its own.
    fn of_guessing(signs: &[usize]) -> Self {
        let blind = |answer: Out| Self::of(signs, signs.iter().map(|_| Some(answer)));
        let all = SIGNED.map(blind);
        let best = all.iter().map(|score| score.all_five).fold(0.0, f64::max);
        let [none, every] = [[false; 5], [true; 5]].map(blind);
        Self {
            all_five: best,
            digits: std::array::from_fn(|digit| none.digits[digit].max(every.digits[digit])),
            ..none
        }
    }

    fn json(&self, mask: &str) -> serde_json::Value {
        json!({
            "pictures": "photographs of signed digits", "mask": mask, "all_five": self.all_five,
            "digits": self.digits, "signs": self.signs, "without_contour": self.lost,
        })
    }
}

fn by_digit(score: &Score, guess: &Score) -> Table {
    let mut table = Table::new(
        "Photographs whose neighbour has the digit out, or not out, rightly; masks by saturation.",
        ["digit", "right", "most common answer"],
    );
    for (k, digit) in Digit::ALL.into_iter().enumerate() {
        table.row([
            format!("{digit:?}").to_lowercase(),
            format!("{:.0} %", 100.0 * score.digits[k]),
            format!("{:.0} %", 100.0 * guess.digits[k]),
        ]);
    }
    table
}

fn by_sign(score: &Score) -> Table {
    let mut table = Table::new(
        "All five digits right, by sign; masks by saturation.",
        ["sign", "digits out", "all five right"],
    );
    for (sign, (out, share)) in SIGNED.into_iter().zip(score.signs).enumerate() {
        let names = Digit::ALL.iter().zip(out).filter(|(_, out)| *out);
        let names: Vec<String> =
            names.map(|(digit, _)| format!("{digit:?}").to_lowercase()).collect();
        let words = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
        table.row([sign.to_string(), words, format!("{:.0} %", 100.0 * share)]);
    }
    table
}
