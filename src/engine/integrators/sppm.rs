//! Stochastic progressive photon mapping (Hachisuka and Jensen 2009) with the schedule of Knaus and
//! Zwicker 2011: each pass is photon mapping on its own, with a radius that shrinks from pass to
//! pass, and the picture is their mean.
//!
//! The eye walk goes through mirrors, glass and glossy surfaces to its first diffuse event. There
//! shadow rays bring what comes straight from the lights, and photons all else. A pixel's
//! statistics are its sums in the film, so that memory does not grow with the passes.

use super::path::{Mode, PathTracer, Walk};
use super::tiled::{CAMERA_DIMENSIONS, RayIntegrator, SamplerKind, Tiled};
use super::vcm::{ALPHA_PARAM, PhotonSource, RADIUS_PARAM, photons_param};
use super::{
    Cancelled, Entry, Fact, Integrator, Missing, ParamKind, ParamSpec, Params, Pass, RenderStats,
};
use crate::engine::bsdf::{Bsdf, Transport};
use crate::engine::event::{Event, Letter};
use crate::engine::film::Film;
use crate::engine::geometry::{Ray, SurfaceInteraction};
use crate::engine::integrators::bidirectional::PhotonGrid;
use crate::engine::integrators::replay::{RadianceSink, Recording, ReplayError, SampleId, Step};
use crate::engine::math::Rgb;
use crate::engine::sampling::{Sampler, mis};
use crate::engine::scene::features::SceneFeatures;

/// Registry entry.
pub const ENTRY: Entry = Entry {
    id: "sppm",
    label: "Progressive photon mapping",
    summary: "For caustics, also those seen in mirrors and through glass; blurred by a radius that \
              shrinks. Slow where light is spread evenly.",
    params: PARAMS,
    missing,
    media: false,
    build,
};

const PARAMS: &[ParamSpec] = &[
    RADIUS_PARAM,
    ALPHA_PARAM,
    photons_param("4"),
    super::SAMPLER_PARAM,
    ParamSpec {
        name: "roulette",
        kind: ParamKind::Integer(0, 10_000_000),
        default: "2",
        unit: "events",
        matters: |_| true,
        doc: "Number of events after which Russian roulette may end either walk.",
    },
];

/// Most events of a path; beyond, it is cut and counted.
const MAX_EVENTS: u32 = 10_000_000;
/// Dimensions reserved per vertex, as in path tracing.
const VERTEX_DIMENSIONS: u32 = 8;

fn build(params: &Params) -> Box<dyn Integrator> {
    let estimator = Estimator {
        weights: PathTracer::of_mode(Mode::Mis),
        roulette: u32::try_from(params.integer("roulette")).unwrap_or(u32::MAX),
        grid: None,
    };
    Box::new(Sppm {
        photons: PhotonSource::new(params),
        tiled: Tiled::new(estimator, SamplerKind::of(params)),
    })
}

fn missing(features: &SceneFeatures, _params: &Params) -> Option<Missing> {
    (features.zero_size_lights && features.specular).then(|| Missing {
        words: "LS(S|G|V)*E".into(),
        why: "light of a point, spot or directional source that first meets a mirror or glass is \
              found by photons alone, and they are gathered at diffuse surfaces"
            .into(),
    })
}

struct Sppm {
    photons: PhotonSource,
    tiled: Tiled<Estimator>,
}

impl Integrator for Sppm {
    fn render_pass(&mut self, cx: &Pass<'_>, film: &mut Film) -> Result<RenderStats, Cancelled> {
        let (grid, mut stats) = self.photons.trace(cx)?;
        self.tiled.estimator_mut().grid = Some(grid);
        stats += self.tiled.render_pass(cx, film)?;
        Ok(stats)
    }

    fn replay(
        &mut self,
        cx: &Pass<'_>,
        sample: &SampleId,
        to: &mut Recording,
    ) -> Result<(), ReplayError> {
        if let Some(done) = self.photons.replay(cx, sample, to) {
            return done;
        }
        let (grid, _) = self.photons.trace(cx)?;
        self.tiled.estimator_mut().grid = Some(grid);
        self.tiled.replay(cx, sample, to)
    }

    fn memory_bytes(&self) -> usize {
        let grid = self.tiled.estimator().grid.as_ref();
        self.tiled.buffer_bytes() + grid.map_or(0, PhotonGrid::bytes)
    }

