//! `cargo xtask two-camera`: a real hand before two calibrated webcams.

mod angles;
mod fit;
mod paper;
mod sheet;

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use glam::DVec3;
use image::RgbImage;
use phalanx::{Progress, Window, WindowFinder, Workspace};
use phalanx_camera::{Rig, Volume, triangulate};
use phalanx_hand::{Dof, HandShape, Pose, write_poses};
use phalanx_refine::PoseFit;
use phalanx_segmentation::{Mask, Silhouette, SkinModel};

use crate::data::sets;
use crate::files;
use crate::progress;
use crate::real::angles::{COUNT, of_joints};
use crate::real::frame::FrameName;
use crate::real::reference::Reference;
use crate::real::take::{Input, Take, TakeCamera};

/// Hands that are learnt from, unless it is said how many.
const SAMPLES: usize = 3000;
/// How often the hand is calibrated, each time from frames refined with it as it was before.
const ROUNDS: usize = 3;
/// Overlap that is asked for in every view.
const GOAL: f64 = 0.88;
/// Side of the cube in which the wrist moves, mm.
const VOLUME_MM: f64 = 400.0;

#[derive(Args)]
pub struct Arguments {
    /// The folder of data; its `two-camera/` is read.
    #[arg(long, value_name = "DIR")]
    data: PathBuf,
    /// How many drawn hands are learnt from.
    #[arg(long, value_name = "N", default_value_t = SAMPLES, value_parser = sets::samples)]
    samples: usize,
    /// Look for the hand only: learn, estimate and refine nothing.
    #[arg(long)]
    windows_only: bool,
    /// Where the pictures go.
    #[arg(long, value_name = "DIR", default_value = "target/two-camera")]
    out: PathBuf,
}

/// A frame in which a hand was looked for.
pub(crate) struct Look {
    pub(crate) name: String,
    pub(crate) images: Vec<RgbImage>,
    pub(crate) masks: Vec<Mask>,
    pub(crate) seen: Result<Seen>,
}

/// A hand that was found in both views.
pub(crate) struct Seen {
    pub(crate) windows: Vec<Window>,
    pub(crate) silhouettes: Vec<Silhouette>,
    /// Where the wrist's rays meet, mm in the world, and by how much they miss.
    pub(crate) wrist: DVec3,
    pub(crate) miss: f64,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let folder = arguments.data.join("two-camera");
    if !folder.is_dir() {
        eprintln!("{}: no such folder; skipped", folder.display());
        return Ok(());
    }
    let take = Take::read(&folder)?;
    let rig = rig(&take)?;
    let looks = look_at(&rig, &take)?;
    let whole: Vec<&str> =
        looks.iter().filter(|look| is_whole(look)).map(|look| look.name.as_str()).collect();
    let mut report: Vec<String> = looks.iter().map(line).collect();
    report.push(format!(
        "whole hand in both views: {} of {} frames: {}\n",
        whole.len(),
        looks.len(),
        whole.join(" ")
    ));
    sheet::write(&arguments.out, &looks)?;
    if !arguments.windows_only {
        let bar = progress::Bar::new();
        report.extend(fit(arguments, &take, &rig, &looks, &bar)?);
    }
    files::print(&report.concat())
}

