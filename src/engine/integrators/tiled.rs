//! The tile loop of all integrators that trace camera rays.

use glam::{UVec2, Vec2};
use rayon::prelude::*;

use super::{Cancelled, Integrator, Params, Pass, RenderStats};
use crate::engine::film::pass_buffer::PassTile;
use crate::engine::film::{Film, PassBuffer, SampleRadiance};
use crate::engine::geometry::Ray;
use crate::engine::integrators::replay::{RadianceSink, Recording, ReplayError, SampleId, Step};
use crate::engine::sampling::{IndependentSampler, Sampler, SobolSampler, Stream};

/// First dimension that belongs to the first vertex: two for the film, two for the lens.
pub const CAMERA_DIMENSIONS: u32 = 4;

/// An estimator of the radiance along a camera ray.
pub trait RayIntegrator: Send + Sync {
    /// Adds the radiance that arrives along `ray`. The sampler stands at [`CAMERA_DIMENSIONS`].
    fn radiance<S: Sampler>(
        &self,
        cx: &Pass<'_>,
        ray: Ray,
        sampler: &mut S,
        out: &mut impl RadianceSink,
        stats: &mut RenderStats,
    );
}

/// Where the random numbers come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SamplerKind {
    /// Independent numbers.
    Independent,
    /// Owen-scrambled Sobol points.
    Sobol,
}

impl SamplerKind {
    /// What the parameter `sampler` says.
    pub fn of(params: &Params) -> Self {
        match params.choice("sampler") {
            "independent" => Self::Independent,
            _ => Self::Sobol,
        }
    }
}

/// A [`RayIntegrator`] run over all pixels.
pub struct Tiled<T> {
    estimator: T,
    sampler: SamplerKind,
    buffer: Option<PassBuffer>,
}

impl<T: RayIntegrator> Tiled<T> {
    /// Runs `estimator` with numbers of that kind.
    pub fn new(estimator: T, sampler: SamplerKind) -> Self {
        Self {
            estimator,
            sampler,
            buffer: None,
        }
    }

    /// The estimator.
    pub fn estimator(&self) -> &T {
        &self.estimator
    }

    /// The estimator, to be changed between passes.
    pub fn estimator_mut(&mut self) -> &mut T {
        &mut self.estimator
    }

    /// Memory of the pass under way.
    pub fn buffer_bytes(&self) -> usize {
        self.buffer.as_ref().map_or(0, PassBuffer::bytes)
    }

    /// Takes the sample of one pixel in one pass.
    pub fn sample(
        &self,
        cx: &Pass<'_>,
        pixel: UVec2,
        out: &mut impl RadianceSink,
        stats: &mut RenderStats,
    ) {
        // Even and odd passes are two scrambles, so that their difference measures the error.
        let width = u64::from(cx.camera.size().x);
        let item = (u64::from(pixel.y) * width + u64::from(pixel.x)) * 2 + cx.index % 2;
        let index = (item, cx.index / 2);
        match self.sampler {
            SamplerKind::Independent => {
                let sampler = IndependentSampler::new(cx.seed, Stream::Camera, index);
                self.sample_with(cx, pixel, sampler, out, stats);
            }
            SamplerKind::Sobol => {
                let sampler = SobolSampler::new(cx.seed, Stream::Camera, index);
                self.sample_with(cx, pixel, sampler, out, stats);
            }
        }
    }

    #[inline]
    fn sample_with<S: Sampler>(
        &self,
        cx: &Pass<'_>,
        pixel: UVec2,
        mut sampler: S,
        out: &mut impl RadianceSink,
        stats: &mut RenderStats,
    ) {
        let film = pixel.as_vec2() + sampler.next_2d();
        let lens = if cx.plan.lens {
            sampler.next_2d()
        } else {
            Vec2::ZERO
        };
        sampler.seek(CAMERA_DIMENSIONS);
        let ray = cx.camera.generate_ray(film, lens);
        let (p, d) = (ray.o, ray.d);
        out.note(|| Step::Lens { p, d, film });
        stats.samples += 1;
        self.estimator.radiance(cx, ray, &mut sampler, out, stats);
    }

    fn render_tile(&self, cx: &Pass<'_>, index: usize, tile: &mut PassTile) -> RenderStats {
        let mut stats = RenderStats::default();
        let planned = cx.plan.planned;
        let mut out = SampleRadiance::new(&cx.plan.classes, planned);
        tile.begin();
        let tiles = crate::engine::film::tiles::Tiles::new(cx.camera.size());
        for (place, pixel) in tiles.pixels(index) {
            out.clear();
            let before = stats.errors();
            self.sample(cx, pixel, &mut out, &mut stats);
            stats.faults.look_at(out.whole());
            tile.put(place, planned, &out);
            let pass = cx.index;
            stats.keep_if_bad(&before, || SampleId::Camera { pixel, pass });
        }
        stats
    }
}

impl<T: RayIntegrator> Integrator for Tiled<T> {
    fn render_pass(&mut self, cx: &Pass<'_>, film: &mut Film) -> Result<RenderStats, Cancelled> {
        let (size, planned) = (film.size(), cx.plan.planned);
        let mut buffer = match self.buffer.take() {
            Some(buffer) => buffer.refit(size, planned),
            None => PassBuffer::new(size, planned),
        };
        let tiles = buffer.tiles_mut().par_iter_mut().enumerate();
        let stats: Result<Vec<RenderStats>, Cancelled> = tiles
            .map(|(i, tile)| cx.cancel.check().map(|()| self.render_tile(cx, i, tile)))
            .collect();
        if stats.is_ok() {
            film.commit(&buffer);
        }
        self.buffer = Some(buffer);
        // Summed in the order of the tiles: the first bad sample is the same for any thread count.
        Ok(stats?
            .into_iter()
            .fold(RenderStats::default(), |mut sum, s| {
                sum += s;
                sum
            }))
    }

    fn replay(
        &mut self,
        cx: &Pass<'_>,
        sample: &SampleId,
        to: &mut Recording,
    ) -> Result<(), ReplayError> {
        let SampleId::Camera { pixel, .. } = *sample else {
            let right = "its samples are those of the stream camera";
            return Err(ReplayError::other_stream(sample, right));
        };
        self.sample(cx, pixel, to, &mut RenderStats::default());
        Ok(())
    }

    fn memory_bytes(&self) -> usize {
        self.buffer_bytes()
    }
}
