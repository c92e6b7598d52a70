//! The weights of all strategies against densities computed apart, vertex by vertex, from the
//! finished path: no recursion, no ratio, and delta events by a rule of their own.

use glam::{Vec2, Vec3A};

use super::*;
use crate::engine::bsdf::Bsdf;
use crate::engine::camera::Camera;
use crate::engine::event::Event;
use crate::engine::geometry::Ray;
use crate::engine::integrators::{Cancel, Pass, RenderStats};
use crate::engine::io::scene_file;
use crate::engine::light::LightSample;
use crate::engine::math::Rgb;
use crate::engine::path::ClassId;
use crate::engine::plan::{LayerSettings, RenderPlan};
use crate::engine::sampling::{IndependentSampler, Sampler, Stream};
use crate::engine::scene::Scene;

const GLASS: f32 = 1.5;

/// A scene of every kind of material; `rest` is its TOML without them.
fn scene(rest: &str) -> Scene {
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
fn things(room: &str, lamp: &str, lights: &str, lens: &str) -> Scene {
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
fn slit(material: &str) -> Scene {
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

/// A complete path, from the light to the lens.
struct Full<'a> {
    pass: &'a Pass<'a>,
    end: LightEnd,
    /// v₁ … vₙ₋₂ and the event at each.
    inner: Vec<(&'a Vertex, Event)>,
    /// Unit directions from each vertex to the next.
    edges: Vec<Vec3A>,
    lens: Vec3A,
}

impl Full<'_> {
    fn n(&self) -> usize {
        self.inner.len() + 2
    }

    /// Index of refraction on the side of a surface that `w` points to.
    fn index(&self, v: &Vertex, w: Vec3A) -> f64 {
        let name = &self.pass.scene.material_names[v.si.material as usize];
        let inside = w.dot(v.si.n_g) < 0.0;
        if name == "glass" && inside {
            f64::from(GLASS)
        } else {
            1.0
        }
    }

    /// Density in 1/sr of drawing `to` at vertex `i`, coming from `from`. The delta of a specular
    /// event is one of the measure n² cosθ dω, the same for both ways, and left out.
    fn pdf_dir(&self, i: usize, from: Vec3A, to: Vec3A) -> f64 {
        let (v, event) = self.inner[i - 1];
        let bsdf: &Bsdf = &v.bsdf;
        if event.is_delta() {
            let basis = self.index(v, to).powi(2) * f64::from(v.si.n_s.dot(to).abs());
            return f64::from(bsdf.event_probability(event, from)) * basis;
        }
        f64::from(bsdf.pdf(event, from, to))
    }

    fn point(&self, i: usize) -> Vec3A {
        match i {
            0 => self.end.p,
            _ if i + 1 == self.n() => self.lens,
            _ => self.inner[i - 1].0.si.p,
        }
    }

    fn normal(&self, i: usize) -> Option<Vec3A> {
        match i {
            0 => self.end.n,
            _ if i + 1 == self.n() => Some(self.pass.camera.forward()),
            _ => Some(self.inner[i - 1].0.si.n_g),
        }
    }

    /// Area density of vertex `to`, next to `from`.
    fn area(&self, pdf_dir: f64, from: usize, to: usize) -> f64 {
        let w = self.edges[from.min(to)].as_dvec3();
        let distance2 = (self.point(from).as_dvec3() - self.point(to).as_dvec3()).length_squared();
        let cos = self.normal(to).map_or(1.0, |n| n.as_dvec3().dot(w).abs());
        pdf_dir * cos / distance2
    }

    /// The density of the strategy (s, n − s).
    fn density(&self, s: usize) -> f64 {
        let (n, scene) = (self.n(), self.pass.scene);
        let light = scene.lights.get(self.end.id);
        let open = |v: usize| v == 0 || v + 1 == n || !self.inner[v - 1].1.is_delta();
        let possible = match s {
            0 => !light.is_delta(),
            1 if n == 2 => !light.is_delta() && !light.is_infinite(),
            _ => open(s - 1) && open(s),
        };
        if !possible {
            return 0.0;
        }
        let (pdf_pos, pdf_dir) = light.pdf_le(self.end.n, self.edges[0]);
        let pmf = f64::from(scene.lights.pmf(self.end.id));
        let mut p = 1.0;
        for i in 0..s {
            p *= match i {
                0 if light.is_infinite() => pmf * f64::from(pdf_dir),
                0 if s == 1 && n > 2 && !light.is_delta() => {
                    let hit = self.light_point();
                    let li = light.pdf_li(self.point(1), -self.edges[0], Some(&hit));
                    pmf * self.area(f64::from(li), 1, 0)
                }
                0 => pmf * f64::from(pdf_pos),
                1 if light.is_infinite() => {
                    let cos = self.normal(1).map_or(1.0, |n| n.dot(self.edges[0]).abs());
                    f64::from(pdf_pos) * f64::from(cos)
                }
                1 => self.area(f64::from(pdf_dir), 0, 1),
                _ => {
                    let out = self.pdf_dir(i - 1, -self.edges[i - 2], self.edges[i - 1]);
                    self.area(out, i - 1, i)
                }
            };
        }
        let first = Ray::new(self.lens, -self.edges[n - 2]);
        let we = self.pass.camera.pdf_we(&first);
        for i in (s..n).rev() {
            p *= if i == n - 1 {
                f64::from(we.0)
            } else {
                let out = if i == n - 2 {
                    f64::from(we.1)
                } else {
                    self.pdf_dir(i + 1, self.edges[i + 1], -self.edges[i])
                };
                if i == 0 && light.is_infinite() {
                    out
                } else {
                    self.area(out, i + 1, i)
                }
            };
        }
        p
    }

    fn light_point(&self) -> crate::engine::geometry::SurfaceInteraction {
        let n = self.end.n.unwrap_or(Vec3A::Z);
        crate::engine::geometry::SurfaceInteraction {
            p: self.end.p,
            p_error: Vec3A::ZERO,
            n_g: n,
            n_s: n,
            uv: Vec2::ZERO,
            wo: self.edges[0],
            t: 0.0,
            material: 0,
            light: Some(self.end.id),
            prim: 0,
        }
    }
}

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

    fn walk_events<'v>(path: &'v Subpath, n: usize) -> Vec<(&'v Vertex, Option<Event>)> {
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
                    let transport = crate::engine::bsdf::Transport::Radiance;
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
                let wi = (y.si.p - z.si.p).normalize();
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
                let transport = crate::engine::bsdf::Transport::Importance;
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
        (None, Some((y, _)), Some(z)) => edges.push((z.si.p - y.si.p).normalize()),
        (None, Some((y, _)), None) => edges.push((lens - y.si.p).normalize()),
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
    println!("{:?}", checker.tally);
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
        let tally = check_scene(&slit(material), Heuristic::Balance, 3000, Some(8));
        assert!(tally.close > 50, "{tally:?}");
    }
}

/// Light tracing never asks for the lens density: one strategy needs no weight.
#[test]
fn a_strategy_alone_has_weight_one() {
    let lens = Density {
        own: 1.0,
        other: 0.0,
        connectible: true,
    };
    let light = [lens; 3];
    let join = Join {
        light: &light,
        eye: &[lens],
        light_other: [0.3, 2.0],
        eye_other: [0.0; 2],
        shadow_ratio: 5.0,
        zero_size: false,
        infinite: false,
    };
    assert_eq!(weight(&join, &Strategies::lens_alone()), 1.0);
    assert!(weight(&join, &Strategies::all(Heuristic::Power)) < 1.0);
}
