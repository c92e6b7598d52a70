//! Photon maps against closed forms: power, roulette, aiming, packing, paths.

#[path = "support/boxes.rs"]
mod boxes;
#[path = "support/chi_square.rs"]
mod chi_square;
#[path = "support/photons.rs"]
mod photons;
mod support;

use std::convert::Infallible;
use std::f32::consts::PI;

use boxes::{diffuse, mirror, point_light, quad, scene, sphere};
use glam::{Vec3, Vec3A};
use lightscope::engine::math::Rgb;
use lightscope::engine::path::PathClasses;
use lightscope::engine::photon::emission::Emission;
use lightscope::engine::photon::{
    MapKind, MapSettings, Packing, PhotonMap, ProjectionMap, Roulette,
};
use lightscope::engine::sampling::{IndependentSampler, Sampler, Stream};
use lightscope::engine::scene::desc::LightDesc;
use photons::{build, estimate, landing, mean_and_error, settings};
use support::render::{load, reference_dir};

/// photon-power: in a closed sphere of albedo ρ all photons stored carry Φ(1 + ρ + ρ² + …).
#[test]
fn stored_power_is_the_geometric_series() {
    for rho in [0.5, 0.9] {
        let walls = sphere(0, Vec3::ZERO, 2.0, true);
        let light = point_light(Vec3::new(0.3, 0.2, -0.1), 1.0);
        let closed = scene(vec![diffuse("wall", rho)], vec![], vec![walls], vec![light]);
        let exact = f64::from(4.0 * PI / (1.0 - rho));
        for roulette in [Roulette::Keep, Roulette::Lose] {
            let power = |index| {
                let settings = MapSettings {
                    roulette,
                    ..settings(20_000, index)
                };
                let map = build(&closed, MapKind::Global, &settings);
                let sum: f64 = map.photons().map(|p| f64::from(p.power.mean())).sum();
                assert!((sum / map.counts.power[0] - 1.0).abs() < 1e-4);
                sum
            };
            let (mean, error) = mean_and_error(&(0..16).map(power).collect::<Vec<_>>());
            println!("albedo {rho}, {roulette:?}: {mean} ± {error}, exact {exact}");
            assert!((mean - exact).abs() < 4.0 * error && error < 0.01 * exact);
        }
    }
}

/// The intensity of photons is kept by one roulette and lost by the other.
#[test]
fn roulette_keeps_power_or_loses_it() {
    let walls = sphere(0, Vec3::ZERO, 2.0, true);
    let light = point_light(Vec3::ZERO, 1.0);
    let closed = scene(vec![diffuse("wall", 0.5)], vec![], vec![walls], vec![light]);
    let spread = |roulette| {
        let map = build(
            &closed,
            MapKind::Global,
            &MapSettings {
                roulette,
                ..settings(5000, 0)
            },
        );
        let powers: Vec<f32> = map.photons().map(|p| p.power.mean()).collect();
        let least = powers.iter().copied().fold(f32::INFINITY, f32::min);
        powers.iter().copied().fold(0.0, f32::max) / least
    };
    assert!(spread(Roulette::Keep) < 1.001);
    assert!(spread(Roulette::Lose) > 100.0);
}

