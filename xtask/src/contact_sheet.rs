//! `cargo xtask contact-sheet`: silhouettes, contours, hand axes and estimates over photographs,
//! and how well the skin model finds them.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;
use glam::DVec3;
use image::{GrayImage, RgbImage, imageops};
use phalanx::{
    Describer, Estimator, Progress, Training, WORKING_SIZE, Workspace, draw_overlay,
    draw_silhouette,
};
use phalanx_camera::{Camera, Intrinsics, Rig};
use phalanx_hand::{HandShape, Side};
use phalanx_segmentation::{Cleanup, CropWindow, Silhouette, SkinModel, clean, downsample};
use rayon::prelude::*;

use crate::data_set::DataSet;
use crate::{files, progress, saturation};

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

/// A folder of photographs.
struct Set {
    name: &'static str,
    folder: &'static str,
    backdrop: Backdrop,
    /// How much of the forearm its photographs show, mm.
    forearm_mm: f64,
}

/// What is behind the hand.
#[derive(PartialEq, Eq)]
enum Backdrop {
    /// Bright and unsaturated, so that saturation alone makes a mask to compare with.
    BrightWall,
    /// Anything else.
    Other,
}

const SETS: [Set; 2] = [
    Set { name: "digits", folder: "digits", backdrop: Backdrop::BrightWall, forearm_mm: 35.0 },
    Set {
        name: "one-camera",
        folder: "one-camera/frames",
        backdrop: Backdrop::Other,
        forearm_mm: 240.0,
    },
];

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let mut report = String::new();
    for set in SETS {
        let folder = arguments.data.join(set.folder);
        if !folder.is_dir() {
            eprintln!("{}: no such folder; left out", folder.display());
            continue;
        }
        let bar = progress::Bar::new();
        let photographs = photographs(&folder)?;
        let looks = look_at(&photographs, &set.estimator(&bar)?, &bar);
        drop(bar);
        write_sheets(&arguments.out, set.name, &looks)?;
        report += &set.report(&photographs, &looks);
    }
    if report.is_empty() {
        let [first, second] = SETS.map(|set| set.folder);
        bail!("{}: there is neither {first} nor {second}", arguments.data.display());
    }
    files::print(&report)
}

/// From the wrist to a little beyond the fingertips.
const HAND_MM: f64 = 195.0;

impl Set {
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

/// All photographs below a folder with their names, in order; large ones at the working size.
/// What cannot be read is named on standard error and left out.
fn photographs(folder: &Path) -> Result<Vec<(String, RgbImage)>> {
    let mut paths = Vec::new();
    collect(folder, &mut paths)?;
    paths.sort();
    let load = |path: &PathBuf| -> Result<(String, RgbImage)> {
        let image = image::open(path).with_context(|| path.display().to_string())?.to_rgb8();
        let name = path.strip_prefix(folder).unwrap_or(path).display().to_string();
        let (width, height) = WORKING_SIZE;
        if image.width() > width && image.height() > height {
            return Ok((name, downsample(&image, width, height)?));
        }
        Ok((name, image))
    };
    let loaded: Vec<_> = paths.par_iter().map(load).collect();
    let readable = loaded.into_iter().filter_map(|photograph| {
        photograph.inspect_err(|error| eprintln!("left out: {error:#}")).ok()
    });
    let photographs: Vec<_> = readable.collect();
    if photographs.is_empty() {
        bail!("{}: no photographs", folder.display());
    }
    Ok(photographs)
}

fn collect(folder: &Path, paths: &mut Vec<PathBuf>) -> Result<()> {
    let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    for entry in entries {
        let path = entry.with_context(|| folder.display().to_string())?.path();
        let extension = path.extension().map(std::ffi::OsStr::to_ascii_lowercase);
        if path.is_dir() {
            collect(&path, paths)?;
        } else if extension
            .is_some_and(|extension| ["jpg", "jpeg", "png"].iter().any(|known| extension == *known))
        {
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
        let rule = estimator.orientation();
        draw_overlay(panel, window, &self.silhouettes[0], rule, None);
        let estimate = estimator.estimate_silhouettes(&self.silhouettes, &mut self.workspace)?;
        let rest = estimator.rig().volume.rest_frame();
        let camera = &estimator.rig().cameras[0];
        let drawn = draw_silhouette(camera, estimator.hand(), &estimate.pose, &rest)?;
        let drawn = Silhouette::from_mask(&drawn).context("the estimated hand")?;
        draw_overlay(panel, window, &self.silhouettes[0], rule, Some(&drawn));
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
    let width = panels.iter().map(|panel| panel.width()).max().unwrap_or_default();
    let height = PANEL_HEIGHT;
    let rows = (panels.len() as u32).div_ceil(GRID.0);
    let mut sheet = RgbImage::new(width * GRID.0, height * rows);
    for (k, panel) in panels.iter().enumerate() {
        let (column, row) = (k as u32 % GRID.0, k as u32 / GRID.0);
        imageops::replace(&mut sheet, *panel, (column * width).into(), (row * height).into());
    }
    files::write_png(path, &sheet)
}

impl Set {
    /// What there is to say of the set.
    fn report(&self, photographs: &[(String, RgbImage)], looks: &[Look]) -> String {
        let mut lines = Vec::new();
        if self.backdrop == Backdrop::BrightWall {
            lines.push(overlap_report(photographs, looks));
        }
        let failed = || looks.iter().filter_map(|look| Some((&look.name, look.failure.as_ref()?)));
        let count = failed().count();
        lines.push(format!("{count} of {} photographs without an estimate", looks.len()));
        lines.extend(failed().map(|(photograph, failure)| format!("  {photograph}: {failure}")));
        lines.iter().fold(String::new(), |text, line| text + self.name + ": " + line + "\n")
    }
}

/// How well the skin model's masks agree with masks from saturation, over all photographs that
/// have one; a photograph without a skin mask counts as no overlap.
fn overlap_report(photographs: &[(String, RgbImage)], looks: &[Look]) -> String {
    let overlap_of = |((_, image), look): (&(String, RgbImage), &Look)| {
        let reference = saturation::reference_mask(image)?;
        Some(look.mask.as_ref().map_or(0.0, |mask| saturation::overlap(mask, &reference)))
    };
    let mut overlaps: Vec<f64> = photographs.iter().zip(looks).filter_map(overlap_of).collect();
    overlaps.sort_by(f64::total_cmp);
    let Some(last) = overlaps.len().checked_sub(1) else {
        return "no photograph is saturated anywhere: there is no mask to compare with".to_owned();
    };
    let at = |share: f64| overlaps[(share * last as f64) as usize];
    format!(
        "{} photographs against masks from saturation over {} of 255: intersection over union \
         median {:.3}, quartiles {:.3} and {:.3}, 5th percentile {:.3}",
        overlaps.len(),
        saturation::THRESHOLD,
        at(0.5),
        at(0.25),
        at(0.75),
        at(0.05)
    )
}
