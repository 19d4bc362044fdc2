//! The estimator of the README's library example is as good as the README says.

use phalanx::{NoProgress, Picture, Preset, Trainer, Workspace, draw_silhouette};
use phalanx_camera::Rig;
use phalanx_hand::{Dof, HandShape, Pose, PoseTable};

/// What the README's table says of estimates through three views, degrees. The table is of ten takes of
/// the motion whose first take is tested here; a tenth more is within what takes differ.
const FIGURE_DEG: f64 = 4.3;
const MOST_DEG: f64 = 1.1 * FIGURE_DEG;

fn unseen() -> Vec<Pose> {
    let take = PoseTable::read(&include_bytes!("../../fixtures/complex.csv")[..]).unwrap().poses;
    let turned = |(number, mut pose): (usize, Pose)| {
        pose[Dof::ThetaZ] = (15.0 * (number % 7) as f64).to_radians();
        pose
    };
    take.into_iter().enumerate().map(turned).collect()
}

#[test]
#[ignore = "trains the default preset, which takes minutes; .ci/run does it"]
fn the_default_preset_estimates_unseen_motion_as_the_readme_says() {
    let rig = Rig::from_toml(include_str!("../../fixtures/desk.toml")).unwrap();
    let hand = HandShape::adult();
    let estimator = Trainer::preset(Preset::Default).fit(&rig, &hand, &NoProgress).unwrap();
    assert!(estimator.error_model().is_some());

    let active: Vec<Dof> =
        Dof::ALL.into_iter().filter(|dof| dof.is_internal() || *dof == Dof::ThetaZ).collect();
    let rest = rig.volume.rest_frame();
    let mut workspace = Workspace::default();
    let mut errors = Vec::new();
    for pose in unseen() {
        let draw = |camera| draw_silhouette(camera, &hand, &pose, &rest).unwrap();
        let masks: Vec<_> = rig.cameras.iter().map(draw).collect();
        let pictures: Vec<_> = masks.iter().map(Picture::Mask).collect();
        let estimate = estimator.estimate(&pictures, &mut workspace).unwrap();
        errors
            .extend(active.iter().map(|&dof| (estimate.pose[dof] - pose[dof]).abs().to_degrees()));
    }
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    eprintln!("{mean:.2}° over {} angles of {} poses", active.len(), errors.len() / active.len());
    assert!(mean < MOST_DEG, "{mean:.2}° where the README says {FIGURE_DEG}°");
}
