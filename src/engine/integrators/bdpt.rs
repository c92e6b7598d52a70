//! Bidirectional path tracing (Lafortune and Willems 1993; Veach and Guibas 1994; Veach 1997,
//! chapter 10).
//!
//! Each sample of a pixel is a walk from the lens and a walk from a light. Every vertex of the one
//! is connected to every vertex of the other; the strategies that could have found the same path
//! share it by multiple importance sampling. It fails where all connections do: paths S+ … S+
//! between a light of zero size and the lens, and puddles of light seen in mirrors only by chance.

use glam::{UVec2, Vec2};
use rayon::prelude::*;

use super::bidirectional::{
    Bidirectional, Heuristic, PhotonGrid, Sink, Strategies, Technique, Workspace, lost_words,
};
use super::tiled::SamplerKind;
use super::{
    Cancelled, Entry, Integrator, Missing, ParamKind, ParamSpec, Params, Pass, Recording,
    RenderStats, ReplayError, SampleId,
};
use crate::engine::film::pass_buffer::PassTile;
use crate::engine::film::{Film, PassBuffer, SampleRadiance, SplatBuffer, SplatList};
use crate::engine::geometry::Ray;
use crate::engine::math::Rgb;
use crate::engine::path::ClassId;
use crate::engine::sampling::{IndependentSampler, Sampler, Shift, SobolSampler, Stream, morton};
use crate::engine::scene::features::SceneFeatures;

/// Registry entry.
pub const ENTRY: Entry = Entry {
    id: "bdpt",
    label: "Bidirectional path tracing",
    summary: "Unbiased; the choice for light that comes around corners, from hidden or enclosed \
              lamps, and for caustics. Slower than path tracing in open, softly lit scenes.",
    params: PARAMS,
    missing,
    media: true,
    build,
};

const PARAMS: &[ParamSpec] = &[
    ParamSpec {
        name: "strategies",
        kind: ParamKind::Strategies,
        default: "all",
        unit: "",
        matters: |_| true,
        doc: "Which strategies (s, t) are on, s vertices sampled from the light and t from the \
              lens: all, all-0,2-*,1 (all but these), or 1,2+0,2 (these alone).",
    },
    ParamSpec {
        name: "picture",
        kind: ParamKind::Strategies,
        default: "all",
        unit: "",
        matters: |_| true,
        doc: "Which strategies (s, t) the picture shows; the others keep their share of each path. \
              1,2 shows what the weights leave of that strategy; with strategies=1,2 it stands \
              alone and unweighted.",
    },
    ParamSpec {
        name: "heuristic",
        kind: ParamKind::Choice(&["balance", "power"]),
        default: "balance",
        unit: "",
        matters: |_| true,
        doc: "How strategies share a path: in proportion to their densities, or to the squares.",
    },
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

/// Tiles of one chunk of work.
const CHUNK: usize = 16;
/// Chunks whose splats are held at the same time.
const ROUND: usize = 128;
/// Side of the squares of pixels whose light walks are spread evenly together: as many pixels as a
/// net has points.
const NET_SIDE: u32 = 256;

fn build(params: &Params) -> Box<dyn Integrator> {
    Box::new(Bdpt::new(params))
}

/// Words that no strategy finds that is on.
fn missing(features: &SceneFeatures, params: &Params) -> Option<Missing> {
    let strategies = params.strategies("strategies");
    if strategies.are_all_on() {
        return unconnectable(features);
    }
    lost_words(&strategies, features).map(|words| Missing {
        words: words.into(),
        why: "the strategies that could find such light are switched off, and those that are on \
              cannot join these paths (longer ones with the same mirrors are lost alike)"
            .into(),
    })
}

/// Words that no strategy can find: between S+ and S+ no two vertices can be connected.
pub(super) fn unconnectable(features: &SceneFeatures) -> Option<Missing> {
    (features.zero_size_lights && features.specular).then_some(Missing {
        words: "LS+((D|G|V)S+)*E".into(),
        why: "light of a point, spot or directional source that meets mirror or glass before and \
              after every diffuse or glossy surface passes no two neighbouring surfaces that a \
              connection can join"
            .into(),
    })
}

/// The estimator that `params` ask for.
fn estimator(params: &Params) -> Bidirectional {
    let heuristic = match params.choice("heuristic") {
        "power" => Heuristic::Power,
        _ => Heuristic::Balance,
    };
    let strategies = params.strategies("strategies").with(heuristic);
    let roulette = usize::try_from(params.integer("roulette")).unwrap_or(usize::MAX);
    Bidirectional::with(strategies, roulette)
}

/// The integrator.
pub(super) struct Bdpt {
    estimator: Bidirectional,
    /// Strategies whose light is shown.
    picture: Strategies,
    sampler: SamplerKind,
    /// Photons to merge with.
    grid: Option<PhotonGrid>,
    samples: Option<PassBuffer>,
    splats: Option<SplatBuffer>,
}

/// Lets the strategies through that the picture shows.
struct Shown<'a, K> {
    picture: &'a Strategies,
    to: &'a mut K,
}

