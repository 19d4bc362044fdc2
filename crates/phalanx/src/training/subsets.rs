//! Learning to answer where some of the cameras are missing.
//!
//! Whatever regressor all cameras have, subsets of them are learnt from the principal components of the views'
//! codes. Kernels see few numbers and learn in no time from few views, so that each subset has its own. A
//! network for each would take as long as that of all cameras: one learns them all, from there on.

use faer::{Mat, MatRef};
use phalanx_rvm::{
    BasisSpec, BlockPca, GroupedRegressor, MissingInputs, PilotSample, SufficientStatistics,
    random_subset,
};
use rayon::prelude::*;

use crate::error::Result;
use crate::estimator::subset_regression::{
    SubsetRegression, SubsetRegressors, of_nothing, rows, views_of,
};
use crate::progress::Progress;
use crate::synthesis::scene::SUBSET_SEED;
use crate::training::cameras::Cameras;
use crate::training::feature_transform::FeatureTransform;
use crate::training::learnt_metric::LearntMetric;
use crate::training::plan::TrainingPlan;
use crate::training::regressor::{RegressorConfig, columns_of};
use crate::training::samples::Samples;
use crate::training::shard::BLOCK;
use crate::view_set::ViewSet;

/// Most blocks of scenes whose components are kept for the subsets' kernels: 64 MiB or so of three views.
const MOST_BLOCKS: usize = 20;

impl TrainingPlan {
    /// The components that are kept of a block's scenes, of so many scenes in all, for the subsets' kernels: of
    /// some blocks, evenly spaced.
    pub(crate) fn subset_components(&self, block: usize, scenes: usize) -> Option<&BlockPca> {
        let FeatureTransform::Metric { components, .. } = &self.transform else { return None };
        let step = scenes.div_ceil(BLOCK).div_ceil(MOST_BLOCKS).max(1);
        (!self.subsets().is_empty() && block.is_multiple_of(step)).then_some(components)
    }

    /// The subsets of the cameras that are learnt.
    fn subsets(&self) -> Vec<ViewSet> {
        match self.answers_from {
            Cameras::Any => ViewSet::learnt(self.rig.cameras.len()),
            Cameras::All => Vec::new(),
        }
    }

    /// What of the components of the views may be missing, and what a network reads in its place: the
    /// components of nothing. `None` where nothing may.
    pub(crate) fn missing_views(&self) -> Option<MissingInputs> {
        let present: Vec<u64> = self.subsets().into_iter().map(ViewSet::bits).collect();
        let FeatureTransform::Components(components) = &self.transform else { return None };
        if present.is_empty() {
            return None;
        }
        let stand_ins = components.blocks().iter().flat_map(of_nothing).collect();
        let groups = views_of(components, self.rig.cameras.len());
        Some(MissingInputs { groups, stand_ins, present })
    }

    /// The kernels of every subset, from what was kept of the scenes; `None` of other regressors.
    pub(crate) fn fit_subsets(
        &self,
        kept: &Samples<f32>,
        progress: &dyn Progress,
    ) -> Result<Option<SubsetRegression>> {
        let (RegressorConfig::LearntMetric(fitter), FeatureTransform::Metric { components, .. }) =
            (&self.regressor, &self.transform)
        else {
            return Ok(None);
        };
        let subsets = self.subsets();
        if subsets.is_empty() {
            return Ok(None);
        }
        progress.begin("learn for missing cameras", subsets.len());
        let (z, y) = kept.columns(components.outputs());
        let fit = |subset: &ViewSet| {
            let rows = rows(components, self.rig.cameras.len(), *subset);
            let own = Mat::from_fn(rows.len(), z.ncols(), |k, i| f64::from(z[(rows[k], i)]));
            let blocks = components.blocks().iter().enumerate();
            let own_blocks: Vec<usize> = blocks
                .filter(|(block, _)| subset.contains(block % self.rig.cameras.len()))
                .map(|(_, map)| map.outputs())
                .collect();
            let fitter = fitter.of_fewer_views(subset.count(), self.rig.cameras.len());
            let fitted = fit_kernels(&fitter, own.as_ref(), y, &own_blocks);
            progress.step();
            fitted
        };
        let regressors = subsets.par_iter().map(fit).collect::<Result<Vec<_>>>()?;
        let regressors = SubsetRegressors::Own(regressors);
        Ok(Some(SubsetRegression::new(components.clone(), regressors)))
    }
}

/// Kernel regression of each group of the pose's numbers, in a distance of its own, on components `z` that are
/// made of blocks of these lengths.
fn fit_kernels(
    fitter: &LearntMetric,
    z: MatRef<'_, f64>,
    y: MatRef<'_, f64>,
    blocks: &[usize],
) -> Result<GroupedRegressor> {
    let pilot = random_subset(z.ncols(), fitter.pilot, SUBSET_SEED);
    let [pilot_z, pilot_y] = [z, y].map(|all| columns_of(all, &pilot));
    let (metric, _) = fitter.learn(pilot_z.as_ref(), pilot_y.as_ref(), blocks)?;
    let read = metric.projection.apply(z)?;
    let centres = random_subset(z.ncols(), fitter.centres, SUBSET_SEED);
    let of_group = |group: usize| {
        let (x, y) = (metric.part(group, read.as_ref()), metric.targets(group, y));
        let [centre_x, centre_y] = [x, y.as_ref()].map(|all| columns_of(all, &centres));
        let pilot = PilotSample { x: centre_x.as_ref(), y: centre_y.as_ref(), samples: &centres };
        let columns = BasisSpec::in_proportion(&pilot, fitter.regression.bandwidth)?;
        let mut sums = SufficientStatistics::new(&columns);
        sums.add(&columns, x, y.as_ref())?;
        Ok(fitter.regression.fit_sums(&columns, &sums)?.model)
    };
    let models = (0..metric.groups.len()).into_par_iter().map(of_group);
    let models = models.collect::<Result<Vec<_>>>()?;
    Ok(GroupedRegressor::from_parts(metric, models)?)
}
