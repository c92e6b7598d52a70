//! Particle tracing to the lens (Arvo 1986, *Backward Ray Tracing*; Dutré and Willems 1994): light
//! paths, each vertex of which is joined to the lens.
//!
//! It is bidirectional path tracing with the strategies t = 1 alone, so that no weight is needed.
//! It finds caustics well. What is seen in a mirror or through glass it cannot find: no vertex next
//! to the lens would be connectible. Directly seen light is noisy, and sky is not found.

use glam::Vec2;
use rayon::prelude::*;

use super::bidirectional::{
    Connector, Density, LightStart, Sink, Strategies, Subpath, Technique, Walker, lens_dimension,
};
use super::tiled::SamplerKind;
use super::{
    Cancelled, Entry, Integrator, Missing, ParamKind, ParamSpec, Params, Pass, Recording,
    RenderStats, ReplayError, SampleId,
};
use crate::engine::film::{Film, SplatBuffer, SplatList};
use crate::engine::math::Rgb;
use crate::engine::path::ClassId;
use crate::engine::sampling::{IndependentSampler, Sampler, SobolSampler, Stream};
use crate::engine::scene::features::SceneFeatures;

/// Registry entry.
pub const ENTRY: Entry = Entry {
    id: "light",
    label: "Light tracing",
    summary: "Unbiased; the choice for caustics on diffuse surfaces. Blind to all that is seen in \
              a mirror or through glass.",
    params: PARAMS,
    missing,
    media: true,
    build,
};

const PARAMS: &[ParamSpec] = &[
    super::SAMPLER_PARAM,
    ParamSpec {
        name: "roulette",
        kind: ParamKind::Integer(0, 10_000_000),
        default: "2",
        unit: "events",
        matters: |_| true,
        doc: "Number of events after which Russian roulette may end a light path.",
    },
];

/// Light paths of one chunk of work.
const CHUNK: u64 = 1024;
/// Chunks whose splats are held at the same time.
const ROUND: u64 = 128;

fn build(params: &Params) -> Box<dyn Integrator> {
    Box::new(LightTracer {
        strategies: Strategies::lens_alone(),
        roulette: usize::try_from(params.integer("roulette")).unwrap_or(usize::MAX),
        sampler: SamplerKind::of(params),
        splats: None,
    })
}

fn missing(features: &SceneFeatures, _params: &Params) -> Option<Missing> {
    if features.shining_media {
        return Some(Missing {
            words: "L.*E".into(),
            why: "light that a medium emits is met by walks from the eye alone".into(),
        });
    }
    let mirror = "a light path cannot be joined to the lens at a mirror or at smooth glass";
    let sky = "light from infinity has no point that could be joined to the lens";
    let (words, why) = match (features.specular, features.environment) {
        (true, false) => ("L.*SE", mirror),
        (false, true) => ("LE", sky),
        (true, true) => (
            "LE|L.*SE",
            "a light path cannot be joined to the lens at a mirror, at \
                          smooth glass, or in the sky",
        ),
        (false, false) => return None,
    };
    Some(Missing {
        words: words.into(),
        why: why.into(),
    })
}

struct LightTracer {
    strategies: Strategies,
    roulette: usize,
    sampler: SamplerKind,
    splats: Option<SplatBuffer>,
}

impl Sink for SplatList {
    fn add(&mut self, _: Technique, _: ClassId, _: Rgb, _: f32) {
        debug_assert!(false, "a light path belongs to no pixel's sample");
    }

    #[inline]
    fn splat(&mut self, film: Vec2, _: Technique, class: ClassId, value: Rgb, weight: f32) {
        self.add(film, class, value * weight);
    }
}

impl LightTracer {
    fn render_chunk(
        &self,
        cx: &Pass<'_>,
        paths: std::ops::Range<u64>,
    ) -> Result<(SplatList, RenderStats), Cancelled> {
        cx.cancel.check()?;
        let mut stats = RenderStats::default();
        let mut splats = SplatList::new(cx.camera.size());
        let mut path = Subpath::default();
        for i in paths {
            let before = stats.errors();
            self.trace_path(cx, i, &mut path, &mut splats, &mut stats);
            stats.faults += splats.take_faults();
            let pass = cx.index;
            stats.keep_if_bad(&before, || SampleId::LightPath { path: i, pass });
        }
        Ok((splats, stats))
    }

