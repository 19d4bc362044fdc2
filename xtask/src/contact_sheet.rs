//! `cargo xtask contact-sheet`: silhouettes, contours, hand axes and estimates over photographs,
//! and how well the skin model finds them.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;
use glam::DVec3;
use image::{GrayImage, RgbImage, imageops};
use phalanx::{Describer, Estimator, Progress, Training, Workspace, draw_overlay, draw_silhouette};
use phalanx_camera::{Camera, Intrinsics, Rig};
use phalanx_hand::{HandShape, Side};
use phalanx_segmentation::{Cleanup, CropWindow, Silhouette, SkinModel, clean, downsample};
use rayon::prelude::*;

use crate::data_set::DataSet;
use crate::saturation::{SaturationThreshold, overlap};
use crate::{files, progress};

/// Panels beside each other on a sheet, and below each other.
const GRID: (u32, u32) = (12, 8);
/// A panel's height, px; its width follows from the photographs' shape.
const PANEL_HEIGHT: u32 = 150;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The folder of data; its `digits/` and `one-camera/frames/` are read.
    #[arg(long, value_name = "DIR")]
    data: PathBuf,
    /// Where the sheets go.
    #[arg(long, value_name = "DIR", default_value = "target/contact-sheet")]
    out: PathBuf,
}

/// One photograph, looked at.
struct Look {
    name: String,
    panel: RgbImage,
    /// The skin model's mask, cleaned; absent where nothing was left of it.
    mask: Option<GrayImage>,
    /// Why there is no contour or no estimate.
    failure: Option<String>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let bar = progress::Bar::new();
    let estimator = Framing { forearm_mm: 35.0 }.estimator(&bar)?;
    let digits = photographs(&arguments.data.join("digits"))?;
    let looks = look_at(&digits, &estimator, &bar);
    write_sheets(&arguments.out, "digits", &looks)?;
    let estimator = Framing { forearm_mm: 240.0 }.estimator(&bar)?;
    let frames = photographs(&arguments.data.join("one-camera/frames"))?;
    let frames: Vec<(String, RgbImage)> = frames
        .into_iter()
        .map(|(name, image)| Ok((name, downsample(&image, 120, 90)?)))
        .collect::<Result<_>>()?;
    let frame_looks = look_at(&frames, &estimator, &bar);
    write_sheets(&arguments.out, "one-camera", &frame_looks)?;
    drop(bar);

    println!("digits: {}", overlap_report(&digits, &looks));
    for (name, looks) in [("digits", &looks), ("one-camera", &frame_looks)] {
        let failures: Vec<&Look> = looks.iter().filter(|look| look.failure.is_some()).collect();
        println!("{name}: {} of {} photographs without an estimate", failures.len(), looks.len());
        for look in failures {
            println!("  {}: {}", look.name, look.failure.as_deref().unwrap_or_default());
        }
    }
    println!("sheets: {}", arguments.out.display());
    Ok(())
}

/// How the photographs of a set show an arm: a camera above it, as far away as the desk's.
struct Framing {
    /// What of the forearm is in the picture, mm.
    forearm_mm: f64,
}

/// From the wrist to a little beyond the fingertips.
const HAND_MM: f64 = 195.0;

impl Framing {
    /// The top camera of the desk, aimed and zoomed so that hand and forearm fill its width.
    fn rig(&self) -> Result<Rig> {
        let mut rig = files::rig(None)?.select(&["top"])?;
        let top = &rig.cameras[0];
        let middle = DVec3::new(0.0, 0.0, 0.5 * (HAND_MM - self.forearm_mm));
        let position = DVec3::new(0.0, top.centre().y, middle.z);
        let intrinsics = top.intrinsics;
        let (width, height) = (intrinsics.width, intrinsics.height);
        let focal = f64::from(width) * position.y / (HAND_MM + self.forearm_mm);
        let intrinsics = Intrinsics::pinhole(width, height, focal);
        rig.cameras[0] = Camera::look_at(&top.name, intrinsics, position, middle, DVec3::X)?;
        Ok(rig)
    }

    /// An estimator for this view alone, learnt from `complex`. The photographs show palms of right
    /// hands and backs of left ones, whose silhouettes are those of a left hand seen from above.
    fn estimator(&self, progress: &dyn Progress) -> Result<Estimator> {
        let hand = HandShape { side: Side::Left, ..files::hand(None)? };
        let data_set = DataSet::stored("complex")?;
        Ok(Training::default().run(&self.rig()?, &hand, &data_set.poses, progress)?)
    }
}

/// All photographs below a folder with their names, in order.
fn photographs(folder: &Path) -> Result<Vec<(String, RgbImage)>> {
    let mut paths = Vec::new();
    collect(folder, &mut paths)?;
    paths.sort();
    if paths.is_empty() {
        bail!("{}: no photographs", folder.display());
    }
    let load = |path: &PathBuf| -> Result<(String, RgbImage)> {
        let image = image::open(path).with_context(|| path.display().to_string())?.to_rgb8();
        let name = path.strip_prefix(folder).unwrap_or(path).display().to_string();
        Ok((name, image))
    };
    paths.par_iter().map(load).collect()
}

