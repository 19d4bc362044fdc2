//! One frame of three views, refined; the tests' targets are for the whole road from masks to a pose.

use criterion::{Criterion, criterion_group, criterion_main};
use phalanx_camera::Rig;
use phalanx_hand::{Dof, HandShape, Pose};
use phalanx_refine::{PoseFitSettings, PosePrior, SilhouetteObservation};
use phalanx_render::Renderer;
use phalanx_segmentation::Mask;
use std::hint::black_box;

fn refinement(c: &mut Criterion) {
    let rig = Rig::from_toml(include_str!("../fixtures/desk.toml")).unwrap();
    let (hand, rest) = (HandShape::adult(), rig.volume.rest_frame());
    let mut truth = Pose::REST;
    let mut deviations = [0.0; Dof::COUNT];
    for (k, dof) in Dof::ALL.into_iter().filter(|dof| dof.is_internal()).enumerate() {
        truth[dof] = 0.15 * (k % 4) as f64;
        deviations[dof.index()] = 0.2;
    }
    let primitives = hand.pose(&truth, &rest).primitives;
    let masks: Vec<_> = rig
        .cameras
        .iter()
        .map(|camera| Mask::from(Renderer::new(camera).unwrap().silhouette(&primitives).unwrap()))
        .collect();
    let see = || -> Vec<SilhouetteObservation> {
        rig.cameras
            .iter()
            .zip(&masks)
            .map(|(c, mask)| SilhouetteObservation::new(c, mask).unwrap())
            .collect()
    };
    let mut start = truth;
    for (k, dof) in Dof::ALL.into_iter().filter(|dof| dof.is_internal()).enumerate() {
        start[dof] += 0.1 * ((k % 3) as f64 - 1.0);
    }
    let prior = PosePrior::independent(start, &deviations).unwrap();
    let evidence = see();
    let refinement = PoseFitSettings::default();
    c.bench_function("evidence of three 120x90 silhouettes", |b| b.iter(see));
    c.bench_function("refine three 120x90 silhouettes", |b| {
        b.iter(|| refinement.fit(&hand, &rest, black_box(&evidence), &start, &prior).unwrap());
    });
}

criterion_group!(benches, refinement);
criterion_main!(benches);
