//! Recursive ray tracing (Whitted 1980, *An Improved Illumination Model for Shaded Display*; Cook,
//! Porter and Carpenter 1984 for soft shadows).
//!
//! Mirrors and glass send on one ray for each of their lobes; diffuse and glossy surfaces are lit
//! by shadow rays to every light, and the tree ends there. It finds `L(D|G)?S*E` and nothing else:
//! no light passes between diffuse surfaces, there are no caustics, and nothing ambient stands in
//! for them. With soft shadows it is unbiased for these words; hard ones light from the middle of
//! each lamp.

use arrayvec::ArrayVec;
use glam::Vec2;

use super::path::turned;
use super::tiled::{CAMERA_DIMENSIONS, RayIntegrator, SamplerKind, Tiled};
use super::{Entry, Integrator, Missing, ParamKind, ParamSpec, Params, Pass, RenderStats};
use crate::engine::bsdf::{Bsdf, Transport};
use crate::engine::geometry::{Departure, Ray, SurfaceInteraction};
use crate::engine::integrators::replay::{RadianceSink, Step};
use crate::engine::math::Rgb;
use crate::engine::path::ClassId;
use crate::engine::sampling::{MAX_SURVIVAL, Sampler};
use crate::engine::scene::features::SceneFeatures;

/// Registry entry.
pub const ENTRY: Entry = Entry {
    id: "whitted",
    label: "Ray tracing (Whitted)",
    summary: "Mirrors, glass and direct light, quickly and without noise; no light between \
              diffuse surfaces and no caustics. The first chapter of the story, not its end.",
    params: PARAMS,
    missing,
    media: false,
    build,
};

const PARAMS: &[ParamSpec] = &[
    ParamSpec {
        name: "shadows",
        kind: ParamKind::Choice(&["soft", "hard"]),
        default: "soft",
        unit: "",
        matters: |_| true,
        doc: "Lamps are sampled all over, or stand for a point in their middle.",
    },
    ParamSpec {
        name: "branching",
        kind: ParamKind::Integer(0, 8),
        default: "4",
        unit: "events",
        matters: |_| true,
        doc: "Number of mirror or glass events up to which all lobes are followed; beyond, one is \
              drawn.",
    },
    super::SAMPLER_PARAM,
];

/// Most specular events of a path; beyond, it is cut and counted.
const MAX_EVENTS: u32 = 10_000_000;
/// Events before a ray of which one lobe is drawn plays roulette.
const ROULETTE_EVENTS: u32 = 4;
/// Dimensions reserved per ray: 0 event, 1 roulette, 2–3 lights, 7 opacity.
const RAY_DIMENSIONS: u32 = 8;
/// Rays that wait: at most seven more for each event followed by all of up to eight lobes.
const MAX_WAITING: usize = 64;

fn build(params: &Params) -> Box<dyn Integrator> {
    let tracer = Whitted {
        soft: params.choice("shadows") != "hard",
        branching: u32::try_from(params.integer("branching")).unwrap_or(0),
    };
    Box::new(Tiled::new(tracer, SamplerKind::of(params)))
}

fn missing(features: &SceneFeatures, _params: &Params) -> Option<Missing> {
    let zero_size = features.zero_size_lights && features.specular;
    let scatters = features.diffuse || features.glossy;
    let (words, why) = match (scatters, zero_size) {
        (true, false) => (
            "L.+(D|G|V).*E",
            "a diffuse or glossy surface is lit by shadow rays alone and sends no ray on",
        ),
        (true, true) => (
            "L.+(D|G|V).*E|LS+E",
            "a diffuse or glossy surface is lit by shadow rays alone and sends no ray on; no ray \
             meets a light of zero size",
        ),
        (false, true) => ("LS+E", "no ray meets a light of zero size"),
        (false, false) => return None,
    };
    Some(Missing {
        words: words.into(),
        why: why.into(),
    })
}

struct Whitted {
    soft: bool,
    branching: u32,
}

/// A ray of the tree.
struct Branch {
    ray: Ray,
    throughput: Rgb,
    suffix: ClassId,
    depth: u32,
    /// What roulette looks at: throughput in the eye's medium.
    kept: Rgb,
    departure: Departure,
}

