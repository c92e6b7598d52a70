//! What a case is, and what it yields.

use std::ops::RangeInclusive;

use super::estimate::{Estimate, Sampling};
use crate::engine::integrators::{self, Entry};
use crate::engine::session::{RenderClock, RenderJob};

/// How long it may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// Minutes for all cases together.
    Quick,
    /// Wider ranges, narrower bounds.
    Full,
}

/// One row of the table of cases.
pub struct Case {
    /// What is typed.
    pub id: &'static str,
    /// What is read.
    pub label: &'static str,
    /// One sentence: what is rendered or asked.
    pub summary: &'static str,
    /// What is swept, for tables and axes; empty for single values.
    pub parameter: &'static str,
    /// The right answer, as a formula or a sentence.
    pub oracle: &'static str,
    /// Whether the cost grows along the sweep: the page then shows error against time.
    pub stiff: bool,
    /// Whether it asks an integrator, and how it is set; `engine` alone for parts of the engine.
    pub fit: fn(&str) -> Fit,
    /// Measures; called once a variant.
    pub run: fn(&mut Run),
}

/// Name under which cases ask parts of the engine and no integrator.
pub const ENGINE: &str = "engine";

/// Whether a case asks an integrator.
#[derive(Clone, Copy)]
pub enum Fit {
    /// It does, once with each of these settings.
    Asked(&'static [Variant]),
    /// It does not, for that reason.
    LeftOut(&'static str),
}

/// Settings of an integrator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variant {
    /// Name beside the integrator's, empty for its defaults.
    pub name: &'static str,
    /// Parameters.
    pub set: &'static [(&'static str, &'static str)],
    /// Share of the right value by which a biased method may be off: what its blur, or an error
    /// that all its passes share, costs.
    pub bias: f64,
}

/// One measurement.
#[derive(Clone, Debug)]
pub struct Point {
    /// Which of several sweeps it belongs to.
    pub curve: String,
    /// The parameter; its logarithm is the axis of charts.
    pub x: f64,
    /// What was measured.
    pub measured: f64,
    /// What is right.
    pub exact: f64,
    /// |measured − exact| over the size of what is right.
    pub deviation: f64,
    /// Half the width of the confidence interval, over the same size.
    pub confidence: f64,
    /// Standard error over the same size.
    pub standard_error: f64,
    /// Most that deviation and interval may be.
    pub bound: f64,
    /// Whether it holds; none if it is only reported.
    pub holds: Option<bool>,
    /// Why not, or what there is to know.
    pub note: String,
    /// Process time in seconds.
    pub t_cpu: f64,
    /// Standard error over the right value after so many seconds of process time.
    pub history: Vec<(f64, f64)>,
}

impl Point {
    /// Error that can be excluded no more: deviation and interval together.
    pub fn error(&self) -> f64 {
        self.deviation + self.confidence
    }

    /// Whether it fails the case.
    pub fn fails(&self) -> bool {
        self.holds == Some(false)
    }
}

/// What a case asked one integrator, and the answers.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The case.
    pub case: &'static str,
    /// The integrator and its variant, or [`ENGINE`].
    pub subject: String,
    /// The answers in the order of the sweep.
    pub points: Vec<Point>,
    /// Why it was not asked.
    pub left_out: Option<&'static str>,
    /// Wall time in seconds.
    pub seconds: f64,
}

impl Outcome {
    /// Whether every answer that is judged holds.
    pub fn holds(&self) -> bool {
        self.points.iter().all(|p| !p.fails())
    }

