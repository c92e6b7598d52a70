//! Filling the irradiance cache in an order of its own: coarse grids of pixels first, in batches
//! that are computed side by side and added one by one, so that the records do not depend on
//! threads.

use std::sync::Arc;

use glam::Vec2;
use rayon::prelude::*;

use super::gather::InverseDistances;
use super::walk::{Estimator, VERTEX_DIMENSIONS, Walk, lambertian, opacity_number, toward};
use crate::engine::bsdf::{Bsdf, Lobe, Transport};
use crate::engine::event::Event;
use crate::engine::geometry::{Ray, SurfaceInteraction};
use crate::engine::integrators::{Cancelled, Pass, RenderStats};
use crate::engine::math::Rgb;
use crate::engine::photon::irradiance_cache::{CacheRecord, CacheSettings, IrradianceCache};
use crate::engine::sampling::{IndependentSampler, Sampler, Stream};

/// Pixels between two points of the coarsest grid.
const COARSEST: u32 = 16;
/// Points whose records are computed side by side.
const BATCH: usize = 64;
/// Least radius of a record, a share of the scene's radius.
const MIN_RADIUS: f32 = 0.02;
/// Largest radius, likewise.
const MAX_RADIUS: f32 = 1.0;
/// Largest number of mirrors before a point that gets a record.
const MAX_MIRRORS: u32 = 8;

impl Estimator {
    /// Computes the records that the view of `cx` needs.
    pub(super) fn fill_cache(
        &mut self,
        cx: &Pass<'_>,
        stats: &mut RenderStats,
    ) -> Result<(), Cancelled> {
        let Some(settings) = &self.settings else {
            return Ok(());
        };
        let radius = cx.scene.geometry.bounding_sphere().1;
        let mut cache = IrradianceCache::new(CacheSettings {
            error: settings.cache_error,
            min_radius: MIN_RADIUS * radius,
            max_radius: MAX_RADIUS * radius,
        });
        let mut stride = COARSEST;
        while stride > 0 {
            let points = self.points(cx, stride);
            for batch in points.chunks(BATCH) {
                cx.cancel.check()?;
                let open = |si: &&SurfaceInteraction| !cache.serves(si.p, toward(si));
                let computed: Vec<(CacheRecord, RenderStats)> = batch
                    .par_iter()
                    .filter(open)
                    .map(|si| self.record(cx, si))
                    .collect();
                for (record, work) in computed {
                    *stats += work;
                    // One added before it in this batch may serve here already.
                    if !cache.serves(record.p, record.n) {
                        cache.insert(record);
                    }
                }
            }
            stride /= 2;
        }
        self.cache = Some(Arc::new(cache));
        Ok(())
    }

    /// Points seen by the pixels of a grid that is not part of the grid before.
    fn points(&self, cx: &Pass<'_>, stride: u32) -> Vec<SurfaceInteraction> {
        let size = cx.camera.size();
        let grid = |n: u32| (0..n).step_by(stride as usize);
        let mut points = Vec::new();
        for (y, x) in grid(size.y).flat_map(|y| grid(size.x).map(move |x| (y, x))) {
            let coarser = 2 * stride;
            let seen = stride < COARSEST && x % coarser == 0 && y % coarser == 0;
            if !seen {
                let pixel = u64::from(y) * u64::from(size.x) + u64::from(x);
                let item = (pixel, 0);
                let sampler = IndependentSampler::new(cx.seed, Stream::Preparation, item);
                let film = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                let ray = cx.camera.generate_ray(film, Vec2::splat(0.5));
                diffuse_points(cx, ray, sampler, &mut points);
            }
        }
        points
    }

    /// What is gathered at a point by a white surface.
    fn record(&self, cx: &Pass<'_>, si: &SurfaceInteraction) -> (CacheRecord, RenderStats) {
        let mut white = Bsdf::new(si);
        white.push(Rgb::WHITE, Lobe::Lambert);
        let (mut scratch, mut stats) = (self.scratch(), RenderStats::default());
        let mut inverse = InverseDistances::default();
        // Numbers by the place, so that a record is the same whichever pixel asks for it.
        let bits = si.p.to_array().map(|x| u64::from(x.to_bits()));
        let item = (bits[0] << 32 | bits[1], bits[2]);
        let numbers = IndependentSampler::new(cx.seed, Stream::Gather, item);
        let all = u32::MAX;
        self.gather(
            cx,
            si,
            &white,
            all,
            numbers,
            &mut scratch,
            &mut stats,
            &mut inverse,
        );
        let rays = self.settings.as_ref().map_or(1, |s| s.gather_rays);
        let record = CacheRecord {
            p: si.p,
            n: toward(si),
            // Infinite where nothing is around: the cache clamps it.
            radius: rays as f32 / inverse.0,
            values: scratch.sums,
        };
        (record, stats)
    }
}

/// The Lambertian surfaces on a walk through mirrors and glass.
fn diffuse_points(
    cx: &Pass<'_>,
    mut ray: Ray,
    mut sampler: IndependentSampler,
    points: &mut Vec<SurfaceInteraction>,
) {
    let mut walk = Walk::new();
    while walk.depth <= MAX_MIRRORS {
        let first = VERTEX_DIMENSIONS * walk.depth;
        let Some(si) = cx
            .scene
            .intersect(&ray, || opacity_number(&mut sampler, first))
        else {
            return;
        };
        let bsdf = cx.scene.bsdf(&si);
        if bsdf.has(Event::Diffuse) && lambertian(&bsdf).is_some() {
            points.push(si);
        }
        sampler.seek(first);
        let (u, u_event) = (sampler.next_2d(), sampler.next_1d());
        let sample = bsdf.sample(si.wo, u_event, u, Transport::Radiance);
        let Some(sample) = sample.filter(|s| s.event != Event::Diffuse) else {
            return;
        };
        walk.depth += 1;
        ray = si.spawn_ray(sample.wi);
    }
}