impl RayIntegrator for Whitted {
    fn radiance<S: Sampler>(
        &self,
        cx: &Pass<'_>,
        ray: Ray,
        sampler: &mut S,
        out: &mut impl RadianceSink,
        stats: &mut RenderStats,
    ) {
        let mut waiting = ArrayVec::<Branch, MAX_WAITING>::new();
        waiting.push(Branch {
            ray,
            throughput: Rgb::WHITE,
            suffix: ClassId::EMPTY,
            depth: 0,
            kept: Rgb::WHITE,
            departure: Departure::NOWHERE,
        });
        let mut first = CAMERA_DIMENSIONS;
        while let Some(branch) = waiting.pop() {
            // The next surface, or the sky.
            stats.ray_at(branch.depth);
            let number = || {
                sampler.seek(first + 7);
                sampler.next_1d()
            };
            let hit = cx.scene.intersect(&branch.ray, number);
            stats.count_ray_fault(cx.scene.ray_fault(branch.departure, hit.as_ref()));
            let Some(si) = hit else {
                let sky = cx.scene.lights.escaped(branch.ray.d);
                out.add(branch.suffix, branch.throughput * sky);
                first += RAY_DIMENSIONS;
                continue;
            };

            out.note(|| Step::vertex(&si, branch.throughput, branch.suffix));

            // A lamp that is seen, directly or in mirrors and through glass.
            if let Some(id) = si.light {
                let emitted = cx.scene.lights.get(id).emitted(&si, si.wo);
                out.add(branch.suffix, branch.throughput * emitted);
            }
            if cx.plan.max_depth.is_none_or(|max| branch.depth < max) {
                let bsdf = cx.scene.bsdf(&si);
                if cx.plan.shadow_rays && bsdf.has_non_delta() {
                    sampler.seek(first + 2);
                    let u = sampler.next_2d();
                    self.add_direct(cx, &branch, &si, &bsdf, u, out, stats);
                }
                sampler.seek(first);
                let u = Vec2::new(sampler.next_1d(), sampler.next_1d());
                self.follow(cx, &branch, &si, &bsdf, u, &mut waiting, stats);
            }
            first += RAY_DIMENSIONS;
        }
    }
}

impl Whitted {
    /// Shadow rays to every light, for each diffuse or glossy event of the surface.
    #[expect(clippy::too_many_arguments, reason = "the state of one ray")]
    fn add_direct(
        &self,
        cx: &Pass<'_>,
        branch: &Branch,
        si: &SurfaceInteraction,
        bsdf: &Bsdf,
        u: Vec2,
        out: &mut impl RadianceSink,
        stats: &mut RenderStats,
    ) {
        for (i, light) in cx.scene.lights.as_slice().iter().enumerate() {
            // The sky has no middle.
            let whole = self.soft || light.is_infinite();
            let u = if whole {
                turned(u, i)
            } else {
                Vec2::splat(0.5)
            };
            let Some(sample) = light.sample_li(si.p, u) else {
                continue;
            };
            out.note(|| Step::shadow_ray(i as u32, 1.0, &sample));
            let incident = branch.throughput * sample.radiance * (1.0 / sample.pdf_dir);
            let mut visibility = None;
            for event in bsdf.non_delta_events() {
                let class = cx.plan.classes.prepend(event.letter(), branch.suffix);
                let f_cos = bsdf.eval(event, si.wo, sample.wi, Transport::Radiance);
                if f_cos.is_black() || !cx.plan.is_wanted(class) {
                    continue;
                }
                let visible = *visibility.get_or_insert_with(|| {
                    stats.rays += 1;
                    cx.scene.transmittance(si, &sample)
                });
                out.add(class, incident * f_cos * visible);
            }
        }
    }

    /// Sends rays on: by every delta lobe, or by one lobe drawn from them where the tree is deep.
    #[expect(clippy::too_many_arguments, reason = "the state of one ray")]
    fn follow(
        &self,
        cx: &Pass<'_>,
        branch: &Branch,
        si: &SurfaceInteraction,
        bsdf: &Bsdf,
        u: Vec2,
        waiting: &mut ArrayVec<Branch, MAX_WAITING>,
        stats: &mut RenderStats,
    ) {
        if branch.depth >= MAX_EVENTS {
            stats.cut_paths += 1;
            return;
        }
        let all = branch.depth < self.branching;
        let total: f32 = bsdf
            .delta_events()
            .map(|e| bsdf.event_probability(e, si.wo))
            .sum();
        // Where one is drawn: its share of the delta lobes.
        let mut left = u.x * total;
        for event in bsdf.delta_events() {
            let share = bsdf.event_probability(event, si.wo);
            if !all {
                let drawn = (0.0..share).contains(&left);
                left -= share;
                if !drawn {
                    continue;
                }
            }
            let transport = Transport::Radiance;
            let Some(sample) = bsdf.sample_event(event, si.wo, 0.0, Vec2::ZERO, transport) else {
                continue;
            };
            // A sample's weight is divided by the probability of its event, which here is 1 or the
            // share of the total.
            let weight = sample.weight * if all { share } else { total };
            let mut next = Branch {
                ray: si.spawn_ray(sample.wi),
                throughput: branch.throughput * weight,
                suffix: cx.plan.classes.prepend(event.letter(), branch.suffix),
                depth: branch.depth + 1,
                kept: branch.kept * weight * (sample.eta * sample.eta),
                departure: si.departure(sample.wi),
            };
            if !all && next.depth > ROULETTE_EVENTS {
                let survival = next.kept.max_component().min(MAX_SURVIVAL);
                if !stats.play(u.y < survival) {
                    continue;
                }
                next.throughput *= 1.0 / survival;
                next.kept *= 1.0 / survival;
            }
            if !next.throughput.is_black() {
                waiting.push(next);
            }
        }
    }
}