    /// The judged point nearest to its bound, or beyond it the farthest.
    pub fn worst(&self) -> Option<&Point> {
        let judged = self.points.iter().filter(|p| p.holds.is_some());
        let rank = |p: &Point| (p.fails(), p.error() / p.bound.max(f64::MIN_POSITIVE));
        judged.max_by(|a, b| {
            let (a, b) = (rank(a), rank(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        })
    }

    /// The first parameter at which deviation or standard error pass `limit`, if they do.
    pub fn passes(&self, limit: f64) -> Option<(&str, f64)> {
        let within = |p: &&Point| p.deviation <= limit && p.standard_error <= limit;
        let beyond = self.points.iter().find(|p| !within(p))?;
        Some((&beyond.curve, beyond.x))
    }
}

/// A case under way with one variant of one integrator.
pub struct Run {
    /// How long it may take.
    pub depth: Depth,
    /// The integrator; none where the engine is asked.
    pub entry: Option<&'static Entry>,
    /// Its settings.
    pub variant: Variant,
    points: Vec<Point>,
    clock: RenderClock,
}

impl Run {
    /// Id of the integrator.
    pub fn id(&self) -> &'static str {
        self.entry.map_or(ENGINE, |entry| entry.id)
    }

    /// `quick` or `full`.
    pub fn pick<T>(&self, quick: T, full: T) -> T {
        match self.depth {
            Depth::Quick => quick,
            Depth::Full => full,
        }
    }

    /// Renders `job` until its mean is known to the bound, and compares that with `exact`.
    pub fn picture(&mut self, x: f64, curve: &str, job: &RenderJob, exact: f64, how: &Sampling) {
        self.pictures(x, curve, std::slice::from_ref(job), exact, how);
    }

    /// The same of several pictures whose means are added up.
    pub fn pictures(
        &mut self,
        x: f64,
        curve: &str,
        jobs: &[RenderJob],
        exact: f64,
        how: &Sampling,
    ) {
        let how = Sampling {
            bias: how.bias.max(self.variant.bias),
            ..*how
        };
        let estimate = Estimate::of(jobs, exact, &how);
        self.points.push(estimate.point(x, curve, exact, &how));
        self.clock = RenderClock::start();
    }

    /// Like [`Self::picture`] where it is only to be reported how far it is off.
    pub fn report(&mut self, x: f64, curve: &str, job: &RenderJob, exact: f64, how: &Sampling) {
        self.picture(x, curve, job, exact, how);
        if let Some(point) = self.points.last_mut() {
            // What is no number fails even where no bound is set.
            let sound = point.measured.is_finite();
            point.holds = (!sound).then_some(false);
        }
    }

    /// A value that needs no statistics: off by at most `bound` of `exact`.
    pub fn value(&mut self, x: f64, curve: &str, measured: f64, exact: f64, bound: f64) {
        let size = if exact == 0.0 { 1.0 } else { exact.abs() };
        let deviation = (measured - exact).abs() / size;
        self.push(x, curve, (measured, exact), (deviation, 0.0), bound, "");
    }

    /// A mean with its standard error, off by no more than chance allows, and known to `bound`.
    pub fn mean(&mut self, x: f64, curve: &str, (mean, half): (f64, f64), exact: f64, bound: f64) {
        let size = if exact == 0.0 { 1.0 } else { exact.abs() };
        let deviation = (mean - exact).abs() / size;
        let half = half / size;
        self.push(x, curve, (mean, exact), (deviation, half), bound, "");
        if let Some(point) = self.points.last_mut() {
            point.holds = Some(deviation <= half && half <= bound);
        }
    }

    /// `failures` of `trials`, of which there must be none. What was not seen in n trials has a
    /// probability below 3/n (95 %).
    pub fn count(&mut self, x: f64, curve: &str, failures: u64, trials: u64, note: &str) {
        let n = trials.max(1) as f64;
        let share = failures as f64 / n;
        self.push(x, curve, (share, 0.0), (share, 3.0 / n), 0.0, note);
        if let Some(point) = self.points.last_mut() {
            point.holds = Some(failures == 0 && trials > 0);
        }
    }

    /// Reports a value without judging it.
    pub fn fact(&mut self, x: f64, curve: &str, deviation: f64, note: &str) {
        self.push(
            x,
            curve,
            (deviation, 0.0),
            (deviation, 0.0),
            f64::INFINITY,
            note,
        );
        if let Some(point) = self.points.last_mut() {
            point.holds = None;
        }
    }

    fn push(
        &mut self,
        x: f64,
        curve: &str,
        (measured, exact): (f64, f64),
        (deviation, confidence): (f64, f64),
        bound: f64,
        note: &str,
    ) {
        self.points.push(Point {
            curve: curve.to_owned(),
            x,
            measured,
            exact,
            deviation,
            confidence,
            standard_error: 0.0,
            bound,
            // What is no number is within no bound.
            holds: Some(deviation <= bound),
            note: note.to_owned(),
            t_cpu: self.clock.cpu(),
            history: Vec::new(),
        });
        self.clock = RenderClock::start();
    }
}

/// Asks the engine or the integrators of `ids` (all if empty); `hear` is told each outcome.
pub fn run(case: &'static Case, ids: &[String], depth: Depth, hear: &mut dyn FnMut(Outcome)) {
    let wanted = |id: &str| ids.is_empty() || ids.iter().any(|i| i == id);
    let engine = std::iter::once((ENGINE, None));
    let all = integrators::REGISTRY.iter().map(|e| (e.id, Some(e)));
    for (id, entry) in engine.chain(all) {
        match (case.fit)(id) {
            Fit::Asked(variants) if entry.is_none() || wanted(id) => {
                variants
                    .iter()
                    .for_each(|v| hear(ask(case, entry, *v, depth)));
            }
            Fit::LeftOut(why) if entry.is_some() && wanted(id) => hear(Outcome {
                case: case.id,
                subject: id.to_owned(),
                points: Vec::new(),
                left_out: Some(why),
                seconds: 0.0,
            }),
            _ => {}
        }
    }
}

fn ask(
    case: &'static Case,
    entry: Option<&'static Entry>,
    variant: Variant,
    depth: Depth,
) -> Outcome {
    let clock = RenderClock::start();
    let mut run = Run {
        depth,
        entry,
        variant,
        points: Vec::new(),
        clock,
    };
    (case.run)(&mut run);
    let subject = match variant.name {
        "" => run.id().to_owned(),
        name => format!("{} {name}", run.id()),
    };
    Outcome {
        case: case.id,
        subject,
        points: run.points,
        left_out: None,
        seconds: clock.wall(),
    }
}

/// Powers of ten.
pub(super) fn decades(exponents: RangeInclusive<i32>, step: usize) -> impl Iterator<Item = f64> {
    exponents.step_by(step).map(|e| 10_f64.powi(e))
}
