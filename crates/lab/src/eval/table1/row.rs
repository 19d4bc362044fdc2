//! A row of Table 1.

use serde::Serialize;

use super::paper::PaperRow;

/// Every figure is the mean over this many random even splits.
pub(crate) const SPLITS: u64 = 5;

/// One row of the table.
#[derive(Serialize)]
pub(crate) struct Row {
    pub(crate) views: usize,
    pub(crate) data_set: String,
    pub(crate) kernels: &'static str,
    pub(crate) counts: &'static str,
    pub(crate) selected_features: usize,
    pub(crate) selected_samples: usize,
    pub(crate) train_samples: usize,
    pub(crate) test_samples: usize,
    pub(crate) mae_deg: f64,
    pub(crate) std_deg: f64,
    pub(crate) worst_deg: f64,
    pub(crate) worst_dof: &'static str,
    pub(crate) mean_predictor_mae_deg: f64,
    pub(crate) paper: Option<PaperRow>,
}
