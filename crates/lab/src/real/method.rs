//! What every method is given, and what it answers.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use anyhow::{Context, Result};
use glam::{DAffine3, DVec2, DVec3};
use image::DynamicImage;
use phalanx::Progress;
use phalanx_camera::Camera;
use phalanx_hand::{HandShape, JOINTS, Landmark, Pose, Primitive};

use super::frame::FrameName;
use super::lose::Lose;
use super::reference::Points;
use super::spoil::Spoil;
use super::take::{Input, Take};
use crate::clock::thread_ms;

/// A camera's landmarks, frame by frame, px.
pub type Landmarks = BTreeMap<FrameName, Points<DVec2>>;

/// The rate that frames' numbers count at, Hz: webcams'.
const RATE: f64 = 30.0;

/// What a method looks at: frames of a take through some of its cameras. References are not in it.
pub struct Sequence<'a> {
    /// The take.
    pub take: &'a Take,
    /// The numbers of the cameras that are used.
    pub views: &'a [usize],
    /// What is looked at.
    pub input: Input,
    /// The frames, in order.
    pub frames: &'a [FrameName],
    /// Which masks are spoilt, and the landmarks that it takes to do so, camera by camera.
    pub spoil: Option<(&'a Spoil, &'a [Landmarks])>,
    /// Which camera is lost in some frames.
    pub lose: Option<&'a Lose>,
    /// The landmarks that may be looked at, camera by camera of the take.
    pub landmarks: &'a [Landmarks],
}

impl Sequence<'_> {
    /// The cameras that are used.
    pub fn cameras(&self) -> Vec<Camera> {
        self.take.cameras(self.views)
    }

    /// When the frame of a number was taken, s: frames that have numbers are counted by them.
    pub fn seconds(&self, number: usize) -> f64 {
        match &self.frames[number] {
            FrameName::Number(number) => *number as f64 / RATE,
            FrameName::Text(_) => number as f64 / RATE,
        }
    }

    /// Whether the view of a number among those used is lost in the frame of a number.
    pub fn is_lost(&self, view: usize, number: usize) -> bool {
        let camera = &self.take.cameras[self.views[view]].camera.name;
        self.lose.is_some_and(|lose| lose.concerns(camera, number, self.frames.len()))
    }

    /// The landmarks of the frame of a number, one for each camera; none of an input without any.
    pub fn landmarks_of(&self, number: usize) -> Vec<Option<phalanx_hand::Landmarks>> {
        if !self.input.has_landmarks() {
            return Vec::new();
        }
        let of_view = |(view, &camera): (usize, &usize)| {
            let points = self.landmarks[camera].get(&self.frames[number])?;
            let is_seen = !self.is_lost(view, number);
            is_seen.then(|| points.map(|point| point.map(Landmark::sure)))
        };
        self.views.iter().enumerate().map(of_view).collect()
    }

    /// The pictures of the frame of a number, one for each camera; none where landmarks alone are looked at.
    ///
    /// # Errors
    /// A picture that cannot be read; it names the file.
    pub fn pictures(&self, number: usize) -> Result<Vec<DynamicImage>> {
        if self.input == Input::Landmarks {
            return Ok(Vec::new());
        }
        self.views.iter().map(|&view| self.picture(view, number)).collect()
    }

    fn picture(&self, view: usize, number: usize) -> Result<DynamicImage> {
        let camera = &self.take.cameras[view];
        let spoil = self.spoil.filter(|(spoil, _)| {
            self.input != Input::Photographs && spoil.concerns(&camera.camera.name, number)
        });
        let Some((spoil, landmarks)) = spoil else {
            return camera.picture(&self.frames[number], self.input);
        };
        let shown = &self.frames[spoil.taken_from(number, self.frames.len())];
        let mask = camera.picture(shown, self.input)?.to_luma8();
        let spoilt = spoil.apply(&mask, landmarks[view].get(shown));
        Ok(spoilt.with_context(|| format!("{} {shown}", camera.camera.name))?.into())
    }
}

