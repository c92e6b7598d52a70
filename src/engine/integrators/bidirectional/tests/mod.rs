//! The weights of all strategies against densities computed apart from the finished path.

mod full_path;
mod numbers;
mod scenes;

use glam::{Vec2, Vec3A};

use self::full_path::Full;
use self::scenes::{slit, things};
use super::*;
use crate::engine::bsdf::Transport;
use crate::engine::camera::Camera;
use crate::engine::event::Event;
use crate::engine::integrators::{Cancel, Pass, RenderStats};
use crate::engine::light::LightSample;
use crate::engine::math::Rgb;
use crate::engine::path::ClassId;
use crate::engine::plan::{LayerSettings, RenderPlan};
use crate::engine::sampling::{IndependentSampler, Sampler, Stream};
use crate::engine::scene::Scene;

/// The weights that the strategies under test gave, in their order.
#[derive(Default)]
struct Record(Vec<(Technique, f32)>);

impl Sink for Record {
    fn add(&mut self, technique: Technique, _: ClassId, _: Rgb, weight: f32) {
        self.0.push((technique, weight));
    }
    fn splat(&mut self, _: Vec2, technique: Technique, _: ClassId, _: Rgb, weight: f32) {
        self.0.push((technique, weight));
    }
}

/// What the comparisons of one scene found.
#[derive(Default, Debug)]
struct Tally {
    paths: usize,
    with_delta: usize,
    close: usize,
    by_s: [usize; 3],
    by_t: [usize; 3],
    worst: f64,
}

struct Checker<'a> {
    pass: &'a Pass<'a>,
    strategies: Strategies,
    tally: Tally,
}

