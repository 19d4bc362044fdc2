//! `phalanx demo`: a first result without a camera.

use phalanx_segmentation::Mask;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use clap::Args;
use glam::DVec3;
use image::{ImageFormat, Rgb, RgbImage, imageops};
use phalanx::{TakeFit, TakeFrame, TakeSettings, draw_silhouette, fit_take};
use phalanx_camera::{Camera, Rig};
use phalanx_cli::files::Output;
use phalanx_hand::{Digit, Dof, HandShape, Pose};
use phalanx_io::take::{Take, write_csv};
use serde_json::json;

use crate::form::Form;
use crate::progress::Bar;
use crate::track::take;

/// The rig of the examples.
const DESK: &str = include_str!("../fixtures/desk.toml");

/// Moments that are drawn, and how many a second.
const MOMENTS: usize = 60;
const RATE: f64 = 10.0;

/// Every so many moments are drawn on the sheet, so much larger than they are.
const SHOWN: usize = 10;
const SCALE: u32 = 2;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The folder that all goes to; it must be new or empty.
    #[arg(long, value_name = "DIR", default_value = "phalanx-demo")]
    out: PathBuf,
    #[command(flatten)]
    form: Form,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let folder = &arguments.out;
    let name = || folder.display().to_string();
    std::fs::create_dir_all(folder).with_context(name)?;
    let is_empty = std::fs::read_dir(folder).with_context(name)?.next().is_none();
    ensure!(is_empty, "{}: the folder is not empty; name another with --out", folder.display());
    let rig = Rig::from_toml(DESK)?;
    // Someone's hand, 5 % larger than the mean one that fitting begins with.
    let hand = HandShape::adult().scaled(|| 1.05);
    let poses: Vec<Pose> = (0..MOMENTS).map(pose).collect();
    let frames: Vec<TakeFrame> =
        poses.iter().map(|pose| drawn(&rig, &hand, pose)).collect::<Result<_>>()?;
    save(folder, "rig.toml", DESK.as_bytes())?;
    for (moment, frame) in frames.iter().enumerate() {
        for (camera, mask) in rig.cameras.iter().zip(frame.masks.iter().flatten()) {
            let place = folder.join("recording").join(&camera.name);
            std::fs::create_dir_all(&place).with_context(name)?;
            save(&place, &format!("{moment:03}.png"), &png(mask)?)?;
        }
    }
    let fit = fit_take(&rig.cameras, &frames, &TakeSettings::default(), &Bar::new())?;
    let take = written(&rig, &fit);
    let mut csv = Vec::new();
    write_csv(&take, &mut csv)?;
    save(folder, "take.csv", &csv)?;
    save(folder, "sheet.png", &png(&sheet(&rig.cameras, &frames, &fit)?)?)?;
    let rest = rig.volume.rest_frame();
    let truth: Vec<[DVec3; 21]> = poses.iter().map(|pose| hand.pose(pose, &rest).joints).collect();
    let error_mm = error_mm(&fit, &truth);
    let said = json!({
        "folder": folder, "frames": MOMENTS, "hand_mm": fit.hand.length_mm(),
        "drawn_hand_mm": hand.length_mm(), "joint_error_mm": error_mm,
    });
    arguments.form.print(&said, || Ok(told(folder, &fit, &hand, error_mm)))
}

/// Fingers that open and close one after the other while the hand turns.
fn pose(moment: usize) -> Pose {
    let mut pose = Pose::REST;
    let at = moment as f64 / RATE;
    for (k, finger) in Digit::FINGERS.into_iter().enumerate() {
        let bent = 0.5 - 0.5 * (2.4 * at + 0.9 * k as f64).cos();
        let angles = [0.0, 1.1 * bent, 1.4 * bent, 0.9 * bent];
        finger.dofs().into_iter().zip(angles).for_each(|(dof, angle)| pose[dof] = angle);
    }
    pose[Dof::ThumbAbduction] = 0.1;
    pose[Dof::ThetaZ] = 0.5 + 0.4 * (1.3 * at).cos();
    pose
}

fn drawn(rig: &Rig, hand: &HandShape, pose: &Pose) -> Result<TakeFrame> {
    let rest = rig.volume.rest_frame();
    let mask = |camera: &Camera| Ok(Some(draw_silhouette(camera, hand, pose, &rest)?));
    Ok(TakeFrame::of_masks(rig.cameras.iter().map(mask).collect::<Result<_>>()?))
}