    /// Light path `number` of a pass.
    fn trace_path(
        &self,
        cx: &Pass<'_>,
        number: u64,
        path: &mut Subpath,
        sink: &mut impl Sink,
        stats: &mut RenderStats,
    ) -> Option<LightStart> {
        // Even and odd passes are two scrambles, so that their difference measures the error.
        let index = (cx.index % 2, cx.index / 2 * paths_per_pass(cx) + number);
        match self.sampler {
            SamplerKind::Independent => {
                let mut sampler = IndependentSampler::new(cx.seed, Stream::Light, index);
                self.trace(cx, &mut sampler, path, sink, stats)
            }
            SamplerKind::Sobol => {
                let mut sampler = SobolSampler::new(cx.seed, Stream::Light, index);
                self.trace(cx, &mut sampler, path, sink, stats)
            }
        }
    }

    /// One light path; where it began, if it did.
    fn trace<S: Sampler>(
        &self,
        cx: &Pass<'_>,
        sampler: &mut S,
        path: &mut Subpath,
        sink: &mut impl Sink,
        stats: &mut RenderStats,
    ) -> Option<LightStart> {
        stats.samples += 1;
        let walker = Walker {
            cx,
            roulette: self.roulette,
        };
        let start = walker.from_light(sampler, path, stats)?;
        let mut connector = Connector {
            cx,
            strategies: &self.strategies,
            sink,
            stats,
        };
        // The only strategy of each path: its density does not matter.
        let lens = Density {
            own: 1.0,
            other: 0.0,
            connectible: true,
            mergeable: false,
        };
        for s in 1..=path.len() {
            sampler.seek(lens_dimension(cx.plan, s));
            let u = sampler.next_2d();
            if s == 1 {
                connector.join_light(path, &start, &lens, u);
            } else {
                connector.join_lens((path, &start), s, &lens, u);
            }
        }
        Some(start)
    }
}

/// A light path for every pixel.
fn paths_per_pass(cx: &Pass<'_>) -> u64 {
    let size = cx.camera.size();
    u64::from(size.x) * u64::from(size.y)
}

impl Integrator for LightTracer {
    fn replay(
        &mut self,
        cx: &Pass<'_>,
        sample: &SampleId,
        to: &mut Recording,
    ) -> Result<(), ReplayError> {
        let SampleId::LightPath { path: number, .. } = *sample else {
            let right = "its samples are those of the stream light, PATH,PASS";
            return Err(ReplayError::other_stream(sample, right));
        };
        let (paths, mut path) = (paths_per_pass(cx), Subpath::default());
        if number >= paths {
            let last = paths - 1;
            let why = format!("a pass of this size has the light paths 0 to {last}");
            return Err(ReplayError::Cannot(why));
        }
        let (mut found, mut stats) = (Recording::default(), RenderStats::default());
        if let Some(start) = self.trace_path(cx, number, &mut path, &mut found, &mut stats) {
            to.start(&start);
            to.subpath(&path);
        }
        to.steps.append(&mut found.steps);
        Ok(())
    }

    fn memory_bytes(&self) -> usize {
        self.splats.as_ref().map_or(0, SplatBuffer::bytes)
    }

    fn render_pass(&mut self, cx: &Pass<'_>, film: &mut Film) -> Result<RenderStats, Cancelled> {
        let (size, planned) = (film.size(), cx.plan.planned);
        let mut splats = match self.splats.take() {
            Some(b) if b.fits(size, planned) => b,
            _ => SplatBuffer::new(size, planned),
        };
        splats.clear();
        let mut stats = RenderStats::default();
        let paths = paths_per_pass(cx);
        let chunks = paths.div_ceil(CHUNK);
        for first in (0..chunks).step_by(ROUND as usize) {
            let round = (first..chunks.min(first + ROUND)).into_par_iter();
            let done: Result<Vec<_>, Cancelled> = round
                .map(|c| self.render_chunk(cx, c * CHUNK..paths.min((c + 1) * CHUNK)))
                .collect();
            // In the order of the chunks: the same for any number of threads.
            let (lists, counts): (Vec<_>, Vec<_>) = done?.into_iter().unzip();
            splats.merge(&lists, &cx.plan.classes, 1.0);
            counts.into_iter().for_each(|c| stats += c);
        }
        film.commit_splats(None, &splats);
        self.splats = Some(splats);
        Ok(stats)
    }
}
