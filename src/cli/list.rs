//! `lightscope list`: what there is to choose from.

use serde::Serialize;

use super::args::{ListArgs, Listing};
use super::error::CliError;
use super::{print, scene};
use crate::engine::integrators::{Entry, Missing, ParamKind, ParamSpec, Params, REGISTRY};
use crate::engine::scene::SceneFeatures;
use crate::engine::stability::case::ENGINE;
use crate::engine::stability::{self, Case, Fit};

/// Runs the command.
pub fn run(args: &ListArgs) -> Result<(), CliError> {
    match args.what {
        Listing::Scenes => show(&scene::listed()?, args.json, |_| Vec::new()),
        Listing::Integrators => {
            let rows: Vec<Row> = REGISTRY.iter().map(integrator).collect();
            show(&rows, args.json, details)
        }
        Listing::Cases => {
            let rows: Vec<Row> = stability::cases().into_iter().map(case).collect();
            show(&rows, args.json, |row| {
                let oracle = row.oracle.iter().map(|o| format!("right is: {o}"));
                let asked = row.asked.iter().map(|a| format!("asks {}", a.join(", ")));
                oracle.chain(asked).collect()
            })
        }
    }
}

/// One thing to choose.
#[derive(Serialize)]
pub struct Row {
    /// What is typed.
    pub id: String,
    /// What is read.
    pub label: String,
    /// One sentence.
    pub summary: String,
    /// Parameters, of integrators only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub params: Option<Vec<Param>>,
    /// Words that cannot be found, of integrators only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub missing: Option<Vec<MissingWords>>,
    /// Whether scenes with participating media can be rendered, of integrators only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub media: Option<bool>,
    /// The right answer, of cases only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub oracle: Option<&'static str>,
    /// What is asked, of cases only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub asked: Option<Vec<&'static str>>,
}

/// A parameter.
#[derive(Serialize)]
pub struct Param {
    name: &'static str,
    range: String,
    default: &'static str,
    unit: &'static str,
    doc: &'static str,
}

/// Words that an integrator cannot find.
#[derive(Serialize)]
pub struct MissingWords {
    /// In which scenes, with which parameters.
    when: String,
    words: String,
    why: String,
}

fn show(rows: &[Row], json: bool, details: impl Fn(&Row) -> Vec<String>) -> Result<(), CliError> {
    if json {
        return print::json(&rows);
    }
    let width = rows.iter().map(|row| row.id.len()).max().unwrap_or(0);
    for row in rows {
        print::line(&format!(
            "{:width$}  {}: {}",
            row.id, row.label, row.summary
        ))?;
        for detail in details(row) {
            print::line(&format!("{:width$}    {detail}", ""))?;
        }
    }
    Ok(())
}

fn details(row: &Row) -> Vec<String> {
    let params = row.params.iter().flatten().map(|p| {
        format!(
            "--set {}=…  {} (default {}). {}",
            p.name, p.range, p.default, p.doc
        )
    });
    let missing = row
        .missing
        .iter()
        .flatten()
        .map(|m| format!("cannot find {} with {}: {}", m.words, m.when, m.why));
    let media = match row.media {
        Some(false) => Some("does not render participating media".to_owned()),
        _ => None,
    };
    params.chain(missing).chain(media).collect()
}

fn integrator(entry: &Entry) -> Row {
    Row {
        id: entry.id.to_owned(),
        label: entry.label.to_owned(),
        summary: entry.summary.to_owned(),
        params: Some(entry.params.iter().map(param).collect()),
        missing: Some(missing(entry)),
        media: Some(entry.media),
        oracle: None,
        asked: None,
    }
}

fn case(case: &Case) -> Row {
    let ids = std::iter::once(ENGINE).chain(REGISTRY.iter().map(|e| e.id));
    let asked = ids.filter(|id| matches!((case.fit)(id), Fit::Asked(_)));
    Row {
        id: case.id.to_owned(),
        label: case.label.to_owned(),
        summary: case.summary.to_owned(),
        params: None,
        missing: None,
        media: None,
        oracle: Some(case.oracle),
        asked: Some(asked.collect()),
    }
}

fn param(spec: &ParamSpec) -> Param {
    Param {
        name: spec.name,
        range: spec.range(),
        default: spec.default,
        unit: spec.unit,
        doc: spec.doc,
    }
}

/// What the integrator loses in any scene, where a light has no size, and where there is a sky: with
/// its defaults, then with each word of a choice that makes a difference.
fn missing(entry: &Entry) -> Vec<MissingWords> {
    let any = SceneFeatures {
        diffuse: true,
        glossy: true,
        specular: true,
        hittable_lights: true,
        ..SceneFeatures::default()
    };
    let zero_size = SceneFeatures {
        zero_size_lights: true,
        ..any
    };
    let sky = SceneFeatures {
        environment: true,
        ..any
    };
    let defaults = Params::defaults(entry.params);
    let always = |params: &Params| (entry.missing)(&any, params);
    let mut rows: Vec<MissingWords> = Vec::new();
    let mut add = |when: String, lost: Option<Missing>| {
        rows.extend(lost.map(|m| MissingWords {
            when,
            words: m.words.into_owned(),
            why: m.why.into_owned(),
        }));
    };
    for (when, features) in [
        ("any lights", any),
        ("lights of zero size", zero_size),
        ("a sky", sky),
    ] {
        // What is lost under any lights is not said again.
        let is_first = features == any;
        let news = |params: &Params| {
            let lost = (entry.missing)(&features, params);
            lost.filter(|m| is_first || always(params).as_ref() != Some(m))
        };
        let usual = news(&defaults);
        add(when.to_owned(), usual.clone());
        for spec in entry.params {
            let words: &[&str] = match spec.kind {
                ParamKind::Choice(words) => words,
                ParamKind::Switch => &["on", "off"],
                _ => continue,
            };
            for word in words {
                let mut params = defaults.clone();
                if params.set(entry.params, spec.name, word).is_err() {
                    continue;
                }
                let lost = news(&params).filter(|m| usual.as_ref() != Some(m));
                add(format!("{when} and {}={word}", spec.name), lost);
            }
        }
    }
    rows
}
