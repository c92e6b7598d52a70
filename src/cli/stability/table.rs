//! The result as a table at the terminal.

use super::Row;
use super::record::LIMIT;
use crate::cli::error::CliError;
use crate::cli::print::{self, duration, figure};
use crate::engine::stability::{Case, Outcome, Point};

/// A share as a percentage.
pub fn percent(share: f64) -> String {
    format!("{} %", figure(100.0 * share))
}

/// `worst ± confidence` of a point.
pub fn deviation(point: &Point) -> String {
    match point.confidence {
        0.0 => percent(point.deviation),
        c => format!("{} ± {}", percent(point.deviation), percent(c)),
    }
}

/// The range of parameters of an outcome.
pub fn range(outcome: &Outcome) -> String {
    let xs = outcome.points.iter().map(|p| p.x);
    let (low, high) = (
        xs.clone().fold(f64::INFINITY, f64::min),
        xs.fold(0.0, f64::max),
    );
    if low == high {
        short(low)
    } else {
        format!("{} … {}", short(low), short(high))
    }
}

/// A parameter as short as can be.
pub fn short(x: f64) -> String {
    if x == 0.0 || (1e-3..1e4).contains(&x) {
        format!("{}", (x * 1e4).round() / 1e4)
    } else {
        format!("{x:.0e}")
    }
}

/// `holds`, `FAILS` or `reported`.
pub fn verdict(outcome: &Outcome) -> &'static str {
    match (
        outcome.holds(),
        outcome.points.iter().any(|p| p.holds.is_some()),
    ) {
        (false, _) => "FAILS",
        (true, true) => "holds",
        (true, false) => "reported",
    }
}

/// Prints what a case is.
pub fn heading(case: &Case) -> Result<(), CliError> {
    print::line(&format!("\n{}: {}", case.id, case.summary))?;
    print::line(&format!("  right is {}", case.oracle))
}

/// Prints an outcome, and where it fails.
pub fn print(case: &Case, outcome: &Outcome) -> Result<(), CliError> {
    if outcome.left_out.is_some() {
        return Ok(());
    }
    print::line(&line(case.parameter, outcome))?;
    for point in outcome.points.iter().filter(|p| p.fails()) {
        let at = short(point.x);
        let why = if point.note.is_empty() {
            format!("{} is not {}", point.measured, point.exact)
        } else {
            point.note.clone()
        };
        print::line(&format!("      at {at} {}: {why}", point.curve))?;
    }
    Ok(())
}

/// Prints who was not asked, and why.
pub fn left_out(row: &Row) -> Result<(), CliError> {
    let left: Vec<&Outcome> = row
        .outcomes
        .iter()
        .filter(|o| o.left_out.is_some())
        .collect();
    let mut reasons: Vec<&str> = Vec::new();
    for reason in left.iter().filter_map(|o| o.left_out) {
        if !reasons.contains(&reason) {
            reasons.push(reason);
        }
    }
    for reason in reasons {
        let same = left.iter().filter(|o| o.left_out == Some(reason));
        let ids: Vec<&str> = same.map(|o| o.subject.as_str()).collect();
        print::line(&format!("  not {}: {reason}", ids.join(", ")))?;
    }
    Ok(())
}

fn line(parameter: &str, outcome: &Outcome) -> String {
    let mut text = format!("  {:<5} {:<18}", verdict(outcome), outcome.subject);
    if let Some(worst) = outcome.worst() {
        let bound = percent(worst.bound);
        text += &format!(" worst {} of {bound}", deviation(worst));
        if !parameter.is_empty() {
            text += &format!(" at {} {}", short(worst.x), worst.curve);
        }
    }
    if !parameter.is_empty() {
        text += &format!("; {parameter} {}", range(outcome));
        if let Some((_, x)) = outcome.passes(LIMIT) {
            text += &format!(", 1 % passed at {}", short(x));
        }
    }
    text + &format!("; {:.1} s", outcome.seconds)
}

/// Prints what it comes to.
pub fn summary(rows: &[Row], seconds: f64) -> Result<(), CliError> {
    let outcomes = || rows.iter().flat_map(|r| &r.outcomes);
    let asked = outcomes().filter(|o| o.left_out.is_none()).count();
    let failed = outcomes().filter(|o| !o.holds()).count();
    let points: usize = outcomes().map(|o| o.points.len()).sum();
    print::line(&format!(
        "\n{} cases, {asked} answers of {points} points, {failed} of them fail; {}",
        rows.len(),
        duration(seconds)
    ))
}
