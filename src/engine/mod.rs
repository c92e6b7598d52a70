//! The renderer core. It knows nothing of windows, prints nothing and reads no files outside `io`.
//!
//! A module uses only what stands before it in this list:
//! math < sampling < geometry < {bsdf, light, media, camera} < scene < path < photon < plan <
//! {film, integrators} < session < measure < stability. `io` uses `scene::desc` only.

pub mod bsdf;
pub mod camera;
pub mod event;
pub mod film;
pub mod geometry;
pub mod integrators;
pub mod io;
pub mod light;
pub mod math;
pub mod measure;
pub mod media;
pub mod path;
pub mod photon;
pub mod plan;
pub mod sampling;
pub mod scene;
pub mod session;
pub mod stability;
