//! The tracker: frames in, poses out.

use std::cmp::Ordering;

use glam::DAffine3;
use phalanx_camera::Camera;
use phalanx_hand::HandShape;
use phalanx_refine::{PoseFitSettings, PosePrior};
use phalanx_segmentation::HandDetector;

use super::delay::Delay;
use super::follow::{self, Followed, follow};
use super::last::Last;
use super::motion::{Motion, Prediction};
use super::noise::MotionNoise;
use super::own_hand::OwnHand;
use super::recent::Recent;
use super::recover::recover;
use super::seen::Seen;
use super::settings::TrackSettings;
use super::state::TrackerState;
use crate::error::{Error, Result};
use crate::fitting::found::Found;
use crate::fitting::frame_fit::FrameFitter;
use crate::fitting::knowledge::ViewKnowledge;
use crate::fitting::known::Known;
use crate::fitting::mistake::{self, Mistake};
use crate::fitting::observation::fitted_hand;
use crate::fitting::proportions::{HandEvidence, KnownHand};
use crate::fitting::report::{FrameFit, Reporter};
use crate::fitting::take::{Proportions, TakeFit};
use crate::fitting::take_frame::TakeFrame;
use crate::fitting::{consensus, misfit, size, starts, views};
use crate::progress::NoProgress;

/// A frame that was tracked.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackedFrame {
    /// When it was taken, seconds.
    pub time: f64,
    /// The pose; `None` as long as no view has shown a hand.
    pub fit: Option<FrameFit>,
}

/// Follows one hand through frames that come one after the other, at any rate.
///
/// The same frames give the same poses, whether they are there already or still to come, at any number of
/// threads.
#[derive(Debug)]
pub struct Tracker {
    cameras: Vec<Camera>,
    postures: PosePrior,
    /// How frames are followed, and how hands are looked for.
    following: PoseFitSettings,
    searching: PoseFitSettings,
    delay: Delay,
    known: Known,
    /// Frames that the hand is going to be learnt from; `None` once it is known.
    own_hand: Option<OwnHand>,
    /// The frame of rest that poses are said in.
    rest: Option<DAffine3>,
    noise: MotionNoise,
    last: Option<Last>,
    /// Whether the last frame is still to be answered.
    owes: bool,
    finder: HandDetector,
    recent: Recent,
}

impl Tracker {
    /// Of one hand before cameras that stand still.
    ///
    /// # Errors
    /// A hand that no one has.
    pub fn new(cameras: &[Camera], settings: &TrackSettings) -> Result<Self> {
        settings.hand.validate()?;
        let known = Known::nothing(&fitted_hand(&settings.hand), cameras.len());
        let own_hand = (settings.proportions == Proportions::FromTake)
            .then(|| OwnHand::new(known.hand.shape.clone()));
        Self::with(cameras, known, own_hand, None, settings.delay)
    }

    /// Of the hand that a take was fitted to, before the same cameras. Poses are said in the take's volume.
    ///
    /// # Errors
    /// None today.
    pub fn of_take(cameras: &[Camera], take: &TakeFit, delay: Delay) -> Result<Self> {
        let rest = take.volume.volume.rest_frame();
        Self::with(cameras, take.known.clone(), None, Some(rest), delay)
    }

    fn with(
        cameras: &[Camera],
        known: Known,
        own_hand: Option<OwnHand>,
        rest: Option<DAffine3>,
        delay: Delay,
    ) -> Result<Self> {
        let unit = known.weights.most();
        Ok(Self {
            cameras: cameras.to_vec(),
            postures: starts::pose_prior()?,
            following: follow::settings(),
            searching: consensus::searching(cameras.len()),
            delay,
            known,
            own_hand,
            rest,
            noise: MotionNoise::new(unit),
            last: None,
            owes: false,
            finder: HandDetector::default(),
            recent: Recent::default(),
        })
    }

    /// One that goes on from a state, before the same cameras. It answers as the tracker that it is the state
    /// of, from the second frame that it is given on if answers come a frame late, else from the first.
    ///
    /// # Errors
    /// None today.
    pub fn resumed(cameras: &[Camera], state: TrackerState) -> Result<Self> {
        let TrackerState { delay, known, rest, noise, recent, last } = state;
        let last = last.map(|(time, motion)| Last::unseen(time, motion));
        Ok(Self { noise, last, recent, ..Self::with(cameras, known, None, rest, delay)? })
    }

    /// What it knows now; `None` as long as the hand is being learnt.
    pub fn state(&self) -> Option<TrackerState> {
        if self.own_hand.is_some() {
            return None;
        }
        Some(TrackerState {
            delay: self.delay,
            known: self.known.clone(),
            rest: self.rest,
            noise: self.noise.clone(),
            recent: self.recent.clone(),
            last: self.last.as_ref().map(|last| (last.time, last.motion.clone())),
        })
    }

