//! The page: one HTML file that needs no other.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::Report;
use super::images::ERROR_SCALE;
use super::options::{ReportOptions, Subject};
use super::store::{Key, Store};
use super::summary::{Contestant, SceneSummary};
use crate::cli::error::CliError;
use crate::cli::print::{duration, escape, figure};
use crate::picture::colors;
use crate::plot::{Chart, Curve, svg};

/// Slope above which an error no longer falls.
const LEVEL: f64 = -0.25;

const STYLE: &str = "body{font:15px/1.5 system-ui,sans-serif;max-width:1060px;margin:2em auto;\
    padding:0 1em;color:#222}table{border-collapse:collapse;margin:1em 0}th,td{padding:.25em .7em;\
    text-align:right;border-bottom:1px solid #ddd}th:first-child,td:first-child{text-align:left}\
    .win{background:#e3f3e3;font-weight:600}.close{background:#f4f6e4}figure{display:inline-block;\
    margin:.4em;vertical-align:top}figcaption{font-size:13px;color:#555;max-width:250px}img{width:\
    250px;image-rendering:pixelated;background:#888}svg{max-width:100%;height:auto}.note{color:\
    #666;font-size:14px}.swatch{display:inline-block;width:.8em;height:.8em;margin-right:.4em}";

/// The plot of a scene.
pub fn plot(scene: &SceneSummary, target: f64) -> Result<String, String> {
    let curves = scene.integrators.iter().enumerate().map(|(i, c)| Curve {
        label: c.id.to_owned(),
        color: colors::curve(i),
        points: c.curve.iter().map(|p| (p.seconds, p.error)).collect(),
        band: c.curve.iter().map(|p| (p.seconds, p.band)).collect(),
    });
    let chart = Chart {
        title: format!("{}: error against time", scene.id),
        x_label: "seconds".to_owned(),
        y_label: match scene.reference {
            Some(_) => "RMSE / mean".to_owned(),
            None => "estimated RMSE / mean".to_owned(),
        },
        curves: curves.collect(),
        target: Some(target),
        guided: true,
    };
    svg(&chart, [980, 560])
}

/// The whole page.
pub fn html(options: &ReportOptions, store: &Store, report: &Report) -> Result<String, CliError> {
    let mut page = String::new();
    let m = &report.machine;
    let (threads, cores, system) = (m.threads, m.cores, escape(&m.system));
    let settings = [
        (
            "machine",
            format!(
                "{} ({cores} threads, {threads} used), {system}",
                escape(&m.processor)
            ),
        ),
        ("program", format!("lightscope {}", m.version)),
        ("time", format!("{} s a run", report.seconds)),
        ("seeds", format!("0 to {}", report.seeds - 1)),
        (
            "target",
            format!("relative error {} %", report.target * 100.0),
        ),
        (
            "depth",
            report
                .max_depth
                .map_or("unlimited".to_owned(), |d| d.to_string()),
        ),
    ];
    page += "<!DOCTYPE html><html lang=\"en\"><head><meta charset=\"utf-8\">";
    let _ = write!(
        page,
        "<title>lightscope report</title><style>{STYLE}</style></head><body>"
    );
    page += "<h1>Error against time</h1><table>";
    for (name, value) in settings {
        let _ = write!(page, "<tr><td>{name}</td><td>{value}</td></tr>");
    }
    page += "</table>";
    page += EXPLANATION;
    for (scene, subject) in report.scenes.iter().zip(&options.scenes) {
        section(&mut page, options, store, scene, subject, report.target)?;
    }
    page += "</body></html>\n";
    Ok(page)
}

const EXPLANATION: &str = "<p class=\"note\">Curves are root mean squares over the seeds, bands \
    run from the best seed to the worst. Errors are looked at after passes 1, 2, 3, 4, 6, 8, 11 …, \
    so that times are a geometric series and two reports with the same seeds have the same errors. \
    The slope is that of the error against passes with the reference's noise taken off; plain \
    random numbers have −1/2, and an unbiased method falls for ever. The error of a biased method \
    levels off at its bias: noise and bias are told apart by the difference of two independent \
    halves of the picture. K = 1000 · relMSE · CPU seconds: less is better.</p>";

fn section(
    page: &mut String,
    options: &ReportOptions,
    store: &Store,
    scene: &SceneSummary,
    subject: &Subject,
    target: f64,
) -> Result<(), CliError> {
    let [width, height] = scene.size;
    let _ = write!(
        page,
        "<h2>{}</h2><p>{width} × {height} pixels. ",
        escape(&scene.id)
    );
    let _ = match (&scene.reference, &scene.reference_noise) {
        (None, _) => write!(
            page,
            "No reference: every error is <b>estimated</b> and holds no bias."
        ),
        (Some(r), None) => write!(
            page,
            "Reference {}, whose own noise is not known.",
            escape(r)
        ),
        (Some(r), Some(n)) => write!(
            page,
            "Reference {}; its own noise alone gives an RMSE of {} and a relMSE of {}.",
            escape(r),
            figure(n.rmse),
            figure(n.relmse)
        ),
    };
    let svg = plot(scene, target).map_err(CliError::failed)?;
    let _ = write!(page, "</p>{svg}");
    race(page, options, scene);
    layers(page, scene);
    notes(page, scene);
    pictures(page, options, store, scene, subject);
    Ok(())
}

