//! Writes the steps of one sample down.

use glam::Vec2;

use super::step::{RadianceSink, Step, VertexStep};
use crate::engine::bsdf::BsdfSample;
use crate::engine::event::Event;
use crate::engine::geometry::{Ray, SurfaceInteraction};
use crate::engine::integrators::bidirectional::{LightStart, Sink, Subpath, Technique};
use crate::engine::math::Rgb;
use crate::engine::path::ClassId;
use crate::engine::photon::Photon;
use crate::engine::photon::emission::Emitted;
use crate::engine::photon::trace::Witness;

/// The steps of one sample, in the order in which they happened.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// The steps.
    pub steps: Vec<Step>,
}

impl Recording {
    /// The radiance that the sample brought to its own pixel: the contributions in their order.
    /// The sum has the bits of that of the render.
    pub fn radiance(&self) -> Rgb {
        let mut sum = Rgb::BLACK;
        for step in &self.steps {
            if let Step::Light {
                film: None,
                radiance,
                ..
            } = step
            {
                sum += *radiance;
            }
        }
        sum
    }

    /// What it brought to places of its own choice on the film, in pixels.
    pub fn splats(&self) -> impl Iterator<Item = (Vec2, Rgb)> {
        self.steps.iter().filter_map(|step| match step {
            Step::Light {
                film: Some(film),
                radiance,
                ..
            } => Some((*film, *radiance)),
            _ => None,
        })
    }

    /// Takes down the vertices that a walk kept, with their densities.
    pub(in crate::engine::integrators) fn subpath(&mut self, path: &Subpath) {
        if path.is_empty() {
            return;
        }
        for i in 1..path.len() {
            let v = path.vertex(i);
            let Step::Vertex(step) = Step::vertex(&v.si, v.throughput, v.class) else {
                continue;
            };
            let density = path.densities(i + 1)[i];
            self.steps.push(Step::Vertex(VertexStep {
                densities: Some([density.own, density.other]),
                ..step
            }));
            let Some(event) = v.event else { continue };
            // Where the next vertex lies; a walk that left the scene kept no direction.
            if i + 1 < path.len() {
                let wi = -path.vertex(i + 1).si.wo;
                let pdf_dir = match event {
                    Event::Specular(_) => v.bsdf.event_probability(event, v.si.wo),
                    _ => v.pdf(event, v.si.wo, wi),
                };
                self.steps.push(Step::Scattered {
                    event,
                    wi,
                    pdf_dir,
                    weight: None,
                });
            }
        }
        self.ended("no further vertex was kept");
    }

    /// Takes down where a light walk began.
    pub(in crate::engine::integrators) fn start(&mut self, start: &LightStart) {
        let e = &start.emission;
        self.steps.push(Step::Emission {
            light: Some(start.end.id),
            p: e.ray.o,
            d: e.ray.d,
            pdf: Some([start.pmf * e.pdf_pos, e.pdf_dir]),
            flux: e.flux() / start.pmf,
        });
    }

    /// Takes down why a walk ended.
    pub fn ended(&mut self, why: &'static str) {
        self.steps.push(Step::Ended { why });
    }
}

impl RadianceSink for Recording {
    fn add(&mut self, class: ClassId, radiance: Rgb) {
        self.steps.push(Step::Light {
            technique: None,
            film: None,
            class,
            weight: None,
            radiance,
        });
    }

    fn note(&mut self, step: impl FnOnce() -> Step) {
        self.steps.push(step());
    }
}

impl Sink for Recording {
    fn begin(&mut self, film: Vec2, ray: &Ray) {
        let (p, d) = (ray.o, ray.d);
        self.steps.push(Step::Lens { p, d, film });
    }

    fn add(&mut self, of: Technique, class: ClassId, value: Rgb, weight: f32) {
        self.steps.push(Step::Light {
            technique: Some([of.s, of.t]),
            film: None,
            class,
            weight: Some(weight),
            radiance: value * weight,
        });
    }

    fn splat(&mut self, film: Vec2, of: Technique, class: ClassId, value: Rgb, weight: f32) {
        self.steps.push(Step::Light {
            technique: Some([of.s, of.t]),
            film: Some(film),
            class,
            weight: Some(weight),
            radiance: value * weight,
        });
    }
}

/// A photon's way.
impl Witness for Recording {
    fn emitted(&mut self, start: &Emitted, share: f32) {
        self.steps.push(Step::Emission {
            light: None,
            p: start.ray.o,
            d: start.ray.d,
            pdf: None,
            flux: start.flux * share,
        });
    }

    fn stored(&mut self, photon: Photon, _si: &SurfaceInteraction, _u: f32) {
        self.steps.push(Step::Stored {
            power: photon.power,
            class: photon.class,
        });
    }

    fn travelled(
        &mut self,
        ray: &Ray,
        si: Option<&SurfaceInteraction>,
        power: Rgb,
        class: ClassId,
    ) {
        self.steps.push(match si {
            Some(si) => Step::vertex(si, power, class),
            None => Step::Escaped { d: ray.d },
        });
    }

    fn scattered(&mut self, sample: &BsdfSample) {
        self.steps.push(Step::scattered(sample));
    }

    fn survived(&mut self, number: f32, power: Option<Rgb>) {
        let left = power.unwrap_or(Rgb::BLACK);
        self.steps
            .push(Step::roulette(number, power.is_some(), left));
    }

    fn cut(&mut self) {
        self.ended("it was cut at the largest number of events");
    }
}
