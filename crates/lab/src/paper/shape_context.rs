//! Fig. 1: from a photograph to a contour and a shape context.

use anyhow::{Context, Result};
use glam::DVec2;
use image::{Rgb, RgbImage, imageops};
use phalanx::{Describer, OrientationRule, WORKING_SIZE, draw_silhouette};
use phalanx_codebook::chi_squared;
use phalanx_segmentation::{Mask, Silhouette, SkinModel, downsample};
use phalanx_shape_context::{BINS, hand_axis, ring_radii, sector_edges};
use serde_json::json;

use super::{Experiment, Figure, Finding, Table, Verdict};
use crate::context::Lab;
use crate::data::data_set::DataSet;
use crate::data::photographs;
use crate::data::saturation;
use crate::figures::mosaic::{magnified, mosaic, tinted};
use crate::figures::photograph::photograph;
use crate::figures::plate;

pub(crate) const EXPERIMENT: Experiment = Experiment {
    name: "fig-1",
    place: "Fig. 1",
    title: "a photograph, its contour and a shape context",
    claim: "classifying pixels by the colour of skin gives the hand's contour, and at the tip of the \
            middle finger a shape context: how much of the contour lies how far away, and where.",
    run,
};

/// The middle finger among the digits.
const MIDDLE_FINGER: usize = 2;
/// Two points are the same place on the hand when they are no further apart, px: less than half
/// of a finger's breadth.
const SAME_PLACE_PX: f64 = 3.0;
/// How much the contours are magnified.
const TIMES: u32 = 4;

/// A photograph, what the colour of skin makes of it, and what to compare that with.
struct Subject {
    words: &'static str,
    photograph: RgbImage,
    /// By the colour of skin.
    mask: Mask,
    /// By other means.
    reference: Mask,
    /// What the reference is.
    means: &'static str,
    tip: Tip,
}

/// Which contour point is the middle finger's tip.
enum Tip {
    /// That nearest to where the model's tip is seen.
    Near(DVec2),
    /// That furthest from the forearm's end.
    Furthest,
}

fn run(lab: &Lab<'_>) -> Result<Finding> {
    let mut notes = vec![format!(
        "Two contours' points are at the same place when they are within {SAME_PLACE_PX} px."
    )];
    let mut comparisons = vec![Comparison::of(rendered(lab)?)?];
    let mut claims = Vec::new();
    if let Some(folder) = lab.data.map(|data| data.join("digits/5")) {
        if folder.is_dir() {
            match real(&folder).and_then(Comparison::of) {
                Ok(comparison) => comparisons.push(comparison),
                Err(error) => {
                    claims.push(false);
                    notes
                        .push(format!("The real photograph has no contour to compare: {error:#}."));
                }
            }
        } else {
            notes.push("There are no photographs of digits; their part is left out.".to_owned());
        }
    }
    claims.extend(comparisons.iter().flat_map(Comparison::claims));
    let said: Vec<String> = comparisons.iter().map(Comparison::sentence).collect();
    let figures = comparisons.iter().map(drawn).collect::<Result<Vec<_>>>()?;
    Ok(Finding {
        verdict: Verdict::of(&claims),
        sentence: format!("{}.", capitalised(&said.join("; "))),
        notes,
        tables: vec![table(&comparisons)],
        figures: figures.into_iter().flatten().collect(),
        json: json!({ "rows": comparisons.iter().map(Comparison::json).collect::<Vec<_>>() }),
    })
}

/// A photograph with the contour of its skin's colour and how alike that of the reference is.
struct Comparison {
    subject: Subject,
    seen: Seen,
    tip: usize,
    found: Match,
}

impl Comparison {
    fn of(subject: Subject) -> Result<Self> {
        let seen = Seen::of(&subject.mask).with_context(|| subject.words)?;
        let reference = Seen::of(&subject.reference).context(subject.means)?;
        let tip = subject.tip.of(&seen)?;
        let found = seen.compare(&reference, tip);
        Ok(Self { subject, seen, tip, found })
    }

    fn claims(&self) -> [bool; 3] {
        [self.seen.is_normalised(), self.found.tip_is_found, self.found.found > 0.9]
    }

