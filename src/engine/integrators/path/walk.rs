//! The walk from the eye.

use glam::Vec3A;

use super::{Mode, PathTracer};
use crate::engine::bsdf::{BsdfSample, Transport};
use crate::engine::event::Event;
use crate::engine::geometry::{Departure, Ray, SurfaceInteraction};
use crate::engine::integrators::replay::{RadianceSink, Step};
use crate::engine::integrators::tiled::{CAMERA_DIMENSIONS, RayIntegrator};
use crate::engine::integrators::{Pass, RenderStats};
use crate::engine::math::Rgb;
use crate::engine::path::ClassId;
use crate::engine::sampling::{MAX_SURVIVAL, Sampler, mis};

/// Most events of a path; beyond, it is cut and counted.
pub(super) const MAX_EVENTS: u32 = 10_000_000;
/// Dimensions reserved per vertex: four for the walk, four for the shadow ray.
const VERTEX_DIMENSIONS: u32 = 8;

/// The state of a walk between two vertices.
pub(in crate::engine::integrators) struct Walk {
    /// Product of f·cosθ/pdf over the events so far, survival divided out.
    pub throughput: Rgb,
    /// Class of the events so far, the light side still open.
    pub suffix: ClassId,
    /// Events so far.
    pub depth: u32,
    /// Product of the squared index ratios: roulette looks at what returns to the eye's medium.
    eta2: f32,
    /// Where the last event happened, and how.
    pub(super) last: Option<Scattered>,
}

impl Walk {
    /// A walk that has left the lens.
    pub fn start() -> Self {
        Self {
            throughput: Rgb::WHITE,
            suffix: ClassId::EMPTY,
            depth: 0,
            eta2: 1.0,
            last: None,
        }
    }

    /// This walk after one more event, `sample` at `si`, as one of several with the weight `share`.
    pub fn after(
        &self,
        si: &SurfaceInteraction,
        sample: &BsdfSample,
        suffix: ClassId,
        share: f32,
    ) -> Self {
        Self {
            throughput: self.throughput * sample.weight * share,
            suffix,
            depth: self.depth + 1,
            eta2: self.eta2 * sample.eta * sample.eta,
            last: Some(Scattered {
                p: si.p,
                event: sample.event,
                pdf_dir: sample.pdf_dir,
                departure: si.departure(sample.wi),
            }),
        }
    }

    /// This walk after scattering at `p` in a medium, in a direction of density `pdf_dir` in 1/sr.
    /// The albedo is in the throughput already.
    pub fn after_volume(&self, p: Vec3A, pdf_dir: f32, suffix: ClassId) -> Self {
        Self {
            throughput: self.throughput,
            suffix,
            depth: self.depth + 1,
            eta2: self.eta2,
            last: Some(Scattered {
                p,
                event: Event::Volume,
                pdf_dir,
                departure: Departure::NOWHERE,
            }),
        }
    }

    /// Where the last event happened and the density of its direction in 1/sr, if a shadow ray from
    /// there might have gone the same way.
    pub(super) fn last_found(&self) -> Option<(Vec3A, f32)> {
        let last = self.last.as_ref().filter(|last| !last.event.is_delta());
        last.map(|last| (last.p, last.pdf_dir))
    }

    /// Where the ray under way left a surface.
    pub fn departure(&self) -> Departure {
        self.last
            .as_ref()
            .map_or(Departure::NOWHERE, |last| last.departure)
    }

    /// That it met the light `id`, for those who listen; `light_pdf` is the density of shadow rays.
    fn met(&self, id: u32, weight: f32, light_pdf: impl FnOnce(Vec3A) -> f32) -> Step {
        let last = self.last.as_ref().filter(|last| !last.event.is_delta());
        Step::Found {
            light: Some(id),
            event: None,
            pdf_light: last.map(|last| light_pdf(last.p)),
            pdf_walk: last.map(|last| last.pdf_dir),
            weight,
            visible: Rgb::WHITE,
        }
    }

    /// Russian roulette after `from` events with the random number `u`; false if the walk ends.
    /// Survival divides the throughput and enters no weight.
    pub fn survives(&mut self, from: u32, u: f32, stats: &mut RenderStats) -> bool {
        if self.depth <= from {
            return !self.throughput.is_black();
        }
        let survival = (self.throughput.max_component() * self.eta2).min(MAX_SURVIVAL);
        self.throughput *= 1.0 / survival;
        stats.play(u < survival)
    }
}

pub(in crate::engine::integrators) struct Scattered {
    p: Vec3A,
    event: Event,
    pdf_dir: f32,
    departure: Departure,
}

