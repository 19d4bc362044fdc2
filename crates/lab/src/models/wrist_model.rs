//! `cargo xtask wrist-model`: trains the wrist model that the segmentation crate ships, on drawn
//! hands in every direction.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;
use glam::{DAffine3, DQuat, DVec2, DVec3};
use phalanx::ItemRng;
use phalanx_camera::{Camera, Intrinsics};
use phalanx_hand::{Dof, HandShape, sample_pose};
use phalanx_segmentation::{Cleanup, HandDetector, WristModel, WristTrainer};

use super::drawn_hand::DrawnHand;
use crate::files;

/// Hands that are learnt from, and as many that are tested on.
const SAMPLES: u64 = 6000;
const SEED: u64 = 6;
/// How far bones and radii differ from the mean hand's.
const SPREAD: f64 = 0.15;
/// Side of the pictures, px, and how far fingertips stay from their border.
const SIDE: u32 = 130;
const MARGIN: f64 = 4.0;

#[derive(Args)]
pub struct Arguments {
    /// Where the model goes; the file that the crate ships by default.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let hand = files::hand(None)?;
    let mut trainer = WristTrainer::default();
    let mut learnt = 0;
    for number in 0..SAMPLES {
        if let Some(sample) = sample(&hand, number)? {
            learnt += usize::from(trainer.add(&sample.mask, sample.wrist().to_array())?);
        }
    }
    let model = trainer.finish()?;
    let shipped = files::in_repository("crates/segmentation/models/wrist.txt");
    let out = arguments.out.clone().unwrap_or(shipped);
    files::write_whole(&out, &model.to_bytes())?;
    files::print(&format!("{}: {learnt} wrists\n{}", out.display(), test(&hand, &model)?))
}

/// How far off the wrists and directions are that the model finds on other hands.
fn test(hand: &HandShape, model: &WristModel) -> Result<String> {
    let mut finder = HandDetector::default();
    let (mut offs, mut angles, mut strange) = (Vec::new(), Vec::new(), Vec::new());
    for number in SAMPLES..2 * SAMPLES {
        let Some(sample) = sample(hand, number)? else { continue };
        let found = finder.find(&sample.mask, &Cleanup::default(), model)?[0];
        let off = sample.wrist().distance(DVec2::from_array(found.wrist));
        offs.push(off / sample.length());
        let direction = DVec2::from_array(found.direction);
        angles.push(sample.direction.angle_to(direction).abs().to_degrees());
        strange.push(found.mahalanobis2);
    }
    let line = |what: &str, values: &mut Vec<f64>| {
        values.sort_by(f64::total_cmp);
        let at = |share: f64| values[(share * (values.len() - 1) as f64) as usize];
        format!("{what}: median {:.3}, 90 % {:.3}, 99 % {:.3}\n", at(0.5), at(0.9), at(0.99))
    };
    Ok(format!("{} others\n", offs.len())
        + &line("wrist off by this share of the hand's length", &mut offs)
        + &line("direction off by degrees", &mut angles)
        + &line("strangeness", &mut strange))
}

/// A hand of its own in a pose of its own, seen from anywhere but nearly along its arm, its arm cut
/// anywhere; nothing where its fingertips are not in the picture.
fn sample(hand: &HandShape, number: u64) -> Result<Option<DrawnHand>> {
    let mut random = ItemRng::new(SEED, number);
    let hand = hand.scaled(|| random.between(1.0 - SPREAD, 1.0 + SPREAD));
    let mut pose = sample_pose(|| random.uniform());
    pose[Dof::WristFlexion] = random.between(-30.0, 30.0).to_radians();
    pose[Dof::WristDeviation] = random.between(-15.0, 10.0).to_radians();
    let roll = DQuat::from_rotation_z(random.between(0.0, std::f64::consts::TAU));
    let tilt = DQuat::from_rotation_x(random.between(-50.0, 50.0).to_radians());
    let rest = DAffine3::from_quat(tilt * roll);
    let away = random.between(400.0, 1500.0);
    let focal = random.between(35.0, 100.0) * away / 185.0;
    let aim = DVec3::new(random.between(-40.0, 40.0), 0.0, random.between(-60.0, 100.0));
    let turned = random.between(0.0, std::f64::consts::TAU);
    let up = DVec3::new(turned.cos(), 0.0, turned.sin());
    let inside = Intrinsics::pinhole(SIDE, SIDE, focal);
    let camera = Camera::look_at("c", inside, aim + DVec3::Y * away, aim, up)?;
    let within = |p: &DVec2| {
        (p - DVec2::splat(f64::from(SIDE) / 2.0)).abs().max_element()
            < f64::from(SIDE) / 2.0 - MARGIN
    };
    let drawn = DrawnHand::of(&hand, &pose, &rest, &camera)?;
    Ok(drawn.filter(|drawn| drawn.points.iter().all(within)))
}
