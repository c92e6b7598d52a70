//! Parameters of photon mapping.

use crate::engine::integrators::{ParamKind, ParamSpec, Params};
use crate::engine::photon::{Kernel, MapSettings, Numbers, Packing, Roulette, SplitRule};

/// How light with more than one diffuse event is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Indirect {
    /// From the global map where the eye looks.
    Direct,
    /// From both maps where gather rays end.
    Gather,
    /// As `Gather`, interpolated between few points.
    Cache,
}

/// All parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhotonSettings {
    /// How indirect light is found.
    pub indirect: Indirect,
    /// Show the caustic component.
    pub caustic_map: bool,
    /// Show the indirect component.
    pub global_map: bool,
    /// Photons stored in the caustic map, about.
    pub caustic_photons: usize,
    /// Photons stored in the global map, about.
    pub global_photons: usize,
    /// Show what photons in media bring.
    pub volume_map: bool,
    /// Photons stored in the volume map, about.
    pub volume_photons: usize,
    /// Radius of an estimate from the volume map, a share of the scene's radius; the largest at a
    /// point.
    pub volume_radius: f32,
    /// Whether it is read along whole rays, where the medium is homogeneous.
    pub volume_beams: bool,
    /// Photons of an estimate.
    pub nearest: usize,
    /// Largest radius of an estimate from the caustic map, a share of the scene's radius.
    pub caustic_radius: f32,
    /// Largest radius of an estimate from the global map, likewise.
    pub global_radius: f32,
    /// Weight of a photon by its distance.
    pub kernel: Kernel,
    /// Rays of a final gather.
    pub gather_rays: u32,
    /// Ward's error bound of interpolated gathers.
    pub cache_error: f32,
    /// Build new maps each pass, so that the picture averages over them.
    pub fresh_maps: bool,
    /// How photons are scattered.
    pub roulette: Roulette,
    /// How they are stored.
    pub packing: Packing,
    /// How the tree splits.
    pub split: SplitRule,
    /// Where the random numbers of photons come from.
    pub numbers: Numbers,
}

impl PhotonSettings {
    /// Reads checked parameters.
    pub fn new(params: &Params) -> Self {
        let count = |name| usize::try_from(params.integer(name)).unwrap_or(0);
        Self {
            indirect: match params.choice("indirect") {
                "gather" => Indirect::Gather,
                "cache" => Indirect::Cache,
                _ => Indirect::Direct,
            },
            caustic_map: params.switch("caustic-map"),
            global_map: params.switch("global-map"),
            caustic_photons: count("caustic-photons"),
            global_photons: count("global-photons"),
            volume_map: params.switch("volume-map"),
            volume_photons: count("volume-photons"),
            volume_radius: params.number("volume-radius") as f32,
            volume_beams: params.choice("volume-estimate") == "beam",
            nearest: count("nearest"),
            caustic_radius: params.number("caustic-radius") as f32,
            global_radius: params.number("global-radius") as f32,
            kernel: Kernel::find(params.choice("kernel")).unwrap_or_default(),
            gather_rays: count("gather-rays") as u32,
            cache_error: params.number("cache-error") as f32,
            fresh_maps: params.switch("fresh-maps"),
            roulette: match params.choice("roulette") {
                "lose" => Roulette::Lose,
                _ => Roulette::Keep,
            },
            packing: match params.choice("packing") {
                "full" => Packing::Full,
                _ => Packing::Packed,
            },
            split: match params.choice("split") {
                "cyclic" => SplitRule::Cyclic,
                _ => SplitRule::Widest,
            },
            numbers: match params.choice("sampler") {
                "sobol" => Numbers::Sobol,
                _ => Numbers::Independent,
            },
        }
    }

    /// What photons are made from, for the map number `index`; the number of photons is left to
    /// each map.
    pub(super) fn map(&self, seed: u64, index: u64) -> MapSettings {
        MapSettings {
            photons: 0,
            roulette: self.roulette,
            packing: self.packing,
            split: self.split,
            numbers: self.numbers,
            seed,
            index,
        }
    }
}

/// Most photons of a map: a gigabyte of them.
const MAX_PHOTONS: i64 = 50_000_000;

