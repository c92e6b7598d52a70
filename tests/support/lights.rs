//! Lights of every kind, and the geometry that their surfaces stand in.

use std::sync::Arc;

use glam::{Quat, Vec3, Vec3A};
use lightscope::engine::geometry::{Geometry, MeshInput, SphereInput};
use lightscope::engine::light::{Emitter, Lights, Silhouette};
use lightscope::engine::math::Rgb;
use lightscope::engine::scene::desc::{ImageData, LightDesc};

pub const RADIANCE: Rgb = Rgb::new(3.0, 2.0, 1.0);

/// Geometry and lights of one kind of emitter.
pub struct Lit {
    pub geometry: Geometry,
    pub lights: Lights,
}

fn lit(meshes: &[MeshInput<'_>], spheres: &[SphereInput], descs: &[LightDesc]) -> Lit {
    let (mut geometry, _) = Geometry::build(meshes, spheres);
    let emitters: Vec<Emitter> = (0..geometry.primitive_count() as u32)
        .map(|prim| Emitter {
            prim,
            radiance: RADIANCE,
        })
        .collect();
    let lights = Lights::build(descs, &emitters, &geometry, Silhouette::of_box(&geometry)).unwrap();
    geometry.set_lights(|prim| lights.of_primitive(prim));
    Lit { geometry, lights }
}

/// Emitting triangles over the given corners.
pub fn mesh(positions: &[Vec3], triangles: &[[u32; 3]]) -> Lit {
    let mesh = MeshInput {
        positions,
        normals: &[],
        uvs: &[],
        triangles,
        material: 0,
    };
    lit(&[mesh], &[], &[])
}

/// One emitting sphere.
pub fn sphere(center: Vec3, radius: f32, inward: bool) -> Lit {
    let sphere = SphereInput {
        center,
        radius,
        inward,
        material: 0,
    };
    lit(&[], &[sphere], &[])
}

/// A light without surface.
pub fn other(desc: LightDesc) -> Lit {
    lit(&[], &[], &[desc])
}

/// An environment image of 12 × 7 texels: black ones, a bright one, one at a pole.
pub fn image() -> Arc<ImageData> {
    let mut pixels: Vec<[f32; 3]> = (0..84)
        .map(|i| [(i % 5) as f32, (i * i % 7) as f32, (i % 3) as f32])
        .collect();
    pixels[40] = [300.0, 200.0, 100.0];
    pixels[4] = [50.0; 3];
    pixels[14..17].fill([0.0; 3]);
    Arc::new(ImageData {
        name: "test".into(),
        width: 12,
        height: 7,
        pixels,
    })
}

/// One light of every kind, near the origin, all of which a point at (0, 0, 2) can see.
pub fn every_kind() -> Vec<(&'static str, Lit)> {
    let corners = [
        Vec3::new(-0.5, -0.4, 0.0),
        Vec3::new(0.6, -0.5, 0.1),
        Vec3::new(0.3, 0.5, -0.1),
    ];
    let square = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
    let position = Vec3::new(0.3, -0.1, 0.0);
    let direction = Vec3::new(-0.05, 0.1, 2.0);
    vec![
        ("triangle", mesh(&corners, &[[0, 1, 2]])),
        ("quad", mesh(&square, &[[0, 1, 2], [0, 2, 3]])),
        ("sphere", sphere(Vec3::new(0.1, 0.2, 0.0), 0.5, false)),
        ("inward", sphere(Vec3::new(0.1, 0.2, 1.0), 3.0, true)),
        (
            "point",
            other(LightDesc::Point {
                position,
                intensity: RADIANCE,
            }),
        ),
        (
            "spot",
            other(LightDesc::Spot {
                position,
                direction,
                intensity: RADIANCE,
                angle_deg: 40.0,
                falloff_deg: 25.0,
            }),
        ),
        (
            "directional",
            other(LightDesc::Directional {
                direction,
                irradiance: RADIANCE,
            }),
        ),
        (
            "constant",
            other(LightDesc::Constant { radiance: RADIANCE }),
        ),
        (
            "environment",
            other(LightDesc::Environment {
                image: image(),
                scale: Rgb::new(1.0, 0.5, 2.0),
                rotation: Quat::from_rotation_y(0.7),
            }),
        ),
    ]
}

/// A point that sees all of [`every_kind`].
pub const VIEW: Vec3A = Vec3A::new(0.0, 0.0, 2.0);
