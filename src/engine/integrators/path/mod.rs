//! Path tracing (Kajiya 1986, *The Rendering Equation*), in three modes.
//!
//! `hits` waits until the walk meets a light. `kajiya` sends one shadow ray to every light at
//! each vertex and ignores the lights the walk meets behind a diffuse or glossy event. `mis`
//! sends one shadow ray to one light and weighs it against the walk's own hits by the power
//! heuristic (Veach 1997, section 9.2), event by event. All three scatter by one event at a
//! time, as Kajiya's roulette between k_diff and k_spec does, and all are unbiased; with lights
//! of zero size `hits` finds nothing and the others miss `LS.*E`.

mod direct;
mod walk;

use super::tiled::{SamplerKind, Tiled};
use super::{Entry, Integrator, Missing, ParamKind, ParamSpec, Params};
use crate::engine::scene::features::SceneFeatures;

/// Registry entry.
pub const ENTRY: Entry = Entry {
    id: "path",
    label: "Path tracing",
    summary: "Unbiased and robust; the choice for open and softly lit scenes. Slow for caustics \
              of small lights and for light behind doors.",
    params: PARAMS,
    missing,
    build,
};

const PARAMS: &[ParamSpec] = &[
    ParamSpec {
        name: "mode",
        kind: ParamKind::Choice(&["mis", "kajiya", "hits"]),
        default: "mis",
        unit: "",
        doc: "How lights are found: by shadow rays and hits weighed together, by a shadow ray to \
              every light, or by hits alone.",
    },
    ParamSpec {
        name: "sampler",
        kind: ParamKind::Choice(&["sobol", "independent"]),
        default: "sobol",
        unit: "",
        doc: "Owen-scrambled Sobol points, or independent random numbers.",
    },
    ParamSpec {
        name: "roulette",
        kind: ParamKind::Integer(0, 10_000_000),
        // Measured: one or two cost caustics of mirrors in a row a third, more than four the others.
        default: "4",
        unit: "events",
        doc: "Number of events after which Russian roulette may end a path.",
    },
];

/// How a walk finds light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    Mis,
    Kajiya,
    Hits,
}

/// The estimator behind the entry.
#[derive(Clone, Copy, Debug)]
struct PathTracer {
    mode: Mode,
    roulette: u32,
}

fn build(params: &Params) -> Box<dyn Integrator> {
    let mode = match params.choice("mode") {
        "hits" => Mode::Hits,
        "kajiya" => Mode::Kajiya,
        _ => Mode::Mis,
    };
    let sampler = match params.choice("sampler") {
        "independent" => SamplerKind::Independent,
        _ => SamplerKind::Sobol,
    };
    let roulette = u32::try_from(params.integer("roulette")).unwrap_or(u32::MAX);
    Box::new(Tiled::new(PathTracer { mode, roulette }, sampler))
}

fn missing(features: &SceneFeatures, params: &Params) -> Option<Missing> {
    if !features.zero_size_lights {
        return None;
    }
    if params.choice("mode") == "hits" {
        let why = "a walk never meets a light of zero size by chance";
        return Some(Missing { words: "L.*E", why });
    }
    let why = "light of a point, spot or directional source that first meets a mirror or glass \
               arrives by no shadow ray and by no chance hit";
    features.specular.then_some(Missing {
        words: "LS.*E",
        why,
    })
}
