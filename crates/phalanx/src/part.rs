//! Training on any number of scenes that stream by, all at once or in parts.

use faer::{Mat, MatRef};
use phalanx_camera::Rig;
use phalanx_hand::{Dof, HandShape};
use phalanx_rvm::{Columns, Metric, Pilot, Projected, Sums};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::container::Container;
use crate::regressor::{columns_of, evenly_spaced};
use crate::shard::{BLOCK, scenes_of};
use crate::{
    Descriptor, Error, Estimator, EvenlySpaced, Progress, Regression, Regressor, Result, Scenes,
    Shard, Training, describe_each, describe_scenes, targets,
};

const PART: Container = Container { what: "training part", mark: *b"PHXPART\0", format: 3 };

/// What one [`Shard`] of a training has seen: enough to be [merged](Self::merge) with the others'
/// and to [`finish`](Self::finish) the estimator. Its size depends on the regressor's columns and
/// not on the number of scenes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Part {
    basis: Basis,
    scenes: usize,
    /// The blocks that are in the sums, ascending, and how many scenes could not be described.
    blocks: Vec<usize>,
    left_out: usize,
    /// One for all numbers of the pose, or for each of the metric's groups.
    sums: Vec<Sums>,
}

/// What every part of a training must know before it begins; each finds it by itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Basis {
    rig: Rig,
    hand: HandShape,
    descriptor: Descriptor,
    regressor: Regressor,
    /// The distances, where the regressor learns them.
    metric: Option<Metric>,
    /// Scenes that scaling and Gaussian centres are taken from, and their x (as the regressor reads
    /// it) and y (28), one after the other.
    pilot: Vec<usize>,
    pilot_x: Vec<f64>,
    pilot_y: Vec<f64>,
}

impl Training {
    /// Learns from scenes of a rig, of which there may be any number: none is kept. Scenes that some
    /// camera does not show well enough are left out; [`Part::left_out`] tells how many.
    ///
    /// A run does the `shard` of all blocks of scenes that it is told; runs that differ in nothing
    /// else give parts which, merged in any order, [finish](Part::finish) to the bytes of a single
    /// run of [`Shard::WHOLE`].
    ///
    /// The codebooks are learnt from at most a thousand scenes, evenly spaced, and the regressor
    /// has at most [`Regressor::CANDIDATES`] Gaussians. `rig` and `hand` are what the estimator
    /// takes pictures to be of, whatever the scenes are.
    ///
    /// # Errors
    /// An unusable rig or hand, fewer than two scenes that can be described, a regressor that
    /// needs its samples at once, or what the stages report.
    pub fn shard(
        &self,
        rig: &Rig,
        hand: &HandShape,
        scenes: &dyn Scenes,
        shard: Shard,
        progress: &dyn Progress,
    ) -> Result<Part> {
        rig.validate()?;
        hand.validate()?;
        let basis = self.basis(rig, hand, scenes, progress)?;
        let columns = basis.columns()?;
        let blocks: Vec<usize> = shard.blocks(scenes.count()).collect();
        let sums = columns.iter().map(Sums::new).collect();
        let mut part = Part { sums, scenes: scenes.count(), left_out: 0, blocks, basis };
        let shown = part.blocks.iter().map(|&block| scenes_of(block, part.scenes).len()).sum();
        progress.begin("render, describe, sum", shown);
        for &block in &part.blocks {
            let numbers: Vec<usize> = scenes_of(block, part.scenes).collect();
            let descriptor = &part.basis.descriptor;
            let described = describe_scenes(rig, scenes, &numbers, descriptor, progress)?;
            let (kept, x) = described_ones(&numbers, described);
            part.left_out += numbers.len() - kept.len();
            if kept.is_empty() {
                continue;
            }
            let y = targets_of(scenes, &kept);
            part.basis.add(&mut part.sums, &columns, &x, &y)?;
        }
        Ok(part)
    }

