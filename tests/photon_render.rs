//! Photon mapping against references, and its switches, layers and limits.

mod support;

use std::sync::Arc;

use glam::UVec2;
use lightscope::engine::camera::Camera;
use lightscope::engine::film::Frame;
use lightscope::engine::integrators::photon::{NoiseBias, PhotonSettings, noise_and_bias};
use lightscope::engine::integrators::{Cancel, Pass};
use lightscope::engine::io::image;
use lightscope::engine::plan::RenderPlan;
use lightscope::engine::session::{RenderJob, Renderer};
use support::agreement::{Blocks, compare_within, mean};
use support::render::{job, load, reference_dir, render};

const LAYERS: [&str; 5] = ["whole", "direct", "specular", "caustic", "indirect"];
/// Independent maps behind each standard error.
const RUNS: u64 = 16;

fn reference_layer(scene: &str, layer: &str, width: usize) -> Blocks {
    let stem = if layer == "whole" { "ref" } else { layer };
    let read = |name: String| {
        let path = reference_dir(scene).join(name);
        image::read(&path, image::Encoding::Linear).unwrap_or_else(|e| panic!("{e}"))
    };
    let (pixels, se) = (read(format!("{stem}.exr")), read(format!("{stem}_se.exr")));
    Blocks::from_reference(&pixels.pixels, &se.pixels, width)
}

fn photon_job(scene: &str, set: &[(&str, &str)]) -> RenderJob {
    let scene = load(&reference_dir(scene).join("scene.json"));
    job(&scene, "photon", set)
}

/// What the program reports for a job, layer by layer.
fn report(job: &RenderJob, seed: u64, maps: u32) -> Vec<NoiseBias> {
    let plan = RenderPlan::new(&job.scene, false, &job.settings.layers).expect("classes");
    let camera = job.camera.with_size(job.size);
    let cancel = Cancel::never();
    let pass = Pass {
        scene: &job.scene,
        camera: &camera,
        plan: &plan,
        seed,
        index: 0,
        cancel: &cancel,
    };
    let settings = PhotonSettings::new(&job.settings.params);
    noise_and_bias(&pass, &settings, maps)
        .expect("nobody cancels")
        .0
}

/// Sixteen runs of two passes over fresh maps against the reference, within the bias that the
/// program reports from other maps.
fn agrees_within_its_bias(scene: &str, set: &[(&str, &str)]) {
    let passes = 2;
    let mut all = vec![("fresh-maps", "on")];
    all.extend_from_slice(set);
    let mut job = photon_job(scene, &all);
    let width = job.size.x as usize;
    let frames: Vec<Frame> = (0..RUNS)
        .map(|seed| {
            job.settings.seed = seed;
            let frame = render(&job, passes);
            assert_eq!(frame.stats.non_finite(), 0);
            frame
        })
        .collect();
    // Reports of independent maps, so that their own error is known block by block.
    let reports: Vec<Vec<NoiseBias>> = (0..RUNS).map(|i| report(&job, 1000 + i, 2)).collect();
    let average = |f: &Frame| mean(&f.layers[0].pixels);
    let whole = frames.iter().map(average).sum::<f64>() / RUNS as f64;
    let mut complaints = Vec::new();
    for (index, layer) in LAYERS.iter().enumerate() {
        let pixels: Vec<&[[f32; 3]]> = frames
            .iter()
            .map(|f| f.layers[index].pixels.as_slice())
            .collect();
        let ours = Blocks::from_runs(&pixels, width);
        let biases: Vec<&[[f32; 3]]> = reports.iter().map(|r| r[index].bias.as_slice()).collect();
        let bias = Blocks::from_runs(&biases, width);
        let reference = reference_layer(scene, layer, width);
        let verdict = compare_within(layer, &ours, &reference, Some(&bias), whole, LAYERS.len());
        let sum = |r: &Vec<NoiseBias>| r[index].mean_bias();
        println!(
            "{scene} {layer}: reported bias {:.3} % of the image, worst block {:.1} standard errors \
             beyond it; would catch another {:.2} %",
            100.0 * reports.iter().map(sum).sum::<f64>() / RUNS as f64 / whole,
            verdict.worst,
            100.0 * verdict.sensitivity
        );
        complaints.extend(verdict.complaints);
    }
    assert!(
        complaints.is_empty(),
        "{scene} {set:?}:\n{}",
        complaints.join("\n")
    );
}

