//! How likely fits are beside each other.

use phalanx_hand::Dof;
use phalanx_refine::PoseFit;

/// How many times too much an energy says of how likely a pose is: places of a border that are beside
/// each other err together.
const OVERSTATED: f64 = 3.0;

/// How likely a pose is beside one of so much less energy.
pub(crate) fn chance(more: f64) -> f64 {
    (-more / OVERSTATED).exp()
}

/// The mean squared distance of each number from a fit's, over that and some other fits, weighted by how well each
/// explains the silhouettes.
pub(crate) fn variance_by_others(best: &PoseFit, others: &[PoseFit]) -> [f64; Dof::COUNT] {
    let chance = |other: &PoseFit| chance((other.energy - best.energy).max(0.0));
    let chances: Vec<f64> = others.iter().map(chance).collect();
    let all = 1.0 + chances.iter().sum::<f64>();
    Dof::ALL.map(|dof| {
        let apart = others.iter().map(|other| (other.pose[dof] - best.pose[dof]).powi(2));
        apart.zip(&chances).map(|(apart, chance)| chance * apart).sum::<f64>() / all
    })
}

#[cfg(test)]
mod tests {
    use phalanx_hand::Pose;

    use super::*;

    fn fit(angle: f64, energy: f64) -> PoseFit {
        let mut pose = Pose::REST;
        pose[Dof::IndexPip] = angle;
        PoseFit {
            pose,
            energy,
            covariance: Vec::new(),
            ious: Vec::new(),
            unexplained: Vec::new(),
            landmarks_unexplained: Vec::new(),
            boundary_rms_px: 0.0,
            nuisance: None,
            converged: true,
            steps: 0,
        }
    }

    /// One that explains as much counts half, and so does one that explains more, since the first is the one to be
    /// believed; what explains much less does not count.
    #[test]
    fn other_fits_count_as_they_explain() {
        let best = fit(0.2, 10.0);
        for (energy, least, most) in [(10.0, 0.499, 0.501), (2.0, 0.499, 0.501), (80.0, 0.0, 1e-9)]
        {
            let variances = variance_by_others(&best, &[fit(1.2, energy)]);
            let variance = variances[Dof::IndexPip.index()];
            assert!((least..=most).contains(&variance), "{energy}: {variance}");
            assert_eq!(variances[Dof::RingPip.index()], 0.0);
        }
        assert_eq!(variance_by_others(&best, &[]), [0.0; Dof::COUNT]);
    }
}
