//! `cargo xtask cost`: what scenes and recordings cost, and what more workers save; writes docs/results/cost.md.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};
use clap::{Args, ValueEnum};

use crate::bench::performance::processor_name;
use crate::bench::repeated;
use crate::child::{self, MEBIBYTE, Taken};
use crate::page::Page;
use crate::recipes::preset_name::PresetName;

const PAGE: Page<'_> =
    Page { file: "cost.md", command: "cargo xtask cost", title: "What scenes and recordings cost" };

#[derive(Args)]
pub struct Arguments {
    /// The program; by default the one beside this.
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
}

/// How many jobs, or computers, share the work.
const WORKERS: [usize; 5] = [1, 2, 4, 8, 16];

/// Training is measured on so many scenes, or as many as the preset has, and on twice as many: from 12,800 on as many
/// are refined, however many are drawn.
const SCENES: usize = 13_000;

/// Cameras of the demo's rig.
const CAMERAS: [&str; 3] = ["side", "top", "other_side"];

/// What `track` fits together by default.
const FIT_TOGETHER: usize = 240;

/// How many frames a fit of all together is measured on, and tracking after a fit of so few.
const TOGETHER: [usize; 2] = [FIT_TOGETHER / 3, FIT_TOGETHER];
const TRACKED: [usize; 2] = [500, 2500];
const FEW: &str = "24";

/// The recordings of the example, and their frames: half a minute.
const RECORDINGS: usize = 100;
const FRAMES: usize = 900;

/// A straight line through what two sizes took.
struct Line {
    fixed: f64,
    each: f64,
}

impl Line {
    fn at(&self, count: usize) -> f64 {
        self.fixed + self.each * count as f64
    }
}

/// CPU seconds and MiB, by the number of scenes or frames.
struct Cost {
    seconds: Line,
    mebibytes: Line,
}

impl Cost {
    fn measured(sizes: [usize; 2], of: impl FnMut(usize) -> Result<Taken>) -> Result<Self> {
        let taken = sizes.into_iter().map(of).collect::<Result<Vec<_>>>()?;
        let line = |what: fn(&Taken) -> f64| {
            let each = (what(&taken[1]) - what(&taken[0])) / (sizes[1] - sizes[0]) as f64;
            Line { fixed: what(&taken[0]) - each * sizes[0] as f64, each }
        };
        let mebibytes = line(|taken| taken.peak / MEBIBYTE);
        Ok(Self { seconds: line(|taken| taken.cpu_seconds), mebibytes })
    }
}

/// Writes the page and prints it.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let program = repeated::program(arguments.program.as_deref())?;
    let folder = repeated::drawn(&program, "target/cost")?;
    // One thread: its CPU time is what a job on one core takes.
    let start = || {
        let mut start = Command::new(&program);
        start.current_dir(&folder).env("RAYON_NUM_THREADS", "1");
        start
    };
    let training = training(&start)?;
    let tracking = tracking(&start, &folder)?;
    PAGE.publish(&format!(
        "Measured on {}, by one thread: CPU time is what a job takes that has a core to itself. All is measured\n\
         at two sizes; the straight line through them gives what is fixed, what each scene or frame adds, and\n\
         the times of larger jobs.\n\n{training}\n{tracking}",
        processor_name()
    ))
}