fn collect(folder: &Path, paths: &mut Vec<PathBuf>) -> Result<()> {
    let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    for entry in entries {
        let path = entry.with_context(|| folder.display().to_string())?.path();
        let extension = path.extension().map(std::ffi::OsStr::to_ascii_lowercase);
        if path.is_dir() {
            collect(&path, paths)?;
        } else if extension.is_some_and(|extension| extension == "jpg" || extension == "png") {
            paths.push(path);
        }
    }
    Ok(())
}

fn look_at(
    photographs: &[(String, RgbImage)],
    estimator: &Estimator,
    progress: &dyn Progress,
) -> Vec<Look> {
    let skin = SkinModel::builtin();
    progress.begin("look at photographs", photographs.len());
    photographs
        .par_iter()
        .map_init(Eyes::default, |eyes, (name, image)| {
            let raw = skin.segment(image);
            let mut panel = enlarged(image);
            let failure = eyes.draw_estimate(&raw, estimator, &mut panel).err();
            progress.step();
            Look {
                name: name.clone(),
                panel,
                mask: clean(&raw, &Cleanup::default()).ok(),
                failure: failure.map(|error| format!("{error:#}")),
            }
        })
        .collect()
}

/// Memory for looking at one photograph after another.
#[derive(Default)]
struct Eyes {
    describer: Describer,
    workspace: Workspace,
    silhouettes: [Silhouette; 1],
}

impl Eyes {
    fn draw_estimate(
        &mut self,
        raw: &GrayImage,
        estimator: &Estimator,
        panel: &mut RgbImage,
    ) -> Result<()> {
        self.describer.silhouette_of_mask(raw, &mut self.silhouettes[0])?;
        let (width, height) = panel.dimensions();
        let window = CropWindow { x: 0, y: 0, width, height };
        draw_overlay(panel, window, &self.silhouettes[0], None);
        let estimate = estimator.estimate_silhouettes(&self.silhouettes, &mut self.workspace)?;
        let rest = estimator.rig().volume.rest_frame();
        let camera = &estimator.rig().cameras[0];
        let drawn = draw_silhouette(camera, estimator.hand(), &estimate.pose, &rest)?;
        let drawn = Silhouette::from_mask(&drawn).context("the estimated hand")?;
        draw_overlay(panel, window, &self.silhouettes[0], Some(&drawn));
        Ok(())
    }
}

fn enlarged(image: &RgbImage) -> RgbImage {
    let width = image.width() * PANEL_HEIGHT / image.height();
    imageops::resize(image, width, PANEL_HEIGHT, imageops::FilterType::Triangle)
}

/// Evenly spaced looks on one sheet, and all that failed on another.
fn write_sheets(folder: &Path, name: &str, looks: &[Look]) -> Result<()> {
    let places = (GRID.0 * GRID.1) as usize;
    let shown = looks.len().min(places);
    let spaced: Vec<&RgbImage> =
        (0..shown).map(|k| &looks[k * looks.len() / shown].panel).collect();
    write_sheet(&folder.join(format!("{name}.png")), &spaced)?;
    let failed: Vec<&RgbImage> = looks
        .iter()
        .filter(|look| look.failure.is_some())
        .map(|look| &look.panel)
        .take(places)
        .collect();
    if failed.is_empty() {
        return Ok(());
    }
    write_sheet(&folder.join(format!("{name}-failed.png")), &failed)
}

fn write_sheet(path: &Path, panels: &[&RgbImage]) -> Result<()> {
    let (width, height) = panels[0].dimensions();
    let rows = (panels.len() as u32).div_ceil(GRID.0);
    let mut sheet = RgbImage::new(width * GRID.0, height * rows);
    for (k, panel) in panels.iter().enumerate() {
        let (column, row) = (k as u32 % GRID.0, k as u32 / GRID.0);
        imageops::replace(&mut sheet, *panel, (column * width).into(), (row * height).into());
    }
    files::write_png(path, &sheet)
}

/// How well the skin model's masks agree with masks from saturation, over all photographs; one
/// without a mask counts as no overlap.
fn overlap_report(photographs: &[(String, RgbImage)], looks: &[Look]) -> String {
    let threshold = SaturationThreshold::of(photographs);
    let mut overlaps: Vec<f64> = photographs
        .iter()
        .zip(looks)
        .filter_map(|((_, image), look)| {
            let reference = threshold.mask(image)?;
            Some(look.mask.as_ref().map_or(0.0, |mask| overlap(mask, &reference)))
        })
        .collect();
    overlaps.sort_by(f64::total_cmp);
    let at = |share: f64| overlaps[(share * (overlaps.len() - 1) as f64) as usize];
    format!(
        "{} photographs against masks from saturation over {} of 255: intersection over union \
         median {:.3}, quartiles {:.3} and {:.3}, 5th percentile {:.3}",
        overlaps.len(),
        threshold.0,
        at(0.5),
        at(0.25),
        at(0.75),
        at(0.05)
    )
}
