//! The two walks. They keep what connections and weights need of every vertex.

use glam::Vec3A;

use super::ends::{LightEnd, Span, area_density};
use super::vertex::Vertex;
use super::weight::Density;
use crate::engine::bsdf::{BsdfSample, Transport};
use crate::engine::event::Event;
use crate::engine::geometry::{Departure, Ray, SurfaceInteraction};
use crate::engine::integrators::{Pass, RenderStats};
use crate::engine::light::EmissionSample;
use crate::engine::math::Rgb;
use crate::engine::media::{Draws, Inside, Phase};
use crate::engine::path::ClassId;
use crate::engine::plan::RenderPlan;
use crate::engine::sampling::{MAX_SURVIVAL, Sampler};

/// Dimensions reserved per vertex: direction 0–1, event 2, roulette 3, light or lens 4–5, choice of
/// a light 6, opacity 7; in media channel and distance 8–9, seeds of the flight 10–11.
#[inline]
pub fn vertex_dimensions(plan: &RenderPlan) -> u32 {
    if plan.features.media { 12 } else { 8 }
}

/// First dimension of the first vertex after a light: position 0–1, direction 2–3, choice 4, a
/// point of the lens 6–7.
pub const FIRST_LIGHT_VERTEX: u32 = 8;
/// Most events of a walk; beyond, it is cut and counted.
const MAX_EVENTS: usize = 10_000_000;

/// A subpath. Vertex 0, the lens or the light, has densities only.
#[derive(Clone, Debug, Default)]
pub struct Subpath {
    /// From vertex 1 on. Those of longer walks before are kept behind them, to be filled again.
    vertices: Vec<Vertex>,
    /// Of vertex 0 and of those in use of `vertices`.
    densities: Vec<Density>,
    /// Light of media that an eye walk met on its way.
    pub(super) glow: Vec<(ClassId, Rgb)>,
}

/// How an eye walk left the scene.
#[derive(Clone, Copy, Debug)]
pub struct Escape {
    /// Direction.
    pub d: Vec3A,
    /// Its density in 1/sr.
    pub pdf_dir: f32,
    /// As in [`Vertex`].
    pub throughput: Rgb,
    /// As in [`Vertex`].
    pub class: ClassId,
}

/// Where a light walk starts.
#[derive(Clone, Copy, Debug)]
pub struct LightStart {
    /// v₀.
    pub end: LightEnd,
    /// Probability of the choice of the light.
    pub pmf: f32,
    /// The first ray.
    pub emission: EmissionSample,
    /// Density of a shadow ray from v₁ to v₀ over that of this start; known with v₁.
    pub shadow_ratio: f32,
    /// What its point is within.
    pub inside: Inside,
    /// Key of random numbers, in scenes with media.
    pub key: u64,
}

impl Subpath {
    fn restart(&mut self, own: f32) {
        self.densities.clear();
        self.glow.clear();
        self.densities.push(Density {
            own,
            other: 0.0,
            connectible: true,
            mergeable: false,
        });
    }

    /// Number of vertices, the end included.
    #[inline]
    pub fn len(&self) -> usize {
        self.densities.len()
    }

    /// Never true once a walk has begun: its end is the first vertex.
    pub fn is_empty(&self) -> bool {
        self.densities.is_empty()
    }

    /// Number of vertices after the end.
    #[inline]
    fn events(&self) -> usize {
        self.densities.len() - 1
    }

    /// The last vertex after the end.
    #[inline]
    fn last(&self) -> Option<&Vertex> {
        self.vertices[..self.events()].last()
    }

    /// Adds a vertex that the walk draws with the density `own`, to be filled.
    #[inline]
    fn add(&mut self, own: f32) -> &mut Vertex {
        let events = self.events();
        self.densities.push(Density {
            own,
            other: 0.0,
            connectible: true,
            mergeable: false,
        });
        if self.vertices.len() == events {
            self.vertices.push(Vertex::blank());
        }
        &mut self.vertices[events]
    }

