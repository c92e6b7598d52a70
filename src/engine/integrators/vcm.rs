//! Vertex connection and merging (Georgiev, Křivánek, Davidovič and Slusallek 2012; Hachisuka,
//! Pantaleoni and Jensen 2012): bidirectional path tracing to which photon mapping is one more
//! family of strategies, weighed against the others.
//!
//! Each pass stores the diffuse vertices of light paths, then connects and merges. Merging is
//! biased by its radius, which shrinks from pass to pass so that bias and noise both vanish (Knaus
//! and Zwicker 2011, *Progressive Photon Mapping: A Probabilistic Approach*). Memory is that of the
//! light paths of one pass, of which there are at most `MAX_PATHS`.

use std::sync::OnceLock;

use rayon::prelude::*;

use super::bdpt::Bdpt;
use super::bidirectional::{LightStart, PhotonGrid, PhotonList, Subpath, Walker};
use super::tiled::SamplerKind;
use super::{
    Cancelled, Entry, Fact, Integrator, Missing, ParamKind, ParamSpec, Params, Pass, Recording,
    RenderStats, ReplayError, SampleId,
};
use crate::engine::film::Film;
use crate::engine::plan::{LayerSettings, RenderPlan};
use crate::engine::sampling::{IndependentSampler, SobolSampler, Stream};
use crate::engine::scene::features::SceneFeatures;

/// Registry entry.
pub const ENTRY: Entry = Entry {
    id: "vcm",
    label: "Vertex connection and merging",
    summary: "Bidirectional path tracing and photon mapping in one: the most robust here, for \
              caustics seen in mirrors and through water too. Biased by a radius that shrinks.",
    params: PARAMS,
    missing,
    media: true,
    build,
};