/// Emission toward the projection map is drawn as its density says.
#[test]
fn the_projection_map_is_sampled_by_its_density() {
    let chrome = mirror("chrome", 0.9);
    let balls = [
        (Vec3::ZERO, 1.0),
        (Vec3::new(1.5, 0.3, 0.0), 0.7),
        (Vec3::new(0.0, 4.0, 9.0), 0.2),
    ];
    let spheres = balls.map(|(c, r)| sphere(0, c, r, false)).to_vec();
    let plate = quad(0, Vec3::new(-3.0, -2.0, -3.0), Vec3::X * 0.8, Vec3::Z * 0.8);
    let light = point_light(Vec3::new(0.0, 3.0, 0.0), 1.0);
    let scene = scene(vec![chrome], vec![plate], spheres, vec![light]);
    let map = ProjectionMap::new(&scene);
    assert_eq!(map.spheres().count(), 5);
    let mut p_values = Vec::new();
    for (i, p) in [
        Vec3A::new(0.0, 3.0, 0.0),
        Vec3A::new(4.0, 1.0, -2.0),
        Vec3A::new(0.1, 0.2, 0.3),
    ]
    .into_iter()
    .enumerate()
    {
        let mut s = IndependentSampler::new(2, Stream::Test, (i as u64, 0));
        let mut draw = || {
            let (d, pdf) = map.sample_from(p, s.next_1d(), s.next_2d())?;
            let other = map.pdf_from(p, d);
            assert!((pdf / other - 1.0).abs() < 0.01, "{pdf} {other}");
            Some(d)
        };
        let grid = chi_square::SphereGrid::new((Vec3A::new(0.7, 0.1, 0.0) - p).normalize(), 0.5);
        let pdf = |d| f64::from(map.pdf_from(p, d));
        let value = chi_square::test_directions(&grid, 200_000, pdf, &mut draw);
        p_values.push((format!("from {p}"), value));
    }
    chi_square::assert_family(&p_values);

    // From infinity: points across a direction, by a grid over the plane.
    let d = Vec3A::new(0.3, -0.9, 0.2).normalize();
    let frame = lightscope::engine::math::Frame::from_normal(d);
    let (cells, half) = (40usize, 12.0);
    let cell = |p: Vec3A| {
        let q = frame.to_local(p);
        let index = |x: f32| ((x / half * 0.5 + 0.5) * cells as f32) as usize;
        index(q.x) * cells + index(q.y)
    };
    let (mut expected, mut counts) = (vec![0.0; cells * cells], vec![0; cells * cells]);
    let fine = 24;
    let step = 2.0 * half / (cells * fine) as f32;
    for i in 0..cells * fine {
        for j in 0..cells * fine {
            let at = |k: usize| (k as f32 + 0.5) * step - half;
            let p = frame.s * at(i) + frame.t * at(j);
            expected[cell(p)] += f64::from(map.pdf_along(d, p) * step * step);
        }
    }
    let mut s = IndependentSampler::new(2, Stream::Test, (9, 0));
    for _ in 0..200_000 {
        let (p, pdf) = map
            .sample_along(d, s.next_1d(), s.next_2d())
            .expect("groups");
        assert!((pdf / map.pdf_along(d, p) - 1.0).abs() < 0.01 || pdf > 0.0);
        counts[cell(p)] += 1;
    }
    let total: f64 = expected.iter().sum();
    assert!(
        (total - 1.0).abs() < 2e-3,
        "the density integrates to {total}"
    );
    let value = chi_square::p_value(&expected, &counts);
    assert!(value > 1e-3, "{value}");
}

/// What photons sent toward mirrors bring is what photons sent everywhere bring, for every kind
/// of light.
#[test]
fn aimed_photons_carry_the_power_of_those_sent_everywhere() {
    let materials = || {
        vec![
            diffuse("floor", 0.5),
            mirror("chrome", 0.8),
            diffuse("black", 0.0),
        ]
    };
    let floor = || {
        quad(
            0,
            Vec3::new(-5.0, 0.0, -5.0),
            Vec3::Z * 10.0,
            Vec3::X * 10.0,
        )
    };
    let ball = || sphere(1, Vec3::new(0.5, 1.5, 0.0), 0.8, false);
    let lamp = |radius| {
        let mut lamp = sphere(2, Vec3::new(-2.0, 3.0, 1.0), radius, false);
        lamp.emission = Some(Rgb::splat(5.0));
        lamp
    };
    let mut panel = quad(2, Vec3::new(1.0, 4.0, 0.0), Vec3::X, Vec3::Z);
    panel.emission = Some(Rgb::splat(9.0));
    let spot = LightDesc::Spot {
        position: Vec3::new(-1.0, 4.0, 0.5),
        direction: Vec3::new(1.0, -1.5, 0.0),
        intensity: Rgb::splat(40.0),
        angle_deg: 40.0,
        falloff_deg: 20.0,
    };
    let beam = LightDesc::Directional {
        direction: Vec3::new(0.4, -1.0, 0.1),
        irradiance: Rgb::splat(2.0),
    };
    let sky = LightDesc::Constant {
        radiance: Rgb::splat(0.4),
    };
    let point = point_light(Vec3::new(0.0, 4.0, 2.0), 20.0);
    let with = |lights: Vec<LightDesc>| scene(materials(), vec![floor()], vec![ball()], lights);
    let scenes = [
        ("point", with(vec![point.clone()])),
        ("spot", with(vec![spot.clone()])),
        ("directional", with(vec![beam.clone()])),
        ("constant", with(vec![sky.clone()])),
        (
            "sphere",
            scene(materials(), vec![floor()], vec![ball(), lamp(0.5)], vec![]),
        ),
        (
            "panel",
            scene(
                materials(),
                vec![floor(), panel.clone()],
                vec![ball()],
                vec![],
            ),
        ),
        (
            "all",
            scene(
                materials(),
                vec![floor(), panel],
                vec![ball(), lamp(0.3)],
                vec![point, spot, beam, sky],
            ),
        ),
    ];
    for (name, scene) in &scenes {
        let aimed = Emission::aimed(scene, ProjectionMap::new(scene)).expect("a mirror");
        let stored = |emission: &Emission, index| {
            let classes = PathClasses::components();
            let never = || Ok::<(), Infallible>(());
            let kind = MapKind::Caustic;
            let settings = settings(8000, index);
            match PhotonMap::build(scene, &classes, kind, emission, &settings, &never) {
                Ok(map) => map.counts,
                Err(impossible) => match impossible {},
            }
        };
        let powers = |emission: &Emission, first: u64| {
            let power = |i| stored(emission, first + i).power[0];
            mean_and_error(&(0..16).map(power).collect::<Vec<_>>())
        };
        let ((a, a_error), (b, b_error)) = (powers(&aimed, 0), powers(&Emission::Everywhere, 50));
        let error = a_error.hypot(b_error);
        println!("{name}: aimed {a} ± {a_error}, everywhere {b} ± {b_error}");
        assert!((a - b).abs() < 4.0 * error && error < 0.02 * b, "{name}");
        // And most of them land: that is what aiming is for.
        let (aimed, blind) = (stored(&aimed, 0), stored(&Emission::Everywhere, 0));
        let rate = |c: lightscope::engine::photon::MapCounts| c.stored as f64 / c.emitted as f64;
        assert!(
            rate(aimed) > 1.2 * rate(blind),
            "{name}: {} {}",
            rate(aimed),
            rate(blind)
        );
    }
}