const SMALL: [(&str, &str); 2] = [("global-photons", "20000"), ("caustic-photons", "20000")];

#[test]
fn direct_use_agrees_on_cornell_diffuse() {
    agrees_within_its_bias("cornell-diffuse", &SMALL);
}

#[test]
fn direct_use_agrees_on_cornell_glass() {
    agrees_within_its_bias("cornell-glass", &SMALL);
}

#[test]
fn direct_use_agrees_on_cornell_glossy() {
    agrees_within_its_bias("cornell-glossy", &SMALL);
}

#[test]
fn direct_use_agrees_on_caustic_ring() {
    agrees_within_its_bias("caustic-ring", &SMALL);
}

#[test]
fn direct_use_agrees_on_point_light() {
    agrees_within_its_bias("point-light", &SMALL);
}

fn pixels(frame: &Frame, layer: &str) -> Vec<[f32; 3]> {
    let found = frame.layers.iter().find(|l| l.label == layer);
    found.expect("a layer of that name").pixels.clone()
}

/// A job of few pixels and photons.
fn small(scene: &str, set: &[(&str, &str)]) -> RenderJob {
    let mut all = vec![
        ("global-photons", "20000"),
        ("caustic-photons", "20000"),
        ("gather-rays", "16"),
    ];
    all.extend_from_slice(set);
    let mut job = photon_job(scene, &all);
    job.size = UVec2::new(24, 24);
    job
}

#[test]
fn each_switch_blackens_its_component_and_nothing_else() {
    for indirect in ["direct", "gather", "cache"] {
        for scene in ["cornell-glass", "cornell-glossy", "cornell-diffuse"] {
            let set = |switch| [("indirect", indirect), switch];
            let on = render(&small(scene, &set(("caustic-map", "on"))), 2);
            for (switch, black) in [("caustic-map", "caustic"), ("global-map", "indirect")] {
                let off = render(&small(scene, &set((switch, "off"))), 2);
                for layer in &LAYERS[1..] {
                    let (a, b) = (pixels(&on, layer), pixels(&off, layer));
                    if *layer == black {
                        assert!(b.iter().flatten().all(|x| *x == 0.0), "{scene} {switch}");
                        let was = a.iter().flatten().any(|x| *x > 0.0);
                        assert!(was || (scene == "cornell-diffuse" && black == "caustic"));
                    } else {
                        assert!(a == b, "{scene} {indirect}: {switch} changes {layer}");
                    }
                }
                let rest = |((w, b), o): ((&[f32; 3], [f32; 3]), &[f32; 3])| {
                    (0..3).all(|c| (w[c] - b[c] - o[c]).abs() <= 1e-5 * (1.0 + w[c]))
                };
                let (w, b, o) = (
                    pixels(&on, "whole"),
                    pixels(&on, black),
                    pixels(&off, "whole"),
                );
                assert!(w.iter().zip(b).zip(&o).all(rest), "{scene} {switch}");
            }
        }
    }
}

