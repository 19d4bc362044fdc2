//! What every road of a preset must do.

use phalanx::Estimator;
use phalanx_hand::Dof;

use super::desk::{difference_deg, estimate, masks, mean, top, unseen};

/// Poses between those learnt are estimated.
pub(crate) fn generalises(learnt: &Estimator) {
    let errors: Vec<f64> = unseen()
        .iter()
        .map(|pose| difference_deg(&estimate(learnt, &masks(&top(), pose)).unwrap().pose, pose))
        .collect();
    assert!(mean(errors.iter().copied()) < 3.0, "{errors:?}");
}

/// Every angle that varies has a deviation: of so few samples perhaps that of its training poses.
pub(crate) fn has_deviations(learnt: &Estimator) {
    let found = estimate(learnt, &masks(&top(), &unseen()[3])).unwrap();
    for dof in Dof::ALL.into_iter().filter(|dof| dof.is_internal()) {
        assert!(found.std[dof.index()].is_some_and(|std| std > 0.0 && std < 1.0), "{dof}");
    }
}

/// What is saved is loaded, and a cut payload refused.
pub(crate) fn survives_its_file(learnt: &Estimator) {
    let bytes = learnt.to_bytes().unwrap();
    assert_eq!(&Estimator::from_bytes(&bytes).unwrap(), learnt);
    for length in (0..bytes.len()).step_by(bytes.len() / 40) {
        assert!(Estimator::from_bytes(&bytes[..length]).is_err());
    }
}
