//! From the 28 numbers of a pose to the 21 joints and the solids.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use glam::DAffine3;
use phalanx_hand::{Dof, HandShape, Pose};

fn kinematics(c: &mut Criterion) {
    let shape = HandShape::adult();
    let bent = Pose(Dof::ALL.map(|dof| 0.4 * dof.range().1));
    c.bench_function("joints and solids of a pose", |b| {
        b.iter(|| shape.pose(black_box(&bent), &DAffine3::IDENTITY));
    });
}

criterion_group!(benches, kinematics);
criterion_main!(benches);
