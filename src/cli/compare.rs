//! `lightscope compare`: how far a picture is from its reference, layer by layer.

use serde::Serialize;

use super::args::CompareArgs;
use super::error::CliError;
use super::picture::{self, Layer, Picture};
use super::print::{self, figure};
use crate::engine::measure::{Metrics, ReferenceNoise, Region};

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
    let region = args.region.as_ref();
    let rows: Vec<Row> = image
        .layers
        .iter()
        .filter_map(|layer| {
            let partner = reference.layers.iter().find(|r| r.key() == layer.key())?;
            row(layer, partner, &reference, region).transpose()
        })
        .collect::<Result<_, CliError>>()?;
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
    /// Without the thousandth of the pixels that differs most.
    without_worst: Option<Metrics>,
    /// What the noise of the reference alone would give.
    reference_noise: Option<ReferenceNoise>,
}

fn row(
    layer: &Layer,
    reference: &Layer,
    picture: &Picture,
    region: Option<&Region>,
) -> Result<Option<Row>, CliError> {
    let cut = |pixels: &[[f32; 3]]| match region {
        None => Ok(pixels.to_vec()),
        Some(region) => region.of(pixels, picture.size).ok_or_else(|| {
            let size = picture.size;
            CliError::usage(format!(
                "the region {region} reaches beyond the picture of {}x{} pixels",
                size.x, size.y
            ))
        }),
    };
    let mut errors = picture.standard_errors.iter();
    let se = errors.find(|se| se.label == reference.label);
    let (x, r) = (cut(&layer.pixels)?, cut(&reference.pixels)?);
    let noise = match se {
        Some(se) => ReferenceNoise::new(&r, &cut(&se.pixels)?),
        None => None,
    };
    Ok(Metrics::new(&x, &r).map(|metrics| Row {
        layer: layer.key().to_owned(),
        metrics,
        without_worst: Metrics::without_worst(&x, &r),
        reference_noise: noise,
    }))
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
        without_worst,
        reference_noise,
    } in rows
    {
        print::line(&format!("{layer:width$} {}", figures(m)))?;
        if let Some(m) = without_worst {
            let (none, cells) = ("", figures(m));
            print::line(&format!("{none:width$} {cells}  without the worst 0.1 %"))?;
        }
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

fn figures(m: &Metrics) -> String {
    let nmse = m.nmse.map_or("-".to_owned(), figure);
    let [rmse, mae, bias, relmse] = [m.rmse, m.mae, m.bias, m.relmse].map(figure);
    columns([rmse, mae, bias, relmse, nmse, figure(m.smape)])
}

fn columns(cells: [String; 6]) -> String {
    cells
        .map(|cell| format!("{cell:>11}"))
        .join(" ")
        .trim_end()
        .to_owned()
}