fn race(page: &mut String, options: &ReportOptions, scene: &SceneSummary) {
    let time = duration(options.seconds);
    let _ = write!(
        page,
        "<h3>After {time}</h3><table><tr><th>integrator</th><th>error</th><th>seeds from – to</th>\
         <th>passes</th><th>slope</th><th>noise</th><th>bias</th><th>K</th>\
         <th>error {} % after</th></tr>",
        options.target * 100.0
    );
    let cell = |x: Option<f64>| x.map_or("–".to_owned(), figure);
    for (i, c) in scene.integrators.iter().enumerate() {
        let [r, g, b] = colors::curve(i);
        let class = match (c.race.winner, c.race.close) {
            (true, _) => " class=\"win\"",
            (_, true) => " class=\"close\"",
            _ => "",
        };
        let mark = if c.race.winner { " ★" } else { "" };
        let band = c.race.band.map_or("–".to_owned(), |[low, high]| {
            format!("{} – {}", figure(low), figure(high))
        });
        let noise = c.parts.map(|p| p.noise);
        let bias = match c.parts {
            Some(parts) if c.bias_seen => figure(parts.bias),
            Some(_) => "none seen".to_owned(),
            None => "–".to_owned(),
        };
        let _ = write!(
            page,
            "<tr{class}><td><span class=\"swatch\" style=\"background:rgb({r},{g},{b})\"></span>{}\
             {mark}</td><td>{}</td><td>{band}</td><td>{:.0}</td><td>{}</td><td>{}</td><td>{}</td>\
             <td>{}</td><td>{}</td></tr>",
            c.id,
            cell(c.race.error),
            c.race.passes,
            c.slope.map_or("–".to_owned(), |s| format!("{s:.2}")),
            cell(noise),
            bias,
            cell(c.k),
            target_time(c, options.target, scene),
        );
    }
    let _ = write!(
        page,
        "</table><p class=\"note\">Error: {}. ★ wins at equal time; pale rows overlap with it and \
         are too close to call.</p>",
        scene.measure
    );
}

fn target_time(c: &Contestant, target: f64, scene: &SceneSummary) -> String {
    // Only where errors are relative to a reference is the bias known.
    let bias = c.parts.zip(c.race.error).zip(c.runs.first());
    let floor = bias.and_then(|((parts, error), run)| {
        let rmse = run.points.last()?.rmse?;
        Some(parts.bias * error / rmse)
    });
    let never =
        scene.reference.is_some() && c.unseen.is_some() && c.bias_seen && floor > Some(target);
    match c.prediction {
        _ if never => "never: its bias is larger".to_owned(),
        Some(p) => duration(p.seconds),
        None => "–".to_owned(),
    }
}

fn layers(page: &mut String, scene: &SceneSummary) {
    let Some(first) = scene.integrators.iter().find(|c| c.layers.len() > 1) else {
        return;
    };
    page.push_str("<h3>Layer by layer: RMSE (bias)</h3><table><tr><th>integrator</th>");
    for layer in &first.layers {
        let _ = write!(page, "<th>{}</th>", escape(&layer.layer));
    }
    page.push_str("</tr>");
    for c in &scene.integrators {
        let _ = write!(page, "<tr><td>{}</td>", c.id);
        for l in &c.layers {
            let _ = write!(page, "<td>{} ({})</td>", figure(l.rmse), figure(l.bias));
        }
        page.push_str("</tr>");
    }
    page.push_str("<tr><td>reference's noise</td>");
    for l in &first.layers {
        let noise = l.reference_rmse.map_or("–".to_owned(), figure);
        let _ = write!(page, "<td>{noise}</td>");
    }
    page.push_str("</tr></table>");
}

fn notes(page: &mut String, scene: &SceneSummary) {
    page.push_str("<ul class=\"note\">");
    for c in &scene.integrators {
        let _ = write!(page, "<li><b>{}</b>: {}", c.id, escape(&c.parameters));
        if let Some(missing) = &c.missing {
            let _ = write!(page, ". It cannot find {}", escape(missing));
        }
        if let Some(unseen) = c.unseen {
            let _ = write!(page, ". Its estimated error is noise alone: {unseen}");
        }
        let late = c.curve.len().saturating_sub(5);
        let end = crate::engine::measure::convergence::fit(
            c.curve[late..].iter().map(|p| (p.pass as f64, p.error)),
        );
        let biased = c.unseen.is_some() && c.bias_seen;
        if biased && c.curve.len() > 5 && end.is_some_and(|e| e.slope > LEVEL) {
            let bias = c.parts.map_or("–".to_owned(), |p| figure(p.bias));
            let _ = write!(
                page,
                ". <b>It has levelled off at its bias</b>, an RMSE of {bias}"
            );
        }
        page.push_str(".</li>");
    }
    page.push_str("</ul>");
}

fn pictures(
    page: &mut String,
    options: &ReportOptions,
    store: &Store,
    scene: &SceneSummary,
    subject: &Subject,
) {
    let mut figure = |path: &std::path::Path, caption: &str| {
        if let Some(bytes) = store.read(path) {
            let data = STANDARD.encode(bytes);
            let _ = write!(
                page,
                "<figure><img alt=\"{0}\" src=\"data:image/png;base64,{data}\"><figcaption>{0}\
                 </figcaption></figure>",
                escape(caption)
            );
        }
    };
    if scene.reference.is_some() {
        figure(&store.reference_path(subject), "reference");
    }
    for c in &options.contestants {
        let key = Key::new(options, subject, c);
        figure(&store.image_path(&key, "picture"), c.0.id);
        if scene.reference.is_some() {
            let caption = format!("{}: relative error, 0 (dark) to {ERROR_SCALE}", c.0.id);
            figure(&store.image_path(&key, "error"), &caption);
        }
    }
}
