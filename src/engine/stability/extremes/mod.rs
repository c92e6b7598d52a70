//! Cases at the ends of what numbers hold, and what must hold there.

mod film;
mod jobs;
mod light_range;
mod lights;
mod photons;
mod rays;
mod scattering;
mod space;
mod threads;
mod vertices;
mod volume;

use super::case::Case;

/// In the order of the table.
pub const CASES: &[&Case] = &[
    &space::SCALE,
    &space::TRANSLATE,
    &space::TELEPHOTO,
    &rays::AXIS,
    &rays::WATERTIGHT,
    &rays::DEGENERATE,
    &rays::COINCIDENT,
    &rays::THIN,
    &vertices::NORMALS,
    &light_range::RANGE,
    &lights::TOUCHING,
    &lights::UNSAMPLEABLE,
    &scattering::GGX,
    &scattering::IOR,
    &scattering::ENDS,
    &vertices::NEAR,
    &vertices::METROPOLIS,
    &volume::MEDIUM,
    &photons::TREE,
    &photons::ESTIMATE,
    &photons::CACHE,
    &film::ACCUMULATE,
    &film::ROULETTE,
    &jobs::SIZES,
    &jobs::EMPTY,
    &threads::THREADS,
    &jobs::LAYERS,
];