impl<K: Sink> Sink for Shown<'_, K> {
    #[inline]
    fn begin(&mut self, film: Vec2, ray: &Ray) {
        self.to.begin(film, ray);
    }

    #[inline]
    fn add(&mut self, of: Technique, class: ClassId, value: Rgb, weight: f32) {
        if self.picture.is_on(of.s, of.t) {
            self.to.add(of, class, value, weight);
        }
    }

    #[inline]
    fn splat(&mut self, film: Vec2, of: Technique, class: ClassId, value: Rgb, weight: f32) {
        if weight != 0.0 && self.picture.is_on(of.s, of.t) {
            self.to.splat(film, of, class, value, weight);
        }
    }
}

/// Weighs and stores.
struct Weighted<'a, 'b> {
    out: &'a mut SampleRadiance<'b>,
    splats: &'a mut SplatList,
}

impl Sink for Weighted<'_, '_> {
    #[inline]
    fn add(&mut self, _: Technique, class: ClassId, value: Rgb, weight: f32) {
        self.out.add(class, value * weight);
    }

    #[inline]
    fn splat(&mut self, film: Vec2, _: Technique, class: ClassId, value: Rgb, weight: f32) {
        self.splats.add(film, class, value * weight);
    }
}

impl Bdpt {
    pub(super) fn new(params: &Params) -> Self {
        Self {
            estimator: estimator(params),
            picture: params.strategies("picture"),
            sampler: SamplerKind::of(params),
            grid: None,
            samples: None,
            splats: None,
        }
    }

    /// Merges with the photons of `grid` from now on.
    pub(super) fn merge_with(&mut self, grid: PhotonGrid) {
        self.estimator.strategies.merging = grid.merging();
        self.grid = Some(grid);
    }

    /// The photons it merges with.
    pub(super) fn photons(&self) -> Option<&PhotonGrid> {
        self.grid.as_ref()
    }

    /// What moves the points of this pass's light walks.
    pub(super) fn light_shift(cx: &Pass<'_>) -> Shift {
        Shift::new(cx.seed, Stream::Light, (cx.index % 2, cx.index / 2))
    }

    /// Takes the sample of `pixel` in the pass `cx`, whose [`Self::light_shift`] is `shift`.
    pub(super) fn sample_pixel(
        &self,
        cx: &Pass<'_>,
        (pixel, shift): (UVec2, &Shift),
        work: &mut Workspace,
        sink: &mut impl Sink,
        stats: &mut RenderStats,
    ) {
        // Even and odd passes are two scrambles, so that their difference measures the error.
        let width = u64::from(cx.camera.size().x);
        let item = (u64::from(pixel.y) * width + u64::from(pixel.x)) * 2 + cx.index % 2;
        let index = (item, cx.index / 2);
        match self.sampler {
            SamplerKind::Independent => {
                let new = |stream| IndependentSampler::new(cx.seed, stream, index);
                let samplers = (new(Stream::Camera), new(Stream::Light));
                self.sample_with(cx, pixel, samplers, work, sink, stats);
            }
            SamplerKind::Sobol => {
                let eye = SobolSampler::new(cx.seed, Stream::Camera, index);
                // The light walks of a square of pixels are a net, so that they spread evenly.
                let square = pixel / NET_SIDE;
                let net = (u64::from(square.y) << 32 | u64::from(square.x)) + 1;
                let index = (net * 2 + cx.index % 2, morton(pixel % NET_SIDE));
                let light = SobolSampler::shifted(cx.seed, Stream::Light, index, shift);
                self.sample_with(cx, pixel, (eye, light), work, sink, stats);
            }
        }
    }

