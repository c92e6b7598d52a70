//! The result as one HTML file that needs no other.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::Row;
use super::record::{LIMIT, Record};
use super::table::{deviation, percent, range, short, verdict};
use crate::cli::error::CliError;
use crate::cli::print::{duration, escape, figure};
use crate::engine::stability::{Outcome, Point};
use crate::picture::colors;
use crate::plot::{Chart, Curve, svg};

const STYLE: &str = "body{font:15px/1.5 system-ui,sans-serif;max-width:1060px;margin:2em auto;\
    padding:0 1em;color:#222}table{border-collapse:collapse;margin:1em 0;font-size:13px}th,td{\
    padding:.2em .6em;text-align:left;border-bottom:1px solid #ddd;vertical-align:top}.holds{\
    color:#1b7f3b}.FAILS{color:#b00020;font-weight:600}.reported{color:#666}.note{color:#666;\
    font-size:14px}svg{max-width:100%;height:auto}h2{margin-top:2em}";

const EXPLANATION: &str = "<p class=\"note\">Each case is compared with an answer that needs no \
    second renderer. Pictures are means of 32 independent runs; what stands after ± is half of the \
    interval outside of which a right answer lies once in a million. A case holds if the right \
    answer is within the interval and the interval within the bound. Error is deviation and \
    interval together; what is reported and not judged lies beyond a documented limit.</p>";

/// Shares below this are shown as this: charts have logarithmic axes.
const FLOOR: f64 = 1e-9;

/// The whole page.
pub fn html(rows: &[Row], record: &Record<'_>) -> Result<String, CliError> {
    let m = &record.machine;
    let mut page = format!(
        "<!DOCTYPE html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>lightscope \
         stability</title><style>{STYLE}</style></head><body><h1>Stiff and extreme cases</h1>\
         <p>lightscope {}, {} ({} threads), {}; {} in {}.</p>{EXPLANATION}",
        m.version,
        escape(&m.processor),
        m.threads,
        escape(&m.system),
        record.depth(),
        duration(record.seconds())
    );
    overview(&mut page, rows);
    for row in rows {
        section(&mut page, row)?;
    }
    page += "</body></html>\n";
    Ok(page)
}

fn overview(page: &mut String, rows: &[Row]) {
    *page += "<table><tr><th>case</th><th>asked</th><th>verdict</th><th>worst</th><th>bound</th>\
              <th>seconds</th></tr>";
    for row in rows {
        let asked: Vec<&Outcome> = row
            .outcomes
            .iter()
            .filter(|o| o.left_out.is_none())
            .collect();
        let verdict = if row.holds() { "holds" } else { "FAILS" };
        let points = asked.iter().filter_map(|o| o.worst());
        let worst = points.max_by(|a, b| {
            let rank = |p: &Point| p.error() / p.bound.max(f64::MIN_POSITIVE);
            rank(a).total_cmp(&rank(b))
        });
        let seconds: f64 = asked.iter().map(|o| o.seconds).sum();
        let _ = write!(
            page,
            "<tr><td><a href=\"#{0}\">{0}</a></td><td>{1}</td><td class=\"{verdict}\">{verdict}\
             </td><td>{2}</td><td>{3}</td><td>{seconds:.1}</td></tr>",
            row.case.id,
            asked.len(),
            worst.map_or("–".to_owned(), deviation),
            worst.map_or("–".to_owned(), |p| percent(p.bound)),
        );
    }
    *page += "</table>";
}

fn section(page: &mut String, row: &Row) -> Result<(), CliError> {
    let case = row.case;
    let _ = write!(
        page,
        "<h2 id=\"{0}\">{1} <small>({0})</small></h2><p>{2} <b>Right is</b> {3}.</p>",
        case.id,
        escape(case.label),
        escape(case.summary),
        escape(case.oracle)
    );
    table(page, row);
    if case.parameter.is_empty() {
        return Ok(());
    }
    chart(page, &errors(row), LIMIT)?;
    if case.stiff {
        chart(page, &costs(row), f64::NAN)?;
        for outcome in &row.outcomes {
            chart(page, &histories(row, outcome), LIMIT)?;
        }
    }
    Ok(())
}