    fn basis(
        &self,
        rig: &Rig,
        hand: &HandShape,
        scenes: &dyn Scenes,
        progress: &dyn Progress,
    ) -> Result<Basis> {
        self.regressor.summed()?;
        let spaced = EvenlySpaced::new(scenes, Training::CODEBOOK_SCENES);
        let described = describe_each(rig, &spaced, self.sight(), progress)?;
        let (contexts, failed): (Vec<_>, Vec<_>) = described.into_iter().partition(Result::is_ok);
        let contexts: Vec<_> = contexts.into_iter().filter_map(Result::ok).collect();
        if contexts.len() < 2 {
            let reason = failed.into_iter().find_map(Result::err);
            return Err(reason.unwrap_or(Error::TooFewPoses { found: contexts.len() }));
        }
        progress.begin("cluster shape contexts", 1);
        let descriptor = self.descriptor(&contexts)?;
        drop(contexts);
        progress.step();
        let pilot = evenly_spaced(scenes.count(), self.regressor.pilot());
        progress.begin("render and describe", pilot.len());
        let described = describe_scenes(rig, scenes, &pilot, &descriptor, progress)?;
        let (pilot, x) = described_ones(&pilot, described);
        let y = targets_of(scenes, &pilot);
        let metric = match &self.regressor {
            Regressor::LearntMetric(fitter) => {
                progress.begin("learn distances", 1);
                let metric = fitter.learn(x.as_ref(), y.as_ref(), &descriptor.blocks())?;
                progress.step();
                Some(metric)
            }
            _ => None,
        };
        let chosen = evenly_spaced(pilot.len(), self.regressor.centres());
        let [x, y] = [x, y].map(|all| columns_of(all.as_ref(), &chosen));
        let x = match &metric {
            Some(metric) => metric.projection.apply(x.as_ref())?,
            None => x,
        };
        let numbers = |all: &Mat<f64>| all.col_iter().flat_map(|c| c.iter().copied()).collect();
        Ok(Basis {
            rig: rig.clone(),
            hand: hand.clone(),
            descriptor,
            regressor: self.regressor.clone(),
            metric,
            pilot_x: numbers(&x),
            pilot_y: numbers(&y),
            pilot: chosen.into_iter().map(|place| pilot[place]).collect(),
        })
    }
}

impl Basis {
    /// Numbers that the regressor reads of a scene.
    fn read(&self) -> usize {
        self.metric.as_ref().map_or(self.descriptor.dim(), |metric| metric.projection.outputs())
    }

    /// The columns of all numbers of the pose together, or of each group.
    fn columns(&self) -> Result<Vec<Columns>> {
        let samples = self.pilot.len();
        let length = |each: usize| each.saturating_mul(samples);
        for (part, found, expected) in [
            ("numbers of pilot descriptors", self.pilot_x.len(), length(self.read())),
            ("numbers of pilot poses", self.pilot_y.len(), length(Dof::COUNT)),
        ] {
            if found != expected {
                return Err(Error::Mismatch { part, found, expected });
            }
        }
        let x = MatRef::from_column_major_slice(&self.pilot_x, self.read(), samples);
        let y = MatRef::from_column_major_slice(&self.pilot_y, Dof::COUNT, samples);
        let Regressor::LearntMetric(fitter) = &self.regressor else {
            let pilot = Pilot { x, y, samples: &self.pilot };
            return Ok(vec![Columns::new(&pilot, self.regressor.summed()?)?]);
        };
        let metric = self.metric()?;
        let of_group = |group: usize| {
            let y = metric.targets(group, y);
            let x = metric.part(group, x);
            let pilot = Pilot { x, y: y.as_ref(), samples: &self.pilot };
            Ok(Columns::in_proportion(&pilot, fitter.regression.width)?)
        };
        (0..metric.groups.len()).into_par_iter().map(of_group).collect()
    }

    /// The learnt distances of a regressor that learns them.
    fn metric(&self) -> Result<&Metric> {
        let missing = Error::Mismatch { part: "learnt metrics", found: 0, expected: 1 };
        self.metric.as_ref().ok_or(missing)
    }

