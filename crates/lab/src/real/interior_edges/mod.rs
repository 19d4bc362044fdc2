//! `cargo xtask interior-edges`: whether the edges inside a hand's silhouette, where a finger lies before another
//! or before the palm, make poses better; judged by a camera that is left out.

mod crease;
mod frame_trial;
mod information;
mod photograph;

use std::path::PathBuf;

use anyhow::{Context, Result, anyhow};
use clap::Args;
use comfy_table::{Table, presets};
use image::DynamicImage;
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
use frame_trial::{Fitted, FrameTrial, NOISES};

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

/// Prints the comparison.
///
/// # Errors
/// Data that is not as expected; names the file.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN).set_header(HEADER);
    for folder in take::chosen_in(&arguments.data, &arguments.take)? {
        let take = Take::read(&folder)?;
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
            let pictures = self.used.iter().map(|&view| self.photograph(view, &frames[number]));
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
                found: Ok(Found::posed(&fit.hand, &fitted.poses[edges], &rest)),
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
    fn photograph(&self, view: usize, frame: &FrameName) -> Result<DynamicImage> {
        let camera = &self.take.cameras[view];
        let name = &camera.camera.name;
        let photograph = camera.in_colour_or_grey(frame)?;
        photograph.with_context(|| format!("{}: no photograph of {name}, {frame}", self.take.name))
    }
}