/// A hand that a method found.
#[derive(Debug, Clone)]
pub struct Found {
    /// The 21 joints in the world, mm.
    pub joints: [DVec3; JOINTS],
    /// The hand's solids in the world, mm; none where a method finds joints only.
    pub solids: Vec<Primitive>,
    /// Standard deviations of the joints along the world's axes, mm, if the method says them.
    pub deviations: Option<[DVec3; JOINTS]>,
    /// Why the method doubts it; empty where it does not.
    pub doubts: Vec<String>,
    /// The names of the cameras whose views it did not use.
    pub left_out: Vec<String>,
}

impl Found {
    /// A hand in a pose of which nothing more is known.
    pub fn posed(hand: &HandShape, pose: &Pose, rest: &DAffine3) -> Self {
        let posed = hand.pose(pose, rest);
        Self {
            joints: posed.joints,
            solids: posed.primitives,
            deviations: None,
            doubts: Vec::new(),
            left_out: Vec::new(),
        }
    }
}

/// What came of one frame.
#[derive(Debug)]
pub struct Outcome {
    /// The hand, or why the frame was refused.
    pub found: Result<Found>,
    /// CPU time of one thread, ms; nothing where it would say nothing.
    pub cpu_ms: Option<f64>,
}

/// A way from pictures to poses.
pub trait Method {
    /// Its name in reports.
    fn name(&self) -> &'static str;

    /// What it makes of all frames, in their order. A frame that it refuses is an outcome; an error ends
    /// the run.
    ///
    /// # Errors
    /// Pictures that cannot be read.
    fn run(&self, sequence: &Sequence<'_>, progress: &dyn Progress) -> Result<Vec<Outcome>>;
}

/// Looks at every frame alone, by its number and its pictures, in parallel, and measures the time of each on its
/// one thread. `memory` is made once for each thread.
///
/// # Errors
/// Pictures that cannot be read.
pub fn each_frame<M>(
    sequence: &Sequence<'_>,
    progress: &dyn Progress,
    memory: impl Fn() -> M + Sync,
    look: impl Fn(&mut M, usize, &[DynamicImage]) -> Result<Found> + Sync,
) -> Result<Vec<Outcome>> {
    let frames = sequence.frames;
    let (next, outcomes) = (AtomicUsize::new(0), Mutex::new(Vec::with_capacity(frames.len())));
    let work = || -> Result<()> {
        let mut memory = memory();
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= frames.len() {
                return Ok(());
            }
            let pictures = sequence.pictures(number)?;
            let (ms, found) = thread_ms(|| look(&mut memory, number, &pictures));
            let outcome = Outcome { found, cpu_ms: Some(ms) };
            let mut outcomes = outcomes.lock().unwrap_or_else(PoisonError::into_inner);
            outcomes.push((number, outcome));
            progress.step();
        }
    };
    on_single_threads(&work)?;
    let mut outcomes = outcomes.into_inner().unwrap_or_else(PoisonError::into_inner);
    outcomes.sort_by_key(|(number, _)| *number);
    Ok(outcomes.into_iter().map(|(_, outcome)| outcome).collect())
}

/// Runs the same work on as many threads as the pool has, each in a pool of its own, so that all that one
/// piece of work starts in parallel stays on its thread and is in its time.
fn on_single_threads(work: &(impl Fn() -> Result<()> + Sync)) -> Result<()> {
    let pools = (0..rayon::current_num_threads())
        .map(|_| rayon::ThreadPoolBuilder::new().num_threads(1).build())
        .collect::<Result<Vec<_>, _>>()
        .context("starting worker threads")?;
    std::thread::scope(|scope| {
        let threads: Vec<_> = pools.iter().map(|pool| scope.spawn(|| pool.install(work))).collect();
        threads.into_iter().try_for_each(|thread| match thread.join() {
            Ok(done) => done,
            Err(panic) => std::panic::resume_unwind(panic),
        })
    })
}