#[test]
fn layers_add_up_and_depth_is_exact() {
    for indirect in ["direct", "gather"] {
        for scene in ["cornell-glass", "cornell-glossy"] {
            let mut job = small(scene, &[("indirect", indirect)]);
            let texts = ["L.{0,2}E", "L.{3}E", "L.{4,}E"];
            job.settings.layers.expressions = texts
                .iter()
                .map(|t| t.parse().expect("an expression"))
                .collect();
            let all = render(&job, 2);
            for group in [&LAYERS[1..], &["expr1", "expr2", "expr3"]] {
                let parts: Vec<_> = group.iter().map(|l| pixels(&all, l)).collect();
                for (i, whole) in pixels(&all, "whole").iter().enumerate() {
                    for c in 0..3 {
                        let sum: f32 = parts.iter().map(|p| p[i][c]).sum();
                        assert!((sum - whole[c]).abs() <= 1e-4 * (1.0 + whole[c]));
                    }
                }
            }
            job.settings.layers.max_depth = Some(3);
            let cut = render(&job, 2);
            // The photons and numbers are the same: so are the layers, bit for bit.
            assert!(pixels(&all, "expr1") == pixels(&cut, "expr1"));
            assert!(pixels(&all, "expr2") == pixels(&cut, "expr2"));
            assert!(pixels(&cut, "expr2").iter().flatten().any(|x| *x > 0.0));
            assert!(pixels(&all, "expr3").iter().flatten().any(|x| *x > 0.0));
            assert!(pixels(&cut, "expr3").iter().flatten().all(|x| *x == 0.0));
        }
    }
}

/// Gathering and interpolation against the direct use of many photons, on the indirect layer.
#[test]
fn gathers_agree_with_the_reference() {
    let scene = "cornell-glass";
    for (indirect, rays, allowed) in [("gather", "16", 0.03), ("cache", "256", 0.06)] {
        let set = [
            ("indirect", indirect),
            ("gather-rays", rays),
            ("fresh-maps", "on"),
            ("global-photons", "60000"),
            ("caustic-photons", "20000"),
            ("nearest", "30"),
        ];
        let mut job = photon_job(scene, &set);
        job.size = UVec2::new(32, 32);
        let frames: Vec<Frame> = (0..4)
            .map(|seed| {
                job.settings.seed = seed;
                render(&job, 1)
            })
            .collect();
        let path = reference_dir(scene).join("indirect.exr");
        let exact = image::read(&path, image::Encoding::Linear).expect("a reference");
        let exact = mean(&exact.pixels);
        let ours = frames
            .iter()
            .map(|f| mean(&pixels(f, "indirect")))
            .sum::<f64>()
            / 4.0;
        println!("{indirect}: indirect light {ours}, reference {exact}");
        assert!(
            (ours / exact - 1.0).abs() < allowed,
            "{indirect}: {ours} {exact}"
        );
    }
}

#[test]
fn what_a_change_does_not_touch_is_kept() {
    let first = small("cornell-glass", &[]);
    let mut renderer = Renderer::new(&first).expect("classes");
    let maps = |renderer: &mut Renderer| {
        renderer
            .render_pass(&Cancel::never())
            .expect("nobody cancels");
        let photons = renderer.frame().photons.expect("maps");
        Arc::clone(photons.maps())
    };
    let built = maps(&mut renderer);
    let set = |name: &str, value: &str| {
        let mut job = first.clone();
        let entry = job.settings.integrator;
        job.settings
            .params
            .set(entry.params, name, value)
            .expect("a parameter");
        job
    };
    let mut moved = first.clone();
    let mut view = first.scene.camera;
    view.position.x += 0.5;
    moved.camera = Camera::new(&view).expect("a view");
    let kept = [
        moved,
        set("nearest", "20"),
        set("indirect", "gather"),
        set("caustic-map", "off"),
        set("kernel", "cone"),
        set("global-radius", "0.1"),
    ];
    for job in kept {
        renderer = Renderer::replace(Some(renderer), &job).expect("classes");
        assert!(
            Arc::ptr_eq(&built, &maps(&mut renderer)),
            "maps were built anew"
        );
        // And the picture is that of a renderer which never had other settings.
        let fresh = render(&job, 1);
        let frame = renderer.frame();
        assert!(
            frame
                .layers
                .iter()
                .zip(&fresh.layers)
                .all(|(a, b)| a.pixels == b.pixels)
        );
    }
    let mut reseeded = first.clone();
    reseeded.settings.seed = 9;
    let mut layered = first.clone();
    layered.settings.layers.expressions = vec!["LDDE".parse().expect("an expression")];
    for job in [
        set("global-photons", "30000"),
        set("roulette", "lose"),
        reseeded,
        layered,
    ] {
        renderer = Renderer::replace(Some(renderer), &job).expect("classes");
        assert!(
            !Arc::ptr_eq(&built, &maps(&mut renderer)),
            "old maps were used"
        );
    }
}

