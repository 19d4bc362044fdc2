//! Takes fitted without a trained model: `take`, the whole take at once, and `frame`, each frame alone with
//! the hand that the take told.

use std::sync::OnceLock;

use anyhow::{Result, anyhow};
use glam::{DAffine3, DVec3};
use image::{DynamicImage, RgbImage};
use phalanx::{FrameFit, Progress, TakeFit, TakeFrame, TakeSettings, fit_frame, fit_take};
use phalanx_camera::Camera;
use phalanx_hand::HandShape;
use phalanx_sampling::spread_subset;
use phalanx_segmentation::{Mask, SceneModel, Segment, SkinModel};

use super::method::{Found, Method, Outcome, Sequence, each_frame};
use super::take::Input;
use crate::clock::timed;

/// The seed by which the frames are drawn whose photographs tell what stands still.
const SUBSET_SEED: u64 = 0;

/// The fits of a take through some cameras, each made when it is first asked for.
pub struct Fits {
    /// What tells the hand in each camera's photographs.
    segmenters: OnceLock<Vec<Box<dyn Segment>>>,
    /// One for each input.
    fits: [OnceLock<Fitted>; Input::ALL.len()],
}

/// A fit, or why there is none, and the CPU time of a frame, ms.
struct Fitted {
    take: Result<TakeFit, phalanx::Error>,
    frame_ms: f64,
}

impl Fits {
    /// Nothing is fitted yet.
    pub fn new() -> Self {
        Self { segmenters: OnceLock::new(), fits: [const { OnceLock::new() }; Input::ALL.len()] }
    }

    fn of(&self, sequence: &Sequence<'_>, progress: &dyn Progress) -> Result<&Fitted> {
        let cell = &self.fits[sequence.input as usize];
        if let Some(fitted) = cell.get() {
            return Ok(fitted);
        }
        let frames: Vec<TakeFrame> = (0..sequence.frames.len())
            .map(|number| self.frame_of(sequence, number))
            .collect::<Result<_>>()?;
        let hand = HandShape { side: sequence.take.side, ..HandShape::adult() };
        let settings = TakeSettings { hand, ..TakeSettings::default() };
        let (seconds, take) =
            timed(|| anyhow::Ok(fit_take(&sequence.cameras(), &frames, &settings, progress)))?;
        let frame_ms = 1e3 * seconds / frames.len() as f64;
        Ok(cell.get_or_init(|| Fitted { take, frame_ms }))
    }

    /// The take's fit, or why there is none.
    pub fn take(
        &self,
        sequence: &Sequence<'_>,
        progress: &dyn Progress,
    ) -> Result<&Result<TakeFit, phalanx::Error>> {
        Ok(&self.of(sequence, progress)?.take)
    }

    /// What the cameras saw in the frame of a number; nothing of a camera that is lost then.
    pub fn frame_of(&self, sequence: &Sequence<'_>, number: usize) -> Result<TakeFrame> {
        let mut frame = self.frame(sequence, number, &sequence.pictures(number)?)?;
        for (view, mask) in frame.masks.iter_mut().enumerate() {
            *mask = mask.take().filter(|_| !sequence.is_lost(view, number));
        }
        Ok(frame)
    }

    /// What the cameras saw in the frame of a number, of which these are the pictures.
    fn frame(
        &self,
        sequence: &Sequence<'_>,
        number: usize,
        pictures: &[DynamicImage],
    ) -> Result<TakeFrame> {
        let mask = |(view, picture): (usize, &DynamicImage)| -> Result<Option<Mask>> {
            Ok(Some(match sequence.input {
                Input::Masks | Input::MasksAndLandmarks => picture.to_luma8().into(),
                Input::Photographs | Input::Landmarks => {
                    self.segmenters(sequence)?[view].segment(&picture.to_rgb8())?
                }
            }))
        };
        let mut masks: Vec<Option<Mask>> =
            pictures.iter().enumerate().map(mask).collect::<Result<_>>()?;
        masks.resize(sequence.views.len(), None);
        let seconds = Some(sequence.seconds(number));
        Ok(TakeFrame { masks, landmarks: sequence.landmarks_of(number), seconds })
    }

