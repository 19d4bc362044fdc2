//! `cargo xtask eval-real`: real takes, by cameras used, input and method.
//!
//! Layout, methods and measures are described in `docs/results/real.md`. Cameras come from a take's
//! calibration alone; references score, and nothing else.

pub mod angles;
mod company;
pub mod constant;
pub(crate) mod contact_sheet;
pub(crate) mod drawn_takes;
pub mod frame;
pub(crate) mod interior_edges;
pub mod landmarks;
pub mod lose;
pub mod method;
pub mod methods;
pub mod mistake;
pub mod overlap;
pub mod per_frame;
pub mod product;
pub mod reference;
pub mod report;
pub mod row;
pub mod score;
pub mod sheet;
pub mod spoil;
mod statistics;
mod subsets;
mod table;
pub mod take;
pub mod tracked;
pub(crate) mod two_camera;
pub mod whole_take;

use std::collections::BTreeMap;
use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use phalanx::Progress;
use serde::Serialize;

use crate::files;
use crate::progress;
use frame::{FrameName, FrameRanges};
use lose::Lose;
use method::{Landmarks, Method, Outcome, Sequence};
use methods::{MethodName, Prepared};
use mistake::Mistake;
use reference::Reference;
use report::Line;
use row::Row;
use score::Scorer;
use spoil::Spoil;
use statistics::percentile;
use take::{Input, Take};

/// What is evaluated.
#[derive(Args)]
pub struct Arguments {
    /// The folder of data: every folder in it with a calibration.json is a take.
    #[arg(long, value_name = "DIR")]
    data: PathBuf,
    /// Only takes of these names.
    #[arg(long, value_name = "NAME")]
    take: Vec<String>,
    /// Only these cameras together, such as cam0,cam1; by default all, each pair and each alone.
    #[arg(long, value_name = "NAMES")]
    cameras: Vec<String>,
    /// Only this input.
    #[arg(long, value_enum)]
    input: Option<Input>,
    /// Only these methods.
    #[arg(long, value_enum, value_delimiter = ',')]
    method: Vec<MethodName>,
    /// Only frames in these ranges, such as 14-185,187-198.
    #[arg(long, value_name = "RANGES")]
    frames: Option<FrameRanges>,
    /// Of so many frames one.
    #[arg(long, value_name = "N", default_value = "1")]
    every: std::num::NonZeroUsize,
    /// Spoil the masks of a view: KIND:CAMERA or KIND:CAMERA:half for every second frame. Kinds: face (one
    /// joins the hand), thumb (alone), other (the mask of another frame), nothing.
    #[arg(long, value_name = "KIND:CAMERA")]
    spoil: Option<Spoil>,
    /// Mistake a whole take: other-side for a hand that is taken for one of the other side, exchanged:CAMERA+CAMERA for
    /// cameras that have each other's pictures.
    #[arg(long, value_name = "WHAT")]
    mistake: Option<Mistake>,
    /// Look at no landmarks of this camera, which then tests those of the others.
    #[arg(long, value_name = "CAMERA")]
    without_landmarks: Option<String>,
    /// Lose a camera in the second and in the last quarter of the frames.
    #[arg(long, value_name = "CAMERA")]
    lose: Option<Lose>,
    /// Write the rows as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write a line for each frame as CSV: its errors, the views left out and the doubts.
    #[arg(long, value_name = "FILE")]
    per_frame: Option<PathBuf>,
    /// Draw the found hands over every tenth frame and the five worst.
    #[arg(long, value_name = "DIR")]
    sheets: Option<PathBuf>,
}

/// The JSON report.
#[derive(Serialize)]
struct Rows<'a> {
    rows: Vec<&'a Row>,
}

