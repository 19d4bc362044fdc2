//! `cargo xtask interior-edges`: whether the edges inside a hand's silhouette, where a finger lies before another
//! or before the palm, make poses better; judged by a camera that is left out.

mod crease;
mod information;
mod photograph;

use std::path::PathBuf;

use anyhow::{Context, Result, anyhow};
use clap::Args;
use comfy_table::{Table, presets};
use glam::{DAffine3, DVec2};
use image::DynamicImage;
use phalanx::{FrameFit, Mask, TakeFit};
use phalanx_camera::Camera;
use phalanx_hand::{Dof, HandShape, Pose};
use phalanx_refine::{DrawnTerm, PoseFit, PoseFitSettings, PosePrior, SilhouetteObservation};
use rayon::prelude::*;

use super::frame::FrameName;
use super::method::{Found, Landmarks, Outcome, Sequence};
use super::reference::Reference;
use super::score::{FrameScore, Scorer};
use super::statistics::{mean, percentile};
use super::take::{self, Input, Take};
use super::whole_take::Fits;
use crate::files;
use crate::progress;
use information::{Seen, of_edges};
use photograph::Photograph;

/// How far off an edge inside the silhouette is, px: as far as silhouettes' borders are taken to be, half of it, and a
/// quarter.
const NOISES: [f64; 3] = [2.0, 1.0, 0.5];

/// Standard deviation of a place of a silhouette's border, px.
const BORDER_NOISE: f64 = 2.0;

/// How often edges are looked for, each time about the pose that those before led to.
const ROUNDS: usize = 3;

const HEADER: [&str; 10] = [
    "take",
    "fitted",
    "edges",
    "edges a frame",
    "joints mm: mean / median",
    "states",
    "bone angles",
    "reprojection, fitted views",
    "left-out view",
    "overlap, left-out view",
];

/// What is compared.
#[derive(Args)]
pub struct Arguments {
    /// The folder of data: every folder in it with a calibration.json is a take.
    #[arg(long, value_name = "DIR")]
    data: PathBuf,
    /// Only takes of these names.
    #[arg(long, value_name = "NAME")]
    take: Vec<String>,
}

/// A take's frames through some of its cameras.
struct Trial<'a> {
    take: &'a Take,
    reference: &'a Reference,
    /// The cameras whose views are fitted.
    used: Vec<usize>,
    input: Input,
}

/// One frame of a trial, ready to be fitted.
struct FrameTrial<'a> {
    hand: &'a HandShape,
    rest: DAffine3,
    start: Pose,
    evidence: Vec<SilhouetteObservation>,
    views: Vec<Seen<'a>>,
    prior: PosePrior,
}

/// What came of a frame.
struct Fitted {
    /// The pose by silhouettes, and those with edges known to each of [`NOISES`].
    poses: Vec<Pose>,
    /// How many edges were found last.
    edges: usize,
}

/// Prints the comparison.
///
/// # Errors
/// Data that is not as expected; names the file.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN).set_header(HEADER);
    for folder in take::takes_in(&arguments.data)? {
        let take = Take::read(&folder)?;
        if !arguments.take.is_empty() && !arguments.take.contains(&take.name) {
            continue;
        }
        let reference = Reference::read(&folder, &take.camera_names())?;
        let all: Vec<usize> = (0..take.cameras.len()).collect();
        let is_masked = !take.frames(&all, Input::Masks).is_empty();
        let input = if is_masked { Input::Masks } else { Input::Photographs };
        for used in with_each_left_out(&all) {
            let trial = Trial { take: &take, reference: &reference, used, input };
            trial.compare(&mut table)?;
        }
    }
    files::print(&format!("{table}\n"))
}

/// All views, and of three or more also all but each.
fn with_each_left_out(all: &[usize]) -> Vec<Vec<usize>> {
    let mut tests = vec![all.to_vec()];
    if all.len() > 2 {
        let others = |left: &usize| all.iter().copied().filter(|view| view != left).collect();
        tests.extend(all.iter().map(others));
    }
    tests
}