    fn sentence(&self) -> String {
        format!(
            "the {} has {} contour points, its context at the tip differs by χ² = {:.3} from that \
             of {}, and {:.1} % of its contexts are most like the one at the same place there",
            self.subject.words,
            self.seen.points().len(),
            self.found.chi_squared,
            self.subject.means,
            100.0 * self.found.found
        )
    }

    fn json(&self) -> serde_json::Value {
        let Self { subject, seen, tip, found } = self;
        json!({
            "photograph": subject.words, "reference": subject.means,
            "contour_points": seen.points().len(), "mean_distance_px": seen.mean_distance,
            "tip_chi_squared": found.chi_squared, "tip_is_found": found.tip_is_found,
            "points_found": found.found, "context": seen.context(*tip),
        })
    }
}

fn table(comparisons: &[Comparison]) -> Table {
    let header =
        ["photograph", "contour points", "μ, px", "χ² at the tip", "tip found again", "all points"];
    let mut table = Table::new(
        "The contexts of the skin's contour against those of the reference: χ² between the two at \
         the tip; whether the reference's most similar context is at the tip too; and of how many \
         points the most similar context is at the same place.",
        header,
    );
    for Comparison { subject, seen, found, .. } in comparisons {
        table.row([
            subject.words.to_owned(),
            seen.points().len().to_string(),
            format!("{:.1}", seen.mean_distance),
            format!("{:.3}", found.chi_squared),
            if found.tip_is_found { "yes" } else { "no" }.to_owned(),
            format!("{:.1} %", 100.0 * found.found),
        ]);
    }
    table
}

/// The open hand as the top camera would photograph it, against the exact silhouette.
fn rendered(lab: &Lab<'_>) -> Result<Subject> {
    let pose = DataSet::stored("open-close")?.poses[0];
    let camera = &lab.rig.cameras[lab.single()?];
    let photograph = photograph(camera, &lab.hand, &pose, &lab.rig, 0)?;
    let rest = lab.rig.volume.rest_frame();
    let tip = phalanx::working_camera(camera)?
        .project(lab.hand.pose(&pose, &rest).ends(&lab.hand)[MIDDLE_FINGER])
        .context("the middle finger's tip is behind the camera")?;
    let small = downsample(&photograph, WORKING_SIZE.0, WORKING_SIZE.1)?;
    Ok(Subject {
        words: "rendered photograph",
        mask: SkinModel::builtin().classify(&small),
        reference: draw_silhouette(camera, &lab.hand, &pose, &rest)?,
        means: "the exact silhouette",
        tip: Tip::Near(tip),
        photograph,
    })
}

/// The middle one of a folder of open hands before a wall, against its mask by saturation.
fn real(folder: &std::path::Path) -> Result<Subject> {
    let mut photographs = photographs::below(folder)?;
    let (name, photograph) = photographs.swap_remove(photographs.len() / 2);
    let reference = saturation::reference_mask(&photograph);
    Ok(Subject {
        words: "real photograph",
        mask: SkinModel::builtin().classify(&photograph),
        reference: reference.with_context(|| format!("{name} is saturated nowhere"))?,
        means: "its mask by saturation",
        tip: Tip::Furthest,
        photograph,
    })
}

/// A silhouette with the shape contexts of its contour.
struct Seen {
    silhouette: Silhouette,
    contexts: Vec<f32>,
    mean_distance: f64,
    /// The direction 0° of all points.
    axis: [f64; 2],
}

/// How alike two contours' contexts are.
struct Match {
    chi_squared: f64,
    tip_is_found: bool,
    /// The part of all points that are.
    found: f64,
}

impl Seen {
    fn of(mask: &Mask) -> Result<Self> {
        let (mut describer, mut silhouette) = (Describer::default(), Silhouette::default());
        describer.silhouette_of_mask(mask, &mut silhouette)?;
        let contexts = describer.contexts(&silhouette, OrientationRule::HandAxis)?;
        let (mean_distance, axis) = (contexts.mean_distance(), contexts.axis(0));
        let contexts = contexts.values().to_vec();
        Ok(Self { silhouette, contexts, mean_distance, axis })
    }

    fn points(&self) -> &[[f64; 2]] {
        &self.silhouette.contour.points
    }

    fn context(&self, point: usize) -> &[f32] {
        &self.contexts[point * BINS..][..BINS]
    }

