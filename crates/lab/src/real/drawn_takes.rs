//! `cargo xtask draw-takes`: takes of strangers' hands before other rigs, laid out as real ones are, so that what was
//! found out with a few real takes is tried on more.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};
use clap::Args;
use glam::{DAffine3, DVec3};
use phalanx::{ItemRng, Mask, MaskNoise};
use phalanx_camera::{Camera, Intrinsics, Volume};
use phalanx_hand::{Dof, HandShape, Pose, Primitive, Side, sample_pose};
use phalanx_render::Renderer;
use rayon::prelude::*;
use serde_json::json;

use super::company::{Company, other_hand, rod};
use crate::files;

#[derive(Args)]
pub struct Arguments {
    /// The folder that takes are written to; it must be new or empty.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Frames of each take.
    #[arg(long, value_name = "N", default_value_t = 48)]
    frames: usize,
    /// Other hands, poses and cameras.
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
}

/// What a take is like.
struct Kind {
    name: &'static str,
    cameras: usize,
    picture: (u32, u32),
    /// The hand's length over the mean adult's.
    size: f64,
    side: Side,
    motion: Motion,
    company: Company,
    /// How wide a picture is where the hand works, mm.
    shown: f64,
}

/// How poses follow each other.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Motion {
    /// From one posture to the next, in so many frames.
    Smooth(usize),
    /// Each frame another posture.
    Stills,
    /// Smooth; the hand comes into the pictures along its arm in the first quarter of the frames, and leaves them so in the
    /// last.
    Passing(usize),
}

const KINDS: [Kind; 11] = [
    kind("one", 1, (640, 480)),
    kind("two", 2, (640, 480)),
    Kind { size: 0.92, ..kind("three", 3, (480, 360)) },
    Kind { size: 1.1, side: Side::Left, ..kind("four", 4, (1280, 720)) },
    Kind { size: 0.76, ..kind("child", 3, (640, 480)) },
    Kind { size: 0.85, ..kind("youth", 2, (640, 480)) },
    Kind { motion: Motion::Stills, ..kind("sixteen", 16, (320, 240)) },
    Kind { motion: Motion::Passing(10), ..kind("passing", 3, (480, 360)) },
    Kind { company: Company::OtherHand, ..kind("both-hands", 3, (480, 360)) },
    Kind { company: Company::Rod, ..kind("rod", 3, (480, 360)) },
    Kind { shown: 2.2 * SHOWN, ..kind("sleeve", 2, (640, 480)) },
];

const fn kind(name: &'static str, cameras: usize, picture: (u32, u32)) -> Kind {
    let (side, motion, company) = (Side::Right, Motion::Smooth(10), Company::None);
    Kind { name, cameras, picture, size: 1.0, side, motion, company, shown: SHOWN }
}

/// How far behind where it works a hand is that comes or leaves, mm: no picture shows it.
const AWAY: f64 = 500.0;

/// How far bones and radii differ from the mean adult's, beside the size.
const SPREAD: f64 = 0.1;

/// How far off the cameras stand, mm, and how wide most pictures are there: arms leave them.
const DISTANCE: f64 = 600.0;
const SHOWN: f64 = 420.0;

/// How far a wrist moves from the middle, mm, and the hand turns about the forearm and about the others, degrees.
const MOVES: f64 = 35.0;
const TURNS: [f64; 3] = [25.0, 25.0, 60.0];

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let folder = &arguments.out;
    std::fs::create_dir_all(folder)?;
    let is_empty = std::fs::read_dir(folder)?.next().is_none();
    ensure!(is_empty, "{}: the folder is not empty; name another with --out", folder.display());
    for (number, kind) in KINDS.iter().enumerate() {
        let mut random = ItemRng::new(arguments.seed, number as u64);
        let take = kind.draw(arguments.frames, &mut random)?;
        take.write(&folder.join(kind.name))?;
        println!(
            "{}: {} cameras, a hand of {:.0} mm",
            kind.name,
            kind.cameras,
            take.hand.length_mm()
        );
    }
    Ok(())
}

