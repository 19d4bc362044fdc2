//! The steps from a photograph to a silhouette.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use image::{Rgb, RgbImage};
use phalanx_segmentation::{
    Cleanup, Contour, Mask, PlainBackground, Silhouette, SkinModel, Workspace, clean_into,
    downsample,
};

/// A hand-like scene: a palm with four fingers and a forearm that leaves below, and speckle.
fn scene(width: u32, height: u32) -> RgbImage {
    RgbImage::from_fn(width, height, |x, y| {
        let [u, v] = [f64::from(x) / f64::from(width), f64::from(y) / f64::from(height)];
        let palm = (u - 0.5).powi(2) / 0.02 + (v - 0.55).powi(2) / 0.03 < 1.0;
        let fingers =
            (0.36..0.64).contains(&u) && (u - 0.36) % 0.08 < 0.04 && (0.1..0.5).contains(&v);
        let forearm = (u - 0.5).abs() < 0.09 && v > 0.6;
        let speckle = (x * 7919 + y * 104_729) % 97 == 0;
        Rgb(if (palm || fingers || forearm) ^ speckle { [205, 150, 125] } else { [150, 155, 165] })
    })
}

fn steps(criterion: &mut Criterion) {
    let photograph = scene(640, 480);
    let small = scene(120, 90);
    let model = SkinModel::builtin();
    let mut raw = Mask::default();
    model.classify_into(&small, &mut raw);
    let (cleanup, mut workspace) = (Cleanup::default(), Workspace::default());
    let mut cleaned = Mask::default();
    clean_into(&raw, &cleanup, &mut workspace, &mut cleaned).expect("there is a hand");
    let mut silhouette = Silhouette::default();

    criterion.bench_function("downsample 640x480 to 120x90", |b| {
        b.iter(|| downsample(black_box(&photograph), 120, 90));
    });
    criterion.bench_function("skin 120x90", |b| {
        b.iter(|| model.classify_into(black_box(&small), &mut raw));
    });
    criterion.bench_function("bright wall 120x90", |b| {
        b.iter(|| PlainBackground::Bright.segment(black_box(&small)));
    });
    criterion.bench_function("clean 120x90", |b| {
        b.iter(|| clean_into(black_box(&raw), &cleanup, &mut workspace, &mut cleaned));
    });
    criterion.bench_function("contour 120x90", |b| b.iter(|| Contour::trace(black_box(&cleaned))));
    criterion.bench_function("silhouette of a clean mask 120x90", |b| {
        b.iter(|| silhouette.extract_into(black_box(&cleaned), &mut workspace));
    });
    criterion.bench_function("colour to silhouette 120x90", |b| {
        b.iter(|| {
            model.classify_into(black_box(&small), &mut raw);
            clean_into(&raw, &cleanup, &mut workspace, &mut cleaned)?;
            silhouette.extract_into(&cleaned, &mut workspace)
        });
    });
}

criterion_group!(benches, steps);
criterion_main!(benches);
