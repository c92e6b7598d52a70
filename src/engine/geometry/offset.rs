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

/// The point `p` of barycentric weights `b`, moved within its triangle until it is at least four
/// times `p_error` from each edge, or a quarter of the height over it where that is less. Rounding
/// moves a point by `p_error`, and what [`offset_origin`] adds to each coordinate by twice as much.
///
/// A point that rounding puts on an edge lies on the neighbour's plane, too, or behind it: a ray
/// that leaves it towards a wall it stands at would meet that wall at `t` ≤ 0 and slip out of the
/// room. `e1` and `e2` are the edges from the first corner, `cross` is e1 × e2.
#[inline]
pub fn inset(p: DVec3, b: [f64; 3], [e1, e2, cross]: [DVec3; 3], p_error: Vec3A) -> DVec3 {
    let least2 = 16.0 * p_error.as_dvec3().length_squared();
    // The height over an edge is twice the area, |cross|, by its length; the longest edge is no
    // longer than the others together.
    let longest2 = 2.0 * (e1.length_squared() + e2.length_squared());
    let (cross2, needed) = (cross.length_squared(), least2 * longest2);
    let clear = |b: f64| b > 0.0 && b * b * cross2 >= needed;
    if clear(b[0]) && clear(b[1]) && clear(b[2]) {
        return p;
    }
    inset_by(p, b, [e1, e2, cross], least2.sqrt())
}

/// Where a point is near an edge: few are.
#[cold]
fn inset_by(p: DVec3, b: [f64; 3], [e1, e2, cross]: [DVec3; 3], least: f64) -> DVec3 {
    let mut moved = p;
    for (weight, edge) in b.into_iter().zip([e2 - e1, -e2, e1]) {
        let inward = cross.cross(edge);
        let height = cross.length() / edge.length();
        let missing = least.min(0.25 * height) - weight * height;
        if missing > 0.0 {
            moved += missing * inward.normalize();
        }
    }
    moved
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
    fn points_at_edges_move_inward_and_no_farther_than_needed() {
        let (e1, e2) = (DVec3::new(1e4, 0.0, 0.0), DVec3::new(0.0, 2.0, 0.0));
        let triangle = [e1, e2, e1.cross(e2)];
        let error = Vec3A::splat(1e-3);
        let least = 4e-3 * 3.0_f64.sqrt();
        // On each edge, in each corner, beyond an edge by rounding, inside.
        for (u, v) in [
            (0.5, 0.0),
            (0.0, 0.5),
            (0.5, 0.5),
            (0.0, 0.0),
            (1.0, 0.0),
            (0.0, 1.0),
            (0.3, -1e-9),
            (0.25, 0.25),
            (1e-8, 0.3),
        ] {
            let p = u * e1 + v * e2;
            let moved = inset(p, [1.0 - u - v, u, v], triangle, error);
            let [x, y] = [moved.x, moved.y];
            let to_slope = (1e4 - x - 5e3 * y) / (1.0_f64 + 5e3_f64.powi(2)).sqrt();
            let corner = u == 1.0 || v == 1.0;
            let needed = if corner { 0.0 } else { 0.999 * least };
            assert!(x >= needed && y >= needed && to_slope >= needed, "{moved}");
            assert!(moved.distance(p) < 2.0 * least, "{moved}");
        }
        let inside = DVec3::new(2e3, 0.5, 0.0);
        assert_eq!(inset(inside, [0.55, 0.2, 0.25], triangle, error), inside);
    }

    #[test]
    fn an_exact_point_stays() {
        let p = Vec3A::new(1.0, 2.0, 0.0);
        let moved = offset_origin(p, Vec3A::new(1e-6, 1e-6, 0.0), Vec3A::Z, Vec3A::Z);
        assert_eq!(moved, p);
    }
}
