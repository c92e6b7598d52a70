//! Microfacets of the GGX distribution (Walter et al. 2007, *Microfacet Models for Refraction
//! through Rough Surfaces*) with separable Smith shadowing, in local coordinates: the normal is
//! +z and `wo` lies above the surface.

use std::f32::consts::{FRAC_1_PI, PI};

use glam::{Vec2, Vec3A};

use super::Transport;
use super::fresnel::Interface;
use crate::engine::math::float::safe_sqrt;

/// The smallest roughness that `f32` directions resolve: their components carry errors of about
/// 1e-7, a thousandth of this. Smaller values other than 0 are raised to it.
pub const MIN_ALPHA: f32 = 1e-4;

/// Density of facet normals D(m) per solid angle and projected area, 1/sr (Walter 2007, eq. 33).
/// With sin² from the components of `m` nothing cancels at small α:
/// cos²(α² − 1) + 1 = sin² + α² cos².
#[inline]
fn distribution(alpha: f32, m: Vec3A) -> f32 {
    let (x, y) = (m.x / alpha, m.y / alpha);
    let k = alpha * (x * x + y * y + m.z * m.z);
    FRAC_1_PI / (k * k)
}

/// G1(w)/|cosθ| = 2 / (|cosθ| + √(cos² + α² sin²)), finite at grazing angles
/// (Walter 2007, eq. 34).
#[inline]
fn shadowing_over_cos(alpha: f32, w: Vec3A) -> f32 {
    let (x, y) = (alpha * w.x, alpha * w.y);
    2.0 / (w.z.abs() + (w.z * w.z + x * x + y * y).sqrt())
}

/// The share G1(w) of the microsurface that is seen from `w`.
#[inline]
fn shadowing(alpha: f32, w: Vec3A) -> f32 {
    // G1 at normal incidence is 1; rounding must not create energy.
    (w.z.abs() * shadowing_over_cos(alpha, w)).min(1.0)
}

/// A facet normal with density G1(wo) D(m) (wo·m)/cosθo, that of the normals visible from `wo`
/// (Dupuy and Benyoub 2023, *Sampling Visible GGX Normals with Spherical Caps*).
#[inline]
pub fn sample_visible_normal(alpha: f32, wo: Vec3A, u: Vec2) -> Vec3A {
    let stretched = Vec3A::new(alpha * wo.x, alpha * wo.y, wo.z).normalize();
    // A point of the cap z > −stretched.z; h is the height of the sum of point and direction, so
    // that a narrow cap loses no digits.
    let h = (1.0 - u.y) * (1.0 + stretched.z);
    let sin = safe_sqrt((1.0 + stretched.z) * u.y * (1.0 - stretched.z + h));
    let (sin_phi, cos_phi) = (2.0 * PI * u.x).sin_cos();
    let (x, y) = (sin * cos_phi + stretched.x, sin * sin_phi + stretched.y);
    Vec3A::new(alpha * x, alpha * y, h).normalize()
}

/// Samples the reflection; None if it points below the surface.
#[inline]
pub fn sample_reflection(alpha: f32, wo: Vec3A, u: Vec2) -> Option<Vec3A> {
    reflect(wo, sample_visible_normal(alpha, wo, u))
}

/// f·cosθi of reflection with Fresnel factor 1 and its density by visible normals, both 1/sr.
#[inline]
pub fn reflection(alpha: f32, wo: Vec3A, wi: Vec3A) -> (f32, f32) {
    let m = (wo + wi).normalize();
    // Density D G1(wo) (wo·m)/cosθo of the normal, over the Jacobian 4 (wo·m) (Walter, eq. 14).
    let pdf = 0.25 * distribution(alpha, m) * shadowing_over_cos(alpha, wo);
    (pdf * shadowing(alpha, wi), pdf)
}

/// Samples reflection or transmission by the Fresnel factor at the sampled facet; `u_lobe`
/// decides. None if the direction lies on the wrong side of the surface.
#[inline]
pub fn sample_dielectric(
    alpha: f32,
    interface: Interface,
    wo: Vec3A,
    u_lobe: f32,
    u: Vec2,
) -> Option<Vec3A> {
    let m = sample_visible_normal(alpha, wo, u);
    let (r, _) = interface.fresnel(wo.dot(m).clamp(0.0, 1.0));
    if u_lobe < r {
        return reflect(wo, m);
    }
    interface.refract(wo, m).filter(|wi| wi.z < 0.0)
}