    /// The hand as it is known now.
    pub fn hand(&self) -> &HandShape {
        &self.known.hand.shape
    }

    /// The frame of the hand at rest that poses are said in, to the world: of the take, else of the first
    /// hand that was seen; `None` before.
    pub fn world_from_hand(&self) -> Option<DAffine3> {
        self.rest
    }

    /// Takes the next frame, which says its time ([`TakeFrame::at`]), later than that of the one before. Gives the frame
    /// that is due: this one or, a frame late, the one before.
    ///
    /// # Errors
    /// No time or one that is not after the last one, or another number of masks or landmarks than cameras.
    pub fn push(&mut self, frame: &TakeFrame) -> Result<Option<TrackedFrame>> {
        let time = frame.seconds.ok_or(Error::NoFrameTime { frame: None })?;
        if let Some(last) = &self.last
            && time.partial_cmp(&last.time) != Some(Ordering::Greater)
        {
            return Err(Error::FrameTime { time, before: last.time });
        }
        let last = self.last.take();
        let prediction = last.as_ref().and_then(|last| {
            Some(last.motion.as_ref()?.predicted(time - last.time, &self.noise, self.hand()))
        });
        let next = if self.may_tell_size(frame) {
            self.begun(time, frame, &[])?
        } else if let (Some(last), Some(prediction)) = (&last, &prediction) {
            self.followed(time, frame, last, prediction)?
        } else {
            let near = self.rest;
            self.begun(time, frame, near.as_slice())?
        };
        let next = self.sized(frame, next)?;
        let due = match (self.delay, last) {
            (Delay::None, _) => Some(self.report(&next)?),
            (Delay::OneFrame, Some(last)) if self.owes => {
                Some(self.report(&last.in_the_light(prediction.as_ref(), &next, self.hand()))?)
            }
            (Delay::OneFrame, _) => None,
        };
        self.learn_hand(&next)?;
        self.last = Some(next);
        self.owes = self.delay == Delay::OneFrame;
        Ok(due)
    }

    /// The frame that is still due.
    ///
    /// # Errors
    /// A hand that a camera cannot draw.
    pub fn finish(mut self) -> Result<Option<TrackedFrame>> {
        let last = self.last.take().filter(|_| self.owes);
        last.map(|last| self.report(&last)).transpose()
    }

    /// How frames are fitted with what is known of the hand and of the borders.
    fn fitter<'a>(&'a self, refinement: &'a PoseFitSettings) -> FrameFitter<'a> {
        let weights = self.known.weights.relative();
        FrameFitter { hand: self.hand(), prior: &self.postures, refinement, weights }
    }

    /// A frame before which no hand was seen, or only near some places.
    fn begun(&mut self, time: f64, frame: &TakeFrame, near: &[DAffine3]) -> Result<Last> {
        let fitter = self.fitter(&self.searching);
        let found = recover(&fitter, &self.cameras, frame, None, near)?;
        let Some(found) = found else { return Ok(Last::unseen(time, None)) };
        let next = self.started(time, self.agreeing(found)?);
        self.rest = self.rest.or(next.motion.as_ref().map(|motion| motion.rest));
        Ok(next)
    }

    /// Whether a frame may be the first that tells how large the hand is: one camera, which left that open, left open as
    /// well how far away the hand is, so that it is looked for anew.
    fn may_tell_size(&self, frame: &TakeFrame) -> bool {
        let is_awaited = self.own_hand.as_ref().is_some_and(OwnHand::awaits_size);
        let is_seen = |&camera: &usize| {
            let mask = frame.masks.get(camera).and_then(Option::as_ref);
            mask.is_some_and(|mask| mask.hand_pixels().next().is_some())
                || frame.landmarks.get(camera).is_some_and(Option::is_some)
        };
        is_awaited && (0..self.cameras.len()).filter(is_seen).count() > 1
    }

    /// The first frame that shows all of a hand that is still to be learnt to two cameras: it tells roughly how large the hand
    /// is, and is fitted again if that is another size than was thought. Any other frame as it is.
    fn sized(&mut self, frame: &TakeFrame, next: Last) -> Result<Last> {
        let (Some(own_hand), Some(found)) = (&mut self.own_hand, &next.found) else {
            return Ok(next);
        };
        if found.cameras_used() < 2 || !own_hand.awaits_size() {
            return Ok(next);
        }
        own_hand.look();
        // Of a hand that comes into the pictures only part is seen, which tells nothing of its size.
        if self.fitter(&self.searching).is_cut_off(found) {
            return Ok(next);
        }
        let place = found.frame(self.hand());
        let (fitter, frames) = (self.fitter(&self.searching), std::slice::from_ref(frame));
        let size = size::of_hand(&fitter, &self.cameras, frames, &place, &NoProgress)?;
        let mean = self.hand().scaled(|| size.unwrap_or(1.0));
        self.own_hand = Some(OwnHand::sized(mean.clone()));
        if size.is_none() {
            return Ok(next);
        }
        self.known.hand = KnownHand::anyone(&mean);
        self.begun(next.time, frame, &[place])
    }