pub(super) const PARAMS: &[ParamSpec] = &[
    ParamSpec {
        name: "indirect",
        kind: ParamKind::Choice(&["direct", "gather", "cache"]),
        default: "direct",
        unit: "",
        matters: |_| true,
        doc: "How indirect light is found: from the global map where the eye looks, from both \
              maps where gather rays end, or by gathers at few points with interpolation between.",
    },
    ParamSpec {
        name: "caustic-map",
        kind: ParamKind::Switch,
        default: "on",
        unit: "",
        matters: |scene| scene.diffuse && (scene.specular || scene.glossy),
        doc: "Off blackens the caustic component; gather rays still read the map.",
    },
    ParamSpec {
        name: "global-map",
        kind: ParamKind::Switch,
        default: "on",
        unit: "",
        matters: |scene| scene.diffuse,
        doc: "Off blackens the indirect component.",
    },
    ParamSpec {
        name: "volume-map",
        kind: ParamKind::Switch,
        default: "on",
        unit: "",
        matters: |scene| scene.volume,
        doc: "Off blackens what photons in media bring; the map is then left unbuilt.",
    },
    ParamSpec {
        name: "volume-estimate",
        kind: ParamKind::Choice(&["beam", "point"]),
        default: "beam",
        unit: "",
        matters: |scene| scene.volume,
        doc: "How the volume map is read: along whole rays in homogeneous media, or at the places \
              where rays are scattered.",
    },
    ParamSpec {
        name: "volume-photons",
        kind: ParamKind::Integer(1, MAX_PHOTONS),
        default: "200000",
        unit: "photons",
        matters: |scene| scene.volume,
        doc: "Photons stored in the volume map, about.",
    },
    ParamSpec {
        name: "volume-radius",
        kind: ParamKind::Number(1e-6, 10.0),
        default: "0.01",
        unit: "of the scene's radius",
        matters: |scene| scene.volume,
        doc: "Radius of an estimate along a ray, and the largest at a point.",
    },
    ParamSpec {
        name: "caustic-photons",
        kind: ParamKind::Integer(1, MAX_PHOTONS),
        default: "200000",
        unit: "photons",
        matters: |scene| scene.diffuse && (scene.specular || scene.glossy),
        doc: "Photons stored in the caustic map, about.",
    },
    ParamSpec {
        name: "global-photons",
        kind: ParamKind::Integer(1, MAX_PHOTONS),
        default: "200000",
        unit: "photons",
        matters: |scene| scene.diffuse,
        doc: "Photons stored in the global map, about.",
    },
    ParamSpec {
        name: "nearest",
        kind: ParamKind::Integer(2, 10_000),
        default: "50",
        unit: "photons",
        matters: |_| true,
        doc: "Photons of an estimate: more of them blur more and are less noisy.",
    },
    ParamSpec {
        name: "caustic-radius",
        kind: ParamKind::Number(1e-6, 10.0),
        default: "0.02",
        unit: "of the scene's radius",
        matters: |scene| scene.diffuse && (scene.specular || scene.glossy),
        doc: "Largest radius of an estimate from the caustic map. Thin bright lines come out too \
              bright where `nearest` ends the search first: raise it and lower the radius.",
    },
    ParamSpec {
        name: "global-radius",
        kind: ParamKind::Number(1e-6, 10.0),
        default: "0.15",
        unit: "of the scene's radius",
        matters: |scene| scene.diffuse,
        doc: "Largest radius of an estimate from the global map.",
    },
    ParamSpec {
        name: "kernel",
        kind: ParamKind::Choice(&["box", "cone", "gaussian", "epanechnikov"]),
        default: "box",
        unit: "",
        matters: |_| true,
        doc: "How photons are weighed by their distance.",
    },
    ParamSpec {
        name: "gather-rays",
        kind: ParamKind::Integer(1, 100_000),
        default: "100",
        unit: "rays",
        matters: |_| true,
        doc: "Rays of a final gather.",
    },
    ParamSpec {
        name: "cache-error",
        kind: ParamKind::Number(0.01, 1.0),
        default: "0.2",
        unit: "",
        matters: |_| true,
        doc: "Error bound of interpolated gathers: smaller is more exact, with more records.",
    },
    ParamSpec {
        name: "fresh-maps",
        kind: ParamKind::Switch,
        default: "off",
        unit: "",
        matters: |_| true,
        doc: "On builds new maps each pass: their noise averages away, their bias stays.",
    },
    ParamSpec {
        name: "roulette",
        kind: ParamKind::Choice(&["keep", "lose"]),
        default: "keep",
        unit: "",
        matters: |_| true,
        doc: "Scattered photons keep their power and some of them die, or all live on and lose \
              power.",
    },
    ParamSpec {
        name: "sampler",
        kind: ParamKind::Choice(&["independent", "sobol"]),
        default: "independent",
        unit: "",
        matters: |_| true,
        doc: "Random numbers of the photons: independent, or Sobol points, which are less noisy \
              and up to half a photon in an estimate too dark.",
    },
    ParamSpec {
        name: "packing",
        kind: ParamKind::Choice(&["packed", "full"]),
        default: "packed",
        unit: "",
        matters: |_| true,
        doc: "Twenty bytes a photon, or full precision.",
    },
    ParamSpec {
        name: "split",
        kind: ParamKind::Choice(&["widest", "cyclic"]),
        default: "widest",
        unit: "",
        matters: |_| true,
        doc: "The tree splits along the longest side, or along x, y and z in turn.",
    },
];
