//! The volume photon map: what is stored, how it is read, and what pictures it makes.

mod support;

use std::f32::consts::PI;

use glam::Vec3A;
use lightscope::engine::film::Frame;
use lightscope::engine::geometry::Ray;
use lightscope::engine::media::Phase;
use lightscope::engine::path::PathClasses;
use lightscope::engine::photon::emission::Emission;
use lightscope::engine::photon::{
    MapKind, MapSettings, Nearest, Numbers, Packing, PhotonMap, Roulette, SplitRule,
};
use lightscope::engine::scene::Scene;
use lightscope::engine::session::RenderJob;
use support::agreement::mean;
use support::reference::{runs_of, whole_mean};
use support::render::{job, render, scene_from_toml};
use support::volumes::{HOMOGENEOUS, smoky_room};

fn build(scene: &Scene, photons: usize, roulette: Roulette) -> PhotonMap {
    let settings = MapSettings {
        photons,
        roulette,
        packing: Packing::Full,
        split: SplitRule::Widest,
        numbers: Numbers::Independent,
        seed: 3,
        index: 0,
    };
    let classes = PathClasses::components();
    let emission = Emission::Everywhere;
    let kind = MapKind::Volume;
    let check = || Ok::<(), ()>(());
    PhotonMap::build(scene, &classes, kind, &emission, &settings, &check).expect("not cancelled")
}

/// In a medium without end a photon of power Φ is scattered until it is absorbed: Φ ϖ/(1 − ϖ) in
/// all, whichever way it loses power, and whatever the extinction of each channel.
#[test]
fn stored_power_is_a_geometric_series() {
    let scene = scene_from_toml(
        r#"
        camera = { position = [0, 0, 5], target = [0, 0, 0] }
        lights = [{ type = "point", position = [0, 0, 0], intensity = [1, 2, 3] }]
        medium = { type = "homogeneous", region = "everywhere", sigma_t = [0.5, 1, 3], albedo = [0.8, 0.5, 0.6] }
        "#,
    );
    for roulette in [Roulette::Keep, Roulette::Lose] {
        let map = build(&scene, 400_000, roulette);
        for (c, albedo) in [0.8, 0.5, 0.6].into_iter().enumerate() {
            let emitted = 4.0 * std::f64::consts::PI * (c + 1) as f64;
            let exact = emitted * albedo / (1.0 - albedo);
            let found = map.counts.power[c];
            assert!(
                (found / exact - 1.0).abs() < 0.02,
                "{c}: {found}, not {exact}"
            );
        }
    }
}

/// Every photon of a cylinder is found, and no other: against a loop over all.
#[test]
fn beams_see_what_a_loop_sees() {
    let scene = smoky_room(HOMOGENEOUS);
    let map = build(&scene, 30_000, Roulette::Keep);
    let phase = Phase::HenyeyGreenstein { g: 0.4 };
    let mut visited = 0;
    for i in 0..200_u32 {
        let turn = |k: f32| ((i as f32 * k).sin() * 43_758.547).fract();
        let o = Vec3A::new(turn(1.3), turn(2.7), turn(3.1)) * 2.0;
        let d = Vec3A::new(turn(4.9), turn(5.3), turn(6.1)).normalize();
        let d = if i % 7 == 0 { Vec3A::X } else { d };
        let ray = Ray::new(o, d);
        let (range, radius) = ((0.1, 1.5 + turn(7.7).abs()), 0.02 + 0.3 * turn(8.3).abs());
        let mut found: Vec<(f32, f32)> = Vec::new();
        map.estimate_beam(&ray, range, phase, radius, |t, c| {
            found.push((t, c.radiance[0]))
        });
        let mut expected = Vec::new();
        for photon in map.photons() {
            let to = photon.p - o;
            let t = to.dot(d);
            let off2 = (to - d * t).length_squared();
            let within = (range.0..range.1).contains(&t) && off2 < radius * radius;
            if within && photon.events > 0 {
                let value = photon.power[0] * phase.pdf(-d, photon.wi) / (PI * radius * radius);
                expected.push((t, value));
            }
        }
        visited += expected.len();
        let order = |a: &(f32, f32), b: &(f32, f32)| a.0.total_cmp(&b.0);
        found.sort_by(order);
        expected.sort_by(order);
        assert_eq!(found.len(), expected.len(), "ray {i}");
        for (a, b) in found.iter().zip(&expected) {
            assert!(
                a.0 == b.0 && (a.1 - b.1).abs() <= 1e-4 * b.1.abs(),
                "{a:?} {b:?}"
            );
        }
    }
    assert!(visited > 10_000, "{visited}");
}

