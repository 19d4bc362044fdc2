//! Outcomes beside the reference.

use anyhow::{Context, Result};
use glam::{DVec2, DVec3};
use image::DynamicImage;
use phalanx_hand::JOINTS;
use phalanx_segmentation::{AdaptedSkin, Mask, SkinModel};
use rayon::prelude::*;

use super::angles;
use super::constant::{ConstantAngles, ConstantPoints};
use super::frame::FrameName;
use super::method::{Found, Outcome, Sequence};
use super::overlap;
use super::reference::{Points, Reference};
use super::row::{Coverage, Iou, Milliseconds, Reprojection, Row, Spread, States};
use super::statistics::{mean, percentile};
use super::take::TakeCamera;

/// Overlap that is asked of every view of a frame.
const GOOD_OVERLAP: f64 = 0.88;

/// Central intervals of the normal distribution, in standard deviations: 50, 68 and 95 %.
const INTERVALS: [f64; 3] = [0.674_490, 0.994_458, 1.959_964];

/// Standard deviation of a reference's joints along each axis, mm: those of the three-camera take were fitted
/// to a detector's landmarks, and are good to some 4 mm in space.
const REFERENCE_MM: f64 = 2.3;

/// The middle finger's knuckle: half of a hand's length from the wrist.
const KNUCKLE: usize = 9;

/// What a take's outcomes are compared with.
pub struct Scorer<'a> {
    reference: &'a Reference,
    joints: ConstantPoints<DVec3>,
    angles: ConstantAngles,
    landmarks: Vec<ConstantPoints<DVec2>>,
    skin: SkinModel,
}

/// One frame's errors; lists are empty where there is no reference.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FrameScore {
    /// Distance of each joint, mm.
    pub joints_mm: Vec<f64>,
    /// Error of each angle between bones, degrees.
    pub angles_deg: Vec<f64>,
    /// The best constant's.
    pub constant_angles_deg: Vec<f64>,
    /// For each finger state whether it is right.
    pub states: Vec<bool>,
    /// Intersection over union, for each view with a mask.
    pub overlaps: Vec<f64>,
    /// Of each joint, view after view, as a share of the hand's length.
    pub reprojection: Vec<Vec<f64>>,
    /// Error of each joint's coordinate over its standard deviation, the reference's own added.
    pub errors_over_deviation: Vec<f64>,
    /// Distance that each joint's deviation promises, mm.
    pub promised_mm: Vec<f64>,
}

impl<'a> Scorer<'a> {
    /// The best constants are those of all frames that the reference has.
    pub fn new(reference: &'a Reference) -> Self {
        Self {
            reference,
            joints: ConstantPoints::of(&reference.joints),
            angles: ConstantAngles::of(&reference.angles),
            landmarks: reference.landmarks.iter().map(ConstantPoints::of).collect(),
            skin: SkinModel::builtin(),
        }
    }

    /// The errors of every frame.
    ///
    /// # Errors
    /// Pictures that cannot be read.
    pub fn frames(&self, sequence: &Sequence<'_>, outcomes: &[Outcome]) -> Result<Vec<FrameScore>> {
        let pairs = sequence.frames.par_iter().zip(outcomes);
        pairs
            .map(|(frame, outcome)| self.frame(sequence, frame, outcome.found.as_ref().ok()))
            .collect()
    }

    fn frame(
        &self,
        sequence: &Sequence<'_>,
        frame: &FrameName,
        found: Option<&Found>,
    ) -> Result<FrameScore> {
        let mut score = FrameScore::default();
        self.score_joints(frame, found, &mut score);
        self.score_angles(frame, found, &mut score);
        for &view in sequence.views {
            let camera = &sequence.take.cameras[view];
            score.reprojection.push(self.reprojection(view, camera, frame, found));
            if found.is_some_and(|found| found.solids.is_empty()) {
                continue;
            }
            if let Some(mask) = self.mask(camera, frame)? {
                score.overlaps.push(found.map_or(0.0, |found| {
                    // A hand that reaches behind the camera is not where the mask is.
                    overlap::draw(&camera.camera, found)
                        .map_or(0.0, |drawn| overlap::overlap(&camera.camera, found, &drawn, &mask))
                }));
            }
        }
        Ok(score)
    }

