//! `cargo xtask contact-sheet`: silhouettes, contours, hand axes and estimates over photographs,
//! and how well the skin model finds them.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;
use image::{RgbImage, imageops};
use phalanx::{Describer, Estimator, Progress, Training, Workspace, draw_overlay, draw_silhouette};
use phalanx_hand::{HandShape, Side};
use phalanx_segmentation::{AdaptedSkin, Cleanup, CropWindow, Mask, Silhouette, SkinModel, clean};
use rayon::prelude::*;

use crate::data::data_set::DataSet;
use crate::data::photographs;
use crate::data::saturation;
use crate::figures::mosaic::mosaic;
use crate::files;
use crate::progress;

/// Panels beside each other on a sheet, and below each other.
const GRID: (u32, u32) = (12, 8);
/// A panel's height, px; its width follows from the photographs' shape.
const PANEL_HEIGHT: u32 = 150;

#[derive(Args)]
pub struct Arguments {
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
    mask: Option<Mask>,
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
        let photographs = photographs::below(&folder)?;
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

impl Set {
    /// An estimator for this view alone, learnt from `complex`. The photographs show palms of right
    /// hands and backs of left ones, whose silhouettes are those of a left hand seen from above.
    fn estimator(&self, progress: &dyn Progress) -> Result<Estimator> {
        let hand = HandShape { side: Side::Left, ..files::hand(None)? };
        let data_set = DataSet::stored("complex")?;
        let rig = photographs::framed(self.forearm_mm)?;
        Ok(Training::default().run(&rig, &hand, &data_set.poses, progress)?)
    }
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
            let raw = AdaptedSkin::new(&skin, image).segment(image);
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
        raw: &Mask,
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
    files::write_png(path, &mosaic(panels, GRID.0, 0))
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
        Some(look.mask.as_ref().map_or(0.0, |mask| mask.iou(&reference)))
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