/// A take to be drawn.
struct DrawnTake {
    cameras: Vec<Camera>,
    hand: HandShape,
    rest: DAffine3,
    poses: Vec<Pose>,
    company: Company,
    /// Those of the other hand, if there is one.
    other_poses: Vec<Pose>,
    /// The seed of the masks' ragged borders.
    ragged: u64,
}

impl Kind {
    fn draw(&self, frames: usize, random: &mut ItemRng) -> Result<DrawnTake> {
        let mut hand =
            HandShape::adult().scaled(|| self.size * random.between(1.0 - SPREAD, 1.0 + SPREAD));
        hand.side = self.side;
        let arm = random.direction();
        let up = arm.any_orthonormal_vector();
        let volume =
            Volume { center: DVec3::ZERO, size: DVec3::splat(2.0 * MOVES), forearm: arm, up };
        let rest = volume.rest_frame();
        let cameras = (0..self.cameras).map(|k| self.camera(k, &rest, random));
        let cameras = cameras.collect::<Result<_>>()?;
        let (poses, ragged) = (self.poses(frames, random), random.seed());
        let company = self.company;
        let other_poses = match company {
            Company::OtherHand => self.poses(frames, random),
            Company::None | Company::Rod => Vec::new(),
        };
        Ok(DrawnTake { cameras, hand, rest, poses, company, other_poses, ragged })
    }

    /// Cameras stand about the arm's side, evenly and a bit at random, turned about themselves as they happen to be.
    fn camera(&self, k: usize, rest: &DAffine3, random: &mut ItemRng) -> Result<Camera> {
        // Few cameras stand within a half circle above the hand; from there they see different sides of it.
        let spread = if self.cameras > 4 { std::f64::consts::TAU } else { 2.4 };
        let at = spread * ((k as f64 + random.between(0.3, 0.7)) / self.cameras as f64 - 0.5);
        let (sin, cos) = at.sin_cos();
        let aside = DVec3::new(sin, cos, random.between(-0.4, 0.4)).normalize();
        let (width, height) = self.picture;
        let focal = f64::from(width) * DISTANCE / self.shown;
        let middle = rest.transform_point3(80.0 * DVec3::Z);
        let position = middle + DISTANCE * rest.transform_vector3(aside);
        let inside = Intrinsics::pinhole(width, height, focal);
        Ok(Camera::look_at(format!("cam{k}"), inside, position, middle, random.direction())?)
    }

    fn poses(&self, frames: usize, random: &mut ItemRng) -> Vec<Pose> {
        let apart = match self.motion {
            Motion::Smooth(frames) | Motion::Passing(frames) => frames,
            Motion::Stills => 1,
        };
        let keys: Vec<Pose> = (0..=frames.div_ceil(apart)).map(|_| posed(random)).collect();
        let pose = |frame: usize| {
            let (key, share) = (frame / apart, (frame % apart) as f64 / apart as f64);
            // Without a jump of speed at the key poses.
            let share = share * share * (3.0 - 2.0 * share);
            let mut pose = keys[key];
            for dof in Dof::ALL {
                pose[dof] += share * (keys[key + 1][dof] - keys[key][dof]);
            }
            if matches!(self.motion, Motion::Passing(_)) {
                pose[Dof::TZ] -= AWAY * away(frame, frames);
            }
            pose
        };
        (0..frames).map(pose).collect()
    }
}

/// How much of its way a hand that passes has still to come, or has gone already: all of it in the first frame and in the
/// last, nothing in the middle half.
fn away(frame: usize, frames: usize) -> f64 {
    let quarter = frames as f64 / 4.0;
    let from_end = frame.min(frames - 1 - frame) as f64;
    (1.0 - from_end / quarter).max(0.0)
}

/// A posture of the prior, somewhere in the volume.
fn posed(random: &mut ItemRng) -> Pose {
    let mut pose = sample_pose(|| random.uniform());
    for (dof, turn) in [Dof::ThetaX, Dof::ThetaY, Dof::ThetaZ].into_iter().zip(TURNS) {
        pose[dof] = random.between(-turn, turn).to_radians();
    }
    for dof in [Dof::TX, Dof::TY, Dof::TZ] {
        pose[dof] = random.between(-MOVES, MOVES);
    }
    pose
}

