//! Projection and unprojection of one point, with and without a lens.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use glam::DVec3;
use phalanx_camera::{Camera, Distortion, Fisheye, Intrinsics, Lens};

fn bench(c: &mut Criterion) {
    let plain = Intrinsics::pinhole(640, 480, 600.0);
    let lens = Distortion { k1: -0.2, k2: 0.05, p1: 1e-3, p2: -1e-3, ..Distortion::NONE };
    let fisheye = Fisheye { k1: -0.02, ..Fisheye::default() };
    for (name, lens) in
        [("pinhole", Lens::PERFECT), ("lens", lens.into()), ("fisheye", fisheye.into())]
    {
        let intrinsics = Intrinsics { lens, ..plain };
        let position = DVec3::new(0.0, 700.0, 0.0);
        let camera = Camera::look_at(name, intrinsics, position, DVec3::ZERO, DVec3::X)
            .expect("a valid camera");
        let point = DVec3::new(30.0, 20.0, 80.0);
        let pixel = camera.project(point).expect("in front");
        c.bench_function(&format!("project/{name}"), |b| {
            b.iter(|| camera.project(black_box(point)));
        });
        c.bench_function(&format!("unproject/{name}"), |b| {
            b.iter(|| camera.unproject(black_box(pixel)));
        });
    }
}

criterion_group!(benches, bench);
criterion_main!(benches);
