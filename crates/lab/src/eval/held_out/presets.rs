//! The presets: estimators learnt as a user's are, from damaged random scenes.

use anyhow::{Context, Result};
use faer::Mat;
use phalanx::{
    Estimator, Framing, Picture, Preset, Progress, Refiner, SceneDescriber, SceneSource, Training,
    Workspace, targets,
};
use phalanx_hand::{Dof, Pose};
use phalanx_refine::PoseFitSettings;
use phalanx_segmentation::{Mask, Silhouette};
use rayon::prelude::*;

use super::errors::Truth;
use super::ground::Ground;
use super::method::Answer;
use super::refined::{self, Starts};
use super::row::{Outcome, Row};
use crate::data::sets::{self, Set};
use crate::eval::table1::single_view;
use crate::recipes::{Trained, trained};

/// What the cameras show, as presets look at it.
enum Frame {
    Silhouettes(Vec<Silhouette>),
    /// As large as they are, to be looked at through windows.
    Masks(Vec<Mask>),
}

/// Of so many samples of a test one is refined, which takes its time; shares no factor with the
/// number of hands that a test shows in turn.
const REFINED_EVERY: usize = 5;

/// What is to be learnt.
struct Asked {
    preset: Preset,
    answers: Vec<Answer>,
    framing: Framing,
    views: Vec<usize>,
}

/// A preset learnt from some of the cameras.
pub(crate) struct Learnt {
    answers: Vec<Answer>,
    refiner: Refiner,
    preset: Preset,
    train: &'static str,
    samples: usize,
    /// The cameras' numbers in the whole rig.
    views: Vec<usize>,
    pub(crate) estimator: Estimator,
    /// What guessing without looking says.
    mean: Pose,
}

/// The name in tables and JSON.
pub(crate) fn name(preset: Preset, answer: Answer) -> &'static str {
    match (answer, preset) {
        (Answer::Refined, _) => "refined",
        (Answer::RefinedOwnHand, _) => "refined_own_hand",
        (Answer::Estimate, Preset::Fast) => "fast",
        (Answer::Estimate, Preset::Default) => "preset",
        (Answer::Estimate, Preset::Best) => "best",
    }
}

/// Learns presets through one view (the top), two next to each other and all, or so many of them as
/// `counts` says if it says any; looking at whole pictures or through windows.
pub(crate) fn learn(
    asked: &[(Preset, Answer)],
    framing: Framing,
    counts: &[usize],
    ground: &Ground,
    progress: &dyn Progress,
) -> Result<Vec<Learnt>> {
    let mut learnt = Vec::new();
    for preset in Preset::ALL {
        let answers: Vec<Answer> =
            asked.iter().filter(|(asked, _)| *asked == preset).map(|&(_, answer)| answer).collect();
        let answers: Vec<Answer> =
            answers.into_iter().filter(|answer| answer.is_given(framing)).collect();
        let wanted = |views: &Vec<usize>| counts.is_empty() || counts.contains(&views.len());
        let views = views(ground).into_iter().filter(wanted);
        for views in views.filter(|_| !answers.is_empty()) {
            let asked = Asked { preset, answers: answers.clone(), framing, views };
            learnt.push(Learnt::new(asked, ground, progress)?);
        }
    }
    Ok(learnt)
}

fn refines(answers: &[Answer]) -> bool {
    answers.iter().any(|answer| *answer != Answer::Estimate)
}

fn views(ground: &Ground) -> Vec<Vec<usize>> {
    let all = ground.rig.cameras.len();
    let single = single_view(&ground.rig).unwrap_or(0);
    let mut views = vec![vec![single], (0..all.min(2)).collect(), (0..all).collect()];
    views.dedup();
    views
}

/// How many cameras presets can look through.
pub(crate) fn view_counts(ground: &Ground) -> Vec<usize> {
    views(ground).iter().map(Vec::len).collect()
}

