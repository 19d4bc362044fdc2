//! What the paper prints in its Table 1, as far as it is legible.

use phalanx_hand::Dof;
use serde::Serialize;

/// One row of the paper's table; `None` where a figure cannot be read.
#[derive(Clone, Copy, Serialize)]
pub(crate) struct PaperRow {
    pub(crate) mae_deg: Option<f64>,
    pub(crate) std_deg: Option<f64>,
    pub(crate) worst_deg: Option<f64>,
    pub(crate) worst_dof: &'static str,
    /// The fields whose figure stands for three cells, so that its place in this row is a guess.
    pub(crate) guessed: &'static [&'static str],
}

/// The paper's row for a number of views, a data set and `lin`, `gauss` or `both`.
pub(crate) fn row(views: usize, data_set: &str, kernels: &str) -> Option<PaperRow> {
    let row = |mae_deg, std_deg, worst_deg, worst_dof: Dof, guessed| {
        Some(PaperRow { mae_deg, std_deg, worst_deg, worst_dof: worst_dof.name(), guessed })
    };
    let all: &[&str] = &["mae_deg", "std_deg", "worst_deg"];
    let (theta_z, thumb_ip, middle_dip) = (Dof::ThetaZ, Dof::ThumbIp, Dof::MiddleDip);
    match (views, data_set, kernels) {
        (1, "open-close", "lin") => {
            row(None, Some(4.3), Some(14.5), theta_z, &["std_deg", "worst_deg"])
        }
        (1, "open-close", "gauss") => row(None, None, None, thumb_ip, &[]),
        (1, "open-close", "both") => row(Some(2.3), Some(2.0), Some(6.0), theta_z, all),
        (1, "complex", "lin" | "gauss") => row(None, None, None, middle_dip, &[]),
        (1, "complex", "both") => row(Some(2.9), Some(2.5), Some(9.9), middle_dip, all),
        (3, "open-close", "lin") => row(Some(5.4), None, Some(17.0), thumb_ip, &[]),
        (3, "open-close", "gauss") => row(Some(3.6), Some(2.7), Some(14.9), thumb_ip, &["std_deg"]),
        (3, "open-close", "both") => row(Some(1.6), None, Some(7.0), thumb_ip, &[]),
        (3, "complex", "lin" | "both") => {
            let mae = if kernels == "lin" { 2.5 } else { 2.4 };
            row(Some(mae), None, None, middle_dip, &[])
        }
        (3, "complex", "gauss") => {
            row(Some(2.4), Some(2.0), Some(8.3), middle_dip, &["std_deg", "worst_deg"])
        }
        _ => None,
    }
}