/// The estimate at a point against a loop: the nearest in a ball, the farthest of them its rim.
#[test]
fn points_see_what_a_loop_sees() {
    let scene = smoky_room(HOMOGENEOUS);
    let map = build(&scene, 30_000, Roulette::Keep);
    let (phase, wo, n) = (Phase::Rayleigh, Vec3A::Z, 40);
    let mut nearest = Nearest::new(n);
    for i in 0..100 {
        let p = Vec3A::new(0.01 * i as f32 - 0.5, 0.3 - 0.004 * i as f32, 0.1);
        let (mut found, mut count) = (0.0, 0);
        map.estimate_point((p, wo), phase, 0.5, &mut nearest, |c| {
            found += f64::from(c.radiance[1]);
            count += 1;
        });
        let mut near: Vec<_> = map
            .photons()
            .filter(|photon| photon.events > 0)
            .map(|photon| ((photon.p - p).length_squared(), photon))
            .filter(|(d2, _)| *d2 < 0.25)
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        near.truncate(n);
        assert_eq!(near.len(), n, "photons are many here");
        let radius = f64::from(near[n - 1].0).sqrt();
        let sum: f64 = near[..n - 1]
            .iter()
            .map(|(_, q)| f64::from(q.power[1] * phase.pdf(wo, q.wi)))
            .sum();
        let exact = sum / (4.0 / 3.0 * std::f64::consts::PI * radius.powi(3));
        assert_eq!(count, n - 1);
        assert!((found - exact).abs() < 1e-4 * exact, "{found} {exact}");
    }
}

fn with_words(mut job: RenderJob, texts: &[&str]) -> RenderJob {
    let parsed = texts.iter().map(|t| t.parse().expect("well-formed"));
    job.settings.layers.expressions = parsed.collect();
    job
}

/// Fresh maps of a small radius tend to the unbiased mean, layer by layer: to within 2 % of the
/// whole's mean and 4 standard errors.
#[test]
fn volume_photons_tend_to_the_mean() {
    let grid = r#"type = "grid", file = "constant.txt", sigma_t_scale = [0.2, 0.6, 1.0]"#;
    let words = ["L.+VE", "LS+VE", "LVE", "L.*DE"];
    for (medium, estimate) in [
        (HOMOGENEOUS, "beam"),
        (HOMOGENEOUS, "point"),
        (grid, "beam"),
    ] {
        let scene = smoky_room(medium);
        let bdpt = runs_of(with_words(job(&scene, "bdpt", &[]), &words), 32);
        let set = [
            ("fresh-maps", "on"),
            ("volume-estimate", estimate),
            ("volume-photons", "60000"),
            ("volume-radius", "0.004"),
            ("global-photons", "30000"),
            ("caustic-photons", "30000"),
            ("global-radius", "0.04"),
        ];
        let photon = runs_of(with_words(job(&scene, "photon", &set), &words), 8);
        let whole = whole_mean(&bdpt);
        for layer in 0..9 {
            let of = |f: &Frame| mean(&f.layers[layer].pixels);
            let moments = |frames: &[Frame]| {
                let n = frames.len() as f64;
                let m = frames.iter().map(of).sum::<f64>() / n;
                let v = frames.iter().map(|f| (of(f) - m).powi(2)).sum::<f64>();
                (m, v / (n - 1.0) / n)
            };
            let ((a, va), (b, vb)) = (moments(&photon), moments(&bdpt));
            println!("{estimate} {layer}: {a} against {b} ± {}", (va + vb).sqrt());
            assert!(
                (a - b).abs() < 0.02 * whole + 4.0 * (va + vb).sqrt(),
                "{estimate} layer {layer}: {a} against {b}"
            );
        }
        let volume = mean(&photon[0].layers[5].pixels);
        assert!(
            volume > 0.03 * whole,
            "{volume} of {whole}: nothing to test"
        );
    }
}

#[test]
fn switched_off_the_volume_map_is_black_and_nothing_else_is() {
    let scene = smoky_room(HOMOGENEOUS);
    let words = ["L.+VE", "LVE", "L.*DE"];
    let on = render(&with_words(job(&scene, "photon", &[]), &words), 2);
    let off = [("volume-map", "off")];
    let off = render(&with_words(job(&scene, "photon", &off), &words), 2);
    let of = |frame: &Frame, layer: usize| mean(&frame.layers[layer].pixels);
    assert!(of(&on, 5) > 0.0 && of(&off, 5) == 0.0);
    assert!(on.layers[6].pixels == off.layers[6].pixels);
    assert!(on.layers[7].pixels == off.layers[7].pixels);
    let facts = |frame: &Frame| frame.facts.iter().any(|f| f.label == "volume map");
    assert!(facts(&on) && !facts(&off));
}