/// f·|cosθi| of the rough dielectric and its density, both 1/sr: reflection for `wi` above the
/// surface (Walter 2007, eq. 20), transmission below (eq. 21).
#[inline]
pub fn dielectric(
    alpha: f32,
    interface: Interface,
    wo: Vec3A,
    wi: Vec3A,
    transport: Transport,
) -> (f32, f32) {
    if wi.z > 0.0 {
        let cos = wo.dot((wo + wi).normalize()).clamp(0.0, 1.0);
        let (r, _) = interface.fresnel(cos);
        let (f, pdf) = reflection(alpha, wo, wi);
        return (r * f, r * pdf);
    }
    let eta = interface.eta();
    let h = wo + wi * eta;
    let length_sq = h.length_squared();
    if length_sq == 0.0 {
        return (0.0, 0.0);
    }
    let m = h * (1.0_f32.copysign(h.z) / length_sq.sqrt());
    let (cos_o, cos_i) = (wo.dot(m), wi.dot(m));
    if cos_o <= 0.0 || cos_i >= 0.0 {
        return (0.0, 0.0);
    }
    let t = interface.transmittance(cos_o, -cos_i);
    // The Jacobian η²|wi·m| / (wo·m + η wi·m)² (eq. 17), whose denominator is |h|².
    let visible = distribution(alpha, m) * shadowing_over_cos(alpha, wo) * cos_o;
    let pdf_over_eta_sq = visible * t * (-cos_i / length_sq);
    let pdf = eta * eta * pdf_over_eta_sq;
    let scale = match transport {
        Transport::Radiance => pdf_over_eta_sq,
        Transport::Importance => pdf,
    };
    (scale * shadowing(alpha, wi), pdf)
}

#[inline]
fn reflect(wo: Vec3A, m: Vec3A) -> Option<Vec3A> {
    let wi = (m * (2.0 * wo.dot(m)) - wo).normalize();
    (wi.z > 0.0).then_some(wi)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::math::float::ONE_MINUS_EPSILON;

    #[test]
    fn matches_the_textbook_formula() {
        for alpha in [0.01_f32, 0.1, 0.5, 1.0] {
            for i in 1..100 {
                let theta = f64::from(i) * 0.0157;
                let m = Vec3A::new(theta.sin() as f32, 0.0, theta.cos() as f32);
                let (a, c) = (f64::from(alpha), f64::from(m.z));
                let s2 = f64::from(m.x).powi(2);
                // The length of the rounded vector enters the textbook form through 1 − cos².
                let k = s2 + a * a * c * c;
                let d = a * a / (std::f64::consts::PI * k * k);
                assert!((f64::from(distribution(alpha, m)) / d - 1.0).abs() < 1e-5);
                let g1 = 2.0 / (1.0 + (1.0 + a * a * s2 / (c * c)).sqrt());
                assert!((f64::from(shadowing(alpha, m)) / g1 - 1.0).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn stays_finite_at_every_extreme() {
        let us = [0.0, f32::MIN_POSITIVE, 0.5, ONE_MINUS_EPSILON];
        for alpha in [MIN_ALPHA, 1e-2, 1.0] {
            for cos in [1.0_f32, 0.5, 1e-3, 1e-7, 1e-20, 0.0] {
                let wo = Vec3A::new((1.0 - cos * cos).sqrt(), 0.0, cos);
                for (x, y) in us.iter().flat_map(|&x| us.map(|y| (x, y))) {
                    let m = sample_visible_normal(alpha, wo, Vec2::new(x, y));
                    assert!(m.is_finite() && m.z > 0.0 && m.is_normalized(), "{m}");
                    let Some(wi) = sample_reflection(alpha, wo, Vec2::new(x, y)) else {
                        continue;
                    };
                    let (f, pdf) = reflection(alpha, wo, wi);
                    assert!(f.is_finite() && pdf.is_finite() && f <= pdf, "{f} {pdf}");
                }
            }
        }
    }
}