impl RayIntegrator for PathTracer {
    fn radiance<S: Sampler>(
        &self,
        cx: &Pass<'_>,
        mut ray: Ray,
        sampler: &mut S,
        out: &mut impl RadianceSink,
        stats: &mut RenderStats,
    ) {
        // Scenes without media never come near the code that knows of them.
        if cx.plan.features.media {
            self.radiance_in_media(cx, ray, sampler, out, stats);
            return;
        }
        let mut walk = Walk::start();
        loop {
            // Dimensions are reserved per vertex: what one vertex draws shifts no later one.
            let first = CAMERA_DIMENSIONS + VERTEX_DIMENSIONS * walk.depth;

            // The next surface, or the sky.
            stats.ray_at(walk.depth);
            let hit = cx.scene.intersect(&ray, || opacity_number(sampler, first));
            stats.count_ray_fault(cx.scene.ray_fault(walk.departure(), hit.as_ref()));
            let Some(si) = hit else {
                self.add_escaped(cx, &walk, &ray, out);
                return;
            };
            out.note(|| Step::vertex(&si, walk.throughput, walk.suffix));

            // Light that the walk met by itself.
            self.add_emitted(cx, &walk, &si, out);
            if cx.plan.max_depth.is_some_and(|max| walk.depth >= max) {
                out.note(|| Step::ended("it has as many events as a path may have"));
                return;
            }
            if walk.depth >= MAX_EVENTS {
                stats.cut_paths += 1;
                out.note(|| Step::ended("it was cut at the largest number of events"));
                return;
            }

            // Light found by shadow rays.
            let bsdf = cx.scene.bsdf(&si);
            if bsdf.is_empty() {
                out.note(|| Step::ended("the surface scatters nothing"));
                return;
            }
            if self.sends_shadow_rays(cx) && bsdf.has_non_delta() {
                sampler.seek(first + 4);
                self.add_direct(cx, &walk, &si, &bsdf, sampler, out, stats);
            }

            // One event, drawn by the roulette between the lobes.
            sampler.seek(first);
            let (direction, event, roulette) =
                (sampler.next_2d(), sampler.next_1d(), sampler.next_1d());
            let Some(sample) = bsdf.sample(si.wo, event, direction, Transport::Radiance) else {
                stats.below_horizon += u64::from(bsdf.has(Event::Glossy));
                out.note(|| Step::ended("no direction was drawn: below the horizon, or no event"));
                return;
            };
            out.note(|| Step::scattered(&sample));
            let suffix = cx.plan.classes.prepend(sample.event.letter(), walk.suffix);
            walk = walk.after(&si, &sample, suffix, 1.0);
            if cx.plan.is_pointless(walk.suffix) {
                out.note(|| Step::ended("no layer that is asked for has such a word"));
                return;
            }

            let survived = walk.survives(self.roulette, roulette, stats);
            out.note(|| Step::roulette(roulette, survived, walk.throughput));
            if !survived {
                return;
            }
            ray = si.spawn_ray(sample.wi);
        }
    }
}

/// The spare number of a vertex, for the stochastic passage through surfaces of opacity below 1.
fn opacity_number<S: Sampler>(sampler: &mut S, first: u32) -> f32 {
    sampler.seek(first + 7);
    sampler.next_1d()
}

impl PathTracer {
    /// Whether shadow rays are part of the mode, and of the plan.
    pub(in crate::engine::integrators) fn sends_shadow_rays(&self, cx: &Pass<'_>) -> bool {
        self.mode != Mode::Hits && cx.plan.shadow_rays
    }

    /// Weight of light that the walk met, against a shadow ray toward it of density `light_pdf`
    /// (selection included, 1/sr).
    fn hit_weight(&self, last: Option<&Scattered>, light_pdf: impl FnOnce(Vec3A) -> f32) -> f32 {
        let Some(last) = last else { return 1.0 };
        if last.event.is_delta() {
            return 1.0;
        }
        match self.mode {
            Mode::Hits => 1.0,
            Mode::Kajiya => 0.0,
            Mode::Mis => mis::power(last.pdf_dir, light_pdf(last.p)),
        }
    }

    /// Light that the walk met at `si`.
    pub(in crate::engine::integrators) fn add_emitted(
        &self,
        cx: &Pass<'_>,
        walk: &Walk,
        si: &SurfaceInteraction,
        out: &mut impl RadianceSink,
    ) {
        let Some(id) = si.light else { return };
        let lights = &cx.scene.lights;
        let light = lights.get(id);
        let emitted = light.emitted(si, si.wo);
        if emitted.is_black() {
            return;
        }
        let light_pdf = |p| lights.pmf(id) * light.pdf_li(p, -si.wo, Some(si));
        let weight = self.hit_weight(walk.last.as_ref(), light_pdf);
        out.note(|| walk.met(id, weight, light_pdf));
        out.add(walk.suffix, walk.throughput * emitted * weight);
    }

    /// Light of the sky that the walk left the scene for.
    pub(in crate::engine::integrators) fn add_escaped(
        &self,
        cx: &Pass<'_>,
        walk: &Walk,
        ray: &Ray,
        out: &mut impl RadianceSink,
    ) {
        out.note(|| Step::Escaped { d: ray.d });
        let lights = &cx.scene.lights;
        for &id in lights.environments() {
            let light = lights.get(id);
            let light_pdf = |p| lights.pmf(id) * light.pdf_li(p, ray.d, None);
            let weight = self.hit_weight(walk.last.as_ref(), light_pdf);
            out.note(|| walk.met(id, weight, light_pdf));
            out.add(walk.suffix, walk.throughput * light.escaped(ray.d) * weight);
        }
    }
}
