//! What walks tell.

use glam::{Vec2, Vec3A};

use crate::engine::bsdf::BsdfSample;
use crate::engine::event::Event;
use crate::engine::film::SampleRadiance;
use crate::engine::geometry::{Ray, SurfaceInteraction};
use crate::engine::light::LightSample;
use crate::engine::math::Rgb;
use crate::engine::path::ClassId;

/// Takes the light of a camera sample, and listens to how it was found, or does not.
pub trait RadianceSink {
    /// Adds the radiance of one complete path (or of all with the same word) of class `class`.
    fn add(&mut self, class: ClassId, radiance: Rgb);

    /// Hears of a step. Renders do not listen: the step is never made.
    #[inline(always)]
    fn note(&mut self, _step: impl FnOnce() -> Step) {}
}

impl RadianceSink for SampleRadiance<'_> {
    #[inline]
    fn add(&mut self, class: ClassId, radiance: Rgb) {
        SampleRadiance::add(self, class, radiance);
    }
}

/// A place on a walk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VertexStep {
    /// Position.
    pub p: Vec3A,
    /// Geometric normal; 0 in a medium.
    pub n: Vec3A,
    /// Unit direction back along the walk.
    pub wo: Vec3A,
    /// Distance travelled to it.
    pub t: f32,
    /// Index of the material; None in a medium.
    pub material: Option<u32>,
    /// Index of the triangle or sphere; None in a medium.
    pub prim: Option<u32>,
    /// Index of the light that shines there.
    pub light: Option<u32>,
    /// Product of f·cosθ/pdf over the events before, survival divided out; on walks from a light
    /// times the flux it left with, W.
    pub throughput: Rgb,
    /// Class of the events before.
    pub class: ClassId,
    /// Densities with which the own and the other walk draw it, 1/m²; of walks that keep them.
    pub densities: Option<[f32; 2]>,
}

/// One step of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// A walk begins at the camera.
    Lens {
        /// Origin.
        p: Vec3A,
        /// Unit direction.
        d: Vec3A,
        /// Film position in pixels.
        film: Vec2,
    },
    /// A walk begins at a light.
    Emission {
        /// Index of the light, where it is known.
        light: Option<u32>,
        /// Origin.
        p: Vec3A,
        /// Unit direction.
        d: Vec3A,
        /// Density of the position, the choice of the light included, and of the direction.
        pdf: Option<[f32; 2]>,
        /// Flux, W.
        flux: Rgb,
    },
    /// The walk arrived somewhere.
    Vertex(VertexStep),
    /// The walk left the scene.
    Escaped {
        /// Unit direction.
        d: Vec3A,
    },
    /// A point of a light was chosen.
    ShadowRay {
        /// Index of the light.
        light: u32,
        /// Probability of its choice.
        pmf: f32,
        /// Unit direction toward it.
        wi: Vec3A,
        /// How far it is.
        distance: f32,
        /// Density of the direction given the light, 1/sr.
        pdf_dir: f32,
    },
    /// Light was found, by a shadow ray (then by an event), or by the walk itself.
    Found {
        /// The event it was evaluated with; None where the walk met the light.
        event: Option<Event>,
        /// Index of the light that the walk met; the shadow ray named that of events.
        light: Option<u32>,
        /// Density with which shadow rays go there, the choice of the light included, 1/sr.
        pdf_light: Option<f32>,
        /// Density with which the walk goes there, 1/sr.
        pdf_walk: Option<f32>,
        /// Weight among the strategies.
        weight: f32,
        /// Share that gets through.
        visible: Rgb,
    },
    /// What comes next was read from there.
    Read {
        /// From where.
        from: &'static str,
    },
    /// Light was added.
    Light {
        /// Vertices from the light and from the lens.
        technique: Option<[usize; 2]>,
        /// Where on the film, if not at the sample's own pixel.
        film: Option<Vec2>,
        /// Class of the whole word.
        class: ClassId,
        /// Weight among the strategies, if the radiance was still to be multiplied by it.
        weight: Option<f32>,
        /// What was added.
        radiance: Rgb,
    },
    /// An event was drawn, and a direction.
    Scattered {
        /// The event.
        event: Event,
        /// Unit direction.
        wi: Vec3A,
        /// P(event)·p_event, 1/sr; of a delta event its probability.
        pdf_dir: f32,
        /// What the throughput was multiplied by, f·cosθ/pdf; of walks that keep their vertices
        /// the throughputs tell.
        weight: Option<Rgb>,
    },
    /// Russian roulette was played.
    Roulette {
        /// The random number.
        number: f32,
        /// Whether the walk goes on.
        survived: bool,
        /// Throughput after it.
        throughput: Rgb,
    },
    /// A photon was stored.
    Stored {
        /// Its power, W.
        power: Rgb,
        /// Class of the events before.
        class: ClassId,
    },
    /// The walk ended.
    Ended {
        /// Why.
        why: &'static str,
    },
}

impl Step {
    /// Arrival at a surface.
    pub fn vertex(si: &SurfaceInteraction, throughput: Rgb, class: ClassId) -> Self {
        let surface = !si.is_in_volume();
        Self::Vertex(VertexStep {
            p: si.p,
            n: si.n_g,
            wo: si.wo,
            t: si.t,
            material: surface.then_some(si.material),
            prim: surface.then_some(si.prim),
            light: si.light,
            throughput,
            class,
            densities: None,
        })
    }

    /// An event and a direction.
    pub fn scattered(sample: &BsdfSample) -> Self {
        Self::Scattered {
            event: sample.event,
            wi: sample.wi,
            pdf_dir: sample.pdf_dir,
            weight: Some(sample.weight),
        }
    }

    /// A game of roulette, and the throughput after it.
    pub fn roulette(number: f32, survived: bool, throughput: Rgb) -> Self {
        Self::Roulette {
            number,
            survived,
            throughput,
        }
    }

    /// The end of a walk.
    pub fn ended(why: &'static str) -> Self {
        Self::Ended { why }
    }

    /// The choice of a point of a light: number `light`, chosen with the probability `pmf`.
    pub fn shadow_ray(light: u32, pmf: f32, sample: &LightSample) -> Self {
        Self::ShadowRay {
            light,
            pmf,
            wi: sample.wi,
            distance: sample.distance,
            pdf_dir: sample.pdf_dir,
        }
    }

    /// Arrival at a place in a medium, at the distance `t`.
    pub fn volume(p: Vec3A, wo: Vec3A, t: f32, throughput: Rgb, class: ClassId) -> Self {
        let mut si = SurfaceInteraction::in_volume(&Ray::new(p, -wo), 0.0);
        (si.p, si.t) = (p, t);
        Self::vertex(&si, throughput, class)
    }
}