impl Learnt {
    fn new(asked: Asked, ground: &Ground, progress: &dyn Progress) -> Result<Self> {
        let Asked { preset, answers, framing, views } = asked;
        let names: Vec<&str> =
            views.iter().map(|&view| ground.rig.cameras[view].name.as_str()).collect();
        let rig = ground.rig.select(&names)?;
        let set = sets::for_preset(framing, &rig, &ground.hand, preset.scenes());
        let training = Training { framing, ..preset.training() };
        let fresh = refines(&answers).then(|| sets::fresh_for(framing, &rig, &ground.hand));
        let Trained { estimator, samples } = trained(&training, &set, fresh.as_ref(), progress)?;
        let mean = Dof::ALL.map(|dof| {
            set.poses.iter().map(|pose| pose[dof]).sum::<f64>() / set.poses.len() as f64
        });
        let refinement = PoseFitSettings::of_strangers();
        let refiner = refined::refiner(&estimator, ground, refinement)?;
        let mean = Pose(mean);
        Ok(Self { answers, refiner, preset, train: set.name, samples, views, estimator, mean })
    }

    fn refines(&self) -> bool {
        refines(&self.answers)
    }

    /// The silhouettes of the cameras that it was learnt from, of those of all.
    fn of_views(&self, silhouettes: &[Silhouette]) -> Vec<Silhouette> {
        self.views.iter().map(|&view| silhouettes[view].clone()).collect()
    }

    /// One pose for each answer; `own` is the refiner with the hand calibrated.
    fn poses(
        &self,
        frame: &Frame,
        own: Option<&Refiner>,
        workspace: &mut Workspace,
    ) -> Result<Vec<Pose>> {
        let estimate = match frame {
            Frame::Silhouettes(all) => {
                self.estimator.estimate_silhouettes(&self.of_views(all), workspace)?
            }
            Frame::Masks(all) => {
                let pictures: Vec<Picture<'_>> =
                    self.views.iter().map(|&view| Picture::Mask(&all[view])).collect();
                self.estimator.estimate(&pictures, workspace)?
            }
        };
        let starts = Starts::Hypotheses;
        let refine = |refiner| refined::refine(&self.estimator, refiner, estimate.clone(), starts);
        let answers = self.answers.iter().map(|answer| match answer {
            Answer::Estimate => Ok(estimate.pose),
            Answer::Refined => refine(&self.refiner),
            Answer::RefinedOwnHand => refine(own.context("the hand was not calibrated")?),
        });
        answers.collect()
    }

    /// Refiners for the hands of a test, if its answers need any.
    fn own_hands(
        &self,
        set: &Set<'_>,
        ground: &Ground,
        progress: &dyn Progress,
    ) -> Result<Vec<Refiner>> {
        if !self.answers.contains(&Answer::RefinedOwnHand) {
            return Ok(Vec::new());
        }
        refined::own_hands(&self.estimator, &self.refiner, &self.views, set, ground, progress)
    }

    fn row(
        &self,
        test: &'static str,
        answer: Answer,
        estimates: &[Pose],
        truth: &Truth,
        ground: &Ground,
    ) -> Result<Row> {
        let (estimates, guess) = (targets(estimates), targets(&[self.mean]));
        let guesses = Mat::from_fn(guess.nrows(), estimates.ncols(), |dof, _| guess[(dof, 0)]);
        let outcome = Outcome {
            train: self.train,
            train_samples: self.samples,
            method: name(self.preset, answer),
            views: self.views.len(),
            kept_samples: self.estimator.regressor().kept_samples(),
        };
        outcome.row(test, estimates.as_ref(), guesses.as_ref(), truth, ground)
    }
}