/// Estimates, calibrates and refines the frames with the whole hand in both views; what came of it.
fn fit(
    arguments: &Arguments,
    take: &Take,
    rig: &Rig,
    looks: &[Look],
    progress: &dyn Progress,
) -> Result<Vec<String>> {
    let learnt = fit::learn(rig, &files::hand(None)?, arguments.samples, progress)?;
    let (mut workspace, mut starts, mut whole) = (Workspace::default(), Vec::new(), Vec::new());
    for look in looks.iter().filter(|look| is_whole(look)) {
        let Ok(seen) = &look.seen else { continue };
        match learnt.start(seen, &mut workspace) {
            Ok(start) => {
                starts.push(start);
                whole.push(look);
            }
            Err(error) => eprintln!("{}: {error:#}", look.name),
        }
    }
    let mean = learnt.estimator.hand();
    let with_mean = learnt.refine(mean, &starts, |k| fit::postures(&starts[k].estimate.pose))?;
    let rounds = own_hand(&learnt, &starts, &with_mean)?;
    let (own, with_own) = rounds.last().context("no round of calibration")?;
    let names: Vec<&str> = whole.iter().map(|look| look.name.as_str()).collect();
    let reference = Reference::read(&take.folder, &take.camera_names())?.angles;
    let of_frame = |name: &&str| reference.get(&FrameName::from(*name)).copied();
    let reference: Vec<_> =
        names.iter().map(|name| of_frame(name).unwrap_or([None; COUNT])).collect();
    let rest = rig.volume.rest_frame();
    let estimates: Vec<Pose> = starts.iter().map(|start| start.estimate.pose).collect();
    let table = |what: &str, hand: &HandShape, poses: &[Pose]| {
        let of = |pose: &Pose| of_joints(&hand.pose(pose, &rest).joints);
        let found: Vec<_> = poses.iter().map(of).collect();
        format!("{what}\n{}", angles::table(&found, &reference))
    };
    let poses_of =
        |fitted: &[PoseFit]| -> Vec<Pose> { fitted.iter().map(|fit| fit.pose).collect() };
    let mut report = vec![table("estimated", mean, &estimates)];
    for (round, (hand, fitted)) in rounds.iter().enumerate() {
        let what = said_of_round(round, hand, fitted);
        report.push(table(&what, hand, &poses_of(fitted)));
    }
    for (what, hand, fitted) in [("mean", mean, &with_mean), ("own", own, with_own)] {
        report.push(said_of(what, hand, &names, fitted));
        let poses = poses_of(fitted);
        report.push(table(&format!("refined with the {what} hand"), hand, &poses));
        let mut csv = Vec::new();
        write_poses(&mut csv, &poses, &Dof::ALL)?;
        files::write_whole(&arguments.out.join(format!("poses-{what}.csv")), &csv)?;
        sheet::write_fits(&arguments.out, what, &whole, hand, &rest, &poses)?;
    }
    report.push(paper::write(&arguments.out, rig, own, arguments.samples, &whole, progress)?);
    Ok(report)
}

/// The hand calibrated and the frames refined with it, round by round, from where the mean hand led. A
/// finger that the mean hand took for another finds its place with a hand that fits.
fn own_hand(
    learnt: &fit::Learnt,
    starts: &[fit::Start],
    with_mean: &[PoseFit],
) -> Result<Vec<(HandShape, Vec<PoseFit>)>> {
    let first = learnt.calibrate(starts, with_mean)?;
    let fitted = learnt.refine(&first, starts, |k| vec![with_mean[k].pose])?;
    let mut rounds = vec![(first, fitted)];
    while let Some((_, before)) = rounds.last().filter(|_| rounds.len() < ROUNDS) {
        let own = learnt.calibrate(starts, before)?;
        let from = |k: usize| [vec![before[k].pose], fit::postures(&before[k].pose)].concat();
        let fitted = learnt.refine(&own, starts, from)?;
        rounds.push((own, fitted));
    }
    Ok(rounds)
}

fn said_of_round(round: usize, own: &HandShape, fitted: &[PoseFit]) -> String {
    let energy: f64 = fitted.iter().map(|fit| fit.energy).sum();
    let length = fit::length_mm(own);
    format!("calibrated, round {}: {length:.0} mm long, energy {energy:.0}", round + 1)
}