/// Evaluates the takes.
///
/// # Errors
/// Data that is not as expected; names the file.
pub fn run(arguments: &Arguments) -> Result<()> {
    let folders = take::chosen_in(&arguments.data, &arguments.take)?;
    let (mut rows, mut notes) = (Reported::default(), Vec::new());
    for folder in &folders {
        let mut take = Take::read(folder)?;
        if let Some(mistake) = &arguments.mistake {
            mistake.make(&mut take)?;
        }
        let reference = Reference::read(folder, &take.camera_names())?;
        let bar = progress::Bar::new();
        let evaluation = Evaluation {
            arguments,
            take: &take,
            reference: &reference,
            scorer: Scorer::new(&reference),
            progress: &bar,
        };
        evaluation.run(&mut rows, &mut notes)?;
        if let Some(constant) = evaluation.scorer.constant_joints_mm() {
            notes.push(format!("{}: best constant hand at the wrist {constant:.1} mm", take.name));
        }
    }
    files::print(&format!("{}\n{}\n", report::table(&rows.lines), notes.join("\n")))
}

/// What was evaluated so far.
#[derive(Default)]
struct Reported {
    lines: Vec<Line>,
    frames: Vec<per_frame::Line>,
}

impl Arguments {
    /// Writes what there is so far, so that a run that is stopped leaves it.
    fn write(&self, reported: &Reported) -> Result<()> {
        if let Some(path) = &self.json {
            let rows = Rows { rows: reported.lines.iter().map(|line| &line.row).collect() };
            files::write_whole(path, (serde_json::to_string_pretty(&rows)? + "\n").as_bytes())?;
        }
        if let Some(path) = &self.per_frame {
            files::write_whole(path, &per_frame::csv(&reported.frames)?)?;
        }
        Ok(())
    }
}

/// One method to run.
struct Job {
    method: MethodName,
    input: Input,
    frames: Vec<FrameName>,
}

/// One take, evaluated.
struct Evaluation<'a> {
    arguments: &'a Arguments,
    take: &'a Take,
    reference: &'a Reference,
    scorer: Scorer<'a>,
    progress: &'a dyn Progress,
}

