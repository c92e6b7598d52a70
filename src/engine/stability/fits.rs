//! How integrators are set for cases, by what the scene asks of them.
//!
//! A case takes one of these tables and says itself where it departs from it.

use super::case::{ENGINE, Fit, Variant};

const fn with(name: &'static str, set: &'static [(&'static str, &'static str)]) -> Variant {
    Variant {
        name,
        set,
        bias: 0.0,
    }
}

const DEFAULT: Variant = with("", &[]);
/// A few chains from a small bootstrap: each run has its own, and the spread of runs shows its
/// error.
const CHAINS: Variant = with("few chains", &[("chains", "16"), ("bootstrap", "2048")]);
/// Maps that are built for nothing here, or bring little: small ones.
const SMALL_MAPS: Variant = with(
    "",
    &[
        ("global-photons", "1000"),
        ("caustic-photons", "1000"),
        ("volume-photons", "1000"),
    ],
);
const MIS: Variant = with("mis", &[("mode", "mis")]);
const KAJIYA: Variant = with("kajiya", &[("mode", "kajiya")]);
const HITS: Variant = with("hits", &[("mode", "hits")]);
const NO_ROULETTE: (&str, &str) = ("roulette", "10000000");
const HITS_SURE: Variant = with("hits", &[("mode", "hits"), NO_ROULETTE]);
/// One ray at every hit: its tree is a path.
const SINGLE: Variant = with("", &[("rays", "1"), ("depth", "16")]);

/// Asks a part of the engine and no integrator.
pub fn engine(id: &str) -> Fit {
    match id {
        ENGINE => Fit::Asked(&[DEFAULT]),
        _ => Fit::LeftOut("a part of the engine is asked, which all integrators share"),
    }
}

/// Only path tracing, for what all integrators share.
pub fn path_only(id: &str) -> Fit {
    match id {
        "path" => Fit::Asked(&[DEFAULT]),
        _ => Fit::LeftOut("what is asked is shared by all integrators; one is enough"),
    }
}

/// Path tracing in all its modes.
pub fn path_modes(id: &str) -> Fit {
    match id {
        "path" => Fit::Asked(&[MIS, KAJIYA, HITS]),
        _ => Fit::LeftOut("what is asked are the three ways in which path tracing finds light"),
    }
}

/// A diffuse object seen in a sky: every integrator finds LDE.
pub fn diffuse_in_sky(id: &str) -> Fit {
    match id {
        "path" => Fit::Asked(&[HITS, MIS, KAJIYA]),
        "monte-carlo" => Fit::Asked(&[SINGLE]),
        "pssmlt" => Fit::Asked(&[CHAINS]),
        "photon" => Fit::Asked(&[SMALL_MAPS]),
        ENGINE => Fit::LeftOut(""),
        _ => Fit::Asked(&[DEFAULT]),
    }
}

/// Words LS*E alone: mirrors and glass before a lamp or a sky.
pub fn specular_only(id: &str) -> Fit {
    match id {
        "path" => Fit::Asked(&[HITS_SURE, MIS]),
        "light" => Fit::LeftOut("it is blind to all that is seen in a mirror or through glass"),
        "monte-carlo" => Fit::LeftOut("its depth ends at 16 events"),
        "pssmlt" => Fit::Asked(&[CHAINS]),
        "photon" => Fit::Asked(&[SMALL_MAPS]),
        ENGINE => Fit::LeftOut(""),
        _ => Fit::Asked(&[DEFAULT]),
    }
}

/// A closed diffuse room, all of it seen: long words LD+E, lights with a surface.
pub fn closed_room(id: &str) -> Fit {
    match id {
        "path" => Fit::Asked(&[HITS, MIS, KAJIYA]),
        "monte-carlo" => Fit::Asked(&[SINGLE]),
        // Photons estimate over discs; on the inside of a sphere the disc cuts a cap.
        "photon" => Fit::Asked(&[FRESH_MAPS]),
        "sppm" => Fit::Asked(&[WIDE]),
        "vcm" => Fit::Asked(&[PROGRESSIVE]),
        "pssmlt" => Fit::Asked(&[CHAINS]),
        ENGINE => Fit::LeftOut(""),
        _ => Fit::Asked(&[DEFAULT]),
    }
}

