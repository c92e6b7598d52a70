//! One Markov chain.

use glam::Vec2;

use super::Brightness;
use crate::engine::film::SplatList;
use crate::engine::integrators::bidirectional::{Bidirectional, Sink, Technique, Workspace};
use crate::engine::integrators::tiled::CAMERA_DIMENSIONS;
use crate::engine::integrators::{Pass, RenderStats, SampleId};
use crate::engine::math::{Fault, FaultCounts, Rgb};
use crate::engine::path::ClassId;
use crate::engine::sampling::{IndependentSampler, PrimarySpace, Sampler, StepKey, Stream};

/// What all chains have in common.
pub(super) struct Source {
    pub estimator: Bidirectional,
    pub large_step: f32,
    pub size: f32,
}

/// What one sample brings to the picture.
#[derive(Clone, Debug, Default)]
struct Brought {
    paths: Vec<(Vec2, ClassId, Rgb)>,
    /// The film position that the sample began with.
    film: Vec2,
    /// Sum of the means of the channels: what the chain is distributed by.
    weight: f64,
    faults: FaultCounts,
}

impl Brought {
    fn push(&mut self, film: Vec2, class: ClassId, value: Rgb) {
        if matches!(
            self.faults.look_at(value),
            Some(Fault::Nan | Fault::Infinite)
        ) {
            return; // left out
        }
        if !value.is_black() {
            self.weight += f64::from(value.mean());
            self.paths.push((film, class, value));
        }
    }
}

impl Sink for Brought {
    #[inline]
    fn add(&mut self, _: Technique, class: ClassId, value: Rgb, weight: f32) {
        self.push(self.film, class, value * weight);
    }

    #[inline]
    fn splat(&mut self, film: Vec2, _: Technique, class: ClassId, value: Rgb, weight: f32) {
        self.push(film, class, value * weight);
    }
}

/// The two random walks of a sample.
#[derive(Clone)]
struct Numbers {
    eye: PrimarySpace,
    light: PrimarySpace,
}

impl Numbers {
    fn new(source: &Source, cx: &Pass<'_>, origin: StepKey) -> Self {
        Self {
            eye: PrimarySpace::new(cx.seed, 0, origin, source.size),
            light: PrimarySpace::new(cx.seed, 1, origin, source.size),
        }
    }
}

impl Source {
    /// Makes the sample that `numbers` stand for.
    fn sample(
        &self,
        cx: &Pass<'_>,
        numbers: &mut Numbers,
        work: &mut Workspace,
        brought: &mut Brought,
        stats: &mut RenderStats,
    ) {
        brought.paths.clear();
        brought.weight = 0.0;
        let (eye, light) = (&mut numbers.eye, &mut numbers.light);
        eye.seek(0);
        let size = cx.camera.size().as_vec2();
        // A product may round up to the border.
        let film = (eye.next_2d() * size).min(size.map(f32::next_down));
        let lens = if cx.plan.lens {
            eye.next_2d()
        } else {
            Vec2::ZERO
        };
        eye.seek(CAMERA_DIMENSIONS);
        brought.film = film;
        stats.samples += 1;
        self.estimator
            .sample(cx, (film, lens), (eye, light), None, work, brought, stats);
        stats.faults += std::mem::take(&mut brought.faults);
    }

    /// What the bootstrap samples of these numbers bring.
    pub fn weigh(&self, cx: &Pass<'_>, samples: std::ops::Range<u64>) -> (Vec<f64>, RenderStats) {
        let mut stats = RenderStats::default();
        let (mut work, mut brought) = (Workspace::default(), Brought::default());
        let weights = samples.map(|item| {
            let origin = StepKey {
                stream: Stream::Bootstrap,
                item,
                step: 0,
            };
            let mut numbers = Numbers::new(self, cx, origin);
            let before = stats.errors();
            self.sample(cx, &mut numbers, &mut work, &mut brought, &mut stats);
            stats.keep_if_bad(&before, || SampleId::Bootstrap { number: item });
            brought.weight
        });
        (weights.collect(), stats)
    }
}

/// A chain and its state.
#[derive(Clone)]
pub(super) struct Chain {
    id: u64,
    step: u64,
    numbers: Numbers,
    state: Brought,
}

impl Chain {
    /// A chain that starts from the bootstrap sample `origin`.
    pub fn new(
        source: &Source,
        cx: &Pass<'_>,
        id: u64,
        origin: StepKey,
        stats: &mut RenderStats,
    ) -> Self {
        let mut numbers = Numbers::new(source, cx, origin);
        let mut state = Brought::default();
        source.sample(
            cx,
            &mut numbers,
            &mut Workspace::default(),
            &mut state,
            stats,
        );
        Self {
            id,
            step: 0,
            numbers,
            state,
        }
    }

    /// Makes `mutations` steps. Every state counts by the time it is expected to last, so that
    /// both the proposal and the state that it did not replace count (Veach 1997, section 11.3.3).
    pub fn run(
        &mut self,
        source: &Source,
        cx: &Pass<'_>,
        mutations: u64,
        splats: &mut SplatList,
    ) -> (Brightness, RenderStats) {
        let mut stats = RenderStats::default();
        let mut brightness = Brightness::default();
        let (mut work, mut proposal) = (Workspace::default(), Brought::default());
        let mut lasted = 0.0;
        for _ in 0..mutations {
            self.step += 1;
            let key = StepKey {
                stream: Stream::Chain,
                item: self.id,
                step: self.step,
            };
            // Numbers of the step itself; those of its coordinates have seeds of their own.
            let mut u = IndependentSampler::new(cx.seed, key.stream, (key.item, key.step));
            let large = u.next_1d() < source.large_step;
            self.numbers.eye.propose(key, large);
            self.numbers.light.propose(key, large);
            let before = stats.errors();
            source.sample(cx, &mut self.numbers, &mut work, &mut proposal, &mut stats);
            let (chain, step) = (self.id, self.step);
            stats.keep_if_bad(&before, || SampleId::ChainStep { chain, step });
            if large {
                brightness.add(Brightness {
                    sum: proposal.weight,
                    samples: 1,
                });
            }

            let acceptance = (proposal.weight / self.state.weight).min(1.0);
            lasted += 1.0 - acceptance;
            stats.mutations += 1;
            if f64::from(u.next_1d()) < acceptance {
                stats.accepted += 1;
                record(&self.state, lasted, splats);
                std::mem::swap(&mut self.state, &mut proposal);
                lasted = acceptance;
            } else {
                record(&proposal, acceptance, splats);
                self.numbers.eye.reject();
                self.numbers.light.reject();
            }
        }
        record(&self.state, lasted, splats);
        stats.faults += splats.take_faults();
        (brightness, stats)
    }
}

/// Splats a state that counts `time` steps, divided by its weight.
fn record(state: &Brought, time: f64, splats: &mut SplatList) {
    if time > 0.0 && state.weight > 0.0 {
        let scale = (time / state.weight) as f32;
        for &(film, class, value) in &state.paths {
            splats.add(film, class, value * scale);
        }
    }
}
