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

/// Lanes of a block.
pub const LANES: usize = 4;

/// Vertices of up to four triangles, `vertices[corner][axis][lane]`, and their primitives.
/// Unused lanes are NaN, which no comparison accepts.
#[derive(Clone, Copy, Debug)]
pub struct TriangleBlock {
    vertices: [[Vec4; 3]; 3],
    prims: [u32; LANES],
}

/// A ray as the triangle test wants it; `K` is the axis of the largest component of `d`.
#[derive(Clone, Copy, Debug)]
pub struct ShearedRay<const K: usize> {
    origin: [Vec4; 3],
    shear_x: Vec4,
    shear_y: Vec4,
    o: DVec3,
    d: DVec3,
    inv_dk: f64,
}

/// The axis of the largest component of `d`.
#[inline]
pub fn dominant_axis(d: Vec3A) -> usize {
    let a = d.abs();
    if a.x >= a.y && a.x >= a.z {
        0
    } else if a.y >= a.z {
        1
    } else {
        2
    }
}

impl<const K: usize> ShearedRay<K> {
    const X: usize = (K + 1) % 3;
    const Y: usize = (K + 2) % 3;

    /// Prepares `ray`, whose dominant axis is `K`.
    #[inline]
    pub fn new(ray: &Ray) -> Self {
        Self {
            origin: [0, 1, 2].map(|axis| Vec4::splat(ray.o[axis])),
            shear_x: Vec4::splat(ray.d[Self::X] / ray.d[K]),
            shear_y: Vec4::splat(ray.d[Self::Y] / ray.d[K]),
            o: ray.o.as_dvec3(),
            d: ray.d.as_dvec3(),
            inv_dk: 1.0 / f64::from(ray.d[K]),
        }
    }
}

/// The sheared x and y of one corner of four triangles.
type Corner = (Vec4, Vec4);

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
    pub fn intersect<const K: usize>(
        &self,
        ray: &ShearedRay<K>,
        mut t_max: f32,
        mut found: impl FnMut(Hit) -> (f32, bool),
    ) -> bool {
        let corner = |i: usize| -> Corner {
            let v = &self.vertices[i];
            let z = v[K] - ray.origin[K];
            let x_axis = ShearedRay::<K>::X;
            let y_axis = ShearedRay::<K>::Y;
            (
                (v[x_axis] - ray.origin[x_axis]) - ray.shear_x * z,
                (v[y_axis] - ray.origin[y_axis]) - ray.shear_y * z,
            )
        };
        let (a, b, c) = (corner(0), corner(1), corner(2));
        let edge = |p: Corner, q: Corner| p.0 * q.1 - p.1 * q.0;
        let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
        let front = u.min(v).min(w).cmpge(Vec4::ZERO);
        let back = u.max(v).max(w).cmple(Vec4::ZERO);
        let mut candidates = (front | back).bitmask();
        while candidates != 0 {
            let lane = candidates.trailing_zeros() as usize & (LANES - 1);
            candidates &= candidates - 1;
            let sheared = [a, b, c].map(|p| (f64::from(p.0[lane]), f64::from(p.1[lane])));
            if let Some(hit) = self.decide(ray, lane, sheared, t_max) {
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
    #[inline]
    fn decide<const K: usize>(
        &self,
        ray: &ShearedRay<K>,
        lane: usize,
        [a, b, c]: [(f64, f64); 3],
        t_max: f32,
    ) -> Option<Hit> {
        // The vertices bound the distance. They also tell most misses.
        let corner = |i: usize| {
            let v = &self.vertices[i];
            DVec3::new(
                f64::from(v[0][lane]),
                f64::from(v[1][lane]),
                f64::from(v[2][lane]),
            )
        };
        let (p0, p1, p2) = (corner(0), corner(1), corner(2));
        let [z0, z1, z2] = [p0, p1, p2].map(|p| (p[K] - ray.o[K]) * ray.inv_dk);
        let t_far = z0.max(z1).max(z2);
        let t_near = z0.min(z1).min(z2);
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
