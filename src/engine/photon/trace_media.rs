//! Photons in participating media (Jensen and Christensen 1998, *Efficient Simulation of Light
//! Transport in Scenes with Participating Media using Photon Maps*).
//!
//! A photon is stored where a medium scatters it, with what the medium scatters of its power: the
//! sum of stored powers over a volume estimates the power that is scattered there.

use super::emission::{EMISSION_DIMENSIONS, Emitted};
use super::record::{MAX_EVENTS, Photon};
use super::trace::{MAX_PATH_EVENTS, MapKind, Prefix, Walks, Witness};
use crate::engine::bsdf::{BsdfSample, Transport};
use crate::engine::event::{Event, Letter};
use crate::engine::geometry::{Departure, Ray, SurfaceInteraction};
use crate::engine::media::Draws;
use crate::engine::path::ClassId;
use crate::engine::sampling::Sampler;
use crate::engine::scene::Arrival;

/// Dimensions reserved a vertex: direction 0–1, event 2, roulette 3, rounding 4, channel and
/// distance 8–9, seeds of the flight 10–11.
const VERTEX_DIMENSIONS: u32 = 12;

impl Walks<'_> {
    /// As `follow`, in scenes with media.
    pub(super) fn follow_in_media<S: Sampler>(
        &self,
        start: Emitted,
        share: f32,
        sampler: &mut S,
        to: &mut impl Witness,
    ) -> u64 {
        let mut ray = start.ray;
        let mut inside = self.scene.inside(ray.o);
        let mut power = start.flux * share;
        let first_power = power.max_component();
        let (mut class, mut events, mut prefix) = (ClassId::EMPTY, 0_u32, Prefix::Empty);
        let (mut rays, mut left) = (0, Departure::NOWHERE);
        loop {
            // Dimensions are reserved per vertex: what one vertex draws shifts no later one.
            let first = EMISSION_DIMENSIONS + VERTEX_DIMENSIONS * events;
            sampler.seek(first);
            let (direction, event) = (sampler.next_2d(), sampler.next_1d());
            let (roulette, rounding) = (sampler.next_1d(), sampler.next_1d());
            sampler.seek(first + 8);
            let (numbers, seed) = (sampler.next_2d(), sampler.next_2d());
            let mut draws = Draws::new(numbers.into(), seed.into());
            let flight = self.scene.fly(ray, inside, power, &mut draws, |_| {});
            rays += draws.rays;

            // Where it arrived, and whether it is stored there, before the roulette.
            let (si, phase) = match flight.arrival {
                Arrival::Surface(si) => (Some(si), None),
                Arrival::Volume(point) => {
                    let along = Ray::new(point.p, -point.wo);
                    let si = SurfaceInteraction::in_volume(&along, 0.0);
                    (Some(si), Some(point.phase))
                }
                Arrival::Escape => (None, None),
            };
            to.travelled(&ray, si.as_ref(), power, class);
            if let Some(fault) = self.scene.ray_fault(left, si.as_ref()) {
                to.strayed(fault);
            }
            let Some(si) = si else { return rays };
            let bsdf = phase.is_none().then(|| self.scene.bsdf(&si));
            let stores = match &bsdf {
                None => self.kind == MapKind::Volume,
                Some(bsdf) => self.keeps(prefix) && bsdf.has(Event::Diffuse),
            };
            let arriving = power * flight.weight;
            if stores {
                let photon = Photon {
                    p: si.p,
                    power: arriving,
                    wi: si.wo,
                    class,
                    events: events.min(MAX_EVENTS),
                };
                to.stored(photon, &si, rounding);
            }

            // One event; absorption on the way to it and at it is decided together.
            let (wi, weight, letter) = match (&bsdf, phase) {
                (_, Some(phase)) => {
                    let wi = phase.sample(si.wo, direction);
                    to.scattered(&BsdfSample {
                        wi,
                        weight: flight.weight,
                        pdf_dir: phase.pdf(si.wo, wi),
                        event: Event::Volume,
                        eta: 1.0,
                    });
                    (wi, flight.weight, Letter::V)
                }
                (Some(bsdf), None) => {
                    let transport = Transport::Importance;
                    let Some(sample) = bsdf.sample(si.wo, event, direction, transport) else {
                        return rays;
                    };
                    to.scattered(&sample);
                    inside = self.scene.beyond(&flight.inside, &si, sample.wi);
                    let weight = flight.weight * sample.weight;
                    (sample.wi, weight, sample.event.letter())
                }
                (None, None) => return rays,
            };
            if phase.is_some() {
                inside = flight.inside;
            }
            prefix = prefix.and(letter);
            if self.kind == MapKind::Caustic && prefix == Prefix::Diffuse {
                return rays; // no word (S|G)+ begins so
            }
            class = self.classes.append(class, letter);
            events += 1;
            let scattered = self.survive(power, weight, events, first_power, roulette);
            to.survived(roulette, scattered);
            let Some(scattered) = scattered else {
                return rays;
            };
            power = scattered;
            if events >= MAX_PATH_EVENTS {
                to.cut();
                return rays;
            }
            ray = si.spawn_ray(wi);
            left = si.departure(wi);
        }
    }
}
