//! The walk from the eye through participating media.
//!
//! Flights end at surfaces or at places where a medium scatters (V). Light is found at both by
//! shadow rays and by the walk itself, weighed by their densities of directions; transmittance
//! divides the throughput and enters no weight (CONTRACT rule 6). On each flight light is looked for
//! at one more place ([`super::equiangular`]); it and the place where the flight is scattered share what
//! they find by their densities of distances.

use glam::{Vec2, Vec3A};

use super::gather::Gather;
use super::glow;
use super::part::Part;
use super::walk::{MAX_EVENTS, Walk};
use super::{Mode, PathTracer, turned};
use crate::engine::bsdf::{Bsdf, Transport};
use crate::engine::event::{Event, Letter};
use crate::engine::geometry::{Ray, SurfaceInteraction};
use crate::engine::integrators::replay::{RadianceSink, Step};
use crate::engine::integrators::tiled::CAMERA_DIMENSIONS;
use crate::engine::integrators::{Pass, RenderStats};
use crate::engine::light::LightSample;
use crate::engine::math::Rgb;
use crate::engine::media::{Draws, Inside};
use crate::engine::path::ClassId;
use crate::engine::sampling::{Sampler, mis};
use crate::engine::scene::{Arrival, Flight, Scene, Span, VolumePoint};

/// Dimensions reserved per vertex and the flight to it: direction 0–1, event 2, roulette 3, light
/// 4–6, channel and distance 8–9, seeds of the flight 10–11, equiangular 12–15.
const VERTEX_DIMENSIONS: u32 = 16;

/// All that a walk works with.
pub(super) struct VolumeWalk<'a, S, G, O> {
    gather: &'a mut G,
    tracer: &'a PathTracer,
    cx: &'a Pass<'a>,
    sampler: &'a mut S,
    out: &'a mut O,
    stats: &'a mut RenderStats,
    walk: Walk,
    ray: Ray,
    /// What the ray's origin is within.
    inside: Inside,
    /// The first of the current vertex's dimensions.
    first: u32,
    /// It may have no more events.
    ends: bool,
}

impl PathTracer {
    /// As `radiance`, in scenes with media.
    pub(super) fn radiance_in_media<S: Sampler>(
        &self,
        cx: &Pass<'_>,
        ray: Ray,
        sampler: &mut S,
        out: &mut impl RadianceSink,
        stats: &mut RenderStats,
    ) {
        self.gather_in_media(cx, ray, sampler, &mut (), out, stats);
    }

    /// Walks through media and ends as `gather` says.
    pub(in crate::engine::integrators) fn gather_in_media<S: Sampler, G: Gather>(
        &self,
        cx: &Pass<'_>,
        ray: Ray,
        sampler: &mut S,
        gather: &mut G,
        out: &mut impl RadianceSink,
        stats: &mut RenderStats,
    ) {
        let mut walk = VolumeWalk {
            gather,
            tracer: self,
            cx,
            sampler,
            out,
            stats,
            walk: Walk::start(),
            inside: cx.scene.inside(ray.o),
            ray,
            first: CAMERA_DIMENSIONS,
            ends: false,
        };
        while walk.step().is_some() {}
    }
}

