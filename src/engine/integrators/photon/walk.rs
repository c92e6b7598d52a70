//! The walk from the eye through mirrors, glass and glossy surfaces to the first diffuse event.

use std::sync::Arc;

use super::direct::Scattered;
use super::params::{Indirect, PhotonSettings};
use crate::engine::bsdf::{Bsdf, Lobe, Transport};
use crate::engine::event::{Event, Letter};
use crate::engine::geometry::{Departure, Ray, SurfaceInteraction};
use crate::engine::integrators::replay::{RadianceSink, Step};
use crate::engine::integrators::tiled::{CAMERA_DIMENSIONS, RayIntegrator};
use crate::engine::integrators::{Pass, RenderStats};
use crate::engine::math::Rgb;
use crate::engine::math::hash::combine;
use crate::engine::path::ClassId;
use crate::engine::photon::irradiance_cache::{ClassSums, IrradianceCache, add_to};
use crate::engine::photon::{Disc, Nearest, PhotonMap, PhotonMaps};
use crate::engine::sampling::{IndependentSampler, MAX_SURVIVAL, Sampler, Stream};

/// Most events of a path; beyond, it is cut and counted.
const MAX_EVENTS: u32 = 10_000_000;
/// Dimensions reserved per vertex: four for the walk, four for the shadow ray.
pub(super) const VERTEX_DIMENSIONS: u32 = 8;
/// Dimensions from here on seed the numbers of gather rays, two a vertex.
const GATHER_DIMENSIONS: u32 = 1 << 20;
/// Events after which roulette may end a walk.
pub(super) const ROULETTE_EVENTS: u32 = 2;

/// The estimator behind the entry; it is made anew whenever maps or settings change.
#[derive(Clone, Default)]
pub struct Estimator {
    /// What the user set.
    pub settings: Option<PhotonSettings>,
    /// The photons.
    pub maps: Arc<PhotonMaps>,
    /// Interpolated gathers, where they are used.
    pub cache: Option<Arc<IrradianceCache>>,
    /// Largest radii in scene units, of the caustic and the global map.
    pub radii: [f32; 2],
    /// Radius in scene units of estimates in media.
    pub volume_radius: f32,
    /// Photons of an estimate.
    pub nearest: usize,
    /// Seed of the photons, and which of several independent maps they are.
    pub numbers: (u64, u64),
}

/// The state of a walk between two vertices.
pub(super) struct Walk {
    /// Product of f·cosθ/pdf over the events so far, survival divided out.
    pub throughput: Rgb,
    /// Class of the events so far, the light side still open.
    pub suffix: ClassId,
    /// Events so far.
    pub depth: u32,
    /// Product of the squared index ratios: roulette looks at what returns to the eye's medium.
    pub eta2: f32,
    /// Where the last event happened, and how.
    pub last: Option<Scattered>,
}

impl Walk {
    /// Before any event.
    pub fn new() -> Self {
        Self {
            throughput: Rgb::WHITE,
            suffix: ClassId::EMPTY,
            depth: 0,
            eta2: 1.0,
            last: None,
        }
    }

    /// Russian roulette: survival divides the throughput and enters no weight.
    pub fn survives(&mut self, u: f32, stats: &mut RenderStats) -> bool {
        if self.depth <= ROULETTE_EVENTS {
            return !self.throughput.is_black();
        }
        let survival = (self.throughput.max_component() * self.eta2).min(MAX_SURVIVAL);
        if !stats.play(u < survival) {
            return false;
        }
        self.throughput *= 1.0 / survival;
        true
    }
}

