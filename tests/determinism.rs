//! The same bits for any number of threads, from any run.

mod support;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use lightscope::engine::film::Frame;
use lightscope::engine::integrators::{Cancel, REGISTRY};
use lightscope::engine::session::Renderer;
use support::render::{job, load, reference_dir, render_with_threads};

fn scene_path(name: &str) -> std::path::PathBuf {
    reference_dir(name).join(Path::new("scene.json"))
}

fn bits(frame: &Frame) -> Vec<u32> {
    let values = frame.layers.iter().flat_map(|l| l.pixels.iter().flatten());
    values.map(|v| v.to_bits()).collect()
}

#[test]
fn one_thread_and_eight_give_the_same_bits_in_every_layer() {
    for scene in ["cornell-glass", "cornell-glossy", "caustic-ring"] {
        let scene = load(&scene_path(scene));
        for entry in REGISTRY {
            let job = job(&scene, entry.id, &[]);
            let one = render_with_threads(&job, 3, 1);
            for threads in [2, 8, 16] {
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
