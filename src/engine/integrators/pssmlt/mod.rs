//! Metropolis light transport in primary sample space (Kelemen, Szirmay-Kalos, Antal and Csonka
//! 2002), over path tracing or over bidirectional path tracing.
//!
//! A state is the list of random numbers behind one sample of the estimator. Chains of mutated
//! states visit samples in proportion to what they bring, the mean of their channels; what a state
//! brings is divided by that, and the picture's mean brightness b comes back as a factor. b is
//! estimated by independent samples: those the chains start from, and every large step since.
//!
//! All is lost that the estimator below cannot find. Light that few random numbers lead to is
//! found late, and then explored: single pictures are smooth long before they are right. The
//! mutations of Veach and Guibas (1997), which change paths and not numbers, are left out.

mod chain;

use rayon::prelude::*;

use self::chain::{Chain, Source};
use super::bdpt::unconnectable;
use super::bidirectional::{Bidirectional, Heuristic, Strategies};
use super::path::ENTRY as PATH;
use super::{
    Cancelled, Entry, Fact, Integrator, Missing, ParamKind, ParamSpec, Params, Pass, Recording,
    RenderStats, ReplayError, SampleId,
};
use crate::engine::film::{Film, SplatBuffer, SplatList};
use crate::engine::math::distribution::Discrete;
use crate::engine::sampling::{IndependentSampler, Sampler, StepKey, Stream};
use crate::engine::scene::features::SceneFeatures;

/// Registry entry.
pub const ENTRY: Entry = Entry {
    id: "pssmlt",
    label: "Metropolis light transport",
    summary: "For light that few paths find, such as lamps behind doors or caustics of caustics; \
              elsewhere slower than what it runs over, and its noise comes in patches.",
    params: PARAMS,
    missing,
    media: true,
    build,
};

const PARAMS: &[ParamSpec] = &[
    ParamSpec {
        name: "over",
        kind: ParamKind::Choice(&["bdpt", "path"]),
        default: "bdpt",
        unit: "",
        matters: |_| true,
        doc: "What turns random numbers into paths: bidirectional path tracing or path tracing.",
    },
    ParamSpec {
        name: "large-step",
        kind: ParamKind::Number(0.01, 1.0),
        default: "0.3",
        unit: "",
        matters: |_| true,
        doc: "Probability of a large step, an independent sample that may lead anywhere.",
    },
    ParamSpec {
        name: "mutation-size",
        kind: ParamKind::Number(0.0001, 0.5),
        default: "0.01",
        unit: "",
        matters: |_| true,
        doc: "Standard deviation of a small step in each random number.",
    },
    ParamSpec {
        name: "chains",
        kind: ParamKind::Integer(1, 65_536),
        default: "256",
        unit: "",
        matters: |_| true,
        doc: "Markov chains in each half of the passes.",
    },
    ParamSpec {
        name: "bootstrap",
        kind: ParamKind::Integer(1, 100_000_000),
        default: "32768",
        unit: "samples",
        matters: |_| true,
        doc: "Independent samples among which the chains of each half find their starts.",
    },
    ParamSpec {
        name: "roulette",
        kind: ParamKind::Integer(0, 10_000_000),
        default: "2",
        unit: "events",
        matters: |_| true,
        doc: "Number of events after which Russian roulette may end a walk.",
    },
];

/// Bootstrap samples of one chunk of work.
const BOOTSTRAP_CHUNK: u64 = 256;
/// Chains whose splats are held at the same time.
const ROUND: usize = 64;

fn build(params: &Params) -> Box<dyn Integrator> {
    let strategies = match params.choice("over") {
        // Hits and shadow rays: path tracing.
        "path" => Strategies::eye_alone(Heuristic::Power),
        _ => Strategies::all(Heuristic::Power),
    };
    let roulette = usize::try_from(params.integer("roulette")).unwrap_or(usize::MAX);
    Box::new(Metropolis {
        source: Source {
            estimator: Bidirectional::with(strategies, roulette),
            large_step: params.number("large-step") as f32,
            size: params.number("mutation-size") as f32,
        },
        chains: params.integer("chains").max(1) as u64,
        bootstrap: params.integer("bootstrap").max(1) as u64,
        halves: [const { None }; 2],
        splats: None,
    })
}

fn missing(features: &SceneFeatures, params: &Params) -> Option<Missing> {
    match params.choice("over") {
        "path" => (PATH.missing)(features, &Params::defaults(PATH.params)),
        _ => unconnectable(features),
    }
}

/// Independent samples of the brightness of the picture.
#[derive(Clone, Copy, Debug, Default)]
struct Brightness {
    sum: f64,
    samples: u64,
}

impl Brightness {
    fn add(&mut self, o: Self) {
        self.sum += o.sum;
        self.samples += o.samples;
    }
}

/// The chains of the even or of the odd passes: two independent pictures, whose difference
/// measures the error.
#[derive(Clone)]
struct Half {
    chains: Vec<Chain>,
    brightness: Brightness,
}

struct Metropolis {
    source: Source,
    chains: u64,
    bootstrap: u64,
    halves: [Option<Half>; 2],
    splats: Option<SplatBuffer>,
}

