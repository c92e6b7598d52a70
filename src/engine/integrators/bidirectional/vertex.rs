//! Vertices of both walks.

use glam::{Vec2, Vec3A};

use crate::engine::bsdf::{Bsdf, BsdfSample, Evaluation, Transport};
use crate::engine::event::Event;
use crate::engine::geometry::{Ray, SurfaceInteraction};
use crate::engine::math::Rgb;
use crate::engine::media::{Inside, Phase};
use crate::engine::path::ClassId;
use crate::engine::scene::Scene;

/// A point of a subpath, on a surface or in a medium.
#[derive(Clone, Debug)]
pub struct Vertex {
    /// Where; `wo` points back along the walk.
    pub si: SurfaceInteraction,
    /// Scattering there, if it is on a surface.
    pub bsdf: Bsdf,
    /// Scattering there, if it is in a medium.
    pub phase: Option<Phase>,
    /// What it is within, on the side of `si.wo`.
    pub inside: Inside,
    /// Key of random numbers for what goes on from here, in scenes with media.
    pub key: u64,
    /// What turns a density in 1/sr, of the direction back, into that of the vertex before, 1/m²
    /// (at infinity 1/sr); 0 where no walk can meet that, as the lens.
    pub back: f32,
    /// Product of f·cosθ/pdf over the events before, survival divided out: radiance from here
    /// times this reaches the pixel, or the flux that arrives here from the light in W.
    pub throughput: Rgb,
    /// Class of the events between this vertex and the end the walk began at, its own excluded
    /// (CONTRACT rule 4).
    pub class: ClassId,
    /// The event drawn there to go on. It restricts nothing that is evaluated there.
    pub event: Option<Event>,
}

impl Vertex {
    /// Nowhere, to be filled.
    pub(super) fn blank() -> Self {
        let si = SurfaceInteraction::in_volume(&Ray::new(Vec3A::ZERO, Vec3A::X), 0.0);
        Self {
            bsdf: Bsdf::new(&si),
            si,
            phase: None,
            inside: Inside::default(),
            key: 0,
            back: 0.0,
            throughput: Rgb::BLACK,
            class: ClassId::EMPTY,
            event: None,
        }
    }

    /// The events that can be evaluated there.
    #[inline]
    pub fn non_delta_events(&self) -> impl Iterator<Item = Event> {
        let volume = self.phase.map(|_| Event::Volume);
        self.bsdf.non_delta_events().chain(volume)
    }

    /// Whether there are any.
    #[inline]
    pub fn has_non_delta(&self) -> bool {
        self.bsdf.has_non_delta() || self.phase.is_some()
    }

    /// f·|cosθ| of a non-delta event between `si.wo` and `wi`, and its densities both ways.
    #[inline]
    pub fn eval_both_ways(&self, event: Event, wi: Vec3A, transport: Transport) -> Evaluation {
        let wo = self.si.wo;
        match self.phase {
            Some(phase) => Evaluation {
                f: Rgb::splat(phase.pdf(wo, wi)),
                toward: phase.pdf(wo, wi),
                back: phase.pdf(wi, wo),
            },
            None => self.bsdf.eval_both_ways(event, wo, wi, transport),
        }
    }

    /// P(event) · p_event in 1/sr of a non-delta event.
    #[inline]
    pub fn pdf(&self, event: Event, wo: Vec3A, wi: Vec3A) -> f32 {
        match self.phase {
            Some(phase) => phase.pdf(wo, wi),
            None => self.bsdf.pdf(event, wo, wi),
        }
    }

    /// What a ray is within that leaves in the direction `d`.
    #[inline]
    pub(super) fn leaving(&self, scene: &Scene, d: Vec3A) -> Inside {
        scene.beyond(&self.inside, &self.si, d)
    }

    /// Draws an event and a direction.
    #[inline]
    pub(super) fn sample(&self, u_event: f32, u: Vec2, transport: Transport) -> Option<BsdfSample> {
        let Some(phase) = self.phase else {
            return self.bsdf.sample(self.si.wo, u_event, u, transport);
        };
        let wi = phase.sample(self.si.wo, u);
        Some(BsdfSample {
            wi,
            weight: Rgb::WHITE,
            pdf_dir: phase.pdf(self.si.wo, wi),
            event: Event::Volume,
            eta: 1.0,
        })
    }
}
