//! Final gathering: the hemisphere is looked at by rays that read both maps where they first meet
//! a diffuse surface (Jensen 2001, section 8.2.4).

use glam::{Vec2, Vec3A};

use super::walk::{Estimator, Scratch, Walk};
use crate::engine::bsdf::{Bsdf, Transport};
use crate::engine::event::{Event, Letter};
use crate::engine::geometry::{Ray, SurfaceInteraction};
use crate::engine::integrators::{Pass, RenderStats};
use crate::engine::path::ClassId;
use crate::engine::photon::Disc;
use crate::engine::photon::irradiance_cache::{ClassSums, add_to};
use crate::engine::sampling::{IndependentSampler, Sampler};

/// Dimensions of one gather ray: four for its start, four a vertex.
const RAY_DIMENSIONS: u32 = 1 << 12;
/// Longest chain of mirrors that a gather ray follows: its dimensions hold no more. Roulette ends
/// it long before.
const MAX_CHAIN: u32 = RAY_DIMENSIONS / 8 - 1;

/// What watches gather rays.
pub(super) trait GatherWitness {
    /// A ray left in direction `d` and met `si`, or nothing.
    fn sent(&mut self, _d: Vec3A, _si: Option<&SurfaceInteraction>) {}
}

impl GatherWitness for () {}

/// The sum of inverse distances: its inverse is Ward's radius of a record.
#[derive(Default)]
pub(super) struct InverseDistances(pub f32);

impl GatherWitness for InverseDistances {
    fn sent(&mut self, _d: Vec3A, si: Option<&SurfaceInteraction>) {
        self.0 += si.map_or(0.0, |si| 1.0 / si.t);
    }
}

/// A gather ray, for display.
#[derive(Clone, Copy, Debug)]
pub struct GatherRay {
    /// Unit direction.
    pub d: Vec3A,
    /// Where it ended; `None` if it left the scene.
    pub end: Option<Vec3A>,
}

impl GatherWitness for Vec<GatherRay> {
    fn sent(&mut self, d: Vec3A, si: Option<&SurfaceInteraction>) {
        self.push(GatherRay {
            d,
            end: si.map(|si| si.p),
        });
    }
}

impl Estimator {
    /// Memory for queries of this estimator.
    pub(super) fn scratch(&self) -> Scratch {
        Scratch {
            nearest: crate::engine::photon::Nearest::new(self.nearest),
            sums: ClassSums::new(),
        }
    }

    /// Adds the radiance that the D lobes scatter toward `si.wo`, by class of the events before.
    #[expect(clippy::too_many_arguments, reason = "see add_direct")]
    pub(super) fn gather(
        &self,
        cx: &Pass<'_>,
        si: &SurfaceInteraction,
        bsdf: &Bsdf,
        allowed: u32,
        mut numbers: IndependentSampler,
        scratch: &mut Scratch,
        stats: &mut RenderStats,
        witness: &mut impl GatherWitness,
    ) {
        let Some(settings) = &self.settings else {
            return;
        };
        if allowed == 0 {
            return; // the diffuse event where a ray ends would be one too many
        }
        // Rows by columns of strata, as square as the number allows.
        let rays = settings.gather_rays.max(1);
        let rows = (1..=rays.isqrt())
            .rev()
            .find(|r| rays.is_multiple_of(*r))
            .unwrap_or(1);
        let columns = rays / rows;
        // The end of a walk takes all of its D event: sampling must not count its probability.
        let share = bsdf.event_probability(Event::Diffuse, si.wo) / rays as f32;
        for i in 0..rays {
            let first = i * RAY_DIMENSIONS;
            numbers.seek(first);
            let jitter = numbers.next_2d();
            let stratum = Vec2::new((i % columns) as f32, (i / columns) as f32);
            let u = (stratum + jitter) / Vec2::new(columns as f32, rows as f32);
            let u = u.min(Vec2::splat(crate::engine::math::float::ONE_MINUS_EPSILON));
            let (u_lobe, transport) = (numbers.next_1d(), Transport::Radiance);
            let start = bsdf.sample_event(Event::Diffuse, si.wo, u_lobe, u, transport);
            let Some(start) = start else { continue };
            let mut walk = Walk::new();
            walk.throughput = start.weight * share;
            let ray = si.spawn_ray(start.wi);
            self.look(
                cx,
                ray,
                walk,
                allowed,
                (&mut numbers, first),
                scratch,
                stats,
                witness,
            );
        }
    }

