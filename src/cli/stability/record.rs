//! The result as JSON.

use serde::Serialize;

use super::Row;
use crate::cli::report::machine::Machine;
use crate::engine::stability::{Depth, Outcome, Point};

/// Error whose passing is told.
pub const LIMIT: f64 = 0.01;

/// Everything that was found.
#[derive(Serialize)]
pub struct Record<'a> {
    /// What it was measured on.
    pub machine: Machine,
    depth: &'static str,
    seconds: f64,
    holds: bool,
    cases: Vec<CaseRecord<'a>>,
}

#[derive(Serialize)]
struct CaseRecord<'a> {
    id: &'a str,
    label: &'a str,
    parameter: &'a str,
    oracle: &'a str,
    holds: bool,
    outcomes: Vec<OutcomeRecord<'a>>,
}

#[derive(Serialize)]
struct OutcomeRecord<'a> {
    subject: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    left_out: Option<&'a str>,
    holds: bool,
    seconds: f64,
    /// First parameter at which deviation or standard error pass 1 %.
    #[serde(skip_serializing_if = "Option::is_none")]
    passes_one_percent_at: Option<f64>,
    points: Vec<PointRecord<'a>>,
}

#[derive(Serialize)]
struct PointRecord<'a> {
    curve: &'a str,
    parameter: f64,
    measured: f64,
    exact: f64,
    deviation: f64,
    confidence: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    bound: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    holds: Option<bool>,
    #[serde(skip_serializing_if = "str::is_empty")]
    note: &'a str,
    t_cpu: f64,
}

impl<'a> Record<'a> {
    /// Of what was found.
    pub fn new(rows: &'a [Row], depth: Depth, seconds: f64, machine: Machine) -> Self {
        Self {
            machine,
            depth: match depth {
                Depth::Quick => "quick",
                Depth::Full => "full",
            },
            seconds,
            holds: rows.iter().all(Row::holds),
            cases: rows.iter().map(case).collect(),
        }
    }

    /// `quick` or `full`.
    pub fn depth(&self) -> &str {
        self.depth
    }

    /// Wall time in seconds.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }
}

fn case(row: &Row) -> CaseRecord<'_> {
    CaseRecord {
        id: row.case.id,
        label: row.case.label,
        parameter: row.case.parameter,
        oracle: row.case.oracle,
        holds: row.holds(),
        outcomes: row.outcomes.iter().map(outcome).collect(),
    }
}

fn outcome(outcome: &Outcome) -> OutcomeRecord<'_> {
    OutcomeRecord {
        subject: &outcome.subject,
        left_out: outcome.left_out,
        holds: outcome.holds(),
        seconds: outcome.seconds,
        passes_one_percent_at: outcome.passes(LIMIT).map(|(_, x)| x),
        points: outcome.points.iter().map(point).collect(),
    }
}

fn point(point: &Point) -> PointRecord<'_> {
    PointRecord {
        curve: &point.curve,
        parameter: point.x,
        measured: point.measured,
        exact: point.exact,
        deviation: point.deviation,
        confidence: point.confidence,
        bound: point.bound.is_finite().then_some(point.bound),
        holds: point.holds,
        note: &point.note,
        t_cpu: point.t_cpu,
    }
}
