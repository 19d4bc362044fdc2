//! The shape contexts of one silhouette of 300 points, on one thread, in each orientation.

#[path = "../tests/shape-context/star.rs"]
mod star;

use criterion::{Criterion, criterion_group, criterion_main};
use phalanx_shape_context::{Chain, Orientation, ShapeContexts, mean_distance};

fn contexts(c: &mut Criterion) {
    let mut points = star::star([60.0, 45.0], 20.0, &star::HAND);
    assert!(points.len() >= 300, "{}", points.len());
    points.truncate(300);
    let mut group = c.benchmark_group("300 points");
    group.bench_function("mean distance", |b| b.iter(|| mean_distance(&points)));
    let mut contexts = ShapeContexts::new();
    for (name, orientation) in [
        ("image axes", Orientation::ImageAxes),
        ("tangent", Orientation::Tangent { chain: Chain::Open }),
        ("centroid", Orientation::Centroid),
        ("principal axis", Orientation::PrincipalAxis),
        ("hand axis", Orientation::HandAxis { forearm_end: [60.0, 89.0] }),
    ] {
        group.bench_function(name, |b| {
            b.iter(|| contexts.compute(&points, orientation).expect("a good contour").values()[0]);
        });
    }
}

criterion_group!(benches, contexts);
criterion_main!(benches);
