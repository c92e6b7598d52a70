//! `lightscope info`: what a scene or a picture holds.

use std::path::Path;

use glam::UVec2;
use serde::Serialize;

use super::args::InfoArgs;
use super::error::CliError;
use super::picture::{self, Format};
use super::{print, scene};
use crate::engine::integrators::REGISTRY;
use crate::engine::measure::metrics::channel_means;
use crate::engine::scene::SceneFeatures;
use crate::engine::session::{RenderJob, Renderer, Settings};

/// Runs the command.
pub fn run(args: &InfoArgs) -> Result<(), CliError> {
    if scene::is_embedded(&args.what) || Format::of(Path::new(&args.what)).is_none() {
        let info = scene_info(&args.what)?;
        return if args.json {
            print::json(&info)
        } else {
            print_scene(&info)
        };
    }
    let info = image_info(Path::new(&args.what))?;
    if args.json {
        print::json(&info)
    } else {
        print_image(&info)
    }
}

#[derive(Serialize)]
struct SceneInfo {
    name: String,
    description: String,
    size: [u32; 2],
    triangles: usize,
    spheres: usize,
    lights: usize,
    materials: Vec<String>,
    bounds: [[f32; 3]; 2],
    features: Vec<&'static str>,
    left_out: Vec<LeftOut>,
    missing: Vec<Missing>,
    warnings: Vec<String>,
    memory: Memory,
}

#[derive(Serialize)]
struct LeftOut {
    what: String,
    why: String,
}

/// Words that an integrator, with its default parameters, cannot find here.
#[derive(Serialize)]
struct Missing {
    integrator: &'static str,
    words: String,
    why: String,
}

/// Bytes.
#[derive(Serialize)]
struct Memory {
    geometry: usize,
    film: usize,
}

fn scene_info(name: &str) -> Result<SceneInfo, CliError> {
    let desc = scene::read(name)?;
    let size = UVec2::new(desc.camera.width, desc.camera.height);
    let (scene, camera) = scene::build(&desc, size)?;
    let settings = Settings::new(&REGISTRY[0]);
    let job = RenderJob {
        scene,
        camera,
        size,
        settings,
        navigating: false,
    };
    let renderer = Renderer::new(&job).map_err(|error| CliError::usage(error.to_string()))?;
    let scene = &job.scene;
    let bounds = scene.geometry.bounds();
    let left_out = renderer.plan().left_out.iter();
    let missing = REGISTRY.iter().filter_map(|entry| {
        let params = crate::engine::integrators::Params::defaults(entry.params);
        let missing = (entry.missing)(&scene.features, &params)?;
        Some(Missing {
            integrator: entry.id,
            words: missing.words.into_owned(),
            why: missing.why.into_owned(),
        })
    });
    Ok(SceneInfo {
        name: scene.name.clone(),
        description: scene.description.clone(),
        size: size.to_array(),
        triangles: scene.geometry.triangle_count(),
        spheres: scene.geometry.sphere_count(),
        lights: scene.lights.len(),
        materials: scene.material_names.clone(),
        bounds: [bounds.min.to_array(), bounds.max.to_array()],
        features: features(&scene.features),
        left_out: left_out
            .map(|l| LeftOut {
                what: l.what.clone(),
                why: l.why.clone(),
            })
            .collect(),
        missing: missing.collect(),
        warnings: scene.warnings.clone(),
        memory: Memory {
            geometry: scene.geometry.memory_bytes(),
            film: renderer.film_bytes(),
        },
    })
}

fn features(f: &SceneFeatures) -> Vec<&'static str> {
    let all = [
        (f.diffuse, "diffuse (D)"),
        (f.glossy, "glossy (G)"),
        (f.specular, "specular (S)"),
        (f.opacity, "opacity"),
        (f.textures, "textures"),
        (f.hittable_lights, "lights with a surface or a sky"),
        (f.zero_size_lights, "lights of zero size"),
        (f.environment, "light at infinity"),
    ];
    all.into_iter()
        .filter(|(on, _)| *on)
        .map(|(_, name)| name)
        .collect()
}

fn print_scene(s: &SceneInfo) -> Result<(), CliError> {
    let [min, max] = s.bounds.map(|p| format!("({}, {}, {})", p[0], p[1], p[2]));
    print::line(&format!("{}: {}", s.name, s.description))?;
    print::line(&format!("picture: {}x{}", s.size[0], s.size[1]))?;
    let counts = (s.triangles, s.spheres, s.lights);
    print::line(&format!(
        "{} triangles, {} spheres, {} lights",
        counts.0, counts.1, counts.2
    ))?;
    print::line(&format!("materials: {}", s.materials.join(", ")))?;
    print::line(&format!("bounds: {min} to {max}"))?;
    print::line(&format!("holds: {}", s.features.join(", ")))?;
    for left_out in &s.left_out {
        print::line(&format!("left out: {} ({})", left_out.what, left_out.why))?;
    }
    for m in &s.missing {
        print::line(&format!(
            "{} cannot find {}: {}",
            m.integrator, m.words, m.why
        ))?;
    }
    for warning in &s.warnings {
        print::line(&format!("warning: {warning}"))?;
    }
    let (geometry, film) = (print::bytes(s.memory.geometry), print::bytes(s.memory.film));
    print::line(&format!(
        "memory: geometry {geometry}, sums of a picture with components {film}"
    ))
}

#[derive(Serialize)]
struct ImageInfo {
    size: [u32; 2],
    layers: Vec<LayerInfo>,
    attributes: std::collections::BTreeMap<String, String>,
}

#[derive(Serialize)]
struct LayerInfo {
    label: String,
    expression: Option<String>,
    /// Of finite pixels.
    mean: Option<[f64; 3]>,
    non_finite: usize,
}

fn image_info(path: &Path) -> Result<ImageInfo, CliError> {
    let picture = picture::read(path)?;
    let layers = picture.layers.into_iter().map(|layer| LayerInfo {
        mean: channel_means(&layer.pixels),
        non_finite: layer
            .pixels
            .iter()
            .filter(|p| p.iter().any(|x| !x.is_finite()))
            .count(),
        label: layer.label,
        expression: layer.expression,
    });
    Ok(ImageInfo {
        size: picture.size.to_array(),
        layers: layers.collect(),
        attributes: picture.attributes.into_iter().collect(),
    })
}

fn print_image(i: &ImageInfo) -> Result<(), CliError> {
    print::line(&format!("{}x{} pixels", i.size[0], i.size[1]))?;
    for layer in &i.layers {
        let mean = layer
            .mean
            .map_or("none".to_owned(), |m| m.map(print::figure).join(" "));
        let expression = layer
            .expression
            .as_ref()
            .map_or(String::new(), |e| format!(" ({e})"));
        let bad = match layer.non_finite {
            0 => String::new(),
            n => format!(", {n} pixels not finite"),
        };
        print::line(&format!("{}{expression}: mean {mean}{bad}", layer.label))?;
    }
    for (name, text) in &i.attributes {
        print::line(&format!("{name}: {text}"))?;
    }
    Ok(())
}