/// The section about training in parts.
fn training(start: &impl Fn() -> Command) -> Result<String> {
    let mut costs = String::from(
        "| preset | scenes | start of a job | a scene in a job | merging, fixed | a scene in merging | memory of 1 job | of each of 16 | of merging |\n\
         |---|--:|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    let mut times = header("preset");
    for preset in PresetName::value_variants() {
        let value = preset.to_possible_value().context("presets can be asked for")?;
        let (name, scenes) = (value.get_name(), preset.preset().scenes());
        let least = SCENES.min(scenes);
        let sizes = [least, 2 * least];
        let part = |scenes: usize| format!("{name}-{scenes}.part");
        let job = Cost::measured(sizes, |scenes| {
            let (part, scenes) = (part(scenes), scenes.to_string());
            let train = ["train", "--preset", name, "--samples", &scenes, "--shard", "1/1"];
            child::run(start().args(train).args(["--out", &part]))
        })?;
        let merging = Cost::measured(sizes, |scenes| {
            child::run(start().args(["merge", &part(scenes), "--out", "hand.phalanx"]))
        })?;
        writeln!(
            costs,
            "| {name} | {scenes} | {:.1} s | {:.2} ms | {:.1} s | {:.2} ms | {:.0} MiB | {:.0} MiB | {:.0} MiB |",
            job.seconds.fixed,
            1e3 * job.seconds.each,
            merging.seconds.fixed,
            1e3 * merging.seconds.each,
            job.mebibytes.at(scenes),
            job.mebibytes.at(scenes / 16),
            merging.mebibytes.at(scenes),
        )?;
        row(&mut times, name, |jobs| {
            job.seconds.at(scenes.div_ceil(jobs)) + merging.seconds.at(scenes)
        })?;
    }
    Ok(format!(
        "## Training in parts\n\n\
         `phalanx train --preset NAME --shard 1/1` and `phalanx merge`, on {SCENES} scenes, or as many as the preset has,\n\
         and twice as many; three views. A job draws the scenes of its part; before, it learns the codebooks and\n\
         what each scene is described by. Merging fits the regressor, and a model of its errors to further scenes:\n\
         a network, which `default` and `best` learn, looks at all scenes there, so that merging grows with them and\n\
         more jobs do not shorten it. A large job can take more memory than the line says.\n\n{costs}\n\
         Minutes that n jobs take, each on a core, and merging them on one after the last of them:\n\
         start + scenes · a scene in a job / n + merging + scenes · a scene in merging. Waiting in a queue and copying\n\
         parts come on top.\n\n{times}"
    ))
}

/// The section about recordings.
fn tracking(start: &impl Fn() -> Command, folder: &Path) -> Result<String> {
    let mut costs = format!(
        "| cameras | a frame, tracked | a frame, fitted together | the hand, from {FIT_TOGETHER} frames | memory of tracking | of fitting {FIT_TOGETHER} together | a recording of {FRAMES} frames |\n\
         |--:|--:|--:|--:|--:|--:|--:|\n"
    );
    let mut times = header("cameras");
    for count in 1..=CAMERAS.len() {
        let cost = |sizes, others: &[&str]| {
            Cost::measured(sizes, |frames| {
                repeated::recording(folder, &CAMERAS[..count], frames)?;
                child::run(repeated::track(&mut start()).args(others))
            })
        };
        let together = cost(TOGETHER, &["--whole-take", "--save-hand", "hand.toml"])?;
        let tracked = cost(TRACKED, &["--hand", "hand.toml", "--fit-together", FEW])?;
        let hand = together.seconds.at(FIT_TOGETHER);
        let recording = hand + tracked.seconds.each * FRAMES as f64;
        writeln!(
            costs,
            "| {count} | {:.0} ms | {:.0} ms | {hand:.0} s | {:.0} MiB | {:.0} MiB | {recording:.0} s |",
            1e3 * tracked.seconds.each,
            1e3 * together.seconds.each,
            tracked.mebibytes.at(FRAMES),
            together.mebibytes.at(FIT_TOGETHER),
        )?;
        row(&mut times, &count.to_string(), |workers| {
            RECORDINGS.div_ceil(workers) as f64 * recording
        })?;
    }
    Ok(format!(
        "## Tracking recordings\n\n\
         `phalanx track --mask` of the take that `phalanx demo` draws, to and fro, in pictures of 120×90: once fitted as a\n\
         whole ({} and {} frames), once tracked from frame to frame by that hand ({} and {}). By default {FIT_TOGETHER}\n\
         frames of a longer recording are fitted together to tell the hand, which is a fixed cost, before all are\n\
         tracked; one of up to {FIT_TOGETHER} frames is fitted together alone.\n\
         Larger pictures, photographs and videos take longer to be read and segmented.\n\n{costs}\n\
         Minutes that n workers, each with a core, take for {RECORDINGS} such recordings: recordings / n, rounded up, times\n\
         what one takes.\n\n{times}",
        TOGETHER[0], TOGETHER[1], TRACKED[0], TRACKED[1]
    ))
}

/// The head of a table of times by the number of workers.
fn header(what: &str) -> String {
    let names = WORKERS.map(|workers| workers.to_string()).join(" | ");
    format!("| {what} | {names} |\n|---|{}\n", "--:|".repeat(WORKERS.len()))
}

/// A line of such a table: minutes.
fn row(table: &mut String, name: &str, seconds: impl Fn(usize) -> f64) -> Result<()> {
    let times = WORKERS.map(|workers| format!("{:.1}", seconds(workers) / 60.0)).join(" | ");
    Ok(writeln!(table, "| {name} | {times} |")?)
}
