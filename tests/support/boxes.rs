//! Small scenes built by hand.
#![allow(dead_code, reason = "each test binary uses a part of it")]

use std::sync::Arc;

use glam::Vec3;
use lightscope::engine::math::Rgb;
use lightscope::engine::scene::Scene;
use lightscope::engine::scene::desc::{
    ColorDesc, LightDesc, MaterialDesc, MeshDesc, NamedMaterial, SceneDesc, SphereDesc,
};

pub fn diffuse(name: &str, reflectance: f32) -> NamedMaterial {
    NamedMaterial {
        name: name.into(),
        material: MaterialDesc::Diffuse {
            reflectance: ColorDesc::Constant(Rgb::splat(reflectance)),
        },
        opacity: None,
    }
}

pub fn mirror(name: &str, reflectance: f32) -> NamedMaterial {
    NamedMaterial {
        name: name.into(),
        material: MaterialDesc::Mirror {
            reflectance: ColorDesc::Constant(Rgb::splat(reflectance)),
        },
        opacity: None,
    }
}

pub fn glass(name: &str, ior: f32) -> NamedMaterial {
    NamedMaterial {
        name: name.into(),
        material: MaterialDesc::Dielectric {
            ior,
            transmittance: Rgb::WHITE,
        },
        opacity: None,
    }
}

/// A parallelogram from `corner` along `a` and `b`; its front is the side of a × b.
pub fn quad(material: usize, corner: Vec3, a: Vec3, b: Vec3) -> MeshDesc {
    MeshDesc {
        name: "quad".into(),
        positions: vec![corner, corner + a, corner + a + b, corner + b],
        normals: Vec::new(),
        uvs: Vec::new(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        material,
        emission: None,
        transform: None,
    }
}

pub fn sphere(material: usize, center: Vec3, radius: f32, inward: bool) -> SphereDesc {
    SphereDesc {
        name: "sphere".into(),
        center,
        radius,
        material,
        emission: None,
        inward,
    }
}

pub fn point_light(position: Vec3, intensity: f32) -> LightDesc {
    LightDesc::Point {
        position,
        intensity: Rgb::splat(intensity),
    }
}

pub fn scene(
    materials: Vec<NamedMaterial>,
    meshes: Vec<MeshDesc>,
    spheres: Vec<SphereDesc>,
    lights: Vec<LightDesc>,
) -> Arc<Scene> {
    let desc = SceneDesc {
        name: "by-hand".into(),
        description: "built by a test".into(),
        camera: Default::default(),
        materials,
        meshes,
        spheres,
        lights,
        ..SceneDesc::default()
    };
    Arc::new(Scene::build(&desc).unwrap_or_else(|e| panic!("{e}")))
}
