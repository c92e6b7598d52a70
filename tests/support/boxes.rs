//! Small scenes built by hand.
#![allow(dead_code, reason = "each test binary uses a part of it")]

use std::sync::Arc;

use lightscope::engine::scene::Scene;
use lightscope::engine::scene::desc::{LightDesc, MeshDesc, NamedMaterial, SceneDesc, SphereDesc};
#[allow(unused_imports, reason = "each test binary uses a part of it")]
pub use lightscope::engine::stability::scenes::{
    diffuse, glass, mirror, point_light, quad, sphere,
};

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