impl Trial<'_> {
    /// A row for silhouettes alone, and one for each noise of the edges.
    fn compare(&self, table: &mut Table) -> Result<()> {
        let all: Vec<usize> = (0..self.take.cameras.len()).collect();
        let frames = self.take.frames(&all, self.input);
        let landmarks = vec![Landmarks::new(); all.len()];
        let seen_by = |views| Sequence {
            take: self.take,
            views,
            input: self.input,
            frames: &frames,
            spoil: None,
            lose: None,
            landmarks: &landmarks,
        };
        let bar = progress::Bar::new();
        let (sequence, fits) = (seen_by(&self.used), Fits::new());
        let fit = fits.take(&sequence, &bar)?.as_ref();
        let fit = fit.map_err(|error| anyhow!("{}: {error}", self.take.name))?;
        let fitted = (0..frames.len()).into_par_iter().map(|number| {
            let frame = fits.frame_of(&sequence, number)?;
            let pictures = self.used.iter().map(|&view| self.grey(view, &frames[number]));
            let pictures = pictures.collect::<Result<Vec<_>>>()?;
            let cameras = sequence.cameras();
            let trial =
                FrameTrial::new(&cameras, fit, &fit.frames[number], &frame.masks, &pictures)?;
            trial.fitted()
        });
        let fitted: Vec<Fitted> = fitted.collect::<Result<_>>()?;
        let rest = fit.volume.volume.rest_frame();
        for edges in 0..=NOISES.len() {
            let outcome = |fitted: &Fitted| Outcome {
                found: Ok(Found::posed(&fit.hand, &fitted.poses[edges], &rest, None)),
                cpu_ms: None,
            };
            let outcomes: Vec<Outcome> = fitted.iter().map(outcome).collect();
            let name = match edges {
                0 => "–".to_owned(),
                k => format!("± {} px", NOISES[k - 1]),
            };
            let count = mean(&fitted.iter().map(|f| f.edges as f64).collect::<Vec<_>>());
            table.add_row(self.row(&seen_by(&all), &outcomes, name, count)?);
        }
        Ok(())
    }

    fn row(
        &self,
        sequence: &Sequence<'_>,
        outcomes: &[Outcome],
        edges: String,
        count: Option<f64>,
    ) -> Result<Vec<String>> {
        let scores = Scorer::new(self.reference).frames(sequence, outcomes)?;
        let all = |of: &dyn Fn(&FrameScore) -> Vec<f64>| -> Vec<f64> {
            scores.iter().flat_map(of).collect()
        };
        let joints = all(&|score| score.joints_mm.clone());
        let angles = all(&|score| score.angles_deg.clone());
        let states = all(&|score| score.states.iter().map(|&s| f64::from(u8::from(s))).collect());
        let is_left_out = |view: &usize| !self.used.contains(view);
        let reprojection = |wanted: &dyn Fn(&usize) -> bool| {
            let of = |score: &FrameScore| -> Vec<f64> {
                let views = (0..score.reprojection.len()).filter(|view| wanted(view));
                views.flat_map(|view| score.reprojection[view].clone()).collect()
            };
            percentile(&all(&of), 50)
        };
        let overlaps = all(&|score| {
            let views = (0..score.overlaps.len()).filter(is_left_out);
            views.map(|view| score.overlaps[view]).collect()
        });
        let percent = |value: Option<f64>| value.map(|v| format!("{:.1} %", 100.0 * v));
        let spread = mean(&joints).zip(percentile(&joints, 50));
        let names = self.take.camera_names();
        let cells = [
            Some(self.take.name.clone()),
            Some(self.used.iter().map(|&view| names[view]).collect::<Vec<_>>().join(", ")),
            Some(edges),
            count.map(|count| format!("{count:.0}")),
            spread.map(|(mean, median)| format!("{mean:.2} / {median:.2}")),
            percent(mean(&states)),
            mean(&angles).map(|angle| format!("{angle:.1}°")),
            percent(reprojection(&|view| !is_left_out(view))),
            percent(reprojection(&is_left_out)),
            mean(&overlaps).map(|overlap| format!("{overlap:.3}")),
        ];
        Ok(cells.into_iter().map(|cell| cell.unwrap_or_else(|| "–".to_owned())).collect())
    }

    /// The photograph of a frame through a camera.
    fn grey(&self, view: usize, frame: &FrameName) -> Result<DynamicImage> {
        let camera = &self.take.cameras[view];
        let name = &camera.camera.name;
        camera.shown(frame)?.with_context(|| format!("{}: no {name} {frame}", self.take.name))
    }
}

