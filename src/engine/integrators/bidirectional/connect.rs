//! The strategies: what each adds, and with which weight.
//!
//! An end that is connected contributes no event probability. It is summed over its non-delta
//! events, each with its own class and its own weight (rule 2 of the code map).

use glam::{Vec2, Vec3A};

use super::ends::{LARGEST_INVERSE, LightEnd, Span, cosine};
use super::merge::PhotonGrid;
use super::strategies::Strategies;
use super::subpath::{Escape, LightStart, Subpath};
use super::vertex::Vertex;
use super::weight::{Density, Join, Meeting, weight};
use crate::engine::bsdf::{Evaluation, Transport};
use crate::engine::camera::CameraSample;
use crate::engine::event::{Event, Letter};
use crate::engine::geometry::Ray;
use crate::engine::integrators::{Pass, RenderStats};
use crate::engine::light::LightSample;
use crate::engine::math::Rgb;
use crate::engine::math::hash::combine;
use crate::engine::path::ClassId;
use crate::engine::scene::Scene;

/// A strategy: number of vertices from the light and from the lens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Technique {
    /// From the light.
    pub s: usize,
    /// From the lens.
    pub t: usize,
}

/// Where contributions go: the unweighted one, and its weight.
pub trait Sink {
    /// A camera sample begins with `ray`, at the film position `film`.
    fn begin(&mut self, _film: Vec2, _ray: &Ray) {}
    /// A path that ends on the pixel whose sample is being taken.
    fn add(&mut self, technique: Technique, class: ClassId, value: Rgb, weight: f32);
    /// A path that ends at the film position `film`.
    fn splat(&mut self, film: Vec2, technique: Technique, class: ClassId, value: Rgb, weight: f32);
}

/// Connects subpaths.
pub struct Connector<'a, K> {
    /// The pass.
    pub cx: &'a Pass<'a>,
    /// Which strategies are on.
    pub strategies: &'a Strategies,
    /// Where contributions go.
    pub sink: &'a mut K,
    /// Counts.
    pub stats: &'a mut RenderStats,
}

/// An event evaluated at the end of a subpath.
struct End {
    class: ClassId,
    diffuse: bool,
    /// f·cosθ of the event.
    f: Rgb,
    /// Density toward the other subpath, 1/sr.
    toward: f32,
    /// Density of the vertex before, drawn by a walk that comes from there; 1/m².
    back: f32,
}

impl End {
    #[inline]
    fn new(v: &Vertex, event: Event, class: ClassId, wi: Vec3A, transport: Transport) -> Self {
        let Evaluation { f, toward, back } = v.eval_both_ways(event, wi, transport);
        Self {
            class,
            diffuse: event == Event::Diffuse,
            f,
            toward,
            back: back * v.back,
        }
    }
}