/// Memory of one camera sample, so that no query allocates.
pub(super) struct Scratch {
    pub nearest: Nearest,
    pub sums: ClassSums,
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
        if cx.plan.features.media {
            self.radiance_in_media(cx, ray, sampler, out, stats);
            return;
        }
        let mut walk = Walk::new();
        let mut scratch = self.scratch();
        loop {
            // Dimensions are reserved per vertex: what one vertex draws shifts no later one.
            let first = CAMERA_DIMENSIONS + VERTEX_DIMENSIONS * walk.depth;
            sampler.seek(first);
            let (direction, event) = (sampler.next_2d(), sampler.next_1d());
            let roulette = sampler.next_1d();

            // The next surface, or the sky; light that the walk met by itself.
            stats.ray_at(walk.depth);
            let hit = cx.scene.intersect(&ray, || opacity_number(sampler, first));
            let left = walk.last.as_ref().map(|last| last.departure);
            let fault = cx
                .scene
                .ray_fault(left.unwrap_or(Departure::NOWHERE), hit.as_ref());
            stats.count_ray_fault(fault);
            let Some(si) = hit else {
                self.add_escaped(cx, &walk, &ray, out);
                return;
            };
            out.note(|| Step::vertex(&si, walk.throughput, walk.suffix));
            self.add_emitted(cx, &walk, &si, out);
            if cx.plan.max_depth.is_some_and(|max| walk.depth >= max) {
                return;
            }
            if walk.depth >= MAX_EVENTS {
                stats.cut_paths += 1;
                return;
            }
            let bsdf = cx.scene.bsdf(&si);
            if bsdf.is_empty() {
                return;
            }

            // Light found by shadow rays, at diffuse and glossy events.
            if cx.plan.shadow_rays && bsdf.has_non_delta() {
                sampler.seek(first + 4);
                self.add_direct(cx, &walk, &si, &bsdf, sampler, out, stats);
            }
            // Light found by photons, at the diffuse event.
            if bsdf.has(Event::Diffuse) {
                let numbers = gather_sampler(cx.seed, sampler, walk.depth);
                self.add_photons(cx, &walk, &si, &bsdf, numbers, &mut scratch, out, stats);
            }

            // One event, drawn by the roulette between the lobes; at D the walk has ended.
            let Some(sample) = bsdf.sample(si.wo, event, direction, Transport::Radiance) else {
                stats.below_horizon += u64::from(bsdf.has(Event::Glossy));
                return;
            };
            out.note(|| Step::scattered(&sample));
            if sample.event == Event::Diffuse {
                out.note(|| Step::ended("a diffuse event: photons told what lies behind it"));
                return;
            }
            walk.throughput *= sample.weight;
            walk.eta2 *= sample.eta * sample.eta;
            walk.suffix = cx.plan.classes.prepend(sample.event.letter(), walk.suffix);
            walk.depth += 1;
            let goes_on = !cx.plan.is_pointless(walk.suffix) && walk.survives(roulette, stats);
            out.note(|| Step::roulette(roulette, goes_on, walk.throughput));
            if !goes_on {
                return;
            }
            walk.last = Some(Scattered {
                p: si.p,
                event: sample.event,
                pdf_dir: sample.pdf_dir,
                departure: si.departure(sample.wi),
            });
            ray = si.spawn_ray(sample.wi);
        }
    }
}