    fn is_normalised(&self) -> bool {
        let sum = |context: &[f32]| context.iter().map(|&share| f64::from(share)).sum::<f64>();
        self.contexts.chunks(BINS).all(|context| (sum(context) - 1.0).abs() < 1e-5)
    }

    /// The point that is nearest to a place.
    fn nearest(&self, place: DVec2) -> Option<usize> {
        let distance = |&point: &usize| DVec2::from(self.points()[point]).distance(place);
        (0..self.points().len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    fn compare(&self, reference: &Self, tip: usize) -> Match {
        let place = |point: usize| DVec2::from(self.points()[point]);
        let is_found = |point: &usize| {
            let chi = |other: usize| chi_squared(self.context(*point), reference.context(other));
            let others = (0..reference.points().len()).map(|other| (chi(other), other));
            let best = others.min_by(|a, b| a.0.total_cmp(&b.0));
            best.is_some_and(|(_, other)| {
                DVec2::from(reference.points()[other]).distance(place(*point)) <= SAME_PLACE_PX
            })
        };
        let count = self.points().len();
        let found = (0..count).filter(is_found).count() as f64 / count as f64;
        let same = reference.nearest(place(tip)).unwrap_or_default();
        let chi_squared = chi_squared(self.context(tip), reference.context(same));
        Match { chi_squared, tip_is_found: is_found(&tip), found }
    }
}

impl Tip {
    fn of(&self, seen: &Seen) -> Result<usize> {
        match self {
            Self::Near(place) => seen.nearest(*place).context("the contour is empty"),
            Self::Furthest => Ok(hand_axis(seen.points(), seen.silhouette.forearm.end)?.tip_index),
        }
    }
}

/// The photograph beside its contour with the context's grid, and the context.
fn drawn(comparison: &Comparison) -> Result<[Figure; 2]> {
    let Comparison { subject, seen, tip, .. } = comparison;
    let contour = contour_panel(seen, *tip);
    let (width, height) = contour.dimensions();
    let photograph =
        imageops::resize(&subject.photograph, width, height, imageops::FilterType::Triangle);
    Ok([
        Figure::picture(
            format!(
                "The {} and the contour that the colour of skin gives of it, with the grid of the \
                 shape context at the tip; the longer line is the direction 0°.",
                subject.words
            ),
            &mosaic(&[photograph, contour], 2, 8),
        )?,
        Figure::svg(
            format!(
                "The shape context at the tip in the {}: radii in units of the mean distance \
                     μ = {:.1} px.",
                subject.words, seen.mean_distance
            ),
            "log-polar plate of five rings and twelve sectors, darker where more contour lies",
            plate::svg(seen.context(*tip)),
        ),
    ])
}

fn contour_panel(seen: &Seen, tip: usize) -> RgbImage {
    let mut small = tinted(&seen.silhouette.mask, [92, 104, 118]);
    for &[x, y] in seen.points() {
        small.put_pixel(x as u32, y as u32, Rgb([235, 235, 235]));
    }
    let [x, y] = seen.points()[tip];
    small.put_pixel(x as u32, y as u32, Rgb([230, 40, 40]));
    let mut panel = magnified(&small, TIMES);
    for (column, row, pixel) in panel.enumerate_pixels_mut() {
        let place = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5) / f64::from(TIMES);
        if seen.is_on_grid(place - DVec2::new(x, y)) {
            *pixel = Rgb([240, 180, 40]);
        }
    }
    panel
}

impl Seen {
    /// Whether a displacement, px, is on a line of the grid of shape contexts or on the line 0°.
    fn is_on_grid(&self, from: DVec2) -> bool {
        const HALF_LINE_PX: f64 = 0.13;
        let radii = ring_radii(self.mean_distance);
        let (inside, outside) = (radii[0], radii[radii.len() - 1]);
        let distance = from.length();
        let across = |angle: f64, reach: std::ops::Range<f64>| {
            let direction = DVec2::from(self.axis).rotate(DVec2::from_angle(angle));
            reach.contains(&from.dot(direction)) && from.perp_dot(direction).abs() < HALF_LINE_PX
        };
        radii.iter().any(|radius| (distance - radius).abs() < HALF_LINE_PX)
            || sector_edges().into_iter().any(|edge| across(edge, inside..outside))
            || across(0.0, 0.0..1.15 * outside)
    }
}

fn capitalised(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}
