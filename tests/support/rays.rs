//! Random rays and simple meshes for the geometry tests.

use glam::{Vec2, Vec3, Vec3A};
use lightscope::engine::geometry::{DropReport, Geometry, MeshInput};
use lightscope::engine::sampling::independent::IndependentSampler;
use lightscope::engine::sampling::sampler::{Sampler, Stream};
use lightscope::engine::sampling::warp::sample_sphere;

/// Random numbers of one test.
pub fn sampler(index: u64) -> IndependentSampler {
    IndependentSampler::new(1, Stream::Test, (index, 0))
}

/// A direction, uniform over the sphere.
pub fn direction(s: &mut impl Sampler) -> Vec3A {
    sample_sphere(s.next_2d())
}

/// A point of the box [−1, 1]³.
pub fn point(s: &mut impl Sampler) -> Vec3 {
    let Vec2 { x, y } = s.next_2d();
    2.0 * Vec3::new(x, y, s.next_1d()) - Vec3::ONE
}

/// Geometry of one mesh.
pub fn build(positions: &[Vec3], triangles: &[[u32; 3]]) -> (Geometry, DropReport) {
    let mesh = MeshInput {
        positions,
        triangles,
        ..MeshInput::default()
    };
    Geometry::build(&[mesh], &[])
}

const BOX: [[u32; 4]; 6] = [
    [0, 1, 3, 2],
    [4, 6, 7, 5],
    [0, 4, 5, 1],
    [2, 3, 7, 6],
    [0, 2, 6, 4],
    [1, 5, 7, 3],
];

/// The box [−1, 1]³ scaled and moved.
pub fn cube(scale: f32, center: Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let sign = |bit: u32| if bit == 0 { -1.0 } else { 1.0 };
    let positions = (0..8_u32)
        .map(|i| center + scale * Vec3::new(sign(i & 4), sign(i & 2), sign(i & 1)))
        .collect();
    let triangles = BOX
        .iter()
        .flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]])
        .collect();
    (positions, triangles)
}
