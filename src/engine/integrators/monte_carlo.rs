//! Naive Monte Carlo: many rays over the hemisphere at every hit, to a chosen depth.
//!
//! It estimates the same integrals as path tracing with `rays` samples at each level instead of
//! one, so that the rays grow by that factor from level to level: most of them are spent where
//! they matter least (Kajiya 1986, section 4). Shown to be compared with path tracing; words longer
//! than its depth are lost.

use super::path::{Mode, PathTracer, Walk, missing as path_missing};
use super::tiled::{CAMERA_DIMENSIONS, RayIntegrator, SamplerKind, Tiled};
use super::{Entry, Integrator, Missing, ParamKind, ParamSpec, Params, Pass, RenderStats};
use crate::engine::bsdf::Transport;
use crate::engine::event::Event;
use crate::engine::geometry::Ray;
use crate::engine::integrators::replay::{RadianceSink, Step};
use crate::engine::sampling::Sampler;
use crate::engine::scene::features::SceneFeatures;

/// Registry entry.
pub const ENTRY: Entry = Entry {
    id: "monte-carlo",
    label: "Naive Monte Carlo",
    summary: "Many rays at every hit, to a chosen depth: what path tracing improves on. Rays grow \
              exponentially with the depth, and what lies deeper is lost.",
    params: PARAMS,
    missing,
    media: false,
    build,
};

const PARAMS: &[ParamSpec] = &[
    super::path::MODE_PARAM,
    ParamSpec {
        name: "rays",
        kind: ParamKind::Integer(1, 1024),
        default: "8",
        unit: "rays",
        matters: |_| true,
        doc: "Rays sent on from every hit.",
    },
    ParamSpec {
        name: "depth",
        kind: ParamKind::Integer(0, 16),
        default: "3",
        unit: "events",
        matters: |_| true,
        doc: "Most events of a path; longer ones are lost.",
    },
    ParamSpec {
        name: "max-rays",
        kind: ParamKind::Integer(1, 1_000_000_000),
        default: "100000",
        unit: "rays",
        matters: |_| true,
        doc: "Most rays of one sample of a pixel, shadow rays left aside; a tree that is cut there \
              is counted, and too dark.",
    },
];

/// Dimensions reserved per ray, as along a path: four to go on, four for the shadow ray.
const RAY_DIMENSIONS: u32 = 8;

fn build(params: &Params) -> Box<dyn Integrator> {
    let count = |name: &str| u32::try_from(params.integer(name)).unwrap_or(0);
    let tree = MonteCarlo {
        direct: PathTracer::of_mode(Mode::of(params)),
        rays: count("rays").max(1),
        depth: count("depth"),
        max_rays: count("max-rays"),
    };
    Box::new(Tiled::new(tree, SamplerKind::Independent))
}

fn missing(features: &SceneFeatures, params: &Params) -> Option<Missing> {
    if !(features.diffuse || features.glossy || features.specular) {
        return None;
    }
    let longer = format!("L.{{{},}}E", params.integer("depth") + 1);
    let why = "rays are sent on to a chosen depth only";
    Some(match path_missing(features, params) {
        Some(lost) => Missing {
            words: format!("{longer}|{}", lost.words).into(),
            why: "rays are sent on to a chosen depth only, and no light of zero size is met by \
                  chance"
                .into(),
        },
        None => Missing {
            words: longer.into(),
            why: why.into(),
        },
    })
}

struct MonteCarlo {
    direct: PathTracer,
    rays: u32,
    depth: u32,
    max_rays: u32,
}

impl RayIntegrator for MonteCarlo {
    fn radiance<S: Sampler>(
        &self,
        cx: &Pass<'_>,
        ray: Ray,
        sampler: &mut S,
        out: &mut impl RadianceSink,
        stats: &mut RenderStats,
    ) {
        let mut tree = Tree {
            cx,
            sampler,
            out,
            stats,
            traced: 0,
        };
        self.grow(&mut tree, &Walk::start(), ray);
        let cut = tree.traced >= self.max_rays;
        stats.cut_trees += u64::from(cut);
    }
}

/// What all rays of one sample share.
struct Tree<'a, S, O> {
    cx: &'a Pass<'a>,
    sampler: &'a mut S,
    out: &'a mut O,
    stats: &'a mut RenderStats,
    traced: u32,
}

impl MonteCarlo {
    /// Follows one ray, and from where it ends as many more as are asked for. Recursion is as deep
    /// as the parameter `depth` at most.
    fn grow<S: Sampler, O: RadianceSink>(&self, tree: &mut Tree<'_, S, O>, walk: &Walk, ray: Ray) {
        if tree.traced >= self.max_rays {
            return;
        }
        let first = CAMERA_DIMENSIONS.wrapping_add(RAY_DIMENSIONS.wrapping_mul(tree.traced));
        tree.traced += 1;
        tree.stats.ray_at(walk.depth);
        let cx = tree.cx;
        let number = || {
            tree.sampler.seek(first.wrapping_add(7));
            tree.sampler.next_1d()
        };
        let hit = cx.scene.intersect(&ray, number);
        let fault = cx.scene.ray_fault(walk.departure(), hit.as_ref());
        tree.stats.count_ray_fault(fault);
        let Some(si) = hit else {
            self.direct.add_escaped(cx, walk, &ray, tree.out);
            return;
        };
        tree.out
            .note(|| Step::vertex(&si, walk.throughput, walk.suffix));
        self.direct.add_emitted(cx, walk, &si, tree.out);
        let max = cx.plan.max_depth.unwrap_or(u32::MAX).min(self.depth);
        let bsdf = cx.scene.bsdf(&si);
        if walk.depth >= max || bsdf.is_empty() {
            return;
        }
        if self.direct.sends_shadow_rays(cx) && bsdf.has_non_delta() {
            tree.sampler.seek(first.wrapping_add(4));
            self.direct
                .add_direct(cx, walk, &si, &bsdf, tree.sampler, tree.out, tree.stats);
        }
        for _ in 0..self.rays {
            // Each ray sent on takes its numbers from its own block, that of the ray it becomes.
            let block = RAY_DIMENSIONS.wrapping_mul(tree.traced);
            tree.sampler.seek(CAMERA_DIMENSIONS.wrapping_add(block));
            let (direction, event) = (tree.sampler.next_2d(), tree.sampler.next_1d());
            match bsdf.sample(si.wo, event, direction, Transport::Radiance) {
                Some(sample) => {
                    tree.out.note(|| Step::scattered(&sample));
                    let letter = sample.event.letter();
                    let suffix = cx.plan.classes.prepend(letter, walk.suffix);
                    let next = walk.after(&si, &sample, suffix, 1.0 / self.rays as f32);
                    self.grow(tree, &next, si.spawn_ray(sample.wi));
                }
                None => {
                    // Absorbed: its block of numbers is used up.
                    tree.traced += 1;
                    tree.stats.below_horizon += u64::from(bsdf.has(Event::Glossy));
                }
            }
            if tree.traced >= self.max_rays {
                return;
            }
        }
    }
}