    /// Adds scenes' descriptors and poses to the sums.
    fn add(
        &self,
        sums: &mut [Sums],
        columns: &[Columns],
        x: &Mat<f64>,
        y: &Mat<f64>,
    ) -> Result<()> {
        let Some(metric) = &self.metric else {
            return Ok(sums[0].add(&columns[0], x.as_ref(), y.as_ref())?);
        };
        let z = metric.projection.apply(x.as_ref())?;
        for (group, (sums, columns)) in sums.iter_mut().zip(columns).enumerate() {
            let y = metric.targets(group, y.as_ref());
            sums.add(columns, metric.part(group, z.as_ref()), y.as_ref())?;
        }
        Ok(())
    }

    /// The regression that sums over all scenes amount to.
    fn fit(&self, sums: &[Sums]) -> Result<Regression> {
        let work: Vec<(Columns, &Sums)> = self.columns()?.into_iter().zip(sums).collect();
        let fit =
            |(columns, sums): &(Columns, &Sums)| Ok(self.regressor.fit_sums(columns, sums)?.model);
        let mut models = work.par_iter().map(fit).collect::<Result<Vec<_>>>()?;
        Ok(match &self.metric {
            Some(metric) => Projected::from_parts(metric.clone(), models)?.into(),
            None => models.remove(0).into(),
        })
    }
}

impl Part {
    /// How many scenes of all could not be described so far.
    pub fn left_out(&self) -> usize {
        self.left_out
    }

    /// Do the numbers of scenes fit each other, and are there no more than training makes?
    fn check_numbers(&self) -> Result<()> {
        let ascending = |numbers: &[usize], end: usize| {
            numbers.is_sorted_by(|a, b| a < b) && numbers.last().is_none_or(|last| *last < end)
        };
        let shown: usize = self.blocks.iter().map(|&b| scenes_of(b, self.scenes).len()).sum();
        for (reason, holds) in [
            ("its blocks are not in order", ascending(&self.blocks, self.scenes.div_ceil(BLOCK))),
            ("its pilot is not in order", ascending(&self.basis.pilot, self.scenes)),
            ("its pilot is too large", self.basis.pilot.len() <= self.basis.regressor.centres()),
            (
                "its sums are of other scenes than its blocks",
                self.sums
                    .iter()
                    .all(|sums| sums.samples().checked_add(self.left_out) == Some(shown)),
            ),
        ] {
            if !holds {
                return Err(Error::FileContent { what: PART.what, reason: reason.to_owned() });
            }
        }
        Ok(())
    }

    /// Adds another part of the same training.
    ///
    /// # Errors
    /// A part of another training, or one that holds a block that is here already.
    pub fn merge(&mut self, other: Self) -> Result<()> {
        for (what, differ) in [
            ("their rigs", self.basis.rig != other.basis.rig),
            ("their hands", self.basis.hand != other.basis.hand),
            ("their numbers of scenes", self.scenes != other.scenes),
            ("their regressors", self.basis.regressor != other.basis.regressor),
            ("what they learn from", self.basis != other.basis),
        ] {
            if differ {
                return Err(Error::ForeignPart { what });
            }
        }
        let held = |block: &&usize| self.blocks.binary_search(block).is_ok();
        if let Some(&block) = other.blocks.iter().find(held) {
            let both = scenes_of(block, self.scenes);
            return Err(Error::Overlap { first: both.start, last: both.end - 1 });
        }
        for (sums, other) in self.sums.iter_mut().zip(&other.sums) {
            sums.merge(other)?;
        }
        self.blocks.extend(other.blocks);
        self.blocks.sort_unstable();
        self.left_out += other.left_out;
        Ok(())
    }

    /// The estimator, once all parts are merged.
    ///
    /// # Errors
    /// A missing part, or what the regressor reports.
    pub fn finish(self) -> Result<Estimator> {
        let all = self.scenes.div_ceil(BLOCK);
        if let Some(missing) = (0..all).find(|block| self.blocks.get(*block) != Some(block)) {
            let missing = scenes_of(missing, self.scenes);
            return Err(Error::MissingPart { first: missing.start, last: missing.end - 1 });
        }
        let regression = self.basis.fit(&self.sums)?;
        let Basis { rig, hand, descriptor, .. } = self.basis;
        Estimator::from_parts(rig, hand, descriptor, regression)
    }