impl Evaluation<'_> {
    /// A line for each of the cameras used, the input and the method; notes beside them.
    fn run(&self, reported: &mut Reported, notes: &mut Vec<String>) -> Result<()> {
        let landmarks = self.landmarks()?;
        for views in subsets::of(&self.take.camera_names(), &self.arguments.cameras)? {
            let jobs = self.jobs(&views);
            let prepared = Prepared::new(self.reference);
            for Job { method, input, frames } in &jobs {
                let sequence = Sequence {
                    take: self.take,
                    views: &views,
                    input: *input,
                    frames,
                    spoil: self.spoil(),
                    lose: self.arguments.lose.as_ref(),
                    landmarks: &landmarks,
                };
                notes.extend(self.line(&sequence, &*prepared.method(*method), reported)?);
                self.arguments.write(reported)?;
            }
        }
        Ok(())
    }

    /// Every input and method that is asked for and has frames.
    fn jobs(&self, views: &[usize]) -> Vec<Job> {
        let methods = match &*self.arguments.method {
            [] => &MethodName::ALL[..],
            some => some,
        };
        let wanted = |method: &MethodName, input: Input| {
            self.arguments.input.is_none_or(|only| only == input)
                && method.inputs().contains(&input)
                && (self.arguments.lose.is_none() || method.may_lose_cameras())
        };
        let job = |input: Input, method: MethodName| {
            let frames = self.frames(method, views, input);
            (!frames.is_empty()).then_some(Job { method, input, frames })
        };
        let of_input = |input: Input| {
            methods
                .iter()
                .filter(move |method| wanted(method, input))
                .filter_map(move |&method| job(input, method))
        };
        Input::ALL.into_iter().flat_map(of_input).collect()
    }

    /// The landmarks that may be looked at.
    fn landmarks(&self) -> Result<Vec<Landmarks>> {
        let mut landmarks = self.reference.landmarks.clone();
        if let Some(camera) = &self.arguments.without_landmarks {
            let view = self.take.camera_names().iter().position(|name| name == camera);
            let view = view.with_context(|| format!("{}: no camera '{camera}'", self.take.name))?;
            landmarks[view].clear();
        }
        Ok(landmarks)
    }

    fn spoil(&self) -> Option<(&Spoil, &[Landmarks])> {
        Some((self.arguments.spoil.as_ref()?, &self.reference.landmarks))
    }

    /// The frames that are asked for; of landmarks those that any of the cameras has some of.
    fn frames(&self, method: MethodName, views: &[usize], input: Input) -> Vec<FrameName> {
        let is_of_landmarks = method == MethodName::Landmarks || input == Input::Landmarks;
        let frames = if is_of_landmarks && views.len() < 2 {
            Vec::new()
        } else if is_of_landmarks {
            let seen = views.iter().flat_map(|&view| self.reference.landmarks[view].keys());
            let mut frames: Vec<FrameName> = seen.cloned().collect();
            frames.sort();
            frames.dedup();
            frames
        } else {
            self.take.frames(views, input)
        };
        let ranges = self.arguments.frames.as_ref();
        let wanted = frames.into_iter().filter(|frame| ranges.is_none_or(|r| r.hold(frame)));
        wanted.step_by(self.arguments.every.get()).collect()
    }

    /// Runs and scores one method.
    fn line(
        &self,
        sequence: &Sequence<'_>,
        method: &dyn Method,
        reported: &mut Reported,
    ) -> Result<Vec<String>> {
        let cameras: Vec<String> = sequence.cameras().into_iter().map(|c| c.name).collect();
        let title =
            [&self.take.name, &*cameras.join("+"), sequence.input.name(), method.name()].join("-");
        let title = match &self.arguments.spoil {
            Some(spoil) => format!("{title}-{spoil}"),
            None => title,
        };
        let title = match &self.arguments.without_landmarks {
            Some(camera) if sequence.input.has_landmarks() => {
                format!("{title}-without-{camera}")
            }
            _ => title,
        };
        let title = match &self.arguments.lose {
            Some(lose) => format!("{title}-{lose}"),
            None => title,
        };
        self.progress.begin(&title, sequence.frames.len());
        let outcomes = method.run(sequence, self.progress)?;
        let scores = self.scorer.frames(sequence, &outcomes)?;
        let row = score::row(sequence, method.name(), &outcomes, &scores)?;
        let of_view = |view: usize| -> Vec<f64> {
            scores.iter().flat_map(|score| score.reprojection[view].iter().copied()).collect()
        };
        let views = 0..sequence.views.len();
        let reprojection_by_view = views.map(|view| percentile(&of_view(view), 50)).collect();
        reported.lines.push(Line { row, reprojection_by_view });
        reported.frames.extend(per_frame::lines(sequence, method.name(), &outcomes, &scores));
        let mut notes = refusals(&title, &outcomes);
        notes.extend(left_out(&title, &outcomes));
        if let Some(folder) = self.arguments.sheets.as_ref().filter(|_| is_drawn(&outcomes)) {
            let path = folder.join(format!("{title}.png"));
            let written = sheet::write(&path, sequence, &outcomes, &scores);
            notes.push(written.with_context(|| path.display().to_string())?);
        }
        Ok(notes)
    }
}

/// Why frames were refused, and how many for each reason.
fn refusals(title: &str, outcomes: &[Outcome]) -> Vec<String> {
    let mut reasons = BTreeMap::new();
    for error in outcomes.iter().filter_map(|outcome| outcome.found.as_ref().err()) {
        *reasons.entry(format!("{error:#}")).or_insert(0) += 1;
    }
    reasons.iter().map(|(reason, count)| format!("{title}: {count} refused: {reason}")).collect()
}

/// In how many frames each camera's view was left out.
fn left_out(title: &str, outcomes: &[Outcome]) -> Vec<String> {
    let mut cameras = BTreeMap::new();
    for found in outcomes.iter().filter_map(|outcome| outcome.found.as_ref().ok()) {
        for camera in &found.left_out {
            *cameras.entry(camera).or_insert(0) += 1;
        }
    }
    let count = outcomes.len();
    cameras
        .iter()
        .map(|(of, times)| format!("{title}: {of} left out in {times} of {count}"))
        .collect()
}

/// Whether there is a hand to draw.
fn is_drawn(outcomes: &[Outcome]) -> bool {
    outcomes.iter().any(|outcome| outcome.found.as_ref().is_ok_and(|own| !own.solids.is_empty()))
}
