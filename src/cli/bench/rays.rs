//! Ray throughput on one mesh, on one thread.

use std::path::Path;

use glam::{UVec2, Vec2, Vec3};
use serde::Serialize;

use crate::cli::args::BenchRaysArgs;
use crate::cli::bench_rays::{RayFile, Throughput, bench_rays, parse_rays};
use crate::cli::error::CliError;
use crate::cli::print::{self, bytes, figure};
use crate::cli::scene;
use crate::engine::math::Frame;
use crate::engine::sampling::warp::sample_cosine_hemisphere;
use crate::engine::sampling::{IndependentSampler, Sampler, Stream};
use crate::engine::scene::SceneDesc;

/// Rays of the camera where no file gives them: a square of this side.
const SIDE: u32 = 512;

#[derive(Serialize)]
struct Figures {
    triangles: usize,
    build_seconds: f64,
    memory_bytes: usize,
    primary: Rays,
    bounce: Rays,
}

#[derive(Serialize)]
struct Rays {
    rays: usize,
    hits: usize,
    mrays_per_second: f64,
    mrays_per_second_occluded: f64,
    sum_t: f64,
}

impl Rays {
    fn new(rays: usize, t: &Throughput) -> Self {
        Self {
            rays,
            hits: t.hits,
            mrays_per_second: t.mrays_per_second,
            mrays_per_second_occluded: t.mrays_per_second_occluded,
            sum_t: t.sum_t,
        }
    }
}

/// Runs the command.
pub fn run(args: &BenchRaysArgs) -> Result<(), CliError> {
    let given = args.rays.as_deref().map(read_rays).transpose()?;
    let desc = scene::read_file(&args.mesh)?;
    let rays = given.map_or_else(|| own_rays(&desc), Ok)?;
    let (positions, triangles) = joined(&desc);
    let report = bench_rays(&positions, &triangles, &rays, args.repeats as usize);
    let figures = Figures {
        triangles: report.triangles,
        build_seconds: report.build_seconds,
        memory_bytes: report.memory_bytes,
        primary: Rays::new(rays.primary.len(), &report.primary),
        bounce: Rays::new(rays.bounce.len(), &report.bounce),
    };
    if args.json {
        print::json(&figures)
    } else {
        print_figures(&figures)
    }
}

fn print_figures(f: &Figures) -> Result<(), CliError> {
    let (seconds, memory) = (figure(f.build_seconds), bytes(f.memory_bytes));
    print::line(&format!(
        "{} triangles, built in {seconds} s, {memory}",
        f.triangles
    ))?;
    for (name, r) in [("primary", &f.primary), ("bounce", &f.bounce)] {
        print::line(&format!(
            "{name}: {} rays, {} hits, {} Mrays/s, occlusion {} Mrays/s, sum of distances {}",
            r.rays,
            r.hits,
            figure(r.mrays_per_second),
            figure(r.mrays_per_second_occluded),
            r.sum_t
        ))?;
    }
    Ok(())
}

fn read_rays(path: &Path) -> Result<RayFile, CliError> {
    let shown = path.display();
    let bytes = std::fs::read(path)
        .map_err(|error| CliError::usage(format!("{shown} cannot be read: {error}")))?;
    parse_rays(&bytes).map_err(|error| CliError::usage(format!("{shown}: {error}")))
}

/// Rays of the mesh's own view, and a diffuse bounce from where each of them hits.
fn own_rays(desc: &SceneDesc) -> Result<RayFile, CliError> {
    let (scene, camera) = scene::build(desc, UVec2::splat(SIDE))?;
    let mut rays = RayFile::default();
    for i in 0..SIDE * SIDE {
        let pixel = Vec2::new((i % SIDE) as f32, (i / SIDE) as f32);
        let ray = camera.generate_ray(pixel + 0.5, Vec2::splat(0.5));
        if let Some(hit) = scene.geometry.intersect(&ray) {
            let si = scene.geometry.interaction(&ray, &hit);
            let mut sampler = IndependentSampler::new(0, Stream::Camera, (u64::from(i), 0));
            let normal = if si.n_g.dot(si.wo) < 0.0 {
                -si.n_g
            } else {
                si.n_g
            };
            let local = sample_cosine_hemisphere(sampler.next_2d());
            rays.bounce
                .push(si.spawn_ray(Frame::from_normal(normal).to_world(local)));
        }
        rays.primary.push(ray);
    }
    Ok(rays)
}

/// All meshes as one.
fn joined(desc: &SceneDesc) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for mesh in &desc.meshes {
        let first = positions.len() as u32;
        let world = |p: &Vec3| mesh.transform.map_or(*p, |t| t.transform_point3(*p));
        positions.extend(mesh.positions.iter().map(world));
        triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    (positions, triangles)
}