impl<'a> FrameTrial<'a> {
    fn new(
        cameras: &'a [Camera],
        take: &'a TakeFit,
        fit: &FrameFit,
        masks: &[Option<Mask>],
        pictures: &[DynamicImage],
    ) -> Result<Self> {
        let rest = take.volume.volume.rest_frame();
        let (mut evidence, mut views) = (Vec::new(), Vec::new());
        for (k, camera) in cameras.iter().enumerate() {
            let Some(mask) = masks[k].as_ref().filter(|_| fit.views[k].is_mask_used) else {
                continue;
            };
            let [wrist, knuckle] = [0, 9].map(|joint| camera.project(fit.joints[joint]));
            let Some((wrist, knuckle)) = wrist.zip(knuckle) else { continue };
            // The arm behind the hand is not compared.
            let length = 2.0 * wrist.distance(knuckle);
            let is_known = |place: DVec2| place.distance(knuckle) < length;
            evidence.push(SilhouetteObservation::within(camera, mask, is_known)?);
            let photograph = Photograph::new(&pictures[k], mask.hand_pixels());
            views.push(Seen { camera, photograph });
        }
        let prior = PosePrior::independent(fit.pose, &deviations())?;
        Ok(Self { hand: &take.hand, rest, start: fit.pose, evidence, views, prior })
    }

    fn fitted(&self) -> Result<Fitted> {
        if self.evidence.is_empty() {
            return Ok(Fitted { poses: vec![self.start; NOISES.len() + 1], edges: 0 });
        }
        let alone = self.fit(&self.start, &self.prior)?.pose;
        let (mut poses, mut edges) = (vec![alone], 0);
        for noise in NOISES {
            let mut pose = alone;
            for _ in 0..ROUNDS {
                let (known, found) =
                    of_edges(&self.views, self.hand, &self.rest, &pose, &self.prior, noise)?;
                edges = found;
                pose = self.fit(&pose, &self.prior.product(&known)?)?.pose;
            }
            poses.push(pose);
        }
        Ok(Fitted { poses, edges })
    }

    fn fit(&self, start: &Pose, prior: &PosePrior) -> Result<PoseFit> {
        let mut settings = PoseFitSettings {
            max_restarts: 0,
            drawn: DrawnTerm::Area,
            ..PoseFitSettings::of_noise(BORDER_NOISE)
        };
        settings.levels.remove(0);
        for level in &mut settings.levels {
            level.every *= 2;
        }
        Ok(settings.fit(self.hand, &self.rest, &self.evidence, start, prior)?)
    }
}

/// How far a pose is from that of the take, radians and mm.
fn deviations() -> [f64; Dof::COUNT] {
    std::array::from_fn(|index| match Dof::ALL[index] {
        Dof::TX | Dof::TY | Dof::TZ => 10.0,
        Dof::ThetaX | Dof::ThetaY | Dof::ThetaZ => 0.2,
        Dof::WristDeviation | Dof::WristFlexion => 0.25,
        _ => 0.35,
    })
}
