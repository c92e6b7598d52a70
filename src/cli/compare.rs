//! `lightscope compare`: how far a picture is from its reference, layer by layer.

use serde::Serialize;

use super::args::CompareArgs;
use super::error::CliError;
use super::picture::{self, Layer};
use super::print::{self, figure};
use crate::engine::measure::{Metrics, ReferenceNoise};

/// Runs the command.
pub fn run(args: &CompareArgs) -> Result<(), CliError> {
    let image = picture::read(&args.image)?;
    let reference = picture::read_reference(&args.reference)?;
    if image.size != reference.size {
        let ([w, h], [rw, rh]) = (image.size.to_array(), reference.size.to_array());
        return Err(CliError::usage(format!(
            "{} has {w}x{h} pixels and {} has {rw}x{rh}; only pictures of one size can be compared",
            args.image.display(),
            args.reference.display()
        )));
    }
    let rows: Vec<Row> = image
        .layers
        .iter()
        .filter_map(|layer| {
            let partner = reference.layers.iter().find(|r| r.key() == layer.key())?;
            row(layer, partner, &reference.standard_errors)
        })
        .collect();
    if rows.is_empty() {
        return Err(CliError::usage(format!(
            "{} and {} have no layer of finite pixels in common",
            args.image.display(),
            args.reference.display()
        )));
    }
    if args.json {
        print::json(&rows)
    } else {
        table(&rows)
    }
}

#[derive(Serialize)]
struct Row {
    layer: String,
    #[serde(flatten)]
    metrics: Metrics,
    /// What the noise of the reference alone would give.
    reference_noise: Option<ReferenceNoise>,
}

fn row(layer: &Layer, reference: &Layer, standard_errors: &[Layer]) -> Option<Row> {
    let se = standard_errors
        .iter()
        .find(|se| se.label == reference.label);
    Some(Row {
        layer: layer.key().to_owned(),
        metrics: Metrics::new(&layer.pixels, &reference.pixels)?,
        reference_noise: se.and_then(|se| ReferenceNoise::new(&reference.pixels, &se.pixels)),
    })
}

fn table(rows: &[Row]) -> Result<(), CliError> {
    let width = rows
        .iter()
        .map(|row| row.layer.chars().count())
        .max()
        .unwrap_or(0)
        .max(8);
    let head = ["rmse", "mae", "bias", "relmse", "nmse", "smape"];
    print::line(&format!(
        "{:width$} {}",
        "layer",
        columns(head.map(str::to_owned))
    ))?;
    for Row {
        layer,
        metrics: m,
        reference_noise,
    } in rows
    {
        let nmse = m.nmse.map_or("-".to_owned(), figure);
        let cells = [m.rmse, m.mae, m.bias, m.relmse].map(figure);
        let [rmse, mae, bias, relmse] = cells;
        let cells = columns([rmse, mae, bias, relmse, nmse, figure(m.smape)]);
        print::line(&format!("{layer:width$} {cells}"))?;
        if let Some(n) = reference_noise {
            let (none, nmse) = (String::new, n.nmse.map_or("-".to_owned(), figure));
            let cells = columns([
                figure(n.rmse),
                none(),
                none(),
                figure(n.relmse),
                nmse,
                none(),
            ]);
            print::line(&format!(
                "{:width$} {cells}  from the reference's own noise",
                ""
            ))?;
        }
        if m.non_finite > 0 {
            print::line(&format!(
                "{:width$} {} pixels are not finite: left out",
                "", m.non_finite
            ))?;
        }
    }
    Ok(())
}

fn columns(cells: [String; 6]) -> String {
    cells
        .map(|cell| format!("{cell:>11}"))
        .join(" ")
        .trim_end()
        .to_owned()
}