impl Checker<'_> {
    /// Compares one weight with its definition.
    fn check(&mut self, full: &Full<'_>, technique: Technique, weight: f32) {
        let n = full.n();
        assert_eq!(technique.s + technique.t, n);
        let share = |p: f64| match self.strategies.heuristic {
            Heuristic::Balance => p,
            Heuristic::Power => p * p,
        };
        let densities: Vec<f64> = (0..n).map(|s| full.density(s)).collect();
        let sum: f64 = densities.iter().map(|p| share(*p)).sum();
        let own = densities[technique.s];
        assert!(
            own > 0.0,
            "{technique:?} of {densities:?} samples what it cannot"
        );
        let expected = share(own) / sum;
        let error = (f64::from(weight) - expected).abs();
        let t = &mut self.tally;
        t.paths += 1;
        t.with_delta += usize::from(full.inner.iter().any(|v| v.1.is_delta()));
        t.by_s[technique.s.min(2)] += 1;
        t.by_t[technique.t.min(3) - 1] += 1;
        let connected = technique.s.max(1);
        let gap = full.point(connected).distance(full.point(connected - 1));
        t.close += usize::from(!full.end.infinite && gap < 2e-3);
        t.worst = t.worst.max(error);
        assert!(
            error < 1e-3,
            "{technique:?}: weight {weight} against {expected} of {densities:?}, events {:?}",
            full.inner.iter().map(|v| v.1).collect::<Vec<_>>()
        );
    }

    fn walk_events(path: &Subpath, n: usize) -> Vec<(&Vertex, Option<Event>)> {
        (1..n)
            .map(|i| (path.vertex(i), path.vertex(i).event))
            .collect()
    }

    /// All weights of one pair of walks.
    fn sample(&mut self, index: u64) {
        let pass = self.pass;
        let mut stats = RenderStats::default();
        let new = |stream| IndependentSampler::new(1, stream, (0, index));
        let (mut a, mut b, mut c) = (new(Stream::Camera), new(Stream::Light), new(Stream::Test));
        let size = pass.camera.size().as_vec2();
        let ray = pass.camera.generate_ray(a.next_2d() * size, a.next_2d());
        let walker = Walker {
            cx: pass,
            roulette: 3,
        };
        let (mut eye, mut light) = (Subpath::default(), Subpath::default());
        let escape = walker.from_lens(ray, 4, &mut a, &mut eye, &mut stats);
        let start = walker.from_light(&mut b, &mut light, &mut stats);
        let strategies = self.strategies.clone();
        let mut record = Record::default();
        let mut connector = Connector {
            cx: pass,
            strategies: &strategies,
            sink: &mut record,
            stats: &mut stats,
        };

        // Each strategy alone, so that its path is known.
        if let Some(escape) = escape {
            connector.escape(&eye, &escape, &mut Vec::new());
            for (i, (technique, weight)) in record.0.drain(..).enumerate() {
                let id = pass.scene.lights.environments()[i];
                let end = LightEnd::new(id, pass.scene.lights.get(id), Vec3A::ZERO, None);
                let full = full(
                    pass,
                    end,
                    &[],
                    &eye,
                    eye.len(),
                    None,
                    Some(-escape.d),
                    ray.o,
                );
                self.check(&full, technique, weight);
            }
        }
        for t in 2..=eye.len() {
            let run = |f: &mut dyn FnMut(&mut Connector<'_, Record>)| {
                let mut record = Record::default();
                f(&mut Connector {
                    cx: pass,
                    strategies: &strategies,
                    sink: &mut record,
                    stats: &mut RenderStats::default(),
                });
                record.0
            };
            let z = eye.vertex(t - 1);
            for (technique, weight) in run(&mut |c| c.hit(&eye, t)) {
                let id = z.si.light.expect("a light was hit");
                let lamp = pass.scene.lights.get(id);
                let end = LightEnd::new(id, lamp, z.si.p, Some(z.si.n_g));
                let full = full(pass, end, &[], &eye, t - 1, None, Some(z.si.wo), ray.o);
                self.check(&full, technique, weight);
            }
            if let Some((id, pmf)) = pass.scene.lights.sample(c.next_1d())
                && let Some(sample) = pass.scene.lights.get(id).sample_li(z.si.p, c.next_2d())
            {
                let found = run(&mut |c| c.shadow(&eye, t, id, pmf, &sample));
                let end = self.shadow_end(id, z, &sample);
                let events = z.bsdf.non_delta_events().filter(|e| {
                    let transport = Transport::Radiance;
                    !z.bsdf.eval(*e, z.si.wo, sample.wi, transport).is_black()
                });
                for ((technique, weight), event) in found.into_iter().zip(events) {
                    let full = full(
                        pass,
                        end,
                        &[],
                        &eye,
                        t,
                        Some(event),
                        Some(-sample.wi),
                        ray.o,
                    );
                    self.check(&full, technique, weight);
                }
            }
            let Some(start) = start else { continue };
            for s in 2..=light.len() {
                let y = light.vertex(s - 1);
                let found = run(&mut |c| c.connect((&light, &start), s, &eye, t));
                let wi = toward(z.si.p, y.si.p);
                let mut pairs = Vec::new();
                use crate::engine::bsdf::Transport::{Importance, Radiance};
                for e in z.bsdf.non_delta_events() {
                    for f in y.bsdf.non_delta_events() {
                        if !z.bsdf.eval(e, z.si.wo, wi, Radiance).is_black()
                            && !y.bsdf.eval(f, y.si.wo, -wi, Importance).is_black()
                        {
                            pairs.push((e, f));
                        }
                    }
                }
                assert!(found.is_empty() || found.len() == pairs.len());
                for ((technique, weight), (e, f)) in found.into_iter().zip(pairs) {
                    let mut from = Self::walk_events(&light, s);
                    from[s - 2].1 = Some(f);
                    let full = full(pass, start.end, &from, &eye, t, Some(e), None, ray.o);
                    self.check(&full, technique, weight);
                }
            }
        }
        let Some(start) = start else { return };
        for s in 2..=light.len() {
            let y = light.vertex(s - 1);
            let lens = eye.densities(1)[0];
            let u = c.next_2d();
            let Some(sample) = pass.camera.sample_wi(y.si.p, u) else {
                continue;
            };
            let mut record = Record::default();
            let mut connector = Connector {
                cx: pass,
                strategies: &strategies,
                sink: &mut record,
                stats: &mut stats,
            };
            connector.join_lens((&light, &start), s, &lens, u);
            let events = y.bsdf.non_delta_events().filter(|e| {
                let transport = Transport::Importance;
                !y.bsdf.eval(*e, y.si.wo, sample.wi, transport).is_black()
            });
            for ((technique, weight), event) in record.0.into_iter().zip(events) {
                let mut from = Self::walk_events(&light, s);
                from[s - 2].1 = Some(event);
                let full = full(pass, start.end, &from, &eye, 1, None, None, sample.target);
                self.check(&full, technique, weight);
            }
        }
    }

    fn shadow_end(&self, id: u32, z: &Vertex, sample: &LightSample) -> LightEnd {
        let light = self.pass.scene.lights.get(id);
        let p = if sample.distance.is_finite() {
            z.si.p + sample.wi * sample.distance
        } else {
            Vec3A::ZERO
        };
        LightEnd::new(id, light, p, sample.n)
    }
}

