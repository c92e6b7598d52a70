//! Ray against triangle, watertight: Woop, Benthin and Wald 2013, *Watertight Ray/Triangle
//! Intersection*.
//!
//! Vertices are moved to the ray's origin and sheared so that the ray is the axis of largest
//! direction component; the edge functions then are 2D cross products. Neighbours compute the same
//! function of a shared edge from the same numbers with opposite sign, and f32 products round
//! monotonically: a sign is right or the function is 0. Four triangles are tested at once; what
//! may be a hit is decided again in f64, where the products are exact, so an edge function of 0 is
//! a ray through the (rounded) edge, which belongs to both neighbours.
//!
//! Distances come from the plane equation in f64, so that the side of the origin is decided
//! far below the rounding of f32 coordinates and no tolerance around `t` = 0 is needed.

use glam::{DVec3, Vec3A, Vec4};

use super::ray::{Hit, Ray};
use crate::engine::math::float::MACHINE_EPSILON;

/// Lanes of a block.
pub const LANES: usize = 4;

/// Vertices of up to four triangles, `vertices[corner][axis][lane]`, and their primitives.
/// Unused lanes are NaN, which no comparison accepts.
#[derive(Clone, Copy, Debug)]
pub struct TriangleBlock {
    vertices: [[Vec4; 3]; 3],
    prims: [u32; LANES],
}

/// A coordinate axis. Of this type, and not of a generic number: three copies of the traversal, of
/// which rays of all directions run all three, fill the instruction cache.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// The first.
    X,
    /// The second.
    Y,
    /// The third.
    Z,
}

impl Axis {
    /// The axis of the largest component of `d`.
    #[inline]
    pub fn dominant(d: Vec3A) -> Self {
        let a = d.abs();
        if a.x >= a.y && a.x >= a.z {
            Self::X
        } else if a.y >= a.z {
            Self::Y
        } else {
            Self::Z
        }
    }

    /// The two that follow in cyclic order.
    #[inline]
    fn others(self) -> (Self, Self) {
        match self {
            Self::X => (Self::Y, Self::Z),
            Self::Y => (Self::Z, Self::X),
            Self::Z => (Self::X, Self::Y),
        }
    }
}

/// A ray as the triangle test wants it.
#[derive(Clone, Copy, Debug)]
pub struct ShearedRay {
    /// The two axes after that of the largest component of the direction, and that.
    axes: [Axis; 3],
    /// Of the origin, by `axes`.
    origin: [Vec4; 3],
    shear_x: Vec4,
    shear_y: Vec4,
    /// −1 or 1, as the largest component of the direction is.
    sign: Vec4,
    /// The size of that component.
    dk: f32,
    pub(super) o: DVec3,
    pub(super) d: DVec3,
    inv_dk: f64,
    /// As in [`Ray`].
    clear_of: [u32; 2],
}

impl ShearedRay {
    /// Prepares `ray`.
    #[inline]
    pub fn new(ray: &Ray) -> Self {
        let (o, d) = (ray.o.to_array(), ray.d.to_array());
        let k = Axis::dominant(ray.d);
        let (x, y) = k.others();
        let axes = [x, y, k];
        let (x, y, z) = (x as usize, y as usize, k as usize);
        Self {
            axes,
            origin: [Vec4::splat(o[x]), Vec4::splat(o[y]), Vec4::splat(o[z])],
            shear_x: Vec4::splat(d[x] / d[z]),
            shear_y: Vec4::splat(d[y] / d[z]),
            sign: Vec4::splat(1.0_f32.copysign(d[z])),
            dk: d[z].abs(),
            o: ray.o.as_dvec3(),
            d: ray.d.as_dvec3(),
            inv_dk: 1.0 / f64::from(d[z]),
            clear_of: ray.clear_of,
        }
    }
}

/// One corner of four triangles: sheared x and y, and what it lies ahead along the dominant axis.
type Corner = (Vec4, Vec4, Vec4);

/// Widening of the distances that lanes are sorted out by: covers three roundings.
const REACH: f32 = 1.0 + 4.0 * MACHINE_EPSILON;

impl TriangleBlock {
    /// A block of at most four triangles.
    pub fn new(triangles: impl Iterator<Item = (u32, [Vec3A; 3])>) -> Self {
        let mut block = Self {
            vertices: [[Vec4::NAN; 3]; 3],
            prims: [u32::MAX; LANES],
        };
        for (lane, (prim, corners)) in triangles.take(LANES).enumerate() {
            block.prims[lane] = prim;
            for (stored, corner) in block.vertices.iter_mut().zip(corners) {
                for axis in 0..3 {
                    stored[axis][lane] = corner[axis];
                }
            }
        }
        block
    }