    fn sample_with(
        &self,
        cx: &Pass<'_>,
        pixel: UVec2,
        (mut eye, mut light): (impl Sampler, impl Sampler),
        work: &mut Workspace,
        sink: &mut impl Sink,
        stats: &mut RenderStats,
    ) {
        let film = pixel.as_vec2() + eye.next_2d();
        let lens = if cx.plan.lens {
            eye.next_2d()
        } else {
            Vec2::ZERO
        };
        stats.samples += 1;
        let samplers = (&mut eye, &mut light);
        let mut shown = Shown {
            picture: &self.picture,
            to: sink,
        };
        self.estimator.sample(
            cx,
            (film, lens),
            samplers,
            self.grid.as_ref(),
            work,
            &mut shown,
            stats,
        );
    }

    fn render_chunk(
        &self,
        cx: &Pass<'_>,
        first: usize,
        tiles: &mut [PassTile],
    ) -> Result<(SplatList, RenderStats), Cancelled> {
        let mut stats = RenderStats::default();
        let mut splats = SplatList::new(cx.camera.size());
        let mut out = SampleRadiance::new(&cx.plan.classes, cx.plan.planned);
        let mut work = Workspace::default();
        let layout = crate::engine::film::tiles::Tiles::new(cx.camera.size());
        let shift = Self::light_shift(cx);
        for (i, tile) in tiles.iter_mut().enumerate() {
            cx.cancel.check()?;
            tile.begin();
            for (place, pixel) in layout.pixels(first + i) {
                out.clear();
                let mut sink = Weighted {
                    out: &mut out,
                    splats: &mut splats,
                };
                let before = stats.errors();
                let sample = (pixel, &shift);
                self.sample_pixel(cx, sample, &mut work, &mut sink, &mut stats);
                stats.faults.look_at(out.whole());
                stats.faults += splats.take_faults();
                tile.put(place, cx.plan.planned, &out);
                let pass = cx.index;
                stats.keep_if_bad(&before, || SampleId::Camera { pixel, pass });
            }
        }
        Ok((splats, stats))
    }
}

impl Integrator for Bdpt {
    fn render_pass(&mut self, cx: &Pass<'_>, film: &mut Film) -> Result<RenderStats, Cancelled> {
        let (size, planned) = (film.size(), cx.plan.planned);
        let mut samples = match self.samples.take() {
            Some(buffer) => buffer.refit(size, planned),
            None => PassBuffer::new(size, planned),
        };
        let mut splats = match self.splats.take() {
            Some(b) if b.fits(size, planned) => b,
            _ => SplatBuffer::new(size, planned),
        };
        splats.clear();
        let mut stats = RenderStats::default();
        for (round, tiles) in samples.tiles_mut().chunks_mut(CHUNK * ROUND).enumerate() {
            let chunks = tiles.par_chunks_mut(CHUNK).enumerate();
            let done: Result<Vec<_>, Cancelled> = chunks
                .map(|(i, tiles)| self.render_chunk(cx, (round * ROUND + i) * CHUNK, tiles))
                .collect();
            // In the order of the chunks: the same for any number of threads.
            let (lists, counts): (Vec<_>, Vec<_>) = done?.into_iter().unzip();
            splats.merge(&lists, &cx.plan.classes, 1.0);
            counts.into_iter().for_each(|c| stats += c);
        }
        film.commit_splats(Some(&samples), &splats);
        self.samples = Some(samples);
        self.splats = Some(splats);
        Ok(stats)
    }

    fn replay(
        &mut self,
        cx: &Pass<'_>,
        sample: &SampleId,
        to: &mut Recording,
    ) -> Result<(), ReplayError> {
        let SampleId::Camera { pixel, .. } = *sample else {
            let right = "the light path that a pixel's sample is connected to belongs to its index \
                         in the stream camera";
            return Err(ReplayError::other_stream(sample, right));
        };
        let (mut work, mut found) = (Workspace::default(), Recording::default());
        let mut stats = RenderStats::default();
        let sample = (pixel, &Self::light_shift(cx));
        self.sample_pixel(cx, sample, &mut work, &mut found, &mut stats);
        // First the walks, then what their strategies found.
        to.steps.push(found.steps.remove(0));
        to.subpath(&work.eye);
        if let Some(start) = &work.start {
            to.start(start);
            to.subpath(&work.light);
        }
        to.steps.append(&mut found.steps);
        Ok(())
    }

    fn memory_bytes(&self) -> usize {
        self.samples.as_ref().map_or(0, PassBuffer::bytes)
            + self.splats.as_ref().map_or(0, SplatBuffer::bytes)
    }
}
