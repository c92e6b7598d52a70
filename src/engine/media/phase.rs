//! Phase functions: where light goes that a medium scatters.
//!
//! Both directions point away from the point of scattering, as at surfaces; θ is the angle between
//! the direction of travel −wo and wi. All of them are symmetric and integrate to 1, so that they
//! are their own sampling densities.

use std::f32::consts::{FRAC_1_PI, TAU};

use glam::{Vec2, Vec3A};

use crate::engine::math::Frame;
use crate::engine::math::float::safe_sqrt;
use crate::engine::sampling::warp;
use crate::engine::scene::desc::media::PhaseDesc;

/// A phase function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// 1/4π.
    Isotropic,
    /// Henyey and Greenstein 1941.
    HenyeyGreenstein {
        /// Mean cosine, in (−1, 1).
        g: f32,
    },
    /// 3/16π (1 + cos²θ).
    Rayleigh,
}

impl From<PhaseDesc> for Phase {
    fn from(desc: PhaseDesc) -> Self {
        match desc {
            PhaseDesc::Isotropic => Self::Isotropic,
            PhaseDesc::HenyeyGreenstein { g } => Self::HenyeyGreenstein { g },
            PhaseDesc::Rayleigh => Self::Rayleigh,
        }
    }
}

impl Phase {
    /// Draws a direction by [`Phase::pdf`].
    #[inline]
    pub fn sample(&self, wo: Vec3A, u: Vec2) -> Vec3A {
        match *self {
            Self::Isotropic => warp::sample_sphere(u),
            Self::HenyeyGreenstein { g } => {
                let axis = if g < 0.0 { wo } else { -wo };
                around(axis, sample_henyey_greenstein(g.abs(), u.x), u.y)
            }
            Self::Rayleigh => around(-wo, 1.0 - sample_rayleigh(u.x), u.y),
        }
    }

    /// Share of the scattered light per solid angle that goes to `wi`, 1/sr.
    #[inline]
    pub fn pdf(&self, wo: Vec3A, wi: Vec3A) -> f32 {
        match *self {
            Self::Isotropic => warp::pdf_sphere(),
            Self::HenyeyGreenstein { g } => {
                // 1 − cosθ by the chord, so that nothing cancels at the peak.
                let axis = if g < 0.0 { wo } else { -wo };
                pdf_henyey_greenstein(g.abs(), 0.5 * (wi - axis).length_squared())
            }
            Self::Rayleigh => pdf_rayleigh(-wo.dot(wi)),
        }
    }
}

/// The direction at 1 − cosθ = `h` from `axis`, at the azimuth 2π `u`.
#[inline]
fn around(axis: Vec3A, h: f32, u: f32) -> Vec3A {
    let r = safe_sqrt(h * (2.0 - h)); // sinθ without cancellation
    let (sin, cos) = (TAU * u).sin_cos();
    Frame::from_normal(axis).to_world(Vec3A::new(r * cos, r * sin, 1.0 - h))
}

/// 1 − cosθ of the Henyey–Greenstein function for 0 ≤ g < 1. With s = (1 − g²)/(1 − g + 2gu) the
/// usual cosθ = (1 + g² − s²)/2g, rearranged so that neither g → 0 nor g → 1 cancels.
#[inline]
fn sample_henyey_greenstein(g: f32, u: f32) -> f32 {
    let below = (1.0 - g) + 2.0 * g * u;
    let s = (1.0 - g) * (1.0 + g) / below;
    ((1.0 - g) * (1.0 - u) * (s + (1.0 - g)) / below).min(2.0)
}

/// Density of [`sample_henyey_greenstein`] at 1 − cosθ = `h`, 1/sr.
#[inline]
fn pdf_henyey_greenstein(g: f32, h: f32) -> f32 {
    let square = (1.0 - g) * (1.0 - g) + 2.0 * g * h;
    0.25 * FRAC_1_PI * (1.0 - g) * (1.0 + g) / (square * square.sqrt())
}

/// cosθ of Rayleigh scattering: the real root of c³ + 3c = 8u − 4 by Cardano's formula, as
/// w − 1/w, which has no cancellation between cube roots (Frisvad 2011, *Importance Sampling the
/// Rayleigh Phase Function*).
#[inline]
fn sample_rayleigh(u: f32) -> f32 {
    let q = (4.0 * u - 2.0).abs();
    let w = (q + (q * q + 1.0).sqrt()).cbrt();
    (w - 1.0 / w).min(1.0).copysign(u - 0.5)
}

/// Density of [`sample_rayleigh`], 1/sr.
#[inline]
fn pdf_rayleigh(cos: f32) -> f32 {
    3.0 / 16.0 * FRAC_1_PI * (1.0 + cos * cos)
}
