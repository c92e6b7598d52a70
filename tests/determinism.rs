//! The same bits for any number of threads, from any run.

mod support;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::UVec2;
use lightscope::engine::camera::Camera;
use lightscope::engine::film::{Film, Frame, SampleRadiance};
use lightscope::engine::geometry::Ray;
use lightscope::engine::integrators::replay::RadianceSink;
use lightscope::engine::integrators::tiled::{RayIntegrator, SamplerKind, Tiled};
use lightscope::engine::integrators::{Cancel, Integrator, Pass, REGISTRY, RenderStats, SampleId};
use lightscope::engine::math::Rgb;
use lightscope::engine::path::ClassId;
use lightscope::engine::plan::RenderPlan;
use lightscope::engine::sampling::Sampler;
use lightscope::engine::session::{RenderClock, Renderer};
use support::render::{job, load, reference_dir, render_with_threads};

fn scene_path(name: &str) -> std::path::PathBuf {
    reference_dir(name).join(Path::new("scene.json"))
}

fn bits(frame: &Frame) -> Vec<u32> {
    let values = frame.layers.iter().flat_map(|l| l.pixels.iter().flatten());
    values.map(|v| v.to_bits()).collect()
}

#[test]
fn one_thread_and_several_give_the_same_bits_in_every_layer() {
    for scene in ["cornell-glass", "cornell-glossy", "caustic-ring"] {
        let scene = load(&scene_path(scene));
        for entry in REGISTRY {
            let mut job = job(&scene, entry.id, &[]);
            job.size = UVec2::new(40, 24);
            let one = render_with_threads(&job, 3, 1);
            for threads in [2, 7] {
                let many = render_with_threads(&job, 3, threads);
                assert_eq!(one.stats, many.stats);
                assert!(
                    bits(&one) == bits(&many),
                    "{} with {threads} threads",
                    entry.id
                );
            }
        }
    }
}

#[test]
fn a_cancelled_pass_leaves_no_trace() {
    let scene = load(&scene_path("cornell-glass"));
    let job = job(&scene, "path", &[]);
    let newest = Arc::new(AtomicU64::new(1));
    let cancel = Cancel::new(Arc::clone(&newest), 1);
    let mut renderer = Renderer::new(&job).expect("classes");
    renderer.render_pass(&cancel).expect("still the newest");
    let before = bits(&renderer.frame());
    newest.store(2, Ordering::Relaxed);
    assert!(renderer.render_pass(&cancel).is_err());
    assert_eq!(renderer.passes(), 1);
    assert_eq!(bits(&renderer.frame()), before);

    // And what follows is what would have followed.
    renderer
        .render_pass(&Cancel::never())
        .expect("never cancelled");
    assert_eq!(
        bits(&renderer.frame()),
        bits(&render_with_threads(&job, 2, 2))
    );
}

#[test]
fn seeds_give_independent_pictures() {
    let scene = load(&scene_path("cornell-diffuse"));
    let mut job = job(&scene, "path", &[]);
    let first = bits(&render_with_threads(&job, 1, 2));
    job.settings.seed = 1;
    assert_ne!(first, bits(&render_with_threads(&job, 1, 2)));
}

/// What a plan leaves out is zero: without a plan the picture has the same bits.
#[test]
fn a_plan_changes_no_bit() {
    for name in ["cornell-diffuse", "cornell-glass", "point-light", "furnace"] {
        let scene = load(&scene_path(name));
        for mode in ["mis", "kajiya", "hits"] {
            let job = job(&scene, "path", &[("mode", mode)]);
            let lens = job.camera.has_lens();
            let plan = RenderPlan::new(&scene, lens, &job.settings.layers).expect("classes");
            let full = plan.clone().with_everything_on();
            assert!(plan.left_out.len() > full.left_out.len());
            let [planned, full] = [plan, full].map(|plan| {
                let mut renderer = Renderer::with_plan(&job, plan, RenderClock::start());
                for _ in 0..4 {
                    renderer
                        .render_pass(&Cancel::never())
                        .expect("nobody cancels");
                }
                renderer.frame()
            });
            assert!(bits(&planned) == bits(&full), "{name} {mode}");
        }
    }
}

/// One, but not a number in about one sample of ten and infinite in another.
struct Faulty;

impl RayIntegrator for Faulty {
    fn radiance<S: Sampler>(
        &self,
        _: &Pass<'_>,
        _: Ray,
        sampler: &mut S,
        out: &mut impl RadianceSink,
        _: &mut RenderStats,
    ) {
        let value = match sampler.next_1d() {
            u if u < 0.1 => f32::NAN,
            u if u < 0.2 => f32::INFINITY,
            _ => 1.0,
        };
        out.add(ClassId::EMPTY, Rgb::splat(value));
    }
}

#[test]
fn samples_that_are_not_finite_are_counted_and_can_be_computed_again() {
    let scene = load(&scene_path("cornell-diffuse"));
    let size = UVec2::new(19, 11);
    let mut settings = job(&scene, "path", &[]).settings.layers;
    settings.components = false;
    let plan = RenderPlan::new(&scene, false, &settings).expect("classes");
    let camera = Camera::new(&scene.camera).expect("a view").with_size(size);
    let cancel = Cancel::never();
    let pass = |index| Pass {
        scene: &scene,
        camera: &camera,
        plan: &plan,
        seed: 3,
        index,
        cancel: &cancel,
    };
    let mut tiled = Tiled::new(Faulty, SamplerKind::Independent);
    let mut film = Film::new(size, plan.planned);
    let mut stats = RenderStats::default();
    for index in 0..64 {
        stats += tiled
            .render_pass(&pass(index), &mut film)
            .expect("nobody cancels");
    }

    // A fifth is counted and left out; the mean of the others is exact.
    let share = stats.non_finite() as f64 / stats.samples as f64;
    assert!((share - 0.2).abs() < 0.02, "{share}");
    let mut layers = Vec::new();
    film.resolve(&plan.labels, &mut layers);
    assert!(layers[0].pixels.iter().all(|p| *p == [1.0; 3]));

    // The first of them is found again from its pixel and pass alone.
    let bad = stats.bad_samples().next().expect("there are some");
    let mut out = SampleRadiance::new(&plan.classes, plan.planned);
    let SampleId::Camera {
        pixel,
        pass: number,
    } = bad.id
    else {
        panic!("{bad:?}")
    };
    tiled.sample(&pass(number), pixel, &mut out, &mut stats);
    assert!(!out.is_finite());
}