impl Estimator {
    /// The terms of the first diffuse event that come from photons: caustics, and indirect light
    /// as the settings say. The switches blacken what is seen directly, and nothing in mirrors:
    /// that belongs to another component.
    #[expect(clippy::too_many_arguments, reason = "see add_direct")]
    pub(super) fn add_photons(
        &self,
        cx: &Pass<'_>,
        walk: &Walk,
        si: &SurfaceInteraction,
        bsdf: &Bsdf,
        numbers: IndependentSampler,
        scratch: &mut Scratch,
        out: &mut impl RadianceSink,
        stats: &mut RenderStats,
    ) {
        let Some(settings) = &self.settings else {
            return;
        };
        let classes = &cx.plan.classes;
        let suffix = classes.prepend(Letter::D, walk.suffix);
        if cx.plan.is_pointless(suffix) {
            return;
        }
        // Events that may stand before this one.
        let allowed = cx
            .plan
            .max_depth
            .map_or(u32::MAX, |max| max - walk.depth - 1);
        let seen_directly = walk.depth == 0;
        scratch.sums.clear();
        if settings.caustic_map || !seen_directly {
            let disc = Disc::new(si, self.radii[0], true);
            self.read(
                self.maps.caustic.as_ref(),
                si,
                bsdf,
                &disc,
                allowed,
                scratch,
            );
        }
        out.note(|| Step::Read {
            from: "the caustic map",
        });
        add_all(cx, walk, suffix, &scratch.sums, Rgb::WHITE, out);
        if !settings.global_map && seen_directly {
            return;
        }
        scratch.sums.clear();
        let mut white = Rgb::WHITE;
        match (settings.indirect, lambertian(bsdf), &self.cache) {
            (Indirect::Direct, ..) => {
                let disc = Disc::new(si, self.radii[1], true);
                self.read(self.maps.global.as_ref(), si, bsdf, &disc, allowed, scratch);
            }
            (Indirect::Cache, Some(albedo), Some(cache))
                if cache.interpolate(si.p, toward(si), &mut scratch.sums) =>
            {
                white = albedo;
            }
            _ => {
                scratch.sums.clear();
                self.gather(cx, si, bsdf, allowed, numbers, scratch, stats, &mut ());
            }
        }
        out.note(|| Step::Read {
            from: match settings.indirect {
                Indirect::Direct => "the global map",
                Indirect::Gather => "gather rays",
                Indirect::Cache => "the irradiance cache, or gather rays",
            },
        });
        add_all(cx, walk, suffix, &scratch.sums, white, out);
    }

    /// Adds what a map says, by class of the events before.
    pub(super) fn read(
        &self,
        map: Option<&PhotonMap>,
        si: &SurfaceInteraction,
        bsdf: &Bsdf,
        disc: &Disc,
        allowed: u32,
        scratch: &mut Scratch,
    ) {
        let (Some(map), Some(settings)) = (map, &self.settings) else {
            return;
        };
        let Scratch { nearest, sums } = scratch;
        map.estimate(si, bsdf, disc, settings.kernel, nearest, |c| {
            if c.events <= allowed {
                add_to(sums, c.class, c.radiance);
            }
        });
    }
}

/// Adds radiance by the classes of the events before the vertex whose class with all that follows
/// is `suffix`.
fn add_all(
    cx: &Pass<'_>,
    walk: &Walk,
    suffix: ClassId,
    sums: &ClassSums,
    factor: Rgb,
    out: &mut impl RadianceSink,
) {
    for &(class, radiance) in sums {
        let class = cx.plan.classes.join(class, suffix);
        out.add(class, walk.throughput * factor * radiance);
    }
}

/// The albedo of the D lobes if all are Lambertian.
pub(super) fn lambertian(bsdf: &Bsdf) -> Option<Rgb> {
    let mut albedo = Rgb::BLACK;
    for (weight, lobe) in bsdf.lobes() {
        match lobe {
            Lobe::Lambert => albedo += weight,
            _ if lobe.letter() == Letter::D => return None,
            _ => {}
        }
    }
    Some(albedo)
}

/// The shading normal on the side that is seen.
pub(super) fn toward(si: &SurfaceInteraction) -> glam::Vec3A {
    if si.n_g.dot(si.wo) < 0.0 {
        -si.n_s
    } else {
        si.n_s
    }
}

/// The numbers of the gather rays of one vertex: more than a point of a sequence has dimensions.
fn gather_sampler<S: Sampler>(seed: u64, sampler: &mut S, depth: u32) -> IndependentSampler {
    sampler.seek(GATHER_DIMENSIONS + 2 * depth);
    let bits = |u: f32| u64::from(u.to_bits());
    let (a, b) = (bits(sampler.next_1d()), bits(sampler.next_1d()));
    IndependentSampler::new(seed, Stream::Gather, (combine(a, b), u64::from(depth)))
}

/// The spare number of a vertex, for the stochastic passage through surfaces of opacity below 1.
pub(super) fn opacity_number<S: Sampler>(sampler: &mut S, first: u32) -> f32 {
    sampler.seek(first + 7);
    sampler.next_1d()
}