/// What twenty bytes lose, on the photons of a reference scene.
#[test]
fn packing_costs_less_than_the_noise() {
    let scene = load(&reference_dir("cornell-glass").join("scene.json"));
    for kind in [MapKind::Caustic, MapKind::Global] {
        let map = |packing| {
            build(
                &scene,
                kind,
                &MapSettings {
                    packing,
                    ..settings(60_000, 0)
                },
            )
        };
        let (full, packed) = (map(Packing::Full), map(Packing::Packed));
        assert_eq!(full.len(), packed.len());
        assert_eq!(packed.memory_bytes(), 20 * packed.len());
        let (mut relative, mut sum, mut total) = (0.0, 0.0, 0.0);
        let count = 2000;
        for i in 0..count {
            // Where photons lie, so that both kinds have something to say.
            let at = full.photon(i * (full.len() / count));
            let si = landing(&scene, Vec3::from(at.p + at.wi * 1e-3), Vec3::from(-at.wi));
            let radiance = |map: &PhotonMap| estimate(map, &scene, &si, 0.5, 50);
            let (a, b) = (radiance(&full), radiance(&packed));
            if a > 0.0 {
                relative += (b / a - 1.0).powi(2);
                sum += b - a;
                total += a;
            }
        }
        let (rms, mean) = ((relative / count as f64).sqrt(), sum / total);
        println!(
            "{kind:?}: packing changes an estimate of 50 by {:.3} % rms, {:.4} % in the mean",
            100.0 * rms,
            100.0 * mean
        );
        // An estimate of 50 photons has a noise of 14 %.
        assert!(rms < 0.01 && mean.abs() < 0.001);
    }
}

/// The ways that are shown one by one are those of the photons in the map.
#[test]
fn shown_paths_are_those_of_the_map() {
    let scene = load(&reference_dir("cornell-glass").join("scene.json"));
    let classes = PathClasses::components();
    let settings = settings(500, 3);
    for kind in [MapKind::Caustic, MapKind::Global] {
        let map = build(&scene, kind, &settings);
        let emission = match kind {
            MapKind::Caustic => Emission::aimed(&scene, ProjectionMap::new(&scene)).expect("glass"),
            MapKind::Global | MapKind::Volume => Emission::Everywhere,
        };
        let all = 0..map.counts.emitted;
        let paths = map.paths(&scene, &classes, &emission, &settings, all);
        let mut shown: Vec<_> = paths.iter().flat_map(|p| &p.stored).collect();
        let stored: Vec<_> = map.photons().collect();
        let mut stored: Vec<_> = stored.iter().collect();
        let key = |p: &&lightscope::engine::photon::Photon| {
            p.p.to_array().map(|x| x.to_bits()).map(|b| b as i32)
        };
        shown.sort_by_key(key);
        stored.sort_by_key(key);
        assert!(shown.len() == stored.len() && shown.len() > 300);
        for (a, b) in shown.iter().zip(&stored) {
            assert_eq!(
                (a.p, a.wi, a.class, a.events),
                (b.p, b.wi, b.class, b.events)
            );
            assert!((a.power - b.power).max_component().abs() <= 1e-6 * a.power.max_component());
        }
        assert!(
            paths
                .iter()
                .all(|p| p.stored.iter().all(|s| p.points.contains(&s.p)))
        );
    }
}