    /// Keeps what the event at the last vertex decides: whether connections may end there, and the
    /// density, in 1/sr, with which the other walk would draw the direction back from there.
    #[inline]
    fn go_on(&mut self, event: Event, backward: f32) {
        let last = self.events();
        let vertex = &mut self.vertices[last - 1];
        vertex.event = Some(event);
        self.densities[last].connectible = !event.is_delta();
        self.densities[last].mergeable = event == Event::Diffuse;
        self.densities[last - 1].other = backward * vertex.back;
    }

    /// Vertex `i`, from 1.
    #[inline]
    pub fn vertex(&self, i: usize) -> &Vertex {
        &self.vertices[i - 1]
    }

    /// The densities of the first `n` vertices.
    #[inline]
    pub fn densities(&self, n: usize) -> &[Density] {
        &self.densities[..n]
    }
}

/// The end a walk began at.
#[derive(Clone, Copy)]
enum Origin {
    Lens(Vec3A),
    Light(LightEnd, (f32, f32)),
}

/// What travels between two vertices.
pub(super) struct Flight {
    pub(super) ray: Ray,
    pub(super) throughput: Rgb,
    class: ClassId,
    /// Density of the ray's direction, 1/sr.
    pdf_dir: f32,
    /// What the walk has kept of what it started with; roulette looks at it. For radiance the
    /// squared index ratios are taken out: what returns to the eye's medium counts.
    pub(super) kept: Rgb,
    /// What the ray's origin is within.
    pub(super) inside: Inside,
}

/// Where a flight scatters.
struct Met {
    si: SurfaceInteraction,
    /// In a medium.
    phase: Option<Phase>,
    /// See [`Vertex`].
    key: u64,
}

/// Makes subpaths.
pub struct Walker<'a> {
    /// The pass.
    pub cx: &'a Pass<'a>,
    /// Number of events after which roulette may end a walk.
    pub roulette: usize,
}