fn written(rig: &Rig, fit: &TakeFit) -> Take {
    let all = vec![true; rig.cameras.len()];
    let frame = |(number, fitted)| {
        let time = number as f64 / RATE;
        take::frame(&rig.cameras, (number, &all), time, Some(fitted))
    };
    let rest = fit.volume.volume.rest_frame();
    let header = take::header(&rig.cameras, (&fit.hand, rest), Some(RATE));
    Take { header, frames: fit.frames.iter().enumerate().map(frame).collect() }
}

/// Mean distance of the joints from where they were drawn, mm.
fn error_mm(fit: &TakeFit, truth: &[[DVec3; 21]]) -> f64 {
    let fitted = fit.frames.iter().flat_map(|frame| frame.joints);
    let distances = fitted.zip(truth.iter().flatten()).map(|(at, drawn)| at.distance(*drawn));
    distances.sum::<f64>() / (21 * truth.len()) as f64
}

/// Moments from top to bottom, cameras from left to right: grey where the fitted hand covers what was seen,
/// orange where something was seen only, blue where the hand was drawn only.
fn sheet(cameras: &[Camera], frames: &[TakeFrame], fit: &TakeFit) -> Result<RgbImage> {
    let rest = fit.volume.volume.rest_frame();
    let mut rows = Vec::new();
    for (frame, fitted) in frames.iter().zip(&fit.frames).step_by(SHOWN) {
        let mut row = Vec::new();
        for (camera, seen) in cameras.iter().zip(frame.masks.iter().flatten()) {
            let drawn = draw_silhouette(camera, &fit.hand, &fitted.pose, &rest)?;
            row.push(panel(seen, &drawn));
        }
        rows.push(row);
    }
    let (width, height) = rows[0][0].dimensions();
    let mut sheet = RgbImage::new(width * cameras.len() as u32, height * rows.len() as u32);
    for (y, row) in rows.iter().enumerate() {
        for (x, panel) in row.iter().enumerate() {
            let (left, top) = (x as i64 * i64::from(width), y as i64 * i64::from(height));
            imageops::replace(&mut sheet, panel, left, top);
        }
    }
    let (width, height) = (sheet.width() * SCALE, sheet.height() * SCALE);
    Ok(imageops::resize(&sheet, width, height, imageops::FilterType::Nearest))
}

fn panel(seen: &Mask, drawn: &Mask) -> RgbImage {
    RgbImage::from_fn(seen.width(), seen.height(), |x, y| {
        let is_hand = |mask: &Mask| mask.is_hand(x, y);
        match (is_hand(seen), is_hand(drawn)) {
            (true, true) => Rgb([190, 190, 190]),
            (true, false) => Rgb([230, 120, 20]),
            (false, true) => Rgb([40, 110, 220]),
            (false, false) => Rgb([20, 20, 24]),
        }
    })
}

fn png<P>(picture: &image::ImageBuffer<P, Vec<u8>>) -> Result<Vec<u8>>
where
    P: image::PixelWithColorType + image::Pixel<Subpixel = u8>,
{
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, ImageFormat::Png)?;
    Ok(bytes.into_inner())
}

fn save(folder: &Path, name: &str, bytes: &[u8]) -> Result<()> {
    Output::new(&folder.join(name), &[] as &[&Path])?.write(bytes)
}

fn told(folder: &Path, fit: &TakeFit, hand: &HandShape, error_mm: f64) -> String {
    let folder = folder.display();
    format!(
        "\
{folder}/rig.toml     three cameras about a desk
{folder}/recording    {MOMENTS} moments of a moving hand, drawn for each camera
{folder}/take.csv     its joint angles with their deviations, a row each moment
{folder}/sheet.png    the fitted hand over what was seen: grey where they agree

The fitted hand is {fitted:.0} mm long (drawn: {drawn:.0}), its joints {error_mm:.1} mm from where they were drawn.

Next: the same from files, as with your own cameras:

    phalanx track --rig {folder}/rig.toml {folder}/recording --mask --out take.csv

`phalanx rig import` reads the calibration of your cameras.
",
        fitted = fit.hand.length_mm(),
        drawn = hand.length_mm(),
    )
}
