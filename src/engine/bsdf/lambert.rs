//! Diffuse reflection at a surface whose shading normal is its geometric one: the quick way to what
//! [`Lobe::Lambert`](super::Lobe::Lambert) says there.

use std::f32::consts::FRAC_1_PI;

use glam::{Vec2, Vec3A};

use crate::engine::math::Frame;
use crate::engine::sampling::warp::sample_cosine_hemisphere;

/// A direction on the side of `wo`, and its density in 1/sr. `None` if either lies in the surface.
#[inline]
pub(super) fn sample(n: Vec3A, wo: Vec3A, u: Vec2) -> Option<(Vec3A, f32)> {
    let outside = n.dot(wo) > 0.0;
    let frame = Frame::from_normal(if outside { n } else { -n });
    let wi = frame.to_world(sample_cosine_hemisphere(u));
    // Rounding may have put it behind.
    let wi = if (n.dot(wi) > 0.0) == outside {
        wi
    } else {
        -wi
    };
    let (pdf, _) = pdf_both_ways(n, wo, wi)?;
    Some((wi, pdf))
}

/// |cosθ|/π in 1/sr of `wi` and of `wo`; `None` where one lies in the surface, or they lie on
/// different sides.
#[inline]
pub(super) fn pdf_both_ways(n: Vec3A, wo: Vec3A, wi: Vec3A) -> Option<(f32, f32)> {
    let (cos_o, cos_i) = (n.dot(wo), n.dot(wi));
    let pdf = |cos: f32| cos.abs().min(1.0) * FRAC_1_PI;
    // A comparison that refuses NaN, too.
    let same_side = (cos_o > 0.0 && cos_i > 0.0) || (cos_o < 0.0 && cos_i < 0.0);
    same_side.then(|| (pdf(cos_i), pdf(cos_o)))
}