    fn score_joints(&self, frame: &FrameName, found: Option<&Found>, score: &mut FrameScore) {
        let truth = self.reference.joints.get(frame);
        if let Some(truth) = truth {
            let errors = match found {
                None => self.joints.errors(truth, DVec3::length),
                Some(found) => {
                    std::array::from_fn(|joint| Some(found.joints[joint].distance(truth[joint]?)))
                }
            };
            score.joints_mm = errors.into_iter().flatten().collect();
        }
        let Some((found, deviations)) = found.and_then(|found| Some((found, found.deviations?)))
        else {
            return;
        };
        score.promised_mm = deviations.map(DVec3::length).to_vec();
        for joint in 0..JOINTS {
            let Some(truth) = truth.and_then(|truth| truth[joint]) else { continue };
            let expected = deviations[joint].map(|deviation| deviation.hypot(REFERENCE_MM));
            let errors = (found.joints[joint] - truth).abs() / expected;
            score.errors_over_deviation.extend(errors.to_array());
        }
    }

    fn score_angles(&self, frame: &FrameName, found: Option<&Found>, score: &mut FrameScore) {
        let ours = found.map(|found| angles::of_joints(&found.joints));
        if let Some(truth) = self.reference.angles.get(frame) {
            let constant = self.angles.errors(truth);
            score.constant_angles_deg = constant.into_iter().flatten().collect();
            score.angles_deg = match ours {
                None => score.constant_angles_deg.clone(),
                Some(ours) => {
                    let pairs = ours.iter().zip(truth);
                    pairs.filter_map(|(ours, truth)| Some((ours - (*truth)?).abs())).collect()
                }
            };
        }
        if let Some(states) = self.reference.states.get(frame) {
            let ours = ours.as_ref().map(angles::states);
            let right = |(finger, state): (usize, &Option<_>)| {
                let state = (*state)?;
                Some(ours.is_some_and(|ours| ours[finger] == state))
            };
            score.states = states.iter().enumerate().filter_map(right).collect();
        }
    }

    fn reprojection(
        &self,
        view: usize,
        camera: &TakeCamera,
        frame: &FrameName,
        found: Option<&Found>,
    ) -> Vec<f64> {
        let known = self.reference.landmarks.get(view).and_then(|frames| frames.get(frame));
        let Some((truth, length)) = known.and_then(|truth| Some((truth, hand_length(truth)?)))
        else {
            return Vec::new();
        };
        let errors = match found {
            None => self.landmarks[view].errors(truth, DVec2::length),
            Some(found) => std::array::from_fn(|joint| {
                let landmark = truth[joint]?;
                let drawn = camera.camera.project(found.joints[joint]);
                Some(drawn.map_or(f64::INFINITY, |drawn| drawn.distance(landmark)))
            }),
        };
        errors.into_iter().flatten().map(|error| error / length).collect()
    }

    /// The take's mask of a frame or, where it has none, skin in its photograph.
    fn mask(&self, camera: &TakeCamera, frame: &FrameName) -> Result<Option<Mask>> {
        if let Some(mask) = camera.mask(frame)? {
            return Ok(Some(mask.to_luma8().into()));
        }
        let photograph = camera.photograph(frame)?.as_ref().map(DynamicImage::to_rgb8);
        Ok(photograph
            .map(|photograph| AdaptedSkin::new(&self.skin, &photograph).segment(&photograph)))
    }

    /// The errors of the best constant for the joints of all frames, mm.
    pub fn constant_joints_mm(&self) -> Option<f64> {
        let frames = self.reference.joints.values();
        let errors = frames.flat_map(|truth| self.joints.errors(truth, DVec3::length));
        mean(&errors.flatten().collect::<Vec<_>>())
    }
}