    fn facts(&self) -> Vec<Fact> {
        let grid = self.tiled.estimator().grid.as_ref();
        grid.map(PhotonGrid::fact).into_iter().collect()
    }
}

struct Estimator {
    /// Weighs hits of lights after a glossy event.
    weights: PathTracer,
    roulette: u32,
    grid: Option<PhotonGrid>,
}

impl RayIntegrator for Estimator {
    fn radiance<S: Sampler>(
        &self,
        cx: &Pass<'_>,
        mut ray: Ray,
        sampler: &mut S,
        out: &mut impl RadianceSink,
        stats: &mut RenderStats,
    ) {
        let mut walk = Walk::start();
        loop {
            let first = CAMERA_DIMENSIONS + VERTEX_DIMENSIONS * walk.depth;
            sampler.seek(first);
            let (direction, event, roulette) =
                (sampler.next_2d(), sampler.next_1d(), sampler.next_1d());

            // The next surface, or the sky, and light that the walk met by itself.
            stats.ray_at(walk.depth);
            let number = || {
                sampler.seek(first + 7);
                sampler.next_1d()
            };
            let hit = cx.scene.intersect(&ray, number);
            stats.count_ray_fault(cx.scene.ray_fault(walk.departure(), hit.as_ref()));
            let Some(si) = hit else {
                self.weights.add_escaped(cx, &walk, &ray, out);
                return;
            };
            out.note(|| Step::vertex(&si, walk.throughput, walk.suffix));
            self.weights.add_emitted(cx, &walk, &si, out);
            if cx.plan.max_depth.is_some_and(|max| walk.depth >= max) {
                return;
            }
            if walk.depth >= MAX_EVENTS {
                stats.cut_paths += 1;
                return;
            }

            // Light found by shadow rays, and by photons at a diffuse surface.
            let bsdf = cx.scene.bsdf(&si);
            if bsdf.is_empty() {
                return;
            }
            if cx.plan.shadow_rays && bsdf.has_non_delta() {
                sampler.seek(first + 4);
                self.add_direct(cx, &walk, &si, &bsdf, sampler, out, stats);
            }
            if bsdf.has(Event::Diffuse) {
                self.gather(cx, &walk, &si, &bsdf, out);
            }

            // On through mirrors, glass and glossy surfaces; a diffuse event has been gathered.
            let Some(sample) = bsdf.sample(si.wo, event, direction, Transport::Radiance) else {
                stats.below_horizon += u64::from(bsdf.has(Event::Glossy));
                return;
            };
            out.note(|| Step::scattered(&sample));
            if sample.event == Event::Diffuse {
                return;
            }
            let suffix = cx.plan.classes.prepend(sample.event.letter(), walk.suffix);
            walk = walk.after(&si, &sample, suffix, 1.0);
            if cx.plan.is_pointless(suffix) || !walk.survives(self.roulette, roulette, stats) {
                return;
            }
            ray = si.spawn_ray(sample.wi);
        }
    }
}

impl Estimator {
    /// A shadow ray to one light. A diffuse event never meets a light by itself here, so that its
    /// weight is 1; a glossy one may.
    #[expect(clippy::too_many_arguments, reason = "the state of one walk")]
    fn add_direct<S: Sampler>(
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

    /// The photons around `si` that some event scattered before; those straight from a light are
    /// the shadow rays' part.
    fn gather(
        &self,
        cx: &Pass<'_>,
        walk: &Walk,
        si: &SurfaceInteraction,
        bsdf: &Bsdf,
        out: &mut impl RadianceSink,
    ) {
        let Some(grid) = &self.grid else { return };
        let plan = cx.plan;
        let suffix = plan.classes.prepend(Letter::D, walk.suffix);
        let scale = (1.0 / grid.merging()) as f32;
        out.note(|| Step::Read {
            from: "the photons around",
        });
        grid.within(si.p, |photon| {
            let events = photon.s - 2;
            let class = plan.classes.join(photon.class, suffix);
            let long = plan
                .max_depth
                .is_some_and(|max| walk.depth + 1 + events > max);
            if events == 0 || long || !plan.is_wanted(class) {
                return;
            }
            let cos = si.n_g.dot(photon.wo).abs();
            let f_cos = bsdf.eval(Event::Diffuse, si.wo, photon.wo, Transport::Radiance);
            if cos > 0.0 {
                // Flux per area over the cosine is radiance times solid angle.
                out.add(class, walk.throughput * photon.flux * f_cos * (scale / cos));
            }
        });
    }
}