    /// Follows a gather ray through mirrors, glass and glossy surfaces to its first diffuse event,
    /// and reads both maps at every diffuse lobe on its way. Light that it meets was found by
    /// shadow rays or stands in the caustic map already: it is dropped.
    #[expect(clippy::too_many_arguments, reason = "see add_direct")]
    fn look(
        &self,
        cx: &Pass<'_>,
        mut ray: Ray,
        mut walk: Walk,
        allowed: u32,
        (numbers, first): (&mut IndependentSampler, u32),
        scratch: &mut Scratch,
        stats: &mut RenderStats,
        witness: &mut impl GatherWitness,
    ) {
        let classes = &cx.plan.classes;
        let started_with = walk.throughput.max_component();
        while walk.depth < allowed.min(MAX_CHAIN) {
            numbers.seek(first + 8 * (walk.depth + 1));
            let (direction, event) = (numbers.next_2d(), numbers.next_1d());
            let roulette = numbers.next_1d();
            stats.rays += 1;
            let si = cx.scene.intersect(&ray, || numbers.next_1d());
            if walk.depth == 0 {
                witness.sent(ray.d, si.as_ref());
            }
            let Some(si) = si else { return };
            let bsdf = cx.scene.bsdf(&si);
            if bsdf.has(Event::Diffuse) {
                let after = classes.prepend(Letter::D, walk.suffix);
                let rest = allowed - walk.depth - 1;
                self.read_end(cx, &walk, after, &si, &bsdf, rest, scratch);
            }
            let sample = bsdf.sample(si.wo, event, direction, Transport::Radiance);
            let Some(sample) = sample.filter(|s| s.event != Event::Diffuse) else {
                return;
            };
            walk.throughput *= sample.weight;
            walk.eta2 *= sample.eta * sample.eta;
            walk.suffix = classes.prepend(sample.event.letter(), walk.suffix);
            walk.depth += 1;
            // Relative to what the ray began with: a share of a gather is no loss.
            walk.throughput *= 1.0 / started_with;
            let survives = walk.survives(roulette, stats);
            walk.throughput *= started_with;
            if !survives {
                return;
            }
            ray = si.spawn_ray(sample.wi);
        }
        if walk.depth >= MAX_CHAIN {
            stats.cut_paths += 1;
        }
    }

    /// Both maps where a gather ray ends, photons straight from the lights included.
    #[expect(clippy::too_many_arguments, reason = "see add_direct")]
    fn read_end(
        &self,
        cx: &Pass<'_>,
        walk: &Walk,
        after: ClassId,
        si: &SurfaceInteraction,
        bsdf: &Bsdf,
        allowed: u32,
        scratch: &mut Scratch,
    ) {
        let Some(settings) = &self.settings else {
            return;
        };
        let Scratch { nearest, sums } = scratch;
        let maps = [&self.maps.caustic, &self.maps.global];
        for (map, radius) in maps.into_iter().zip(self.radii) {
            let Some(map) = map else { continue };
            let disc = Disc::new(si, radius, false);
            map.estimate(si, bsdf, &disc, settings.kernel, nearest, |c| {
                if c.events <= allowed {
                    let class = cx.plan.classes.join(c.class, after);
                    add_to(sums, class, walk.throughput * c.radiance);
                }
            });
        }
    }
}