    /// A frame of a hand whose motion is known.
    fn followed(
        &mut self,
        time: f64,
        frame: &TakeFrame,
        last: &Last,
        prediction: &Prediction,
    ) -> Result<Last> {
        let seen = Seen::of(&self.cameras, frame, &mut self.finder)?;
        let predicted = &prediction.motion;
        let before = last.motion.as_ref().unwrap_or(predicted);
        let fitter = self.fitter(&self.following);
        let followed = follow(&fitter, &seen, before, predicted, &self.noise, self.recent.usual())?;
        let is_good = followed.as_ref().is_some_and(|own| misfit::agrees(&own.found.refined));
        if !is_good && !seen.is_empty() {
            let near: Vec<DAffine3> = [predicted.rest].into_iter().chain(self.rest).collect();
            let badly = followed.as_ref().map(|followed| &followed.found);
            let fitter = self.fitter(&self.searching);
            let found = recover(&fitter, &self.cameras, frame, badly, &near)?;
            let found = found.filter(|found| {
                badly.is_none_or(|badly| found.misfit < WORTH_A_JUMP * badly.misfit)
            });
            if let Some(found) = found {
                return Ok(self.started(time, self.agreeing(found)?));
            }
        }
        let Some(followed) = followed else {
            return Ok(Last::unseen(time, Some(predicted.clone())));
        };
        let Followed { found, silhouettes, motion, offset, before, after } = followed;
        self.noise.learn(&offset, &before, &after);
        self.recent.push(found.misfit);
        let used = found.left_out.clone();
        let found = self.agreeing(found)?;
        if found.left_out != used {
            // Without a view the pose is another.
            return Ok(self.started(time, found));
        }
        Ok(Last { time, found: Some(found), silhouettes, motion: Some(motion) })
    }

    /// Keeps a frame that tells of the hand, and learns the hand once there are enough.
    fn learn_hand(&mut self, next: &Last) -> Result<()> {
        let (Some(_), Some(found), Some(rest)) = (&self.own_hand, &next.found, &self.rest) else {
            return Ok(());
        };
        if !views::is_right(&self.fitter(&self.searching), found)? {
            return Ok(());
        }
        if !self.own_hand.as_mut().is_some_and(|own_hand| own_hand.keep(found)) {
            return Ok(());
        }
        let rest = *rest;
        let Some(own_hand) = self.own_hand.take() else { return Ok(()) };
        let believing = consensus::believing();
        let absolute =
            FrameFitter { weights: self.known.weights.clone(), ..self.fitter(&believing) };
        let ViewKnowledge { weights, persistent } = ViewKnowledge::of(&absolute, own_hand.kept())?;
        let border = HandEvidence { independent: weights.most(), persistent };
        self.known.weights = weights;
        let learnt = own_hand.learn(&self.fitter(&believing), &rest, border)?;
        if let Some(learnt) = learnt {
            self.known.hand = learnt;
        }
        let searching = self.fitter(&self.searching);
        if mistake::is_other_side(&searching, own_hand.kept(), &NoProgress)? {
            self.known.mistake = Some(Mistake::OtherSide);
        }
        Ok(())
    }

    /// A frame without the views that disagree.
    fn agreeing(&self, found: Found) -> Result<Found> {
        if misfit::agrees(&found.refined) {
            return Ok(found);
        }
        Ok(views::without_disagreeing(&self.fitter(&self.searching), &found)?.0)
    }

    /// A hand that was found without a motion.
    fn started(&self, time: f64, found: Found) -> Last {
        let covariance: Vec<f64> =
            found.refined.covariance.iter().map(|own| own / self.noise.unit()).collect();
        let motion = Motion::starting(found.rest, found.refined.pose, &covariance, self.hand());
        let silhouettes = self.fitter(&self.searching).silhouettes(&found);
        Last { time, found: Some(found), silhouettes, motion: Some(motion) }
    }

    /// What is said of a frame.
    fn report(&self, last: &Last) -> Result<TrackedFrame> {
        let Last { time, found, silhouettes, motion } = last;
        let (Some(motion), Some(rest)) = (motion, self.rest) else {
            return Ok(TrackedFrame { time: *time, fit: None });
        };
        let known = &self.known;
        let fitter =
            &FrameFitter { weights: known.weights.clone(), ..self.fitter(&self.searching) };
        let reporter = Reporter { cameras: &self.cameras, fitter, known, rest };
        let fit = match found {
            Some(found) => reporter.report_beside(found, silhouettes.clone())?,
            None => reporter.unseen(&motion.pose, &motion.rest),
        };
        Ok(TrackedFrame { time: *time, fit: Some(fit) })
    }
}

/// A hand that was looked for is taken for the one that was followed if it is nearer to agreeing by so much.
const WORTH_A_JUMP: f64 = 0.8;
