//! Scenes that hold every kind of event.

use crate::engine::io::scene_file;
use crate::engine::scene::Scene;

pub(super) const GLASS: f32 = 1.5;

/// A scene of every kind of material; `rest` is its TOML without them.
pub(super) fn scene(rest: &str) -> Scene {
    let text = format!(
        r#"
        {rest}
        [materials]
        white = {{ type = "diffuse", reflectance = [0.9, 0.8, 0.7] }}
        glass = {{ type = "dielectric", ior = {GLASS} }}
        coat = {{ type = "plastic", diffuse_reflectance = [0.7, 0.2, 0.2], ior = 1.5 }}
        metal = {{ type = "ggx_conductor", specular_reflectance = [0.9, 0.9, 0.9], alpha = 0.2 }}
        frost = {{ type = "rough_dielectric", ior = 1.5, alpha = 0.3 }}
        satin = {{ type = "mix", materials = ["white", "metal"], weight = 0.5 }}
        "#
    );
    let desc = scene_file::from_toml(&text, "test.toml").unwrap_or_else(|e| panic!("{e}"));
    Scene::build(&desc).unwrap_or_else(|e| panic!("{e}"))
}

/// Every kind of event, in a room or in the open, under a lamp (a sphere) and other lights.
pub(super) fn things(room: &str, lamp: &str, lights: &str, lens: &str) -> Scene {
    scene(&format!(
        r#"
        camera = {{ position = [0, 0.3, 3.5], target = [0, 0, 0], vfov_deg = 50, width = 32, height = 24 {lens} }}
        spheres = [
            {room} {lamp}
            {{ center = [0, -4, 0], radius = 3, material = "white" }},
            {{ center = [-1.1, 0, 0], radius = 0.9, material = "glass" }},
            {{ center = [0.9, -0.3, 0.4], radius = 0.7, material = "coat" }},
            {{ center = [0.2, 0.7, -1.2], radius = 0.6, material = "satin" }},
            {{ center = [1.3, 1, -0.6], radius = 0.5, material = "frost" }},
            {{ center = [0.3, -0.7, 1.3], radius = 0.2, material = "metal" }},
        ]
        lights = [{lights}]
        "#
    ))
}

/// Two spheres that all but touch; eye and light look into the gap.
pub(super) fn slit(material: &str) -> Scene {
    scene(&format!(
        r#"
        camera = {{ position = [0, 0.3, 3.5], target = [0, 0, 0], vfov_deg = 0.05, width = 32, height = 24 }}
        spheres = [
            {{ center = [-1.00001, 0, 0], radius = 1, material = "white" }},
            {{ center = [1.00001, 0, 0], radius = 1, material = "{material}" }},
        ]
        lights = [{{ type = "spot", position = [0, -0.3, 3], direction = [0, 0.1, -1], intensity = [5, 5, 5], angle_deg = 0.02 }}]
        "#
    ))
}