/// Every learnt preset on one test set.
pub(crate) fn test(
    set: &Set<'_>,
    learnt: &[Learnt],
    ground: &Ground,
    progress: &dyn Progress,
) -> Result<Vec<Row>> {
    let own = learnt.iter().map(|learnt| learnt.own_hands(set, ground, progress));
    let own = own.collect::<Result<Vec<_>>>()?;
    let Some(first) = learnt.first() else { return Ok(Vec::new()) };
    let view_config = first.estimator.descriptor().view_config();
    let describer = SceneDescriber::new(&ground.rig, view_config)?;
    let every = if learnt.iter().any(Learnt::refines) { REFINED_EVERY } else { 1 };
    let numbers: Vec<usize> = (0..set.count()).step_by(every).collect();
    progress.begin(&format!("see {}", set.name), numbers.len());
    let look = |(describer, workspace): &mut (SceneDescriber, Workspace), &number: &usize| {
        let scene = set.scene(number);
        progress.step();
        let frame = match view_config.framing {
            Framing::Picture => {
                Frame::Silhouettes(describer.silhouettes(&scene).ok()?.cloned().collect())
            }
            Framing::Window => Frame::Masks(describer.masks(&scene).ok()?.to_vec()),
        };
        let each = learnt
            .iter()
            .zip(&own)
            .map(|(learnt, own)| learnt.poses(&frame, own.get(number % set.hands()), workspace));
        Some((scene, each.collect::<Result<Vec<_>>>().ok()?))
    };
    let memory = || (describer.clone(), Workspace::default());
    let estimated: Vec<_> = numbers.par_iter().map_init(memory, look).flatten().collect();
    if estimated.len() < numbers.len() {
        let (left_out, all) = (numbers.len() - estimated.len(), numbers.len());
        eprintln!("{}: {left_out} of {all} cannot be estimated by every preset", set.name);
    }
    let truth = Truth::of(estimated.iter().map(|(scene, _)| scene.clone()), ground);
    rows(set.name, learnt, estimated.into_iter().map(|(_, each)| each), &truth, ground)
}

/// Every learnt preset on silhouettes from elsewhere, of all cameras.
pub(crate) fn test_masks(
    frames: &[Vec<Silhouette>],
    learnt: &[Learnt],
    truth: &Truth,
    ground: &Ground,
) -> Result<Vec<Row>> {
    let own = learnt.iter().map(|learnt| -> Result<Option<Refiner>> {
        if !learnt.answers.contains(&Answer::RefinedOwnHand) {
            return Ok(None);
        }
        let seen: Vec<_> = frames.iter().map(|frame| learnt.of_views(frame)).collect();
        refined::own_hand_of_masks(&learnt.estimator, &learnt.refiner, &seen).map(Some)
    });
    let own = own.collect::<Result<Vec<_>>>()?;
    let estimates = |frame: &Vec<Silhouette>| -> Result<Vec<Vec<Pose>>> {
        let mut workspace = Workspace::default();
        let each = learnt.iter().zip(&own);
        let frame = Frame::Silhouettes(frame.clone());
        each.map(|(learnt, own)| learnt.poses(&frame, own.as_ref(), &mut workspace)).collect()
    };
    let estimated = frames.par_iter().map(estimates).collect::<Result<Vec<_>>>()?;
    rows("masks", learnt, estimated.into_iter(), truth, ground)
}

/// The rows of estimates, of each sample one by every answer of every preset.
pub(crate) fn rows(
    test: &'static str,
    learnt: &[Learnt],
    estimates: impl Iterator<Item = Vec<Vec<Pose>>>,
    truth: &Truth,
    ground: &Ground,
) -> Result<Vec<Row>> {
    let estimates: Vec<Vec<Vec<Pose>>> = estimates.collect();
    let mut rows = Vec::new();
    for (number, learnt) in learnt.iter().enumerate() {
        for (k, &answer) in learnt.answers.iter().enumerate() {
            let own: Vec<Pose> = estimates.iter().map(|each| each[number][k]).collect();
            let row = learnt.row(test, answer, &own, truth, ground);
            rows.push(row.with_context(|| name(learnt.preset, answer))?);
        }
    }
    Ok(rows)
}