impl<'a, S: Sampler, G: Gather, O: RadianceSink> VolumeWalk<'a, S, G, O> {
    /// A flight and the event at its end; None if the walk ends.
    fn step(&mut self) -> Option<()> {
        // Dimensions are reserved per vertex: what one vertex draws shifts no later one.
        self.first = CAMERA_DIMENSIONS + VERTEX_DIMENSIONS * self.walk.depth;
        let plan = self.cx.plan;
        let ends = plan.max_depth.is_some_and(|max| self.walk.depth >= max);
        self.ends = ends;
        let volume_class = plan.classes.prepend(Letter::V, self.walk.suffix);
        let lights_volumes =
            !ends && self.tracer.sends_shadow_rays(self.cx) && plan.is_wanted(volume_class);

        // The next event, and light of the media on the way.
        let (mut draws, flight, part) = self.fly(lights_volumes);
        if !flight.emitted.is_black() {
            let share = if self.looks_for_glow() {
                glow::met_share(self.cx, &self.walk, self.ray.d)
            } else {
                1.0
            };
            let value = self.walk.throughput * flight.emitted * share;
            self.out.add(self.walk.suffix, value);
        }

        // Light found at one more place of the way.
        if let Some(part) = &part {
            self.add_equiangular(part, volume_class, &mut draws.fork());
        }
        self.walk.throughput *= flight.weight;
        if self.walk.throughput.is_black() {
            return None;
        }

        // Light found at its end, and the event there.
        let mut shadow = draws.fork();
        match &flight.arrival {
            Arrival::Escape => {
                let (cx, walk) = (self.cx, &self.walk);
                self.tracer.add_escaped(cx, walk, &self.ray, self.out);
                return None;
            }
            Arrival::Surface(si) => {
                let (cx, walk) = (self.cx, &self.walk);
                self.out
                    .note(|| Step::vertex(si, walk.throughput, walk.suffix));
                self.tracer.add_emitted(cx, walk, si, self.out);
                if ends {
                    return None;
                }
                self.scatter_at_surface(si, &flight.inside, &mut shadow)?;
            }
            Arrival::Volume(point) => {
                let (walk, t) = (&self.walk, flight.t);
                let (value, class) = (walk.throughput, walk.suffix);
                self.out
                    .note(|| Step::volume(point.p, point.wo, t, value, class));
                if ends {
                    return None;
                }
                self.inside = flight.inside;
                if lights_volumes {
                    let part = part.filter(|p| p.number == flight.spans);
                    self.light_volume(point, volume_class, part.as_ref(), flight.t, &mut shadow);
                }
                if self.looks_for_glow() && plan.is_wanted(volume_class) {
                    let inside = &self.inside;
                    let found = glow::at_volume(self.cx, &self.walk, point, inside, &mut shadow);
                    self.out.add(volume_class, found);
                }
                if G::ENDS {
                    self.gather.at_volume(&self.walk, point, self.out);
                    self.count(&shadow);
                    return None;
                }
                self.scatter_in_volume(point, volume_class);
            }
        }
        self.count(&shadow);

        // What may end it.
        if self.walk.depth >= MAX_EVENTS {
            self.stats.cut_paths += 1;
            return None;
        }
        self.sampler.seek(self.first + 3);
        let roulette = self.sampler.next_1d();
        let goes_on = !plan.is_pointless(self.walk.suffix)
            && self
                .walk
                .survives(self.tracer.roulette, roulette, self.stats);
        let throughput = self.walk.throughput;
        self.out
            .note(|| Step::roulette(roulette, goes_on, throughput));
        goes_on.then_some(())
    }

    /// Flies to the next event; keeps the part for the equiangular place if one is wanted.
    fn fly(&mut self, lights_volumes: bool) -> (Draws, Flight, Option<Part<'a>>) {
        self.sampler.seek(self.first + 8);
        let (first, seed) = (self.sampler.next_2d(), self.sampler.next_2d());
        let mut draws = Draws::new(first.into(), seed.into());
        self.stats.ray_at(self.walk.depth);
        let looks = lights_volumes && self.tracer.equiangular && self.tracer.mode == Mode::Mis;
        let (mut part, mut number) = (None, 0);
        let beta = self.walk.throughput;
        let (gather, walk, out) = (&mut *self.gather, &self.walk, &mut *self.out);
        let gathers = G::ENDS && !self.ends;
        let on_span = |span: &Span<'_>| {
            if gathers {
                gather.along(walk, span, out);
            }
            let fits = span.medium.is_homogeneous() && span.medium.scatters();
            if looks && fits && part.is_none() {
                part = Some((
                    span.ray,
                    span.range,
                    beta * span.weight,
                    span.inside,
                    number,
                ));
            }
            number += 1;
        };
        let (scene, ray): (&'a Scene, Ray) = (self.cx.scene, self.ray);
        let flight = scene.fly(ray, self.inside, beta, &mut draws, on_span);
        let met = match &flight.arrival {
            Arrival::Surface(si) => Some(si),
            Arrival::Escape | Arrival::Volume(_) => None,
        };
        if !matches!(flight.arrival, Arrival::Volume(_)) {
            let fault = scene.ray_fault(self.walk.departure(), met);
            self.stats.count_ray_fault(fault);
        }
        // The flight's first ray is counted by its level already.
        self.stats.rays += draws.rays - 1;
        self.stats.exceeded_majorants += draws.exceeded;
        let part = part.and_then(|(ray, range, beta, inside, number)| {
            Some(Part {
                medium: scene.media.along(&inside, &ray, range.1)?.0,
                ray,
                range,
                beta,
                inside,
                number,
            })
        });
        (draws, flight, part)
    }

