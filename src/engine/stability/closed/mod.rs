//! Cases whose light is known in closed form.

mod furnace;
mod lamps;
mod media;
mod photons;
mod specular;
mod spheres;

use super::case::Case;

/// In the order of the table.
pub const CASES: &[&Case] = &[
    &furnace::OBJECT,
    &furnace::GGX,
    &spheres::INTEGRATING,
    &spheres::POINT,
    &lamps::FALLOFF,
    &lamps::DISK,
    &lamps::SMALL,
    &specular::CHAIN,
    &specular::SLAB,
    &specular::REFRACTION,
    &media::BEER,
    &media::SLAB,
    &media::HALF_SPACE,
    &media::FURNACE,
    &photons::POWER,
    &photons::LENS,
];
