//! Origins of secondary rays, outside the error box of the surface they leave.

use glam::{DVec3, Vec3A};

/// `p` moved along ±`n_g`, to the side that `d` points to, until the plane through it clears the
/// box of half width `p_error`; rounded outward (*Physically Based Rendering*, 4th ed., 6.8.6).
///
/// No absolute distance enters: where `p` is exact the move is empty, and the intersection tests,
/// which decide the side in double precision, find `t` = 0 there.
#[inline]
pub fn offset_origin(p: Vec3A, p_error: Vec3A, n_g: Vec3A, d: Vec3A) -> Vec3A {
    let distance = n_g.abs().dot(p_error);
    let offset = if d.dot(n_g) < 0.0 {
        -distance * n_g
    } else {
        distance * n_g
    };
    let moved = p + offset;
    Vec3A::new(
        round_towards(moved.x, offset.x),
        round_towards(moved.y, offset.y),
        round_towards(moved.z, offset.z),
    )
}

/// Barycentric weights `b` moved towards the middle of the triangle until the point is at least
/// twice `p_error` from its edges; half way at most, where the triangle is no wider than that.
///
/// A point that rounding puts on an edge lies on the neighbour's plane, too, or behind it: a ray
/// that leaves it towards a wall it stands at would meet that wall at `t` ≤ 0 and slip out of the
/// room. `e1` and `e2` are the edges from the first corner.
#[inline]
pub fn inset(b: [f64; 3], e1: DVec3, e2: DVec3, cross: DVec3, p_error: Vec3A) -> [f64; 3] {
    let longest = e1.length_squared().max(e2.length_squared());
    let longest = longest.max((e2 - e1).length_squared());
    // The height over an edge is twice the area, |cross|, by its length.
    let error = p_error.as_dvec3().length_squared();
    let least = (4.0 * error * longest / cross.length_squared()).sqrt();
    if b[0].min(b[1]).min(b[2]) >= least {
        return b;
    }
    let least = least.min(1.0 / 6.0);
    b.map(|b| least + (1.0 - 3.0 * least) * b.max(0.0))
}

/// The neighbour of `x` in the direction of the sign of `by`.
#[inline]
fn round_towards(x: f32, by: f32) -> f32 {
    if by > 0.0 {
        x.next_up()
    } else if by < 0.0 {
        x.next_down()
    } else {
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clears_the_error_box_on_the_side_of_the_direction() {
        let n = Vec3A::new(0.6, -0.48, 0.64);
        for exponent in -20..=20 {
            let p = Vec3A::new(1.0, -3.0, 0.7) * 2.0_f32.powi(exponent);
            let error = p.abs() * 1e-6;
            for sign in [1.0, -1.0] {
                let moved = offset_origin(p, error, n, n * sign);
                let clearance =
                    f64::from(sign) * (moved.as_dvec3() - p.as_dvec3()).dot(n.as_dvec3());
                // The farthest corner of the box along the normal.
                let needed = error.as_dvec3().dot(n.abs().as_dvec3());
                assert!(clearance >= needed && clearance < 2.0 * needed);
            }
        }
    }

    #[test]
    fn an_exact_point_stays() {
        let p = Vec3A::new(1.0, 2.0, 0.0);
        let moved = offset_origin(p, Vec3A::new(1e-6, 1e-6, 0.0), Vec3A::Z, Vec3A::Z);
        assert_eq!(moved, p);
    }
}