/// The hand's length in a picture by its landmarks, px.
fn hand_length(landmarks: &Points<DVec2>) -> Option<f64> {
    let length = 2.0 * landmarks[0]?.distance(landmarks[KNUCKLE]?);
    (length > 0.0).then_some(length)
}

/// What a run's frames come to.
///
/// # Errors
/// As many outcomes as there are frames are expected.
pub fn row(
    sequence: &Sequence<'_>,
    method: &'static str,
    outcomes: &[Outcome],
    scores: &[FrameScore],
) -> Result<Row> {
    let frames = sequence.frames.len();
    let is_whole = outcomes.len() == frames && scores.len() == frames;
    is_whole.then_some(()).with_context(|| format!("{method} did not answer for every frame"))?;
    let found = || outcomes.iter().filter_map(|outcome| outcome.found.as_ref().ok());
    let refused = frames - found().count();
    let all = |of: fn(&FrameScore) -> &[f64]| -> Vec<f64> {
        scores.iter().flat_map(|score| of(score).iter().copied()).collect()
    };
    let states: Vec<bool> = scores.iter().flat_map(|score| score.states.clone()).collect();
    let reprojection: Vec<f64> =
        scores.iter().flat_map(|score| score.reprojection.iter().flatten().copied()).collect();
    let times: Vec<f64> = outcomes.iter().filter_map(|outcome| outcome.cpu_ms).collect();
    let cameras = sequence.cameras().into_iter().map(|camera| camera.name).collect();
    Ok(Row {
        take: sequence.take.name.clone(),
        cameras,
        input: sequence.input.name(),
        method,
        frames,
        refused,
        doubted: found().filter(|found| !found.doubts.is_empty()).count(),
        joints_mm: spread(&all(|score| &score.joints_mm)),
        states: (!states.is_empty()).then(|| States {
            right: states.iter().filter(|right| **right).count(),
            of: states.len(),
        }),
        bone_angles_deg: mean(&all(|score| &score.angles_deg)),
        best_constant_deg: mean(&all(|score| &score.constant_angles_deg)),
        // Of a method that draws nothing, nothing can be said.
        iou: iou(scores).filter(|_| refused == frames || found().any(|own| !own.solids.is_empty())),
        reprojection: percentile(&reprojection, 50)
            .zip(percentile(&reprojection, 90))
            .map(|(median, p90)| Reprojection { median, p90 }),
        coverage: coverage(&all(|score| &score.errors_over_deviation)),
        std_mm: mean(&all(|score| &score.promised_mm)),
        ms: percentile(&times, 50)
            .zip(percentile(&times, 95))
            .map(|(median, p95)| Milliseconds { median, p95 }),
    })
}

fn spread(errors: &[f64]) -> Option<Spread> {
    Some(Spread {
        mean: mean(errors)?,
        median: percentile(errors, 50)?,
        p95: percentile(errors, 95)?,
    })
}

fn iou(scores: &[FrameScore]) -> Option<Iou> {
    let seen: Vec<&[f64]> =
        scores.iter().map(|score| &*score.overlaps).filter(|views| !views.is_empty()).collect();
    let reached =
        seen.iter().filter(|views| views.iter().all(|&overlap| overlap >= GOOD_OVERLAP)).count();
    Some(Iou { mean: mean(&seen.concat())?, least_above_088: reached as f64 / seen.len() as f64 })
}

fn coverage(errors_over_deviation: &[f64]) -> Option<Coverage> {
    let within = |interval: f64| {
        let inside = errors_over_deviation.iter().filter(|error| **error <= interval).count();
        inside as f64 / errors_over_deviation.len() as f64
    };
    let [half, one_sigma, two_sigma] = INTERVALS.map(within);
    (!errors_over_deviation.is_empty()).then_some(Coverage { half, one_sigma, two_sigma })
}