/// How much of what was seen a hand covers, frame by frame.
fn said_of(what: &str, hand: &HandShape, names: &[&str], fitted: &[PoseFit]) -> String {
    let (least, reached) = fit::overlaps(fitted, GOAL);
    let first = format!(
        "{what} hand, {:.0} mm long: least overlap of a frame's views {least:.3} on average; at least \
         {GOAL} in both views in {:.0} % of {} frames\n",
        fit::length_mm(hand),
        100.0 * reached,
        fitted.len()
    );
    let frame = |(name, fit): (&&str, &PoseFit)| {
        let overlaps = fit.ious.iter().map(|overlap| format!("{overlap:.3}"));
        format!("  {name} {}\n", overlaps.collect::<Vec<_>>().join(" "))
    };
    std::iter::once(first).chain(names.iter().zip(fitted).map(frame)).collect()
}

/// The rig of the calibration, the person opposite the first camera.
fn rig(take: &Take) -> Result<Rig> {
    let all: Vec<usize> = (0..take.cameras.len()).collect();
    let cameras = take.cameras(&all);
    let guess = Volume::between(&cameras, VOLUME_MM)?;
    let rig = Rig { cameras, volume: Volume { forearm: -guess.forearm, ..guess } };
    rig.validate()?;
    Ok(rig)
}

/// Looks for the hand in each frame, near where it was in the frame before unless that did not show
/// the whole of it.
fn look_at(rig: &Rig, take: &Take) -> Result<Vec<Look>> {
    let (skin, mut finder, mut last) = (SkinModel::builtin(), WindowFinder::default(), None);
    let all: Vec<usize> = (0..take.cameras.len()).collect();
    let mut looks = Vec::new();
    for frame in take.frames(&all, Input::Photographs) {
        let image = |camera: &TakeCamera| camera.picture(&frame, Input::Photographs);
        let images = take.cameras.iter().map(|camera| Ok(image(camera)?.to_rgb8()));
        let images: Vec<RgbImage> = images.collect::<Result<_>>()?;
        let masks: Vec<Mask> = images.iter().map(|image| skin.classify(image)).collect();
        let seen = see(rig, &masks, &mut finder, last);
        let look = Look { name: frame.to_string(), images, masks, seen };
        last = look.seen.as_ref().ok().filter(|_| is_whole(&look)).map(|seen| seen.wrist);
        looks.push(look);
    }
    Ok(looks)
}

fn see(rig: &Rig, masks: &[Mask], finder: &mut WindowFinder, last: Option<DVec3>) -> Result<Seen> {
    let windows = finder.find(&rig.cameras, masks, last)?;
    let mut silhouettes = vec![Silhouette::default(); windows.len()];
    finder.silhouettes(&windows, &mut silhouettes)?;
    let rays = rig.cameras.iter().zip(&windows);
    let rays: Vec<_> =
        rays.filter_map(|(camera, window)| camera.unproject(window.hand.wrist.into())).collect();
    let met = triangulate(&rays)?;
    Ok(Seen { windows, silhouettes, wrist: met.point, miss: met.spread })
}

/// Whether the whole hand is in all views.
fn is_whole(look: &Look) -> bool {
    look.seen.as_ref().is_ok_and(|seen| seen.windows.iter().all(|window| !window.hand.cut_off))
}

fn line(look: &Look) -> String {
    match &look.seen {
        Err(error) => format!("{}: {error:#}\n", look.name),
        Ok(Seen { windows, wrist, miss, .. }) => {
            let views: Vec<String> = windows
                .iter()
                .map(|window| {
                    let hand = &window.hand;
                    let cut_off = if hand.cut_off { ", cut off" } else { "" };
                    format!(
                        "wrist {:.0},{:.0} length {:.0} width {:.0} strangeness {:.1}{cut_off}",
                        hand.wrist[0], hand.wrist[1], hand.length, hand.width, hand.mahalanobis2
                    )
                })
                .collect();
            let views = views.join("; ");
            format!("{}: {views}; at {wrist:.0} mm, missed by {miss:.1} mm\n", look.name)
        }
    }
}
