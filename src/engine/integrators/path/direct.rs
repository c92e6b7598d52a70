//! Light found by shadow rays.

use glam::Vec2;

use super::walk::Walk;
use super::{Mode, PathTracer};
use crate::engine::bsdf::{Bsdf, Transport};
use crate::engine::geometry::SurfaceInteraction;
use crate::engine::integrators::replay::{RadianceSink, Step};
use crate::engine::integrators::{Pass, RenderStats};
use crate::engine::light::LightSample;
use crate::engine::math::Rgb;
use crate::engine::sampling::{Sampler, mis};

/// The point `u` of the square for light number `i`, where one point serves all lights: turned by
/// the golden ratio's relative in two dimensions (Roberts 2018, *The Unreasonable Effectiveness of
/// Quasirandom Sequences*).
pub(in crate::engine::integrators) fn turned(u: Vec2, i: usize) -> Vec2 {
    (u + Vec2::new(i as f32 * 0.754_877_7, i as f32 * 0.569_840_3)).fract()
}

impl PathTracer {
    /// Next event estimation at `si`: in mode `mis` toward one light chosen at random, in mode
    /// `kajiya` toward every light.
    #[expect(
        clippy::too_many_arguments,
        reason = "the state of one walk; a struct would be made and taken apart once a vertex"
    )]
    pub(in crate::engine::integrators) fn add_direct<S: Sampler>(
        &self,
        cx: &Pass<'_>,
        walk: &Walk,
        si: &SurfaceInteraction,
        bsdf: &Bsdf,
        sampler: &mut S,
        out: &mut impl RadianceSink,
        stats: &mut RenderStats,
    ) {
        let lights = &cx.scene.lights;
        if self.mode == Mode::Mis {
            if let Some((id, pmf, sample)) = lights.sample_li(si.p, sampler) {
                out.note(|| Step::shadow_ray(id, pmf, &sample));
                self.add_light_sample(cx, walk, si, bsdf, &sample, pmf, out, stats);
            }
            return;
        }
        // One point of the square serves all lights, turned by a number of each light's own.
        let u = sampler.next_2d();
        for (i, light) in lights.as_slice().iter().enumerate() {
            if let Some(sample) = light.sample_li(si.p, turned(u, i)) {
                out.note(|| Step::shadow_ray(i as u32, 1.0, &sample));
                self.add_light_sample(cx, walk, si, bsdf, &sample, 1.0, out, stats);
            }
        }
    }

    /// The contribution of one light sample, summed over the non-delta events of `bsdf`, each
    /// with the class and the weight of its own (rule 2 of the code map).
    #[expect(clippy::too_many_arguments, reason = "see add_direct")]
    fn add_light_sample(
        &self,
        cx: &Pass<'_>,
        walk: &Walk,
        si: &SurfaceInteraction,
        bsdf: &Bsdf,
        light: &LightSample,
        pmf: f32,
        out: &mut impl RadianceSink,
        stats: &mut RenderStats,
    ) {
        let light_pdf = pmf * light.pdf_dir;
        let incident = walk.throughput * light.radiance * (1.0 / light_pdf);
        let mut visibility = None;
        for event in bsdf.non_delta_events() {
            let class = cx.plan.classes.prepend(event.letter(), walk.suffix);
            if !cx.plan.is_wanted(class) {
                continue;
            }
            let f_cos = bsdf.eval(event, si.wo, light.wi, Transport::Radiance);
            if f_cos.is_black() {
                continue;
            }
            let visible = *visibility.get_or_insert_with(|| {
                stats.rays += 1;
                cx.scene.transmittance(si, light)
            });
            if visible == 0.0 {
                return;
            }
            let weight = if self.mode == Mode::Kajiya || light.is_delta {
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
}