    fn count(&mut self, draws: &Draws) {
        self.stats.rays += draws.rays;
        self.stats.exceeded_majorants += draws.exceeded;
    }

    /// The light to be sampled, or in mode `kajiya` every one: index, probability of the choice, and
    /// where on it.
    fn light_choices(&mut self) -> impl Iterator<Item = (u32, f32, Vec2)> + use<'a, S, G, O> {
        self.sampler.seek(self.first + 4);
        let (u, choice) = (self.sampler.next_2d(), self.sampler.next_1d());
        let lights = &self.cx.scene.lights;
        let one = self.tracer.mode == Mode::Mis;
        let (range, pmf) = match lights.sample(choice) {
            Some((id, pmf)) if one => (id..id + 1, pmf),
            Some(_) => (0..lights.len() as u32, 1.0),
            None => (0..0, 1.0),
        };
        range.map(move |id| (id, pmf, if one { u } else { turned(u, id as usize) }))
    }

    /// Whether shadow rays look for light of media. Gathering does not: it has no photons of theirs.
    fn looks_for_glow(&self) -> bool {
        !G::ENDS && self.tracer.mode == Mode::Mis && !self.cx.scene.media.glow.is_empty()
    }

    fn sample_light(&self, id: u32, p: Vec3A, u: Vec2) -> Option<LightSample> {
        self.cx.scene.lights.get(id).sample_li(p, u)
    }

    /// Light and the next event at a surface; `inside` is true on the side the walk came from.
    fn scatter_at_surface(
        &mut self,
        si: &SurfaceInteraction,
        inside: &Inside,
        shadow: &mut Draws,
    ) -> Option<()> {
        let bsdf = self.cx.scene.bsdf(si);
        if bsdf.is_empty() {
            return None;
        }
        if self.tracer.sends_shadow_rays(self.cx) && bsdf.has_non_delta() {
            for (id, pmf, u) in self.light_choices() {
                if let Some(light) = self.sample_light(id, si.p, u) {
                    self.out.note(|| Step::shadow_ray(id, pmf, &light));
                    self.light_surface(si, &bsdf, inside, &light, pmf, shadow);
                }
            }
        }
        if self.looks_for_glow() && bsdf.has_non_delta() {
            let place = (si, &bsdf, inside);
            glow::at_surface(self.cx, &self.walk, place, shadow, self.out);
        }
        if G::ENDS && bsdf.has(Event::Diffuse) {
            self.gather.at_surface(&self.walk, si, &bsdf, self.out);
        }
        self.sampler.seek(self.first);
        let (direction, event) = (self.sampler.next_2d(), self.sampler.next_1d());
        let Some(sample) = bsdf.sample(si.wo, event, direction, Transport::Radiance) else {
            self.stats.below_horizon += u64::from(bsdf.has(Event::Glossy));
            self.out
                .note(|| Step::ended("no direction was drawn: below the horizon, or no event"));
            return None;
        };
        self.out.note(|| Step::scattered(&sample));
        let letter = sample.event.letter();
        if G::ENDS && letter == Letter::D {
            return None;
        }
        let suffix = self.cx.plan.classes.prepend(letter, self.walk.suffix);
        self.walk = self.walk.after(si, &sample, suffix, 1.0);
        self.inside = self.cx.scene.beyond(inside, si, sample.wi);
        self.ray = si.spawn_ray(sample.wi);
        Some(())
    }

    /// What one light sample brings to a surface, summed over the non-delta events there, each with
    /// the class and the weight of its own (CONTRACT rule 2).
    fn light_surface(
        &mut self,
        si: &SurfaceInteraction,
        bsdf: &Bsdf,
        inside: &Inside,
        light: &LightSample,
        pmf: f32,
        shadow: &mut Draws,
    ) {
        let (cx, walk) = (self.cx, &self.walk);
        let light_pdf = pmf * light.pdf_dir;
        let incident = walk.throughput * light.radiance * (1.0 / light_pdf);
        let mut visibility = None;
        for event in bsdf.non_delta_events() {
            let class = cx.plan.classes.prepend(event.letter(), walk.suffix);
            let f_cos = bsdf.eval(event, si.wo, light.wi, Transport::Radiance);
            if !cx.plan.is_wanted(class) || f_cos.is_black() {
                continue;
            }
            let visible = *visibility.get_or_insert_with(|| {
                let ray = light.ray_from(si);
                let inside = cx.scene.beyond(inside, si, light.wi);
                cx.scene.transmittance_in_media(ray, inside, shadow)
            });
            if visible.is_black() {
                return;
            }
            let pdf = bsdf.pdf(event, si.wo, light.wi);
            let weight = if G::ENDS && event == Event::Diffuse {
                1.0 // a diffuse event never meets a light by itself then
            } else {
                self.light_weight(light, light_pdf, pdf)
            };
            self.out.note(|| Step::Found {
                event: Some(event),
                light: None,
                pdf_light: Some(light_pdf),
                pdf_walk: Some(pdf),
                weight,
                visible,
            });
            self.out.add(class, incident * f_cos * visible * weight);
        }
    }

    /// Weight of light found by a shadow ray of density `light_pdf` beside a walk that goes there by
    /// itself with the density `pdf`.
    fn light_weight(&self, light: &LightSample, light_pdf: f32, pdf: f32) -> f32 {
        if self.tracer.mode == Mode::Kajiya || light.is_delta {
            1.0
        } else {
            mis::power(light_pdf, pdf)
        }
    }

    /// Light where tracking scattered the flight at the distance `t`.
    fn light_volume(
        &mut self,
        point: &VolumePoint,
        class: ClassId,
        part: Option<&Part<'_>>,
        t: f32,
        shadow: &mut Draws,
    ) {
        let inside = self.inside;
        for (id, pmf, u) in self.light_choices() {
            let Some(light) = self.sample_light(id, point.p, u) else {
                continue;
            };
            self.out.note(|| Step::shadow_ray(id, pmf, &light));
            let share = part.map_or(1.0, |part| part.tracked_share(self.cx, id, t));
            let value = self.volume_light(point, &inside, &light, pmf, shadow);
            self.out.add(class, self.walk.throughput * value * share);
        }
    }

    /// What one light sample brings to a place in a medium.
    fn volume_light(
        &self,
        point: &VolumePoint,
        inside: &Inside,
        light: &LightSample,
        pmf: f32,
        shadow: &mut Draws,
    ) -> Rgb {
        let light_pdf = pmf * light.pdf_dir;
        let phase = point.phase.pdf(point.wo, light.wi);
        let weight = if G::ENDS {
            1.0
        } else {
            self.light_weight(light, light_pdf, phase)
        };
        let ray = if light.distance.is_finite() {
            Ray::between(point.p, light.target)
        } else {
            Ray::new(point.p, light.wi)
        };
        let visible = self.cx.scene.transmittance_in_media(ray, *inside, shadow);
        light.radiance * visible * (phase * weight / light_pdf)
    }

    /// Light at one more place of a flight, near a light.
    fn add_equiangular(&mut self, part: &Part<'_>, class: ClassId, shadow: &mut Draws) {
        self.sampler.seek(self.first + 12);
        let (choice, u) = (self.sampler.next_1d(), self.sampler.next_1d());
        let u_light = self.sampler.next_2d();
        let lights = &self.cx.scene.lights;
        let Some((id, pmf)) = lights.sample(choice) else {
            return;
        };
        let Some(distances) = part.equiangular(self.cx, id) else {
            return;
        };
        let t = distances.sample(u);
        let pdf = distances.pdf(t);
        let point = VolumePoint::new(part.medium, &part.ray, t);
        let Some(light) = lights.get(id).sample_li(point.p, u_light) else {
            return;
        };
        let arrives = part.medium.scattered_at(t - part.range.0);
        let throughput = part.beta * arrives * (mis::power(pdf, part.pdf_tracked(t)) / pdf);
        if throughput.is_black() {
            return;
        }
        self.out.note(|| Step::Read {
            from: "one more place of the way, drawn near a light",
        });
        self.out.note(|| Step::shadow_ray(id, pmf, &light));
        let value = self.volume_light(&point, &part.inside, &light, pmf, shadow);
        self.count(shadow);
        self.out.add(class, throughput * value);
    }

    /// The next direction from a place in a medium.
    fn scatter_in_volume(&mut self, point: &VolumePoint, class: ClassId) {
        self.sampler.seek(self.first);
        let d = point.phase.sample(point.wo, self.sampler.next_2d());
        let pdf = point.phase.pdf(point.wo, d);
        self.out.note(|| Step::Scattered {
            event: Event::Volume,
            wi: d,
            pdf_dir: pdf,
            weight: Some(Rgb::WHITE),
        });
        self.walk = self.walk.after_volume(point.p, pdf, class);
        self.ray = Ray::new(point.p, d);
    }
}