impl Metropolis {
    /// Takes independent samples and starts chains from some of them, chosen in proportion to what
    /// they bring (Veach 1997, section 11.3.1). No chains if none brings light.
    fn start(&self, cx: &Pass<'_>, half: u64) -> Result<(Half, RenderStats), Cancelled> {
        let first = half * self.bootstrap;
        let chunks = (0..self.bootstrap.div_ceil(BOOTSTRAP_CHUNK)).into_par_iter();
        let done: Result<Vec<_>, Cancelled> = chunks
            .map(|c| {
                cx.cancel.check()?;
                let end = self.bootstrap.min((c + 1) * BOOTSTRAP_CHUNK);
                let samples = c * BOOTSTRAP_CHUNK..end;
                Ok(self
                    .source
                    .weigh(cx, first + samples.start..first + samples.end))
            })
            .collect();
        let (weights, counts): (Vec<_>, Vec<_>) = done?.into_iter().unzip();
        let weights: Vec<f64> = weights.into_iter().flatten().collect();
        let mut stats = RenderStats::default();
        counts.into_iter().for_each(|c| stats += c);
        let brightness = Brightness {
            sum: weights.iter().sum(),
            samples: self.bootstrap,
        };
        let mut chains = Vec::new();
        // Without light to start from there are no chains, and the picture stays black.
        stats.dark_starts = u64::from(brightness.sum <= 0.0);
        if let Some(choice) = Discrete::new(&weights) {
            for i in 0..self.chains {
                let id = half * self.chains + i;
                let mut u = IndependentSampler::new(cx.seed, Stream::Bootstrap, (id, u64::MAX));
                let origin = StepKey {
                    stream: Stream::Bootstrap,
                    item: first + choice.sample(u.next_1d()).index as u64,
                    step: 0,
                };
                chains.push(Chain::new(&self.source, cx, id, origin, &mut stats));
            }
        }
        Ok((Half { chains, brightness }, stats))
    }

    /// One mutation for every pixel, shared by the chains.
    fn advance(
        &self,
        cx: &Pass<'_>,
        half: &mut Half,
        splats: &mut SplatBuffer,
    ) -> Result<RenderStats, Cancelled> {
        let mut stats = RenderStats::default();
        let (size, count) = (cx.camera.size(), half.chains.len() as u64);
        let mutations = u64::from(size.x) * u64::from(size.y);
        for (round, chains) in half.chains.chunks_mut(ROUND).enumerate() {
            let done: Result<Vec<_>, Cancelled> = chains
                .par_iter_mut()
                .enumerate()
                .map(|(i, chain)| {
                    cx.cancel.check()?;
                    let i = (round * ROUND + i) as u64;
                    let share = mutations * (i + 1) / count - mutations * i / count;
                    let mut list = SplatList::new(size);
                    let (brightness, stats) = chain.run(&self.source, cx, share, &mut list);
                    Ok((list, brightness, stats))
                })
                .collect();
            // In the order of the chains: the same for any number of threads.
            let mut lists = Vec::new();
            for (list, brightness, counts) in done? {
                half.brightness.add(brightness);
                stats += counts;
                lists.push(list);
            }
            splats.merge(&lists, &cx.plan.classes, 1.0);
        }
        Ok(stats)
    }
}

impl Integrator for Metropolis {
    fn replay(&mut self, _: &Pass<'_>, _: &SampleId, _: &mut Recording) -> Result<(), ReplayError> {
        let why = "a step of a Markov chain depends on all steps before it, so that none can be \
                   followed alone; replay the algorithm that it runs over: bdpt, or path";
        Err(ReplayError::Cannot(why.to_owned()))
    }

    fn memory_bytes(&self) -> usize {
        self.splats.as_ref().map_or(0, SplatBuffer::bytes)
    }

    fn render_pass(&mut self, cx: &Pass<'_>, film: &mut Film) -> Result<RenderStats, Cancelled> {
        let (size, planned) = (film.size(), cx.plan.planned);
        let parity = cx.index % 2;
        let mut stats = RenderStats::default();
        // The first pass of a half starts its chains; a cancelled pass leaves them where they were.
        let known = self.halves[parity as usize]
            .clone()
            .filter(|_| cx.index >= 2);
        let mut half = match known {
            Some(half) => half,
            None => {
                let (half, counts) = self.start(cx, parity)?;
                stats += counts;
                half
            }
        };
        let mut splats = match self.splats.take() {
            Some(b) if b.fits(size, planned) => b,
            _ => SplatBuffer::new(size, planned),
        };
        splats.clear();
        stats += self.advance(cx, &mut half, &mut splats)?;
        film.commit_splats(None, &splats);
        self.splats = Some(splats);
        self.halves[parity as usize] = Some(half);
        if cx.index == 0 {
            self.halves[1] = None;
        }
        let mut brightness = Brightness::default();
        for half in self.halves.iter().flatten() {
            brightness.add(half.brightness);
        }
        film.set_scale(brightness.sum / brightness.samples.max(1) as f64);
        Ok(stats)
    }

    fn needs_preview(&self, _cx: &Pass<'_>) -> bool {
        true // the independent samples before the first mutation take as long as a picture
    }

    fn facts(&self) -> Vec<Fact> {
        let (mut brightness, mut chains) = (Brightness::default(), 0);
        for half in self.halves.iter().flatten() {
            brightness.add(half.brightness);
            chains += half.chains.len();
        }
        let samples = brightness.samples;
        let value = match (samples, chains) {
            (0, _) => return Vec::new(),
            (_, 0) => format!("none: none of {samples} independent samples found light"),
            _ => format!(
                "{chains}; mean brightness {:.4} by {samples} independent samples",
                brightness.sum / samples as f64
            ),
        };
        let label = "Markov chains";
        vec![Fact { label, value }]
    }
}