/// Puts a path together: `from` are the vertices of the light walk, the event at the last one
/// chosen; the eye walk gives its first `t` vertices, the event at the last one being `event`
/// or, where the walk went on to the light, the one it drew.
#[expect(clippy::too_many_arguments, reason = "the parts of a path")]
fn full<'f>(
    pass: &'f Pass<'f>,
    end: LightEnd,
    from: &[(&'f Vertex, Option<Event>)],
    eye: &'f Subpath,
    t: usize,
    event: Option<Event>,
    first: Option<Vec3A>,
    lens: Vec3A,
) -> Full<'f> {
    let mut inner = Vec::new();
    let mut edges = Vec::new();
    for (v, e) in from {
        inner.push((*v, e.expect("an event")));
        edges.push(-v.si.wo);
    }
    let eye_part: Vec<_> = (1..t).rev().map(|i| eye.vertex(i)).collect();
    // The edge between the two parts.
    match (first, from.last(), eye_part.first()) {
        (Some(first), ..) => edges.push(first),
        (None, Some((y, _)), Some(z)) => edges.push(-toward(z.si.p, y.si.p)),
        (None, Some((y, _)), None) => edges.push(toward(y.si.p, lens)),
        (None, None, _) => unreachable!("a path begins somewhere"),
    }
    for (k, v) in eye_part.into_iter().enumerate() {
        let e = if k == 0 { event.or(v.event) } else { v.event };
        inner.push((v, e.expect("an event")));
        edges.push(v.si.wo);
    }
    Full {
        pass,
        end,
        inner,
        edges,
        lens,
    }
}

/// Unit direction from `a` to `b`, rounded as connections round it: microfacets at grazing angles
/// magnify a last digit.
fn toward(a: Vec3A, b: Vec3A) -> Vec3A {
    let to = b - a;
    to / to.length_squared().sqrt()
}

fn check_scene(scene: &Scene, heuristic: Heuristic, samples: u64, max_depth: Option<u32>) -> Tally {
    let camera = Camera::new(&scene.camera).expect("a view");
    let settings = LayerSettings {
        components: true,
        max_depth,
        ..LayerSettings::default()
    };
    let plan = RenderPlan::new(scene, camera.has_lens(), &settings).expect("classes");
    let cancel = Cancel::never();
    let pass = Pass {
        scene,
        camera: &camera,
        plan: &plan,
        seed: 1,
        index: 0,
        cancel: &cancel,
    };
    let mut checker = Checker {
        pass: &pass,
        strategies: Strategies::all(heuristic),
        tally: Tally::default(),
    };
    for index in 0..samples {
        checker.sample(index);
    }
    checker.tally
}

const ROOM: &str = r#"{ center = [0, 0, 0], radius = 4, material = "white", inward = true },"#;
const LAMP: &str =
    r#"{ center = [0.5, 1.9, 0.5], radius = 0.3, material = "white", emission = [9, 9, 9] },"#;
const LENS: &str = ", lens = { radius = 0.2, focus_distance = 3 }";
/// Room, lamp and other lights.
const LIGHTS: [(&str, &str, &str); 6] = [
    (ROOM, LAMP, ""),
    (
        ROOM,
        "",
        r#"{ type = "point", position = [0.5, 1.9, 0.5], intensity = [5, 5, 5] }"#,
    ),
    (
        ROOM,
        LAMP,
        r#"{ type = "spot", position = [0.5, 1.9, -0.5], direction = [0, -1, 0], intensity = [5, 5, 5], angle_deg = 60, falloff_deg = 20 }"#,
    ),
    (
        "",
        "",
        r#"{ type = "directional", direction = [1, -2, -1], irradiance = [3, 3, 3] }"#,
    ),
    ("", "", r#"{ type = "constant", radiance = [1, 1, 1] }"#),
    (
        "",
        LAMP,
        r#"{ type = "constant", radiance = [1, 1, 1] }, { type = "constant", radiance = [2, 1, 1] }"#,
    ),
];

#[test]
fn weights_are_those_of_the_densities_computed_apart() {
    let mut sum = Tally::default();
    for heuristic in [Heuristic::Balance, Heuristic::Power] {
        for (room, lamp, lights) in LIGHTS {
            for lens in ["", LENS] {
                let scene = things(room, lamp, lights, lens);
                let samples = if room.is_empty() { 3000 } else { 300 };
                let tally = check_scene(&scene, heuristic, samples, None);
                assert!(tally.paths > 1000 && tally.with_delta > 100, "{tally:?}");
                for i in 0..3 {
                    sum.by_s[i] += tally.by_s[i];
                    sum.by_t[i] += tally.by_t[i];
                }
            }
        }
    }
    // Every kind of strategy was seen.
    let all = sum.by_s.iter().chain(&sum.by_t);
    assert!(all.into_iter().all(|n| *n > 300), "{sum:?}");
}

#[test]
fn weights_hold_for_vertices_next_to_each_other() {
    // Longer paths have densities beyond f64: the recursion knows their ratios, this test not.
    for material in ["white", "satin", "frost"] {
        let tally = check_scene(&slit(material), Heuristic::Balance, 40_000, Some(8));
        assert!(tally.close > 50, "{tally:?}");
    }
}
