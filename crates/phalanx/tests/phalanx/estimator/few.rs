//! The presets with few of everything, so that they are learnt in no time.

use phalanx::{LearntMetric, NetworkTraining, Preset, RegressorConfig, Training};
use phalanx_rvm::MlpTrainer;

/// The fast preset, of so many kernels.
pub(crate) fn kernels(kernels: usize, words: usize) -> Training {
    let preset = Preset::Fast.training();
    let RegressorConfig::LearntMetric(learnt) = preset.regressor else {
        unreachable!("it learns distances")
    };
    let mut metric = learnt.metric;
    (metric.centres, metric.gradients, metric.rank) = (kernels, 30, 6);
    let regressor = RegressorConfig::LearntMetric(LearntMetric {
        components: 20,
        centres: kernels,
        metric,
        ..learnt
    });
    with_words(words, Training { regressor, ..preset })
}

/// The default preset, learnt in so many rounds.
pub(crate) fn network(epochs: usize, words: usize) -> Training {
    let preset = Preset::Default.training();
    let RegressorConfig::Network(network) = preset.regressor else {
        unreachable!("it is a network")
    };
    let perceptron =
        MlpTrainer { hidden: vec![32; 3], epochs, batch: 16, dropout: 0.0, ..network.perceptron };
    let regressor =
        RegressorConfig::Network(NetworkTraining { components: 20, perceptron, ..network });
    with_words(words, Training { regressor, ..preset })
}

fn with_words(words: usize, training: Training) -> Training {
    let mut vocabulary = training.vocabulary;
    (vocabulary.centres, vocabulary.most_samples) = (words, 2000);
    Training { vocabulary, ..training }
}
