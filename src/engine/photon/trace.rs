//! The first pass: photons scattered through the scene by roulette (Jensen 2001, chapter 5).

use super::emission::{EMISSION_DIMENSIONS, Emission, Emitted};
use super::record::{MAX_EVENTS, Photon};
use crate::engine::bsdf::{BsdfSample, Transport};
use crate::engine::event::{Event, Letter};
use crate::engine::geometry::{Departure, Ray, RayFault, SurfaceInteraction};
use crate::engine::math::Rgb;
use crate::engine::path::{ClassId, PathClasses};
use crate::engine::sampling::{MAX_SURVIVAL, Sampler};
use crate::engine::scene::Scene;

/// Which photons a walk keeps. Together the maps hold every prefix once (rule 7 of the code map).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapKind {
    /// Prefixes (S|G)+.
    Caustic,
    /// All others, the empty one too.
    Global,
    /// Every prefix, of photons that a medium scatters.
    Volume,
}

/// What becomes of a photon's power when it is scattered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Roulette {
    /// It survives with the probability of the largest channel's share and keeps its power: all
    /// photons stay alike (Jensen 2001, section 5.4; the lecture's choice).
    Keep,
    /// It survives and its power shrinks; only below a thousandth of what it left with does
    /// roulette end it. Many faint photons: kept to compare.
    Lose,
}

/// The share of its first power below which a photon that loses power plays roulette.
const FAINT: f32 = 1e-3;
/// A photon that lost nothing in so many events would not end between perfect mirrors: from then on
/// it survives with [`MAX_SURVIVAL`] at most.
const LOSSLESS_EVENTS: u32 = 64;
/// Most events of a path; beyond, it is cut and counted.
pub(super) const MAX_PATH_EVENTS: u32 = 10_000_000;
/// Dimensions reserved a vertex.
const VERTEX_DIMENSIONS: u32 = 8;

/// What the events before a vertex were.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Prefix {
    Empty,
    Specular,
    Diffuse,
}

impl Prefix {
    /// With one more event.
    pub fn and(self, letter: Letter) -> Self {
        match (self, letter) {
            (Self::Diffuse, _) | (_, Letter::D | Letter::V) => Self::Diffuse,
            (_, Letter::S | Letter::G) => Self::Specular,
        }
    }
}

/// What the walks of a map have in common.
pub struct Walks<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Classes of the layers.
    pub classes: &'a PathClasses,
    /// What to keep.
    pub kind: MapKind,
    /// How to scatter.
    pub roulette: Roulette,
    /// How to start.
    pub emission: &'a Emission,
}

/// Where one photon went, for those who watch it.
pub trait Witness {
    /// It was stored at `si`; `u` is a number for rounding.
    fn stored(&mut self, photon: Photon, si: &SurfaceInteraction, u: f32);
    /// It left a light; its power is its flux times `share`.
    fn emitted(&mut self, _start: &Emitted, _share: f32) {}
    /// It travelled along `ray` to `si`, or left the scene, with this power and after events of
    /// this class.
    fn travelled(&mut self, _: &Ray, _si: Option<&SurfaceInteraction>, _power: Rgb, _: ClassId) {}
    /// An event and a direction were drawn.
    fn scattered(&mut self, _sample: &BsdfSample) {}
    /// It played roulette with the number `u`: its power then, if it survived.
    fn survived(&mut self, _u: f32, _power: Option<Rgb>) {}
    /// Something went wrong with a ray of it.
    fn strayed(&mut self, _fault: RayFault) {}
    /// It was cut at the largest number of events.
    fn cut(&mut self) {}
}

impl Walks<'_> {
    /// Emits one photon and follows it to its end. `share` is 1/number of photons emitted; the
    /// sampler belongs to this photon alone. Returns the number of rays.
    pub fn follow<S: Sampler>(&self, share: f32, sampler: &mut S, to: &mut impl Witness) -> u64 {
        let Some(start) = self.emission.sample(self.scene, sampler) else {
            return 0;
        };
        to.emitted(&start, share);
        if self.scene.features.media {
            return self.follow_in_media(start, share, sampler, to);
        }
        let mut ray = start.ray;
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
            rays += 1;
            let si = self.scene.intersect(&ray, || sampler.next_1d());
            to.travelled(&ray, si.as_ref(), power, class);
            if let Some(fault) = self.scene.ray_fault(left, si.as_ref()) {
                to.strayed(fault);
            }
            let Some(si) = si else { return rays };
            let bsdf = self.scene.bsdf(&si);
            if bsdf.is_empty() {
                return rays;
            }

            // Stored wherever a D event exists, before the roulette.
            if self.keeps(prefix) && bsdf.has(Event::Diffuse) {
                let photon = Photon {
                    p: si.p,
                    power,
                    wi: si.wo,
                    class,
                    events: events.min(MAX_EVENTS),
                };
                to.stored(photon, &si, rounding);
            }

            // One event, drawn by the roulette between the lobes.
            let Some(sample) = bsdf.sample(si.wo, event, direction, Transport::Importance) else {
                return rays;
            };
            to.scattered(&sample);
            prefix = prefix.and(sample.event.letter());
            if self.kind == MapKind::Caustic && prefix == Prefix::Diffuse {
                return rays; // no word (S|G)+ begins so
            }
            class = self.classes.append(class, sample.event.letter());
            events += 1;
            let scattered = self.survive(power, sample.weight, events, first_power, roulette);
            to.survived(roulette, scattered);
            let Some(scattered) = scattered else {
                return rays;
            };
            power = scattered;
            if events >= MAX_PATH_EVENTS {
                to.cut();
                return rays;
            }
            ray = si.spawn_ray(sample.wi);
            left = si.departure(sample.wi);
        }
    }

    /// Whether photons of such a prefix are stored on surfaces.
    pub(super) fn keeps(&self, prefix: Prefix) -> bool {
        match self.kind {
            MapKind::Caustic => prefix == Prefix::Specular,
            MapKind::Global => prefix != Prefix::Specular,
            MapKind::Volume => false,
        }
    }

    /// The power after an event of weight `weight`; `None` if the photon was absorbed.
    pub(super) fn survive(
        &self,
        power: Rgb,
        weight: Rgb,
        events: u32,
        first: f32,
        u: f32,
    ) -> Option<Rgb> {
        let scattered = power * weight;
        let (before, after) = (power.max_component(), scattered.max_component());
        let mut survival = match self.roulette {
            Roulette::Keep => (after / before).min(1.0),
            Roulette::Lose => (after / (FAINT * first)).min(1.0),
        };
        if events >= LOSSLESS_EVENTS {
            survival = survival.min(MAX_SURVIVAL);
        }
        // A comparison that ends photons without power, too.
        (u < survival).then(|| scattered / survival)
    }
}