const PARAMS: &[ParamSpec] = &[
    RADIUS_PARAM,
    ALPHA_PARAM,
    PHOTONS_PARAM,
    ParamSpec {
        name: "heuristic",
        kind: ParamKind::Choice(&["balance", "power"]),
        default: "balance",
        unit: "",
        matters: |_| true,
        doc: "How strategies share a path: in proportion to their densities, or to the squares.",
    },
    ParamSpec {
        name: "strategies",
        kind: ParamKind::Strategies,
        default: "all",
        unit: "",
        matters: |_| true,
        doc: "Which strategies of connection (s, t) are on, s vertices sampled from the light and \
              t from the lens: all, all-0,2-*,1 (all but these), or 1,2+0,2 (these alone).",
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

/// Radius of merging in the first pass.
pub(super) const RADIUS_PARAM: ParamSpec = ParamSpec {
    name: "radius",
    kind: ParamKind::Number(0.000_001, 1.0),
    default: "0.005",
    unit: "of the scene's radius",
    matters: |_| true,
    doc: "Radius of merging in the first pass.",
};

/// How fast it shrinks.
pub(super) const ALPHA_PARAM: ParamSpec = ParamSpec {
    name: "alpha",
    kind: ParamKind::Number(0.01, 1.0),
    default: "0.75",
    unit: "",
    matters: |_| true,
    doc: "How slowly the radius shrinks: after n passes its square is n^(alpha-1) of the first.",
};

/// How many photons a pass merges with.
const PHOTONS_PARAM: ParamSpec = photons_param("0.75");

/// The same for any algorithm, but for the default.
pub(super) const fn photons_param(default: &'static str) -> ParamSpec {
    ParamSpec {
        name: "photons",
        kind: ParamKind::Number(0.001, 64.0),
        default,
        unit: "a pixel",
        matters: |_| true,
        doc: "Photons that a pass stores, about, for every pixel: by as many light paths as that \
              takes, but at most 4 a pixel and 262144 in all. Fewer are quicker where other \
              strategies find the light.",
    }
}

/// Most light paths that one pass stores.
pub(super) const MAX_PATHS: u64 = 1 << 18;
/// Light paths that tell how many a number of photons takes.
const PILOT: u64 = 1024;
/// Most light paths a pixel, where few of them leave a photon.
const MOST_A_PIXEL: f64 = 4.0;
/// Light paths of one chunk of work.
const CHUNK: u64 = 1024;

fn build(params: &Params) -> Box<dyn Integrator> {
    Box::new(Vcm {
        bdpt: Bdpt::new(params),
        photons: PhotonSource::new(params),
    })
}

fn missing(features: &SceneFeatures, _params: &Params) -> Option<Missing> {
    (features.zero_size_lights && features.specular).then(|| Missing {
        words: "LS+((G|V)S+)*E".into(),
        why: "light of a point, spot or directional source that meets mirror or glass before and \
              after every glossy surface, and no diffuse one, can be neither connected nor merged"
            .into(),
    })
}

/// Where the photons of each pass come from.
pub(super) struct PhotonSource {
    radius: f64,
    alpha: f64,
    /// Photons a pixel.
    photons: f64,
    /// Photons that a light path leaves, about.
    yield_of_a_path: OnceLock<f64>,
    roulette: usize,
    sampler: SamplerKind,
}

impl PhotonSource {
    pub(super) fn new(params: &Params) -> Self {
        Self {
            radius: params.number("radius"),
            alpha: params.number("alpha"),
            photons: params.number("photons"),
            yield_of_a_path: OnceLock::new(),
            roulette: usize::try_from(params.integer("roulette")).unwrap_or(usize::MAX),
            sampler: SamplerKind::of(params),
        }
    }

    /// Radius of merging in pass `index`: its square shrinks by (i + α) / (i + 1) in pass i (Knaus
    /// and Zwicker 2011, equation 15), of which n^(α−1) is the asymptote.
    fn radius(&self, cx: &Pass<'_>) -> f32 {
        let (_, scene) = cx.scene.geometry.bounding_sphere();
        let shrink = ((cx.index + 1) as f64).powf(0.5 * (self.alpha - 1.0));
        (self.radius * f64::from(scene) * shrink) as f32
    }

    /// Light paths of a pass: as many as leave `photons` for every pixel, within [`MAX_PATHS`] and
    /// [`MOST_A_PIXEL`].
    fn paths(&self, cx: &Pass<'_>) -> Result<u64, Cancelled> {
        let each = match self.yield_of_a_path.get() {
            Some(each) => *each,
            None => {
                let each = self.pilot(cx)?;
                *self.yield_of_a_path.get_or_init(|| each)
            }
        };
        let pixels = cx.camera.size().as_dvec2().element_product();
        let most = (pixels * MOST_A_PIXEL) as u64;
        Ok(((pixels * self.photons / each) as u64).clamp(1, most.clamp(1, MAX_PATHS)))
    }

    /// Photons that a light path leaves, by some paths of unlimited depth and any class: it depends
    /// on the scene and on roulette alone, so that any pass of any job finds the same. 1 where none
    /// is left: no number of paths helps.
    fn pilot(&self, cx: &Pass<'_>) -> Result<f64, Cancelled> {
        let Ok(plan) = RenderPlan::new(cx.scene, false, &LayerSettings::default()) else {
            return Ok(1.0);
        };
        let cx = Pass {
            plan: &plan,
            seed: 0,
            ..*cx
        };
        let stored = (0..PILOT).into_par_iter().map(|i| {
            cx.cancel.check()?;
            let (mut list, mut path) = (PhotonList::default(), Subpath::default());
            let mut sampler = SobolSampler::new(cx.seed, Stream::Preparation, (0, i));
            let mut stats = RenderStats::default();
            let walker = self.walker(&cx);
            if let Some(start) = walker.from_light(&mut sampler, &mut path, &mut stats) {
                list.store(&path, &start);
            }
            Ok(list.len() as u64)
        });
        let stored: u64 = stored.sum::<Result<u64, Cancelled>>()?;
        Ok(match stored {
            0 => 1.0,
            _ => stored as f64 / PILOT as f64,
        })
    }

    /// Traces the light paths of a pass.
    pub(super) fn trace(&self, cx: &Pass<'_>) -> Result<(PhotonGrid, RenderStats), Cancelled> {
        let paths = self.paths(cx)?;
        let chunks = (0..paths.div_ceil(CHUNK)).into_par_iter();
        let done: Result<Vec<_>, Cancelled> = chunks
            .map(|c| {
                cx.cancel.check()?;
                Ok(self.trace_chunk(cx, paths, c * CHUNK..paths.min((c + 1) * CHUNK)))
            })
            .collect();
        // In the order of the chunks: the same for any number of threads.
        let (lists, counts): (Vec<_>, Vec<_>) = done?.into_iter().unzip();
        let mut stats = RenderStats::default();
        counts.into_iter().for_each(|c| stats += c);
        let radius = self.radius(cx).max(f32::MIN_POSITIVE);
        Ok((PhotonGrid::new(&lists, radius, paths), stats))
    }

    /// Follows a light path of a pass again; None if `sample` is none.
    pub(super) fn replay(
        &self,
        cx: &Pass<'_>,
        sample: &SampleId,
        to: &mut Recording,
    ) -> Option<Result<(), ReplayError>> {
        let SampleId::MergedPath { path: number, .. } = *sample else {
            return None;
        };
        let paths = match self.paths(cx) {
            Ok(paths) => paths,
            Err(cancelled) => return Some(Err(cancelled.into())),
        };
        if number >= paths {
            let last = paths - 1;
            let why = format!("a pass of this size has the light paths 0 to {last}");
            return Some(Err(ReplayError::Cannot(why)));
        }
        let (mut path, mut stats) = (Subpath::default(), RenderStats::default());
        let start = self.trace_path(cx, paths, number, &mut path, &mut stats);
        if let Some(start) = &start {
            to.start(start);
            to.subpath(&path);
        }
        Some(Ok(()))
    }

    fn walker<'a>(&self, cx: &'a Pass<'a>) -> Walker<'a> {
        Walker {
            cx,
            roulette: self.roulette,
        }
    }

    /// Light path `number` of a pass.
    fn trace_path(
        &self,
        cx: &Pass<'_>,
        per_pass: u64,
        number: u64,
        path: &mut Subpath,
        stats: &mut RenderStats,
    ) -> Option<LightStart> {
        let walker = self.walker(cx);
        // Even and odd passes are two scrambles, so that their difference measures the error.
        let index = (cx.index % 2, cx.index / 2 * per_pass + number);
        match self.sampler {
            SamplerKind::Independent => {
                let mut sampler = IndependentSampler::new(cx.seed, Stream::Photon, index);
                walker.from_light(&mut sampler, path, stats)
            }
            SamplerKind::Sobol => {
                let mut sampler = SobolSampler::new(cx.seed, Stream::Photon, index);
                walker.from_light(&mut sampler, path, stats)
            }
        }
    }

    fn trace_chunk(
        &self,
        cx: &Pass<'_>,
        per_pass: u64,
        paths: std::ops::Range<u64>,
    ) -> (PhotonList, RenderStats) {
        let mut stats = RenderStats::default();
        let (mut list, mut path) = (PhotonList::default(), Subpath::default());
        for i in paths {
            let before = stats.errors();
            let start = self.trace_path(cx, per_pass, i, &mut path, &mut stats);
            let pass = cx.index;
            stats.keep_if_bad(&before, || SampleId::MergedPath { path: i, pass });
            if let Some(start) = start {
                list.store(&path, &start);
            }
        }
        (list, stats)
    }
}

struct Vcm {
    bdpt: Bdpt,
    photons: PhotonSource,
}

impl Integrator for Vcm {
    fn render_pass(&mut self, cx: &Pass<'_>, film: &mut Film) -> Result<RenderStats, Cancelled> {
        let (grid, mut stats) = self.photons.trace(cx)?;
        self.bdpt.merge_with(grid);
        stats += self.bdpt.render_pass(cx, film)?;
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
        self.bdpt.merge_with(grid);
        self.bdpt.replay(cx, sample, to)
    }

    fn memory_bytes(&self) -> usize {
        self.bdpt.memory_bytes() + self.bdpt.photons().map_or(0, PhotonGrid::bytes)
    }

    fn facts(&self) -> Vec<Fact> {
        self.bdpt
            .photons()
            .map(PhotonGrid::fact)
            .into_iter()
            .collect()
    }
}