impl DrawnTake {
    fn write(&self, folder: &Path) -> Result<()> {
        let said = json!({ "unit_mm": 1, "side": match self.hand.side {
            Side::Left => "left",
            Side::Right => "right",
        } });
        files::write_whole(&folder.join("take.json"), said.to_string().as_bytes())?;
        let cameras: Vec<_> = self.cameras.iter().map(calibration).collect();
        let cameras = json!({ "cameras": cameras }).to_string();
        files::write_whole(&folder.join("calibration.json"), cameras.as_bytes())?;
        files::write_whole(&folder.join("reference-joints.csv"), self.joints().as_bytes())?;
        let mask = |number: usize| -> Result<()> {
            let (frame, camera) = (number / self.cameras.len(), number % self.cameras.len());
            let camera = &self.cameras[camera];
            let solids = self.solids(frame);
            let mut mask = Mask::from(Renderer::new(camera)?.silhouette(&solids)?);
            MaskNoise::Boundary.apply(&mut mask, self.ragged.wrapping_add(number as u64));
            let path = folder.join("masks").join(&camera.name).join(format!("{frame:04}.png"));
            write_mask(&path, &mask)
        };
        (0..self.poses.len() * self.cameras.len()).into_par_iter().try_for_each(mask)
    }

    /// What there is to see in a frame.
    fn solids(&self, frame: usize) -> Vec<Primitive> {
        let posed = self.hand.pose(&self.poses[frame], &self.rest);
        let mut solids = posed.primitives.clone();
        match self.company {
            Company::None => {}
            Company::OtherHand => {
                solids.extend(other_hand(&self.hand, &self.other_poses[frame], &self.rest));
            }
            Company::Rod => {
                let back = self.rest.matrix3 * self.poses[frame].rotation() * DVec3::Y;
                solids.push(rod(&posed, back));
            }
        }
        solids
    }

    /// Whether some camera's picture shows the whole hand.
    fn is_seen(&self, frame: usize) -> bool {
        let joints = self.hand.pose(&self.poses[frame], &self.rest).joints;
        let sees = |camera: &Camera, at: DVec3| {
            camera.project(at).is_some_and(|pixel| camera.intrinsics.contains(pixel))
        };
        self.cameras.iter().any(|camera| joints.iter().all(|&at| sees(camera, at)))
    }

    /// Where the joints are in the frames that show the hand.
    fn joints(&self) -> String {
        let mut text = "frame,joint,x_mm,y_mm,z_mm\n".to_owned();
        let seen = self.poses.iter().enumerate().filter(|(frame, _)| self.is_seen(*frame));
        for (frame, pose) in seen {
            for (joint, at) in self.hand.pose(pose, &self.rest).joints.iter().enumerate() {
                let DVec3 { x, y, z } = at;
                writeln!(text, "{frame},{joint},{x:.2},{y:.2},{z:.2}").expect("a string takes all");
            }
        }
        text
    }
}

fn write_mask(path: &Path, mask: &Mask) -> Result<()> {
    let mut png = std::io::Cursor::new(Vec::new());
    mask.write_to(&mut png, image::ImageFormat::Png)?;
    files::write_whole(path, &png.into_inner())
}

/// A camera by OpenCV's conventions.
fn calibration(camera: &Camera) -> serde_json::Value {
    let Intrinsics { fx, fy, cx, cy, width, height, .. } = camera.intrinsics;
    let rows: Vec<[f64; 3]> =
        (0..3).map(|k| camera.extrinsics.rotation.row(k).to_array()).collect();
    json!({
        "name": camera.name, "width": width, "height": height,
        // The middle of the first pixel is (0, 0) there.
        "camera_matrix": [[fx, 0.0, cx - 0.5], [0.0, fy, cy - 0.5], [0.0, 0.0, 1.0]],
        "distortion_coefficients": [0, 0, 0, 0, 0],
        "rotation": rows,
        "translation": camera.extrinsics.translation.to_array(),
    })
}