/// The metric of its discs counts heights sixteen times: on a sphere of radius R that loses
/// 15 r²/(4R²) of the photons within r, at fifty of fifty thousand photons 2 %.
const FRESH_MAPS: Variant = Variant {
    name: "fresh maps",
    set: &[("fresh-maps", "on"), ("global-photons", "50000")],
    bias: 0.03,
};
/// Its few photons a pass need wide discs; a disc of radius r cuts a cap that is r²/4 wider.
const WIDE: Variant = Variant {
    name: "radius=0.2",
    set: &[("radius", "0.2")],
    bias: 0.02,
};
const PROGRESSIVE: Variant = Variant {
    bias: 0.01,
    ..DEFAULT
};

/// The same under a light of zero size.
pub fn closed_room_point(id: &str) -> Fit {
    match id {
        "path" => Fit::Asked(&[MIS, KAJIYA]),
        _ => closed_room(id),
    }
}

/// Direct light of a light of zero size on a diffuse surface, all of it seen.
pub fn direct_point(id: &str) -> Fit {
    match id {
        "path" => Fit::Asked(&[MIS, KAJIYA]),
        "monte-carlo" => Fit::Asked(&[SINGLE]),
        "pssmlt" => Fit::Asked(&[CHAINS]),
        "photon" => Fit::Asked(&[SMALL_MAPS]),
        ENGINE => Fit::LeftOut(""),
        _ => Fit::Asked(&[DEFAULT]),
    }
}

/// Direct light of a lamp on a spot that is seen through a telescope.
pub fn direct_narrow(id: &str) -> Fit {
    match id {
        "path" => Fit::Asked(&[MIS, KAJIYA]),
        "monte-carlo" => Fit::Asked(&[SINGLE]),
        "light" => Fit::LeftOut("no light path lands in so narrow a view by chance"),
        "pssmlt" => Fit::Asked(&[CHAINS]),
        "photon" => Fit::Asked(&[SMALL_MAPS]),
        ENGINE => Fit::LeftOut(""),
        _ => Fit::Asked(&[DEFAULT]),
    }
}

/// Media: those integrators that render them.
pub fn in_media(id: &str) -> Fit {
    match id {
        "path" => Fit::Asked(&[HITS_SURE, MIS]),
        "bdpt" => Fit::Asked(&[DEFAULT]),
        "light" => Fit::LeftOut("no light path lands in so narrow a view by chance"),
        "pssmlt" => Fit::LeftOut("it runs over bdpt, which is asked, and adds noise of its own"),
        "photon" => {
            Fit::LeftOut("the blur of its volume map has no closed form; its own tests bound it")
        }
        "vcm" => Fit::Asked(&[DEFAULT]),
        ENGINE => Fit::LeftOut(""),
        _ => Fit::LeftOut("it does not render participating media"),
    }
}

/// Caustics of a light of zero size on a diffuse screen.
pub fn caustic_point(id: &str) -> Fit {
    match id {
        "light" | "bdpt" | "vcm" => Fit::Asked(&[DEFAULT]),
        "sppm" => Fit::LeftOut(
            "a picture of 64 pixels has 64 photons a pass, too few to know a caustic by; vcm, which merges likewise, is asked",
        ),
        "photon" => Fit::LeftOut(
            "the blur of its discs has no closed form here; photon-power asks what it stores",
        ),
        "pssmlt" => Fit::Asked(&[CHAINS]),
        "path" | "monte-carlo" => {
            Fit::LeftOut("light of zero size that first meets glass arrives by no shadow ray")
        }
        "whitted" => Fit::LeftOut("it finds no caustics"),
        _ => Fit::LeftOut(""),
    }
}