    /// What tells the hand in the photographs of each camera that is used.
    fn segmenters(&self, sequence: &Sequence<'_>) -> Result<&[Box<dyn Segment>]> {
        if let Some(segmenters) = self.segmenters.get() {
            return Ok(segmenters);
        }
        let some = spread_subset(sequence.frames.len(), SceneModel::PICTURES, SUBSET_SEED);
        let mut of_views = vec![Vec::new(); sequence.views.len()];
        for number in some {
            for (own, picture) in of_views.iter_mut().zip(sequence.pictures(number)?) {
                own.push(picture.to_rgb8());
            }
        }
        let segmenter = |photographs: Vec<RgbImage>| -> Result<Box<dyn Segment>> {
            let skin = SkinModel::builtin();
            Ok(match SceneModel::learn(&photographs, &skin)? {
                Some(scene) => Box::new(scene),
                None => Box::new(skin),
            })
        };
        let segmenters = of_views.into_iter().map(segmenter).collect::<Result<_>>()?;
        Ok(self.segmenters.get_or_init(|| segmenters))
    }
}

impl Default for Fits {
    fn default() -> Self {
        Self::new()
    }
}

/// A fitted frame of a hand whose poses are said about `rest`.
pub fn found(cameras: &[Camera], hand: &HandShape, rest: &DAffine3, fit: &FrameFit) -> Found {
    let missing = cameras.iter().zip(&fit.views).filter(|(_, view)| view.missing.is_some());
    // A joint's deviation is in all directions together.
    let along_each = |std: f64| DVec3::splat(std / 3.0_f64.sqrt());
    Found {
        joints: fit.joints,
        deviations: Some(fit.joint_std.map(along_each)),
        doubts: fit.doubts.iter().map(|doubt| format!("{doubt:?}")).collect(),
        left_out: missing.map(|(camera, _)| camera.name.clone()).collect(),
        ..Found::posed(hand, &fit.pose, rest)
    }
}

fn of_take(cameras: &[Camera], take: &TakeFit, fit: &FrameFit) -> Found {
    found(cameras, &take.hand, &take.volume.volume.rest_frame(), fit)
}

/// `phalanx::fit_take`.
pub struct WholeTake<'a>(pub &'a Fits);

impl Method for WholeTake<'_> {
    fn name(&self) -> &'static str {
        "take"
    }

    fn run(&self, sequence: &Sequence<'_>, progress: &dyn Progress) -> Result<Vec<Outcome>> {
        let Fitted { take, frame_ms } = self.0.of(sequence, progress)?;
        if take.as_ref().is_ok_and(|take| !take.tells_side()) {
            eprintln!("{}: it hardly tells a right hand from a left one", sequence.take.name);
        }
        let cameras = sequence.cameras();
        let outcome = |number: usize| Outcome {
            found: match take {
                Ok(take) => Ok(of_take(&cameras, take, &take.frames[number])),
                Err(error) => Err(anyhow!("{error}")),
            },
            cpu_ms: Some(*frame_ms),
        };
        Ok((0..sequence.frames.len()).map(outcome).collect())
    }
}

/// `phalanx::fit_frame` with the hand of the take.
pub struct FramesAlone<'a>(pub &'a Fits);

impl Method for FramesAlone<'_> {
    fn name(&self) -> &'static str {
        "frame"
    }

    fn run(&self, sequence: &Sequence<'_>, progress: &dyn Progress) -> Result<Vec<Outcome>> {
        let Fitted { take, .. } = self.0.of(sequence, progress)?;
        let cameras = sequence.cameras();
        each_frame(
            sequence,
            progress,
            || (),
            |(), number, pictures| {
                let take = take.as_ref().map_err(|error| anyhow!("{error}"))?;
                let fit = fit_frame(&cameras, &self.0.frame(sequence, number, pictures)?, take)?;
                Ok(of_take(&cameras, take, &fit))
            },
        )
    }
}
