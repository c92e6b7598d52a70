//! Scattering at a surface, one event at a time.
//!
//! A [`Bsdf`] is a short list of lobes with weights. Its lobes are grouped into events as
//! rule 1 of the code map has it: all diffuse lobes are one event, all microfacet lobes are one, each
//! delta lobe is one of its own. P(event | point, wo) sums to 1 over the events, is greater than
//! 0 wherever the event's f is, and depends on nothing else.
//!
//! All directions are unit vectors in world space that point away from the surface; `wo` is the
//! direction already known (toward the eye in a camera walk, toward the light in a light walk),
//! `wi` the one to find or to evaluate.

mod fresnel;
mod ggx;
mod lambert;
mod lobe;
mod scatter;
mod shares;
mod view;

pub use fresnel::mean_transmittance;
pub use ggx::MIN_ALPHA;
pub use lobe::Lobe;
pub use scatter::{Bsdf, BsdfSample, Evaluation, MAX_LOBES};

/// Which quantity travels along the path being built: decides the direction of non-symmetric
/// scattering, which is the 1/η² of refraction and shading normals (Veach 1997, chapter 5).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// A camera walk.
    Radiance,
    /// A light walk.
    Importance,
}
