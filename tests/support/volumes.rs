//! Scenes with participating media.

use std::sync::Arc;

use lightscope::engine::io::image;
use lightscope::engine::scene::Scene;

use super::agreement::{Blocks, compare, mean};
use super::reference::{layer_blocks, runs, whole_mean};
use super::render::{load, reference_dir};

/// What fills [`smoky_room`], if not a grid.
pub const HOMOGENEOUS: &str = r#"type = "homogeneous", sigma_t = [0.3, 0.9, 1.5]"#;

/// A room of coloured smoke with glass, lit by a small lamp and a sphere.
pub fn smoky_room(medium: &str) -> Arc<Scene> {
    let folder = tempfile::tempdir().expect("a folder");
    let constant = format!("2 3 4\n{}", "1.5 ".repeat(24));
    std::fs::write(folder.path().join("constant.txt"), constant).expect("written");
    let path = folder.path().join("scene.toml");
    let text = format!(
        r#"
        camera = {{ position = [0, 0.3, 3.5], target = [0, 0, 0], vfov_deg = 50, width = 24, height = 16 }}
        materials.black = {{ type = "diffuse", reflectance = 0 }}
        materials.white = {{ type = "diffuse", reflectance = [0.7, 0.6, 0.5] }}
        materials.glass = {{ type = "dielectric", ior = 1.5 }}
        materials.metal = {{ type = "ggx_conductor", specular_reflectance = 0.9, alpha = 0.3 }}
        spheres = [
            {{ center = [0, 0, 0], radius = 4, material = "white", inward = true }},
            {{ center = [0.5, 1.9, 0.5], radius = 0.4, material = "black", emission = [9, 8, 7] }},
            {{ center = [-1.1, 0, 0], radius = 0.7, material = "glass", interior = "vacuum", priority = 1 }},
            {{ center = [1, -0.3, 0.4], radius = 0.6, material = "metal" }},
        ]
        medium = {{ {medium}, albedo = [0.95, 0.8, 0.5], phase = {{ type = "hg", g = 0.4 }},
                   region = {{ min = [-1.6, -1.4, -1.5], max = [1.5, 1.3, 1.2] }} }}
        "#
    );
    std::fs::write(&path, text).expect("written");
    load(&path)
}

/// The whole of a reference scene with media; its components are not known there.
pub fn agrees_with_reference(scene: &str, integrator: &str, set: &[(&str, &str)], passes: u64) {
    let read = |name: &str| {
        let path = reference_dir(scene).join(name);
        image::read(&path, image::Encoding::Linear).unwrap_or_else(|e| panic!("{e}"))
    };
    let (pixels, se) = (read("ref.exr"), read("ref_se.exr"));
    let (frames, width) = runs(scene, integrator, set, passes);
    let reference = Blocks::from_reference(&pixels.pixels, &se.pixels, width);
    let whole = mean(&pixels.pixels);
    let verdict = compare(
        "whole",
        &layer_blocks(&frames, 0, width),
        &reference,
        whole,
        1,
    );
    println!(
        "{scene} {integrator} {set:?}: {} against {whole}, worst block {:.1} standard errors, would \
         catch {:.2} %, {:.2} % in a block",
        whole_mean(&frames),
        verdict.worst,
        100.0 * verdict.sensitivity,
        100.0 * verdict.block_sensitivity
    );
    let complaints = verdict.complaints;
    assert!(
        complaints.is_empty(),
        "{scene} {integrator}: {complaints:#?}"
    );
    assert!(verdict.sensitivity <= 0.011, "{scene}: too noisy to tell");
}
