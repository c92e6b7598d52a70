//! The figures of `bench integrators` as a table.

use super::integrators::Row;
use crate::cli::error::CliError;
use crate::cli::print::{self, figure};

/// A pass that takes longer than this share of the time is marked.
const LATE: f64 = 1.25;

/// A line an integrator, a column a scene and time. `rows` holds, scene after scene and integrator
/// after integrator, the times of one render.
pub fn print(
    rows: &[Row],
    ids: &[&str],
    seconds: &[f64],
    efficiency: bool,
) -> Result<(), CliError> {
    let Some(first) = rows.first() else {
        return Ok(());
    };
    let what = if efficiency {
        "1000 · relMSE · CPU seconds"
    } else {
        "relMSE"
    };
    print::line(&format!(
        "{what}, {} (in brackets: mean over the reference's)",
        first.layer
    ))?;
    let scenes: Vec<&[Row]> = rows.chunks(ids.len() * seconds.len()).collect();
    let column = |f: &dyn Fn(&Row) -> String, i: usize| {
        let cell = |rows: &&[Row], j: usize| {
            let width = title(&rows[j]).chars().count().max(18);
            format!("{:>width$}", f(&rows[i * seconds.len() + j]))
        };
        let cells = scenes
            .iter()
            .flat_map(|rows| (0..seconds.len()).map(move |j| cell(rows, j)));
        cells.collect::<Vec<_>>().join("  ")
    };
    print::line(&format!("{:12} {}", "", column(&title, 0)))?;
    for (i, id) in ids.iter().enumerate() {
        let cell = |r: &Row| {
            let value = if efficiency { r.k } else { r.relmse };
            let mark = if is_late(r) { "*" } else { "" };
            format!("{} ({:.2}){mark}", figure(value), r.brightness)
        };
        print::line(&format!("{id:12} {}", column(&cell, i)))?;
        let reports = |r: &Row| r.integrator == *id && r.reported_bias.is_some();
        if !efficiency && rows.iter().any(reports) {
            let bias = |r: &Row| r.reported_bias.map_or(String::new(), figure);
            print::line(&format!("{:12} {}", "  its bias", column(&bias, i)))?;
        }
    }
    if rows.iter().any(is_late) {
        print::line("* its last pass ended late; --json tells when")?;
    }
    Ok(())
}

fn title(row: &Row) -> String {
    format!("{}, {} s", row.scene, row.seconds)
}

fn is_late(row: &Row) -> bool {
    row.t_wall > LATE * row.seconds
}
