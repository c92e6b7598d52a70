//! Rays through media and boundaries.
//!
//! Between two events a ray crosses surfaces that do not stop it: those of opacity below 1, an
//! index-matched boundary among them (opacity 0), and shadow rays the like. They are no events; what
//! lies between them attenuates.

use glam::Vec3A;

use super::prepared::Scene;
use crate::engine::geometry::{Ray, SurfaceInteraction};
use crate::engine::math::Rgb;
use crate::engine::media::{Draws, Inside, Medium, Phase};

/// Most surfaces that one ray may cross without an event.
const MAX_CROSSINGS: u32 = 10_000;

/// A place where a medium scatters light.
#[derive(Clone, Copy, Debug)]
pub struct VolumePoint {
    /// Position.
    pub p: Vec3A,
    /// Unit direction the ray came from.
    pub wo: Vec3A,
    /// Where scattered light goes.
    pub phase: Phase,
    /// What of the light is scattered there, per length.
    pub sigma_s: Rgb,
    /// Whether the medium is the same around it.
    pub homogeneous: bool,
}

impl VolumePoint {
    /// The place in `medium` at the distance `t` of `ray`.
    pub fn new(medium: &Medium, ray: &Ray, t: f32) -> Self {
        let p = ray.at(t);
        Self {
            p,
            wo: -ray.d,
            phase: medium.phase,
            sigma_s: medium.sigma_t * medium.albedo * medium.density(p),
            homogeneous: medium.is_homogeneous(),
        }
    }
}

/// What ends a flight.
#[derive(Clone, Debug)]
pub enum Arrival {
    /// A surface that stops it.
    Surface(SurfaceInteraction),
    /// Scattering in a medium.
    Volume(VolumePoint),
    /// Nothing: it leaves the scene.
    Escape,
}

/// A part of a flight within one medium.
pub struct Span<'a> {
    /// The medium.
    pub medium: &'a Medium,
    /// The ray of this part; distances count from its origin.
    pub ray: Ray,
    /// Where on it the medium begins and ends.
    pub range: (f32, f32),
    /// What the flight before it is weighed by.
    pub weight: Rgb,
    /// What it is within.
    pub inside: Inside,
}

/// A flight from one event to the next.
#[derive(Clone, Debug)]
pub struct Flight {
    /// What ended it.
    pub arrival: Arrival,
    /// What the throughput is multiplied by.
    pub weight: Rgb,
    /// Radiance of media on the way, as it arrives at the flight's begin.
    pub emitted: Rgb,
    /// What its end is within, on the side it came from.
    pub inside: Inside,
    /// Number of parts within media before the one where it was scattered.
    pub spans: u32,
    /// Distance on the last part's ray at which it was scattered.
    pub t: f32,
}

impl Scene {
    /// What the point `p`, on no surface, is within.
    pub fn inside(&self, p: Vec3A) -> Inside {
        self.media.inside(&self.geometry, p)
    }

    /// What a ray is within that leaves `si` in the direction `d`, where `inside` is true on the
    /// side of `si.wo`.
    #[inline]
    pub fn beyond(&self, inside: &Inside, si: &SurfaceInteraction, d: Vec3A) -> Inside {
        self.media.beyond(inside, si, d)
    }

    /// Flies along `ray` to the next event with the throughput `beta`. `on_span` sees each part
    /// within a medium before it is tracked.
    pub fn fly(
        &self,
        mut ray: Ray,
        mut inside: Inside,
        beta: Rgb,
        draws: &mut Draws,
        mut on_span: impl FnMut(&Span<'_>),
    ) -> Flight {
        let mut flight = Flight {
            arrival: Arrival::Escape,
            weight: Rgb::WHITE,
            emitted: Rgb::BLACK,
            inside,
            spans: 0,
            t: 0.0,
        };
        for _ in 0..MAX_CROSSINGS {
            draws.rays += 1;
            let hit = self.geometry.intersect(&ray);
            let end = hit.map_or(f32::INFINITY, |h| h.t);
            if let Some((medium, range)) = self.media.along(&inside, &ray, end) {
                let span = Span {
                    medium,
                    ray,
                    range,
                    weight: flight.weight,
                    inside,
                };
                on_span(&span);
                let tracked = medium.track(&ray, range, beta * flight.weight, draws);
                flight.emitted += flight.weight * tracked.emitted;
                flight.weight *= tracked.weight;
                if let Some(t) = tracked.t {
                    flight.arrival = Arrival::Volume(VolumePoint::new(medium, &ray, t));
                    (flight.inside, flight.t) = (inside, t);
                    return flight;
                }
                flight.spans += 1;
            }
            let Some(hit) = hit else { return flight };
            let si = self.geometry.interaction(&ray, &hit);
            let opacity = self.materials[si.material as usize].opacity(&si);
            if opacity >= 1.0 || opacity > 0.0 && draws.next() < opacity {
                flight.inside = inside;
                flight.arrival = Arrival::Surface(si);
                return flight;
            }
            self.media.cross(&mut inside, &si, ray.d);
            ray = si.spawn_ray(ray.d);
        }
        flight.weight = Rgb::BLACK;
        flight
    }

    /// The share of light that gets through media and surfaces along `ray`, up to its end, in the
    /// mean over `draws`.
    pub fn transmittance_in_media(
        &self,
        mut ray: Ray,
        mut inside: Inside,
        draws: &mut Draws,
    ) -> Rgb {
        let mut transmittance = Rgb::WHITE;
        for _ in 0..MAX_CROSSINGS {
            draws.rays += 1;
            let hit = self.geometry.intersect(&ray);
            let si = hit.map(|hit| self.geometry.interaction(&ray, &hit));
            if let Some(si) = &si {
                transmittance *= 1.0 - self.materials[si.material as usize].opacity(si);
                if transmittance.is_black() {
                    return Rgb::BLACK;
                }
            }
            let end = hit.map_or(ray.t_max, |h| h.t);
            if let Some((medium, range)) = self.media.along(&inside, &ray, end) {
                transmittance *= medium.transmittance(&ray, range, draws);
            }
            let Some(si) = si.filter(|_| !transmittance.is_black()) else {
                return transmittance;
            };
            self.media.cross(&mut inside, &si, ray.d);
            let (t_max, [_, end]) = (ray.t_max - si.t, ray.clear_of);
            ray = Ray {
                t_max,
                clear_of: [si.prim, end],
                ..si.spawn_ray(ray.d)
            };
        }
        Rgb::BLACK
    }
}