impl<K: Sink> Connector<'_, K> {
    /// Whether paths of the strategy (s, t) are wanted.
    #[inline]
    fn is_on(&self, s: usize, t: usize) -> bool {
        let short = self
            .cx
            .plan
            .max_depth
            .is_none_or(|max| s + t <= max as usize + 2);
        short && self.strategies.is_on(s, t)
    }

    /// s = 0: the last of the `t` vertices of the eye walk lies on a light.
    pub fn hit(&mut self, eye: &Subpath, t: usize) {
        let lights = &self.cx.scene.lights;
        let v = eye.vertex(t - 1);
        let Some(id) = v.si.light.filter(|_| self.is_on(0, t)) else {
            return;
        };
        let light = lights.get(id);
        let emitted = light.emitted(&v.si, v.si.wo);
        if emitted.is_black() {
            return;
        }
        let end = LightEnd::new(id, light, v.si.p, Some(v.si.n_g));
        let (le, pmf) = (light.pdf_le(end.n, v.si.wo), lights.pmf(id));
        let (mut departs, mut shadow_ratio) = (0.0, 1.0);
        if t > 2 {
            let before = &eye.vertex(t - 2).si;
            departs = end.depart(le, v.si.wo, before);
            let pdf_li = light.pdf_li(before.p, -v.si.wo, Some(&v.si));
            shadow_ratio = end.shadow_ratio(pdf_li, le, before.p);
        }
        let join = Join {
            diffuse: [false; 2],
            meeting: Meeting::Connection,
            light: &[],
            eye: eye.densities(t),
            light_other: [0.0; 2],
            eye_other: [end.start(pmf, le), departs],
            shadow_ratio,
            zero_size: false,
            infinite: false,
        };
        let weight = weight(&join, self.strategies);
        self.sink.add(
            Technique { s: 0, t },
            v.class,
            v.throughput * emitted,
            weight,
        );
    }

    /// s = 0: the eye walk left the scene; all environments are seen there.
    pub fn escape(&mut self, eye: &Subpath, escape: &Escape, scratch: &mut Vec<Density>) {
        let t = eye.len() + 1;
        if !self.is_on(0, t) {
            return;
        }
        let lights = &self.cx.scene.lights;
        for &id in lights.environments() {
            let light = lights.get(id);
            let end = LightEnd::new(id, light, Vec3A::ZERO, None);
            let (le, pmf) = (light.pdf_le(None, -escape.d), lights.pmf(id));
            // The direction is the last vertex.
            scratch.clear();
            scratch.extend_from_slice(eye.densities(t - 1));
            scratch.push(Density {
                own: escape.pdf_dir,
                other: 0.0,
                connectible: true,
                mergeable: false,
            });
            let departs = if t > 2 {
                end.depart(le, escape.d, &eye.vertex(t - 2).si)
            } else {
                0.0
            };
            let join = Join {
                diffuse: [false; 2],
                meeting: Meeting::Connection,
                light: &[],
                eye: scratch,
                light_other: [0.0; 2],
                eye_other: [end.start(pmf, le), departs],
                shadow_ratio: 1.0,
                zero_size: false,
                infinite: true,
            };
            let weight = weight(&join, self.strategies);
            let value = escape.throughput * light.escaped(escape.d);
            self.sink
                .add(Technique { s: 0, t }, escape.class, value, weight);
        }
    }

    /// s = 1: a shadow ray from the last of the `t` vertices of the eye walk to the point `sample`
    /// of the light `id`, which was chosen with the probability `pmf`.
    pub fn shadow(&mut self, eye: &Subpath, t: usize, id: u32, pmf: f32, sample: &LightSample) {
        if !self.is_on(1, t) {
            return;
        }
        let light = self.cx.scene.lights.get(id);
        let v = eye.vertex(t - 1);
        let (p, wi) = (v.si.p, sample.wi);
        let q = if sample.distance.is_finite() {
            p + wi * sample.distance
        } else {
            sample.target
        };
        let end = LightEnd::new(id, light, q, sample.n);
        let le = light.pdf_le(sample.n, -wi);
        let start = end.start(pmf, le);
        let arrives = end.depart(le, -wi, &v.si);
        let shadow_ratio = end.shadow_ratio(sample.pdf_dir, le, p);
        let incident = v.throughput * sample.radiance * (1.0 / (pmf * sample.pdf_dir));
        let mut visibility = None;
        for event in v.non_delta_events() {
            let class = self.cx.plan.classes.prepend(event.letter(), v.class);
            if !self.cx.plan.is_wanted(class) {
                continue;
            }
            let z = End::new(v, event, class, wi, Transport::Radiance);
            if z.f.is_black() {
                continue;
            }
            let from = |scene: &Scene| (v.leaving(scene, wi), combine(v.key, 1));
            let visible = self.visible(&mut visibility, from, || sample.ray_from(&v.si));
            if visible.is_black() {
                return;
            }
            let join = Join {
                diffuse: [false, event == Event::Diffuse],
                meeting: Meeting::Connection,
                light: &[Density {
                    own: start,
                    other: 0.0,
                    connectible: true,
                    mergeable: false,
                }],
                eye: eye.densities(t),
                light_other: [end.arrive(z.toward, p), 0.0],
                eye_other: [arrives, z.back],
                shadow_ratio,
                zero_size: sample.is_delta,
                infinite: end.infinite,
            };
            let weight = weight(&join, self.strategies);
            self.sink.add(
                Technique { s: 1, t },
                class,
                incident * z.f * visible,
                weight,
            );
        }
    }

    /// s ≥ 2, t ≥ 2: the last of `s` vertices of the light walk and the last of `t` of the eye walk
    /// see each other.
    pub fn connect(&mut self, from: (&Subpath, &LightStart), s: usize, eye: &Subpath, t: usize) {
        if !self.is_on(s, t) {
            return;
        }
        let (light, start) = from;
        let (y, z) = (light.vertex(s - 1), eye.vertex(t - 1));
        let distance2 = (y.si.p - z.si.p).length_squared();
        if distance2 == 0.0 {
            return; // one point twice: its directions to itself have no measure
        }
        let span = Span::new(&z.si, &y.si);
        let wi = span.direction;
        let throughput = z.throughput * y.throughput * (1.0 / distance2);
        let (to_eye, to_light) = span.areas(&z.si, &y.si);
        let plan = self.cx.plan;
        let mut visibility = None;
        for event in z.non_delta_events() {
            let suffix = plan.classes.prepend(event.letter(), z.class);
            let eye_end = End::new(z, event, suffix, wi, Transport::Radiance);
            if eye_end.f.is_black() {
                continue;
            }
            for event in y.non_delta_events() {
                let prefix = plan.classes.append(y.class, event.letter());
                let class = plan.classes.join(prefix, suffix);
                if !plan.is_wanted(class) {
                    continue;
                }
                let light_end = End::new(y, event, prefix, -wi, Transport::Importance);
                if light_end.f.is_black() {
                    continue;
                }
                let ray = || z.si.spawn_ray_to_surface(&y.si);
                let from = |scene: &Scene| (z.leaving(scene, wi), combine(z.key, y.key));
                let visible = self.visible(&mut visibility, from, ray);
                if visible.is_black() {
                    return;
                }
                let join = Join {
                    diffuse: [light_end.diffuse, eye_end.diffuse],
                    meeting: Meeting::Connection,
                    light: light.densities(s),
                    eye: eye.densities(t),
                    light_other: [eye_end.toward * to_light, light_end.back],
                    eye_other: [light_end.toward * to_eye, eye_end.back],
                    shadow_ratio: start.shadow_ratio,
                    zero_size: start.end.zero_size,
                    infinite: start.end.infinite,
                };
                let weight = weight(&join, self.strategies);
                let value = throughput * eye_end.f * light_end.f * visible;
                self.sink.add(Technique { s, t }, class, value, weight);
            }
        }
    }

    /// Merging: the last of the `t` vertices of the eye walk with the photons around it.
    pub fn merge(&mut self, grid: &PhotonGrid, eye: &Subpath, t: usize) {
        let v = eye.vertex(t - 1);
        if !v.bsdf.has(Event::Diffuse) {
            return;
        }
        let plan = self.cx.plan;
        let suffix = plan.classes.prepend(Letter::D, v.class);
        let scale = (1.0 / grid.merging()) as f32;
        let densities = eye.densities(t);
        let eye_before = if t > 2 { densities[t - 3].other } else { 0.0 };
        grid.within(v.si.p, |photon| {
            let s = photon.s as usize;
            let class = plan.classes.join(photon.class, suffix);
            let long = plan.max_depth.is_some_and(|max| s + t > max as usize + 3);
            if long || !plan.is_wanted(class) {
                return;
            }
            let end = End::new(v, Event::Diffuse, class, photon.wo, Transport::Radiance);
            let cos = v.si.n_g.dot(photon.wo).abs();
            if end.f.is_black() || cos == 0.0 {
                return;
            }
            let (path, light) = grid.path(photon);
            let join = Join {
                light,
                eye: eye.densities(t - 1),
                light_other: [densities[t - 1].own, end.toward * photon.back],
                eye_other: [end.back, eye_before],
                shadow_ratio: path.shadow_ratio,
                diffuse: [true, false],
                meeting: Meeting::Merging,
                zero_size: path.end.zero_size,
                infinite: path.end.infinite,
            };
            let weight = weight(&join, self.strategies);
            // Flux per area over the cosine is radiance times solid angle.
            let value = v.throughput * photon.flux * end.f * (scale / cos);
            self.sink.add(Technique { s, t }, class, value, weight);
        });
    }

    /// t = 1, s ≥ 2: the last of `s` vertices of the light walk is joined to the lens by the random
    /// point `u` on it.
    pub fn join_lens(&mut self, from: (&Subpath, &LightStart), s: usize, lens: &Density, u: Vec2) {
        if !self.is_on(s, 1) {
            return;
        }
        let (light, start) = from;
        let y = light.vertex(s - 1);
        let Some(sample) = self.cx.camera.sample_wi(y.si.p, u) else {
            return;
        };
        let importance = y.throughput * (sample.importance / sample.pdf_dir);
        let seen = self.drawn_by_lens(&sample, cosine(&y.si, sample.wi));
        let mut visibility = None;
        for event in y.non_delta_events() {
            let class = self.cx.plan.classes.append(y.class, event.letter());
            if !self.cx.plan.is_wanted(class) {
                continue;
            }
            let end = End::new(y, event, class, sample.wi, Transport::Importance);
            if end.f.is_black() {
                continue;
            }
            let from = |scene: &Scene| (y.leaving(scene, sample.wi), combine(y.key, 2));
            let ray = || y.si.spawn_ray_to(sample.target);
            let visible = self.visible(&mut visibility, from, ray);
            if visible.is_black() {
                return;
            }
            let join = Join {
                diffuse: [event == Event::Diffuse, false],
                meeting: Meeting::Connection,
                light: light.densities(s),
                eye: std::slice::from_ref(lens),
                light_other: [seen, end.back],
                eye_other: [0.0; 2],
                shadow_ratio: start.shadow_ratio,
                zero_size: start.end.zero_size,
                infinite: start.end.infinite,
            };
            let weight = weight(&join, self.strategies);
            let value = importance * end.f * visible;
            let technique = Technique { s, t: 1 };
            self.sink
                .splat(sample.film, technique, end.class, value, weight);
        }
    }

    /// s = t = 1: the point where a light walk starts is joined to the lens.
    pub fn join_light(&mut self, light: &Subpath, start: &LightStart, lens: &Density, u: Vec2) {
        let (end, emission) = (&start.end, &start.emission);
        let Some(n) = end.n.filter(|_| self.is_on(1, 1) && !end.infinite) else {
            return;
        };
        let Some(sample) = self.cx.camera.sample_wi(end.p, u) else {
            return;
        };
        let cos = n.dot(sample.wi);
        if cos <= 0.0 || !self.cx.plan.is_wanted(ClassId::EMPTY) {
            return;
        }
        let from = |_: &Scene| (start.inside, start.key);
        let ray = || Ray {
            clear_of: emission.ray.clear_of,
            ..Ray::between(emission.ray.o, sample.target)
        };
        let visible = self.visible(&mut None, from, ray);
        let flux = emission.radiance * (cos / (start.pmf * emission.pdf_pos));
        let value = flux * (sample.importance / sample.pdf_dir) * visible;
        if value.is_black() {
            return;
        }
        let seen = self.drawn_by_lens(&sample, cos);
        let join = Join {
            diffuse: [false; 2],
            meeting: Meeting::Connection,
            light: light.densities(1),
            eye: std::slice::from_ref(lens),
            light_other: [seen, 0.0],
            eye_other: [0.0; 2],
            shadow_ratio: 1.0,
            zero_size: end.zero_size,
            infinite: false,
        };
        let weight = weight(&join, self.strategies);
        let technique = Technique { s: 1, t: 1 };
        self.sink
            .splat(sample.film, technique, ClassId::EMPTY, value, weight);
    }

    /// Density in 1/m² with which eye walks meet the point that `sample` joins to the lens, where
    /// the surface has the cosine `cos`.
    #[inline]
    fn drawn_by_lens(&self, sample: &CameraSample, cos: f32) -> f32 {
        let near = (1.0 / sample.distance).min(LARGEST_INVERSE);
        self.cx.camera.pdf_dir(-sample.wi) * cos * (near * near)
    }
}