fn table(page: &mut String, row: &Row) {
    *page += "<table><tr><th>integrator</th><th>verdict</th><th>worst</th><th>bound</th><th>range\
              </th><th>1 % passed at</th><th>seconds</th></tr>";
    for outcome in &row.outcomes {
        let subject = escape(&outcome.subject);
        if let Some(why) = outcome.left_out {
            let why = escape(why);
            let _ = write!(
                page,
                "<tr><td>{subject}</td><td class=\"reported\" colspan=\"6\">{why}</td></tr>"
            );
            continue;
        }
        let verdict = verdict(outcome);
        let worst = outcome.worst();
        let _ = write!(
            page,
            "<tr><td>{subject}</td><td class=\"{verdict}\">{verdict}</td><td>{}</td><td>{}</td>\
             <td>{}</td><td>{}</td><td>{:.1}</td></tr>",
            worst.map_or("–".to_owned(), deviation),
            worst.map_or("–".to_owned(), |p| percent(p.bound)),
            range(outcome),
            outcome
                .passes(LIMIT)
                .map_or("–".to_owned(), |(_, x)| short(x)),
            outcome.seconds,
        );
        for point in outcome.points.iter().filter(|p| p.fails()) {
            let _ = write!(
                page,
                "<tr><td></td><td class=\"FAILS\" colspan=\"6\">at {} {}: {}; measured {}, right {}\
                 </td></tr>",
                short(point.x),
                escape(&point.curve),
                escape(&point.note),
                figure(point.measured),
                figure(point.exact)
            );
        }
    }
    *page += "</table>";
}

/// Draws a chart that has points at two parameters at least.
fn chart(page: &mut String, chart: &Chart, target: f64) -> Result<(), CliError> {
    let mut chart = chart.clone();
    chart.target = target.is_finite().then_some(target);
    chart.curves.retain(|c| {
        let first = c.points.first().map(|p| p.0);
        c.points.iter().any(|p| Some(p.0) != first)
    });
    if chart.curves.is_empty() {
        return Ok(());
    }
    *page += &svg(&chart, [980, 460]).map_err(CliError::failed)?;
    Ok(())
}

/// The points of an outcome by sweep.
fn sweeps(outcome: &Outcome) -> BTreeMap<&str, Vec<&Point>> {
    let mut sweeps: BTreeMap<&str, Vec<&Point>> = BTreeMap::new();
    for point in &outcome.points {
        sweeps.entry(&point.curve).or_default().push(point);
    }
    sweeps
}

fn curves(row: &Row, y: impl Fn(&Point) -> Option<f64>) -> Vec<Curve> {
    let mut curves = Vec::new();
    for outcome in &row.outcomes {
        for (name, points) in sweeps(outcome) {
            let shown = points.iter().filter_map(|p| Some((p.x, y(p)?)));
            let mut points: Vec<(f64, f64)> = shown.collect();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            curves.push(Curve {
                label: format!("{} {name}", outcome.subject).trim().to_owned(),
                color: colors::curve(curves.len()),
                points,
                band: Vec::new(),
            });
        }
    }
    curves
}

fn errors(row: &Row) -> Chart {
    Chart {
        title: format!("{}: error against {}", row.case.label, row.case.parameter),
        x_label: row.case.parameter.to_owned(),
        y_label: "error (deviation + confidence)".to_owned(),
        curves: curves(row, |p| Some(p.error().max(FLOOR))),
        target: None,
        guided: false,
    }
}

/// Process time to a standard error of one per cent, by the last look at each point.
fn costs(row: &Row) -> Chart {
    Chart {
        title: format!("{}: cost against {}", row.case.label, row.case.parameter),
        x_label: row.case.parameter.to_owned(),
        y_label: "CPU seconds to 1 %".to_owned(),
        curves: curves(row, |p| {
            let (seconds, error) = p.history.last()?;
            Some(seconds * (error / LIMIT).powi(2))
        }),
        target: None,
        guided: false,
    }
}

/// Error against time, a curve a parameter.
fn histories(row: &Row, outcome: &Outcome) -> Chart {
    let points = outcome.points.iter().filter(|p| p.history.len() > 1);
    let curve = |(i, p): (usize, &Point)| Curve {
        label: format!("{} {}", short(p.x), p.curve).trim().to_owned(),
        color: colors::curve(i),
        points: p.history.clone(),
        band: Vec::new(),
    };
    Chart {
        title: format!(
            "{}, {}: standard error against time for each {}",
            row.case.label, outcome.subject, row.case.parameter
        ),
        x_label: "CPU seconds".to_owned(),
        y_label: "standard error / right value".to_owned(),
        curves: points.enumerate().map(curve).collect(),
        target: None,
        guided: true,
    }
}
