//! `cargo xtask two-camera`: a real hand before two calibrated webcams.

mod frames;
mod sheet;

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use glam::DVec3;
use image::{GrayImage, RgbImage};
use phalanx::{Window, WindowFinder};
use phalanx_camera::{Rig, Volume, cameras_from_opencv_json, triangulate};
use phalanx_segmentation::{Silhouette, SkinModel};

use crate::files;
use frames::Frame;

/// The squares of the chessboard that the cameras were calibrated with, mm.
const SQUARE_MM: f64 = 50.0;
/// Side of the cube in which the wrist moves, mm.
const VOLUME_MM: f64 = 400.0;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The folder of data; its `two-camera/` is read.
    #[arg(long, value_name = "DIR")]
    data: PathBuf,
    /// Where the pictures go.
    #[arg(long, value_name = "DIR", default_value = "target/two-camera")]
    out: PathBuf,
}

/// A frame in which a hand was looked for.
pub(crate) struct Look {
    pub(crate) name: String,
    pub(crate) images: Vec<RgbImage>,
    pub(crate) masks: Vec<GrayImage>,
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
    let rig = rig(&folder)?;
    let frames = frames::read(&folder, &rig)?;
    let looks = look_at(&rig, frames);
    let mut report = String::new();
    for look in &looks {
        report += &line(look);
    }
    let whole: Vec<&str> =
        looks.iter().filter(|look| is_whole(look)).map(|look| look.name.as_str()).collect();
    report += &format!(
        "whole hand in both views: {} of {} frames: {}\n",
        whole.len(),
        looks.len(),
        whole.join(" ")
    );
    sheet::write(&arguments.out, &looks)?;
    files::print(&report)
}

/// The rig of the calibration, the person opposite the first camera.
fn rig(folder: &std::path::Path) -> Result<Rig> {
    let path = folder.join("calibration.json");
    let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let cameras = cameras_from_opencv_json(&text, SQUARE_MM)?;
    let guess = Volume::between(&cameras, VOLUME_MM)?;
    let rig = Rig { cameras, volume: Volume { forearm: -guess.forearm, ..guess } };
    rig.validate()?;
    Ok(rig)
}

/// Looks for the hand in each frame, near where it was in the frame before.
fn look_at(rig: &Rig, frames: Vec<Frame>) -> Vec<Look> {
    let (skin, mut finder, mut last) = (SkinModel::builtin(), WindowFinder::default(), None);
    let mut looks = Vec::with_capacity(frames.len());
    for Frame { name, images } in frames {
        let masks: Vec<GrayImage> = images.iter().map(|image| skin.segment(image)).collect();
        let seen = see(rig, &masks, &mut finder, last);
        last = seen.as_ref().ok().map(|seen| seen.wrist);
        looks.push(Look { name, images, masks, seen });
    }
    looks
}

fn see(
    rig: &Rig,
    masks: &[GrayImage],
    finder: &mut WindowFinder,
    last: Option<DVec3>,
) -> Result<Seen> {
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
                        hand.wrist[0], hand.wrist[1], hand.length, hand.width, hand.strangeness
                    )
                })
                .collect();
            let views = views.join("; ");
            format!("{}: {views}; at {wrist:.0} mm, missed by {miss:.1} mm\n", look.name)
        }
    }
}