#[test]
fn a_view_on_the_move_shows_a_preview_until_maps_exist() {
    let job = small("cornell-glass", &[]);
    let mut renderer = Renderer::new(&job).expect("classes");
    let coarse = |renderer: &mut Renderer| {
        let film = renderer
            .render_coarse(2, &Cancel::never())
            .expect("nobody cancels");
        let mut frame = renderer.frame();
        renderer.snapshot(Some(&film), 1, &mut frame);
        frame
    };
    let before = coarse(&mut renderer);
    assert!(before.preview && before.photons.is_none());
    renderer
        .render_pass(&Cancel::never())
        .expect("nobody cancels");
    assert!(!renderer.frame().preview);
    assert!(
        !coarse(&mut renderer).preview,
        "the maps are there: no preview is needed"
    );
    let gather = small("cornell-glass", &[("indirect", "gather")]);
    renderer = Renderer::replace(Some(renderer), &gather).expect("classes");
    assert!(coarse(&mut renderer).preview);
}

#[test]
fn building_maps_can_be_cancelled() {
    use std::sync::atomic::AtomicU64;
    let job = small("cornell-glass", &[]);
    let mut renderer = Renderer::new(&job).expect("classes");
    let cancel = Cancel::new(Arc::new(AtomicU64::new(2)), 1);
    assert!(renderer.render_pass(&cancel).is_err());
    let frame = renderer.frame();
    assert!(frame.photons.is_none() && frame.passes == 0);
    renderer
        .render_pass(&Cancel::never())
        .expect("nobody cancels");
    let fresh = render(&job, 1);
    assert!(renderer.frame().layers[0].pixels == fresh.layers[0].pixels);
}

#[test]
fn what_is_shown_of_an_estimate_is_what_was_rendered() {
    use glam::Vec2;
    use lightscope::engine::photon::MapKind;
    let job = small(
        "cornell-glass",
        &[("indirect", "cache"), ("cache-error", "0.4")],
    );
    let mut renderer = Renderer::new(&job).expect("classes");
    renderer
        .render_pass(&Cancel::never())
        .expect("nobody cancels");
    let view = renderer.frame().photons.expect("photons");
    let records = view.cache().expect("records").records().len();
    assert!(records > 20, "{records} records");
    // The floor next to the glass ball's caustic.
    let camera = job.camera.with_size(UVec2::new(64, 64));
    let ray = camera.generate_ray(Vec2::new(44.0, 58.0), Vec2::ZERO);
    let hit = job.scene.geometry.intersect(&ray).expect("the floor");
    let si = job.scene.geometry.interaction(&ray, &hit);
    let query = view
        .query(&job.scene, &si, MapKind::Global)
        .expect("a global map");
    assert_eq!(query.photons.len(), 50);
    let map = view.map(MapKind::Global).expect("a global map");
    // A diffuse floor: radiance = albedo/π · Σ power · weight.
    let sum = query
        .photons
        .iter()
        .map(|w| map.photon(w.index).power * w.density);
    let irradiance = sum.fold(lightscope::engine::math::Rgb::BLACK, |a, b| a + b);
    let expected = irradiance * (0.73 / std::f32::consts::PI);
    assert!((query.radiance - expected).max_component().abs() < 1e-3 * expected.max_component());
    for w in &query.photons {
        let distance = (map.photon(w.index).p - si.p).length();
        assert!(distance <= query.radius * 1.0001);
    }
    let plan = RenderPlan::new(&job.scene, false, &job.settings.layers).expect("classes");
    let cancel = Cancel::never();
    let pass = Pass {
        scene: &job.scene,
        camera: &camera,
        plan: &plan,
        seed: 0,
        index: 0,
        cancel: &cancel,
    };
    let (rays, gathered) = view.gather(&pass, &si);
    assert_eq!(rays.len(), 16);
    assert!(rays.iter().all(|r| r.d.dot(si.n_g) > 0.0));
    assert!(gathered.mean() > 0.3 * query.radiance.mean());
}
