//! Shadow rays, and light that the walk meets.

use glam::Vec3A;

use super::walk::{Estimator, Walk};
use crate::engine::bsdf::{Bsdf, Transport};
use crate::engine::event::Event;
use crate::engine::geometry::{Departure, Ray, SurfaceInteraction};
use crate::engine::integrators::replay::{RadianceSink, Step};
use crate::engine::integrators::{Pass, RenderStats};
use crate::engine::math::Rgb;
use crate::engine::sampling::{Sampler, mis};

/// The last event of a walk.
pub(super) struct Scattered {
    /// Where.
    pub p: Vec3A,
    /// Which: G or S, since a walk ends at D.
    pub event: Event,
    /// P(event) · p_event, 1/sr.
    pub pdf_dir: f32,
    /// Where the ray left the surface.
    pub departure: Departure,
}

impl Estimator {
    /// A shadow ray to one light. The D event takes it with weight 1, since nothing else counts
    /// words whose light part before it is empty; the G event shares it with the walk's own hits
    /// (rules 2 and 7 of the code map).
    #[expect(
        clippy::too_many_arguments,
        reason = "the state of one walk; a struct would be made and taken apart once a vertex"
    )]
    pub(super) fn add_direct<S: Sampler>(
        &self,
        cx: &Pass<'_>,
        walk: &Walk,
        si: &SurfaceInteraction,
        bsdf: &Bsdf,
        sampler: &mut S,
        out: &mut impl RadianceSink,
        stats: &mut RenderStats,
    ) {
        let Some((id, pmf, light)) = cx.scene.lights.sample_li(si.p, sampler) else {
            return;
        };
        out.note(|| Step::shadow_ray(id, pmf, &light));
        let light_pdf = pmf * light.pdf_dir;
        let incident = walk.throughput * light.radiance * (1.0 / light_pdf);
        let mut visibility = None;
        for event in bsdf.non_delta_events() {
            let class = cx.plan.classes.prepend(event.letter(), walk.suffix);
            let f_cos = bsdf.eval(event, si.wo, light.wi, Transport::Radiance);
            if f_cos.is_black() || !cx.plan.is_wanted(class) {
                continue;
            }
            let visible = *visibility.get_or_insert_with(|| {
                stats.rays += 1;
                cx.scene.transmittance(si, &light)
            });
            if visible == 0.0 {
                return;
            }
            let weight = if event == Event::Diffuse || light.is_delta {
                1.0
            } else {
                mis::power(light_pdf, bsdf.pdf(event, si.wo, light.wi))
            };
            out.note(|| Step::Found {
                event: Some(event),
                light: None,
                pdf_light: Some(light_pdf),
                pdf_walk: Some(bsdf.pdf(event, si.wo, light.wi)),
                weight,
                visible: Rgb::splat(visible),
            });
            out.add(class, incident * f_cos * (weight * visible));
        }
    }

    /// Light of the surface that the walk met: a word without D.
    pub(super) fn add_emitted(
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
        let weight = hit_weight(walk.last.as_ref(), light_pdf);
        out.note(|| met(walk, id, weight, light_pdf));
        out.add(walk.suffix, walk.throughput * emitted * weight);
    }

    /// Light from infinity where the walk leaves the scene.
    pub(super) fn add_escaped(
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
            let weight = hit_weight(walk.last.as_ref(), light_pdf);
            out.note(|| met(walk, id, weight, light_pdf));
            out.add(walk.suffix, walk.throughput * light.escaped(ray.d) * weight);
        }
    }
}

/// Weight of light that the walk met, against a shadow ray toward it of density `light_pdf`
/// (selection included, 1/sr).
fn hit_weight(last: Option<&Scattered>, light_pdf: impl FnOnce(Vec3A) -> f32) -> f32 {
    match last {
        Some(last) if !last.event.is_delta() => mis::power(last.pdf_dir, light_pdf(last.p)),
        _ => 1.0,
    }
}

/// That the walk met the light `id`, for those who listen.
fn met(walk: &Walk, id: u32, weight: f32, light_pdf: impl FnOnce(Vec3A) -> f32) -> Step {
    let last = walk.last.as_ref().filter(|last| !last.event.is_delta());
    Step::Found {
        event: None,
        light: Some(id),
        pdf_light: last.map(|last| light_pdf(last.p)),
        pdf_walk: last.map(|last| last.pdf_dir),
        weight,
        visible: Rgb::WHITE,
    }
}