impl Walker<'_> {
    /// A walk from the lens along `ray`, which began as the camera's film position and lens point
    /// say. Returns how it left the scene, if it did.
    pub fn from_lens<S: Sampler>(
        &self,
        ray: Ray,
        first_dimension: u32,
        sampler: &mut S,
        path: &mut Subpath,
        stats: &mut RenderStats,
    ) -> Option<Escape> {
        let (pdf_pos, pdf_dir) = self.cx.camera.pdf_of_generated(&ray);
        path.restart(pdf_pos);
        let flight = Flight {
            ray,
            throughput: Rgb::WHITE,
            class: ClassId::EMPTY,
            pdf_dir,
            kept: Rgb::WHITE,
            inside: self.cx.scene.inside(ray.o),
        };
        let origin = Origin::Lens(ray.o);
        let end = self.walk(origin, flight, first_dimension, sampler, path, stats)?;
        Some(Escape {
            d: end.ray.d,
            pdf_dir: end.pdf_dir,
            throughput: end.throughput,
            class: end.class,
        })
    }

    /// A walk from a light chosen by its power. None if the light has nothing to send.
    pub fn from_light<S: Sampler>(
        &self,
        sampler: &mut S,
        path: &mut Subpath,
        stats: &mut RenderStats,
    ) -> Option<LightStart> {
        let lights = &self.cx.scene.lights;
        sampler.seek(0);
        let (u_pos, u_dir) = (sampler.next_2d(), sampler.next_2d());
        let choice = if lights.are_several() {
            sampler.next_1d()
        } else {
            0.0
        };
        let (id, pmf) = lights.sample(choice)?;
        let light = lights.get(id);
        let emission = light.sample_le(u_pos, u_dir)?;
        let le = (emission.pdf_pos, emission.pdf_dir);
        let end = LightEnd::new(id, light, emission.p, emission.n);
        path.restart(end.start(pmf, le));
        let inside = self.cx.scene.inside(emission.ray.o);
        let flight = Flight {
            ray: emission.ray,
            throughput: emission.flux() / pmf,
            class: ClassId::EMPTY,
            pdf_dir: emission.pdf_dir,
            kept: Rgb::WHITE,
            inside,
        };
        let mut start = LightStart {
            end,
            pmf,
            emission,
            shadow_ratio: 1.0,
            inside,
            key: Draws::new(u_pos.into(), u_dir.into()).key(),
        };
        if !flight.throughput.is_black() {
            let origin = Origin::Light(end, le);
            self.walk(origin, flight, FIRST_LIGHT_VERTEX, sampler, path, stats);
        }
        if path.len() > 1 {
            let first = path.vertex(1);
            let pdf_li = light.pdf_li(first.si.p, first.si.wo, self.point_of(&start).as_ref());
            start.shadow_ratio = end.shadow_ratio(pdf_li, le, first.si.p);
        }
        Some(start)
    }

    /// v₀ as `Light::pdf_li` wants to see it.
    fn point_of(&self, start: &LightStart) -> Option<SurfaceInteraction> {
        let n = start.end.n?;
        Some(SurfaceInteraction {
            p: start.end.p,
            p_error: start.emission.p_error,
            n_g: n,
            n_s: n,
            uv: glam::Vec2::ZERO,
            wo: start.emission.ray.d,
            t: 0.0,
            material: 0,
            light: Some(start.end.id),
            prim: 0,
        })
    }

    /// Adds vertices to `path` until the walk ends; returns the flight that left the scene.
    fn walk<S: Sampler>(
        &self,
        origin: Origin,
        mut flight: Flight,
        first_dimension: u32,
        sampler: &mut S,
        path: &mut Subpath,
        stats: &mut RenderStats,
    ) -> Option<Flight> {
        let transport = match origin {
            Origin::Lens(_) => Transport::Radiance,
            Origin::Light(..) => Transport::Importance,
        };
        loop {
            // Dimensions are reserved per vertex: what one vertex draws shifts no later one.
            let events = path.events();
            let first = first_dimension + vertex_dimensions(self.cx.plan) * events as u32;
            match transport {
                Transport::Radiance => stats.ray_at(events as u32),
                Transport::Importance => stats.light_ray_at(events as u32),
            }
            let Some(met) = self.meet(&mut flight, transport, first, sampler, path, stats) else {
                return Some(flight);
            };
            self.arrive(origin, &flight, &met, path)?;
            let max = self.cx.plan.max_depth;
            if max.is_some_and(|max| events >= max as usize) {
                return None;
            }
            if events >= MAX_EVENTS {
                stats.cut_paths += 1;
                return None;
            }

            // One event, drawn by the roulette between the lobes.
            let vertex = path.last()?;
            if vertex.bsdf.is_empty() && vertex.phase.is_none() {
                return None;
            }
            sampler.seek(first);
            let (direction, event, roulette) =
                (sampler.next_2d(), sampler.next_1d(), sampler.next_1d());
            let Some(sample) = vertex.sample(event, direction, transport) else {
                stats.below_horizon += u64::from(vertex.bsdf.has(Event::Glossy));
                return None;
            };
            let backward = backward_pdf(vertex, &sample);
            self.advance(&mut flight, &met.si, &sample, transport)?;
            path.go_on(sample.event, backward);

            // Russian roulette: survival divides the throughput and enters no weight.
            if events + 1 > self.roulette {
                let survival = flight.kept.max_component().min(MAX_SURVIVAL);
                if !stats.play(roulette < survival) {
                    return None;
                }
                flight.throughput *= 1.0 / survival;
                flight.kept *= 1.0 / survival;
            } else if flight.throughput.is_black() {
                return None;
            }
        }
    }

    /// The next place where the flight scatters; None if it leaves the scene.
    #[inline]
    fn meet<S: Sampler>(
        &self,
        flight: &mut Flight,
        transport: Transport,
        first: u32,
        sampler: &mut S,
        path: &mut Subpath,
        stats: &mut RenderStats,
    ) -> Option<Met> {
        let left = match path.last() {
            Some(last) => last.si.departure(flight.ray.d),
            None => Departure::NOWHERE,
        };
        let met = if self.cx.plan.features.media {
            let (class, before) = (flight.class, flight.throughput);
            let fly = self.fly(flight, first, sampler, stats);
            if !fly.emitted.is_black() && transport == Transport::Radiance {
                path.glow.push((class, before * fly.emitted));
            }
            let key = fly.key;
            fly.met.map(|(si, phase)| Met { si, phase, key })
        } else {
            let opacity_number = || {
                sampler.seek(first + 7);
                sampler.next_1d()
            };
            let si = self.cx.scene.intersect(&flight.ray, opacity_number);
            let (phase, key) = (None, 0);
            si.map(|si| Met { si, phase, key })
        };
        let si = met.as_ref().map(|met| &met.si);
        stats.count_ray_fault(self.cx.scene.ray_fault(left, si));
        met
    }

    /// Adds the vertex `met`; None if it is seen exactly edge-on: nothing scatters there.
    #[inline]
    fn arrive(&self, origin: Origin, flight: &Flight, met: &Met, path: &mut Subpath) -> Option<()> {
        let si = &met.si;
        let (own, back) = match (path.last(), origin) {
            (Some(last), _) => {
                let (back, ahead) = Span::new(&last.si, si).areas(&last.si, si);
                (flight.pdf_dir * ahead, back)
            }
            (None, Origin::Lens(p)) => (area_density(flight.pdf_dir, p, si), 0.0),
            (None, Origin::Light(end, le)) => {
                (end.depart(le, flight.ray.d, si), end.arrive(1.0, si.p))
            }
        };
        if own <= 0.0 {
            return None;
        }
        let vertex = path.add(own);
        vertex.bsdf.reset(si);
        if met.phase.is_none() {
            self.cx.scene.add_lobes(si, &mut vertex.bsdf);
        }
        vertex.si = *si;
        (vertex.phase, vertex.key, vertex.back) = (met.phase, met.key, back);
        (vertex.inside, vertex.class, vertex.event) = (flight.inside, flight.class, None);
        vertex.throughput = flight.throughput;
        Some(())
    }

    /// Scatters the flight; None if no layer that is asked for has words of its new class.
    fn advance(
        &self,
        flight: &mut Flight,
        si: &SurfaceInteraction,
        sample: &BsdfSample,
        transport: Transport,
    ) -> Option<()> {
        let (plan, letter) = (self.cx.plan, sample.event.letter());
        flight.throughput *= sample.weight;
        flight.kept *= sample.weight;
        flight.pdf_dir = sample.pdf_dir;
        flight.ray = si.spawn_ray(sample.wi);
        if plan.features.media {
            flight.inside = self.cx.scene.beyond(&flight.inside, si, sample.wi);
        }
        let pointless = match transport {
            Transport::Radiance => {
                flight.kept *= sample.eta * sample.eta;
                flight.class = plan.classes.prepend(letter, flight.class);
                plan.is_pointless(flight.class)
            }
            Transport::Importance => {
                flight.class = plan.classes.append(flight.class, letter);
                plan.is_pointless_from_light(flight.class)
            }
        };
        (!pointless).then_some(())
    }
}

/// P(event) · p_event in 1/sr of the way back: from the sampled direction to the one that was known.
///
/// A delta event carries the same delta either way, which cancels between strategies, but its
/// probability does not, nor the Jacobian |dω_wi / dω_wo| where refraction narrows or widens a
/// bundle of directions: n² cosθ dω is what it keeps (Veach 1997, section 5.2). It is the ratio of
/// the densities of a rough dielectric as its roughness vanishes.
fn backward_pdf(vertex: &Vertex, sample: &BsdfSample) -> f32 {
    let (wo, wi) = (vertex.si.wo, sample.wi);
    if !sample.event.is_delta() {
        return vertex.pdf(sample.event, wi, wo);
    }
    let probability = vertex.bsdf.event_probability(sample.event, wi);
    if sample.eta == 1.0 {
        return probability;
    }
    let (cos_o, cos_i) = (vertex.si.n_s.dot(wo).abs(), vertex.si.n_s.dot(wi).abs());
    probability * (cos_o / cos_i) / (sample.eta * sample.eta)
}
