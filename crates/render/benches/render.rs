//! The adult hand in the desk's three cameras, 120×90, on one thread.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use image::GrayImage;
use phalanx_camera::{Camera, Distortion, Intrinsics, Lens, Rig};
use phalanx_hand::{HandShape, Pose, Primitive};
use phalanx_render::{Appearance, Renderer, Supersampling};

fn hand(rig: &Rig) -> Vec<Primitive> {
    HandShape::adult().pose(&Pose::REST, &rig.volume.rest_frame()).primitives
}

fn renderers(rig: &Rig, lens: Lens) -> Vec<Renderer> {
    let with = |camera: &Camera| camera.with_intrinsics(Intrinsics { lens, ..camera.intrinsics });
    rig.cameras.iter().map(|c| Renderer::new(&with(c)).expect("a valid camera")).collect()
}

fn bench(c: &mut Criterion) {
    let rig = Rig::from_toml(include_str!("../fixtures/desk.toml")).expect("valid");
    let hand = hand(&rig);
    let barrel = Distortion { k1: -0.2, ..Distortion::NONE };
    for (name, lens) in [("pinhole", Lens::PERFECT), ("lens", barrel.into())] {
        let mut views = renderers(&rig, lens);
        let mut image = GrayImage::default();
        c.bench_function(&format!("three silhouettes/{name}"), |b| {
            b.iter(|| {
                for view in &mut views {
                    view.silhouette_into(black_box(&hand), &mut image).expect("in front");
                }
            });
        });
        let top = &mut views[1];
        c.bench_function(&format!("coverage, 4×4 samples/{name}"), |b| {
            b.iter(|| top.coverage_into(black_box(&hand), Supersampling::X4, &mut image));
        });
        c.bench_function(&format!("depth/{name}"), |b| b.iter(|| top.depth(black_box(&hand))));
        let look = Appearance::default();
        c.bench_function(&format!("shaded, 2×2 samples/{name}"), |b| {
            b.iter(|| top.shade(black_box(&hand), &look, 1));
        });
    }
}

criterion_group!(benches, bench);
criterion_main!(benches);
