//! Trainings for those who do not want to choose.

use phalanx_codebook::KMeans;
use phalanx_multiview::CodebookTrainer;
use phalanx_rvm::{
    Bandwidth, ExpectedGradientOuterProduct, MlpTrainer, NystromRegularisation, NystromRidge,
    PredictiveDeviation,
};

use crate::features::describer::OrientationRule;
use crate::training::cameras::Cameras;
use crate::training::learnt_metric::LearntMetric;
use crate::training::network_training::NetworkTraining;
use crate::training::recipe::{Encoding, Training};
use crate::training::regressor::RegressorConfig;
use crate::window::Framing;

/// How much time an estimator is worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Preset {
    /// 4,000 scenes: some seconds on two cores, three views.
    Fast,
    /// 120,000 scenes, learnt by a network: a few minutes.
    #[default]
    Default,
    /// 240,000 scenes and a wider network: ten minutes or so.
    Best,
}

impl Preset {
    /// All, the fastest first.
    pub const ALL: [Self; 3] = [Self::Fast, Self::Default, Self::Best];

    /// How many scenes it is meant to learn from.
    pub fn scenes(self) -> usize {
        match self {
            Self::Fast => 4000,
            Self::Default => 120_000,
            Self::Best => 240_000,
        }
    }

    /// The training. It learns from scenes that stream by, of which it should see independent,
    /// damaged ones, as many as [`scenes`](Self::scenes) says.
    pub fn training(self) -> Training {
        let regression = |width, penalties: &[f64]| NystromRidge {
            bandwidth: Bandwidth::Relative(width),
            deviation: PredictiveDeviation::Gcv,
            regularisation: NystromRegularisation::Gcv(penalties.to_vec()),
        };
        let regressor = match self {
            Self::Fast => RegressorConfig::LearntMetric(LearntMetric {
                pilot: 2000,
                components: 120,
                metric: ExpectedGradientOuterProduct {
                    regression: regression(1.0, &[0.01, 0.03, 0.1, 0.3]),
                    rounds: 1,
                    centres: 800,
                    gradients: 300,
                    rank: 32,
                },
                centres: 800,
                regression: regression(1.0, &[1e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1]),
            }),
            Self::Default => network(512, 14),
            Self::Best => network(768, 16),
        };
        Training {
            orientation: OrientationRule::default(),
            framing: Framing::default(),
            vocabulary: CodebookTrainer {
                centres: 48,
                clustering: KMeans { restarts: 1, ..KMeans::default() },
                ..CodebookTrainer::default()
            },
            encoding: Encoding::Vlad,
            regressor,
            answers_from: Cameras::default(),
        }
    }
}

/// A network on principal components, three layers so wide and one after them. In the same time, more
/// scenes teach it more than looking at each of them more often; and where so many differ, little
/// need be left out.
fn network(width: usize, epochs: usize) -> RegressorConfig {
    let perceptron =
        MlpTrainer { hidden: vec![width; 3], epochs, dropout: 0.05, ..MlpTrainer::default() };
    RegressorConfig::Network(NetworkTraining { pilot: 4000, components: 120, perceptron })
}
