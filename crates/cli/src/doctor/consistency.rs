//! A rig, a model, and whether they are of the same cameras.

use phalanx::Estimator;
use phalanx_camera::{Camera, Rig};

use crate::finding::Finding;
use crate::rig::check::is_alike;

pub(super) fn of_rig(rig: &Rig) -> Vec<Finding> {
    let scales = match rig.view_scales() {
        Ok(scales) => scales,
        Err(error) => return vec![Finding::broken("rig", error.to_string())],
    };
    let sizes = scales.iter().map(|scale| {
        format!("{} sees a hand of 190 mm {:.0} px long", scale.camera, scale.hand_px())
    });
    let mut findings = vec![Finding::good("rig", sizes.collect::<Vec<_>>().join(", "))];
    if rig.cameras.len() == 1 {
        findings.push(Finding::doubtful(
            "rig",
            "one camera leaves open how far away the hand is, and what fingers behind the outline do",
        ));
    }
    let alike = rig.view_angles().into_iter().filter(is_alike).map(|pair| {
        let (first, second) = (pair.first, pair.second);
        Finding::doubtful("rig", format!("{first} and {second} look from nearly the same side"))
    });
    findings.extend(alike);
    findings
}

pub(super) fn of_model(model: &Estimator) -> Finding {
    let cameras = &model.rig().cameras;
    let names: Vec<&str> = cameras.iter().map(|camera| camera.name.as_str()).collect();
    Finding::good("model", format!("for the cameras {}", names.join(", ")))
}

/// The model's cameras against the rig's of the same names.
pub(super) fn between(rig: &Rig, model: &Estimator) -> Vec<Finding> {
    model.rig().cameras.iter().map(|trained| compared(rig, trained)).collect()
}

fn compared(rig: &Rig, trained: &Camera) -> Finding {
    let what = format!("camera '{}'", trained.name);
    let again = "train again for this rig";
    let Some(camera) = rig.cameras.iter().find(|camera| camera.name == trained.name) else {
        return Finding::broken(what, format!("the model knows it, the rig does not; {again}"));
    };
    let sizes = [camera, trained].map(|it| (it.intrinsics.width, it.intrinsics.height));
    if sizes[0] != sizes[1] {
        let [own, other] = sizes.map(|(width, height)| format!("{width}×{height}"));
        let text = format!("pictures of {own} px in the rig, {other} px in the model; {again}");
        return Finding::broken(what, text);
    }
    let apart = camera.centre().distance(trained.centre());
    if camera.extrinsics != trained.extrinsics {
        let text = format!("it stands or looks elsewhere ({apart:.1} mm apart); {again}");
        return Finding::broken(what, text);
    }
    if camera.intrinsics != trained.intrinsics {
        return Finding::broken(what, format!("its lens is another in the model; {again}"));
    }
    Finding::good(what, "the same in the rig and the model")
}