    /// Calls `found` for the triangles that `ray` meets at a distance in (0, `t_max`]. It returns
    /// the distance up to which more are wanted, and whether to stop, as does this.
    #[inline(always)]
    pub fn intersect(
        &self,
        ray: &ShearedRay,
        mut t_max: f32,
        mut found: impl FnMut(Hit) -> (f32, bool),
    ) -> bool {
        let corner = |i: usize| -> Corner {
            let v = &self.vertices[i];
            let [x, y, z] = ray.axes;
            let z = v[z as usize] - ray.origin[2];
            (
                (v[x as usize] - ray.origin[0]) - ray.shear_x * z,
                (v[y as usize] - ray.origin[1]) - ray.shear_y * z,
                z * ray.sign,
            )
        };
        let (a, b, c) = (corner(0), corner(1), corner(2));
        let edge = |p: Corner, q: Corner| p.0 * q.1 - p.1 * q.0;
        let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
        let front = u.min(v).min(w).cmpge(Vec4::ZERO);
        let back = u.max(v).max(w).cmple(Vec4::ZERO);
        // A line meets much that its ray does not: what lies behind, or farther than is wanted.
        // The sign of a difference is exact.
        let (nearest, farthest) = (a.2.min(b.2).min(c.2), a.2.max(b.2).max(c.2));
        let ahead = farthest.cmpgt(Vec4::ZERO);
        let near = nearest.cmple(Vec4::splat(t_max * ray.dk * REACH));
        let mut candidates = ((front | back) & ahead & near).bitmask();
        while candidates != 0 {
            let lane = candidates.trailing_zeros() as usize & (LANES - 1);
            candidates &= candidates - 1;
            // Where a ray begins or ends it passes the first test.
            if ray.clear_of.contains(&self.prims[lane]) {
                continue;
            }
            // Not by `map` over the corners, which is not inlined.
            let of_lane = |v: Vec4| f64::from(v.to_array()[lane]);
            let at = |p: Corner| (of_lane(p.0), of_lane(p.1));
            if let Some(hit) = self.decide(ray, lane, [at(a), at(b), at(c)], t_max) {
                let (closest, stop) = found(hit);
                if stop {
                    return true;
                }
                t_max = closest;
            }
        }
        false
    }

    /// The test of one lane in f64; `t` in (0, `t_max`].
    #[inline(never)]
    fn decide(
        &self,
        ray: &ShearedRay,
        lane: usize,
        [a, b, c]: [(f64, f64); 3],
        t_max: f32,
    ) -> Option<Hit> {
        // The vertices bound the distance.
        let corner = |i: usize| {
            let v = &self.vertices[i];
            DVec3::new(
                f64::from(v[0][lane]),
                f64::from(v[1][lane]),
                f64::from(v[2][lane]),
            )
        };
        let (p0, p1, p2) = (corner(0), corner(1), corner(2));
        let k = ray.axes[2] as usize;
        let o = f64::from(ray.origin[2].x);
        let depth = |i: usize| (f64::from(self.vertices[i][k][lane]) - o) * ray.inv_dk;
        let (z0, z1, z2) = (depth(0), depth(1), depth(2));
        // Vertices are numbers: the comparisons need not look for NaN, as `max` does.
        let greater = |a: f64, b: f64| if a > b { a } else { b };
        let less = |a: f64, b: f64| if a < b { a } else { b };
        let (t_far, t_near) = (greater(greater(z0, z1), z2), less(less(z0, z1), z2));
        if !(t_far > 0.0 && t_near <= f64::from(t_max)) {
            return None;
        }

        // Edge functions of f32 coordinates: the products are exact, hence the signs.
        let edge = |p: (f64, f64), q: (f64, f64)| p.0 * q.1 - p.1 * q.0;
        let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let det = u + v + w;
        if det == 0.0 {
            return None;
        }

        // A triangle seen edge on has no accurate plane distance but still bounds it.
        let n = (p1 - p0).cross(p2 - p0);
        let t = (n.dot(p0 - ray.o) / n.dot(ray.d)).clamp(t_near, t_far) as f32;
        // NaN, from a ray in the plane, is no hit.
        if t > 0.0 && t <= t_max {
            Some(Hit {
                t,
                prim: self.prims[lane],
                u: (v / det) as f32,
                v: (w / det) as f32,
            })
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lanes are sorted out by distances in `f32`, where what is met is decided in `f64`: at the end
    /// of a ray both must say the same.
    #[test]
    fn a_triangle_across_the_ray_is_met_up_to_its_very_end() {
        let mut met = 0;
        for (exponent, step) in (-30..=30).flat_map(|e| (1..40).map(move |step| (e, step))) {
            let scale = 2.0_f32.powi(exponent);
            let (o, z) = (0.37 * scale, scale * (1.0 + 0.026 * step as f32));
            for (axis, sign) in (0..3).flat_map(|axis| [(axis, 1.0), (axis, -1.0)]) {
                let at = |x: f32, y: f32, z: f32| {
                    let mut p = [0.0; 3];
                    (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (z, x, y);
                    Vec3A::from(p)
                };
                let far = 9.0 * scale;
                let corners = [at(-far, -far, z), at(far, -far, z), at(0.0, far, z)];
                let block = TriangleBlock::new(std::iter::once((7, corners)));
                let slant = 0.02 * step as f32;
                let d = at(slant, -0.5 * slant, sign).normalize();
                let mut ray = Ray::new(at(0.0, 0.0, sign * o), d);
                let meets = |ray: &Ray| {
                    let mut hit = None;
                    block.intersect(&ShearedRay::new(ray), ray.t_max, |h| {
                        hit = Some(h.t);
                        (h.t, true)
                    });
                    hit
                };
                let Some(t) = meets(&ray) else {
                    assert!(sign < 0.0, "in front, and missed: {ray:?}");
                    continue;
                };
                assert!(sign > 0.0, "behind, and met: {ray:?}");
                ray.t_max = t.next_up();
                assert_eq!(meets(&ray), Some(t));
                ray.t_max = t.next_down();
                assert_eq!(meets(&ray), None);
                met += 1;
            }
        }
        assert_eq!(met, 61 * 39 * 3);
    }
}