    /// The part's file.
    ///
    /// # Errors
    /// None that a part can cause; encoding is fallible in form.
    pub fn to_bytes(&self) -> Result<Vec<u8>> {
        PART.encode(self)
    }

    /// Reads a part's file.
    ///
    /// # Errors
    /// Bytes that are no part, of another format, truncated, corrupt, or that contradict
    /// themselves.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let part: Self = PART.decode(bytes)?;
        part.basis.rig.validate()?;
        part.basis.hand.validate()?;
        part.check_numbers()?;
        let columns = part.basis.columns()?;
        let (found, expected) = (part.sums.len(), columns.len());
        if found != expected {
            return Err(Error::Mismatch { part: "sums", found, expected });
        }
        // Sums refuse to be joined with those of other columns.
        for (columns, sums) in columns.iter().zip(&part.sums) {
            Sums::new(columns).merge(sums)?;
        }
        Ok(part)
    }
}

/// Which scenes could be described, and their descriptors.
fn described_ones(numbers: &[usize], described: Vec<Result<Vec<f64>>>) -> (Vec<usize>, Mat<f64>) {
    let kept: Vec<(usize, Vec<f64>)> = numbers
        .iter()
        .zip(described)
        .filter_map(|(&number, described)| Some((number, described.ok()?)))
        .collect();
    let dim = kept.first().map_or(0, |(_, x)| x.len());
    let x = Mat::from_fn(dim, kept.len(), |row, i| kept[i].1[row]);
    (kept.into_iter().map(|(number, _)| number).collect(), x)
}

fn targets_of(scenes: &dyn Scenes, numbers: &[usize]) -> Mat<f64> {
    let poses: Vec<_> = numbers.iter().map(|&number| scenes.scene(number).pose).collect();
    targets(&poses)
}

#[cfg(test)]
mod tests {
    use phalanx_hand::Pose;
    use phalanx_rvm::Ridge;

    use super::*;
    use crate::{NominalScenes, Silent};

    fn part() -> Part {
        let rig = Rig::from_toml(include_str!("../fixtures/desk.toml")).unwrap();
        let rig = rig.select(&["top"]).unwrap();
        let hand = HandShape::adult();
        let poses: Vec<Pose> = (0..24)
            .map(|k| {
                let mut pose = Pose::REST;
                pose[Dof::ThetaZ] = 0.06 * f64::from(k);
                pose
            })
            .collect();
        let mut training =
            Training { regressor: Regressor::Ridge(Ridge::default()), ..Training::default() };
        training.vocabulary.centres = 10;
        training.vocabulary.most_samples = 500;
        let scenes = NominalScenes { rig: &rig, hand: &hand, poses: &poses };
        training.shard(&rig, &hand, &scenes, Shard::WHOLE, &Silent).unwrap()
    }

    #[test]
    fn parts_that_contradict_themselves_are_refused() {
        let good = part();
        assert_eq!(Part::from_bytes(&good.to_bytes().unwrap()).unwrap(), good);
        let spoils: [fn(&mut Part); 6] = [
            |part| part.blocks = vec![0, 0],
            |part| part.blocks = vec![1],
            |part| part.left_out = usize::MAX,
            |part| part.basis.pilot.swap(0, 1),
            |part| part.basis.pilot_x.truncate(3),
            |part| part.scenes = usize::MAX,
        ];
        for (k, spoil) in spoils.into_iter().enumerate() {
            let mut spoilt = good.clone();
            spoil(&mut spoilt);
            let error = Part::from_bytes(&spoilt.to_bytes().unwrap()).unwrap_err();
            let named = matches!(error, Error::FileContent { .. } | Error::Mismatch { .. });
            assert!(named, "spoil {k}: {error}");
        }
    }
}
