//! Path tracing (Kajiya 1986, *The Rendering Equation*), in three modes.
//!
//! `hits` waits until the walk meets a light. `kajiya` sends one shadow ray to every light at
//! each vertex and ignores the lights the walk meets behind a diffuse or glossy event. `mis`
//! sends one shadow ray to one light and weighs it against the walk's own hits by the power
//! heuristic (Veach 1997, section 9.2), event by event. All three scatter by one event at a
//! time, as Kajiya's roulette between k_diff and k_spec does, and all are unbiased; with lights
//! of zero size `hits` finds nothing and the others miss `LS.*E`.

mod direct;
mod equiangular;
mod gather;
mod glow;
mod part;
mod volume;
mod walk;

pub(super) use direct::turned;
pub(super) use gather::Gather;
pub(super) use walk::Walk;

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
    media: true,
    build,
};

const PARAMS: &[ParamSpec] = &[
    MODE_PARAM,
    super::SAMPLER_PARAM,
    ParamSpec {
        name: "roulette",
        kind: ParamKind::Integer(0, 10_000_000),
        // Measured: one or two cost caustics of mirrors in a row a third, more than four the others.
        default: "4",
        unit: "events",
        matters: |_| true,
        doc: "Number of events after which Russian roulette may end a path.",
    },
    ParamSpec {
        name: "equiangular",
        kind: ParamKind::Choice(&["on", "off"]),
        default: "on",
        unit: "",
        matters: |scene| scene.volume,
        doc: "In homogeneous media, one more place on each flight where light is looked for, near \
              the light (Kulla and Fajardo 2012).",
    },
];

/// How lights are found.
pub(super) const MODE_PARAM: ParamSpec = ParamSpec {
    name: "mode",
    kind: ParamKind::Choice(&["mis", "kajiya", "hits"]),
    default: "mis",
    unit: "",
    matters: |_| true,
    doc: "How lights are found: by shadow rays and hits weighed together, by a shadow ray to \
          every light, or by hits alone.",
};

/// How a walk finds light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    Mis,
    Kajiya,
    Hits,
}

/// The estimator behind the entry.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathTracer {
    mode: Mode,
    roulette: u32,
    equiangular: bool,
}

impl Mode {
    /// What the parameter `mode` says.
    pub(super) fn of(params: &Params) -> Self {
        match params.choice("mode") {
            "hits" => Self::Hits,
            "kajiya" => Self::Kajiya,
            _ => Self::Mis,
        }
    }
}

impl PathTracer {
    /// For those whose walks through media end at places of their own.
    pub(super) fn for_gathering(roulette: u32) -> Self {
        Self {
            mode: Mode::Mis,
            roulette,
            equiangular: true,
        }
    }

    /// For those who take its estimates at single vertices.
    pub(super) fn of_mode(mode: Mode) -> Self {
        Self {
            mode,
            roulette: 0,
            equiangular: false,
        }
    }
}

fn build(params: &Params) -> Box<dyn Integrator> {
    let mode = Mode::of(params);
    let sampler = SamplerKind::of(params);
    let roulette = u32::try_from(params.integer("roulette")).unwrap_or(u32::MAX);
    let equiangular = params.choice("equiangular") == "on";
    let tracer = PathTracer {
        mode,
        roulette,
        equiangular,
    };
    Box::new(Tiled::new(tracer, sampler))
}

/// Words that neither shadow rays nor hits find.
pub(super) fn missing(features: &SceneFeatures, params: &Params) -> Option<Missing> {
    if !features.zero_size_lights {
        return None;
    }
    if params.choice("mode") == "hits" {
        let why = "a walk never meets a light of zero size by chance";
        return Some(Missing {
            words: "L.*E".into(),
            why: why.into(),
        });
    }
    let why = "light of a point, spot or directional source that first meets a mirror or glass \
               arrives by no shadow ray and by no chance hit";
    features.specular.then_some(Missing {
        words: "LS.*E".into(),
        why: why.into(),
    })
}
