//! The walk from the eye through participating media: it ends at the first diffuse event, or where
//! a medium scatters it first. There a volume map takes the place of both surface maps (Jensen and
//! Christensen 1998); light straight from the lights is found by shadow rays.

use super::walk::{Estimator, ROULETTE_EVENTS, Scratch, Walk};
use crate::engine::bsdf::Bsdf;
use crate::engine::event::Letter;
use crate::engine::geometry::{Ray, SurfaceInteraction};
use crate::engine::integrators::path::{Gather, PathTracer, Walk as PathWalk};
use crate::engine::integrators::replay::RadianceSink;
use crate::engine::integrators::{Pass, RenderStats};
use crate::engine::math::Rgb;
use crate::engine::path::ClassId;
use crate::engine::photon::{Contribution, PhotonMap};
use crate::engine::sampling::{IndependentSampler, Sampler, Stream};
use crate::engine::scene::{Span, VolumePoint};

/// Reads the maps where a walk ends.
struct Reader<'a, 'c> {
    estimator: &'a Estimator,
    cx: &'a Pass<'c>,
    scratch: Scratch,
    stats: RenderStats,
}

impl Estimator {
    /// As `radiance`, in scenes with media.
    pub(super) fn radiance_in_media<S: Sampler>(
        &self,
        cx: &Pass<'_>,
        ray: Ray,
        sampler: &mut S,
        out: &mut impl RadianceSink,
        stats: &mut RenderStats,
    ) {
        let mut reader = Reader {
            estimator: self,
            cx,
            scratch: self.scratch(),
            stats: RenderStats::default(),
        };
        let walk = PathTracer::for_gathering(ROULETTE_EVENTS);
        walk.gather_in_media(cx, ray, sampler, &mut reader, out, stats);
        *stats += reader.stats;
    }

    /// The volume map, if it is shown.
    fn volume_map(&self) -> Option<&PhotonMap> {
        let shown = self.settings.as_ref().is_some_and(|s| s.volume_map);
        self.maps.volume.as_ref().filter(|_| shown)
    }

    fn reads_beams(&self) -> bool {
        self.settings.as_ref().is_some_and(|s| s.volume_beams)
    }
}

impl Reader<'_, '_> {
    /// The class of what a photon brings to a walk that ends in a medium; None if it is not wanted,
    /// or too long.
    fn class(&self, walk: &PathWalk, c: &Contribution) -> Option<ClassId> {
        let plan = self.cx.plan;
        let allowed = plan.max_depth.map_or(u32::MAX, |max| max - walk.depth - 1);
        let suffix = plan.classes.prepend(Letter::V, walk.suffix);
        let class = plan.classes.join(c.class, suffix);
        (c.events <= allowed && plan.is_wanted(class)).then_some(class)
    }
}

impl Gather for Reader<'_, '_> {
    const ENDS: bool = true;

    fn along(&mut self, walk: &PathWalk, span: &Span<'_>, out: &mut impl RadianceSink) {
        let medium = span.medium;
        let reads = self.estimator.reads_beams() && medium.is_homogeneous() && medium.scatters();
        let Some(map) = self.estimator.volume_map().filter(|_| reads) else {
            return;
        };
        let (radius, phase) = (self.estimator.volume_radius, medium.phase);
        let throughput = walk.throughput * span.weight;
        map.estimate_beam(&span.ray, span.range, phase, radius, |t, c| {
            if let Some(class) = self.class(walk, &c) {
                let through = medium.transmittance_over(t - span.range.0);
                out.add(class, throughput * through * c.radiance);
            }
        });
    }

    fn at_volume(&mut self, walk: &PathWalk, point: &VolumePoint, out: &mut impl RadianceSink) {
        let along_rays = self.estimator.reads_beams() && point.homogeneous;
        let Some(map) = self.estimator.volume_map().filter(|_| !along_rays) else {
            return;
        };
        // The collision brought σ_s into the throughput; photons have it in their powers.
        let scattered = |c: usize| match point.sigma_s[c] {
            0.0 => 0.0,
            s => 1.0 / s,
        };
        let throughput = walk.throughput * Rgb::new(scattered(0), scattered(1), scattered(2));
        let (radius, place) = (self.estimator.volume_radius, (point.p, point.wo));
        let mut nearest = std::mem::replace(
            &mut self.scratch.nearest,
            crate::engine::photon::Nearest::new(1),
        );
        map.estimate_point(place, point.phase, radius, &mut nearest, |c| {
            if let Some(class) = self.class(walk, &c) {
                out.add(class, throughput * c.radiance);
            }
        });
        self.scratch.nearest = nearest;
    }

    fn at_surface(
        &mut self,
        walk: &PathWalk,
        si: &SurfaceInteraction,
        bsdf: &Bsdf,
        out: &mut impl RadianceSink,
    ) {
        let mut ended = Walk::new();
        ended.throughput = walk.throughput;
        ended.suffix = walk.suffix;
        ended.depth = walk.depth;
        // No gather rays are sent in media: these numbers are not drawn from.
        let numbers = IndependentSampler::new(self.cx.seed, Stream::Gather, (0, 0));
        let (cx, scratch, stats) = (self.cx, &mut self.scratch, &mut self.stats);
        self.estimator
            .add_photons(cx, &ended, si, bsdf, numbers, scratch, out, stats);
    }
}
