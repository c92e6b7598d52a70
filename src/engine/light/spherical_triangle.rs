//! A triangle as seen from a point: its solid angle, and directions uniform over it.
//!
//! The map is that of Peters 2021, *BRDF Importance Sampling for Polygonal Lights*, section 4,
//! which cuts off a triangle of the wanted solid angle as Arvo 1995, *Stratified Sampling of
//! Spherical Triangles*, does, but without inverse trigonometry. It is rearranged here into sums of
//! positive terms: no difference cancels, and a triangle as small as a star or as large as half
//! the sky is sampled to within a few roundings. Small ones need no second method: the map tends
//! to the uniform one by area.

use glam::{Vec2, Vec3A};

/// Below this solid angle in sr, products of solid angles leave the range of `f32`.
const MIN_SOLID_ANGLE: f32 = 1e-30;
/// Below this value of 1 + cos of an arc, the arc is taken as the side that is cut.
const LONG_ARC: f32 = 0.1;

/// A corner seen from a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight {
    to: Vec3A,
    distance: f32,
    unit: Vec3A,
}

impl Sight {
    /// `corner` seen from `p`.
    #[inline]
    pub fn new(corner: Vec3A, p: Vec3A) -> Self {
        let to = corner - p;
        let distance = to.length();
        let unit = to / distance;
        Self { to, distance, unit }
    }

    /// 1 + cos of the arc to another.
    #[inline]
    pub fn arc(&self, to: &Self) -> f32 {
        0.5 * (self.unit + to.unit).length_squared()
    }
}

/// Half the solid angle of a triangle, as the direction (x, y) in the plane that has it from the x
/// axis (van Oosterom and Strackee 1983, equation 8).
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfAngle {
    x: f32,
    y: f32,
}

impl HalfAngle {
    /// Of the triangle of the corners `v`, with 1 + cos of the arcs 01, 02 and 12; `normal` is
    /// (v1 − v0) × (v2 − v0). `None` if the point is not on the side `normal` points to.
    #[inline]
    pub fn new(v: [&Sight; 3], [g01, g02, g12]: [f32; 3], normal: Vec3A) -> Option<Self> {
        // Six times the volume of the tetrahedron; positive in front. Taken from the nearest
        // corner, where the height above the plane is rounded least.
        let [d0, d1, d2] = [v[0].distance, v[1].distance, v[2].distance];
        let nearest = if d0 <= d1.min(d2) {
            v[0].to
        } else if d1 <= d2 {
            v[1].to
        } else {
            v[2].to
        };
        let y = -nearest.dot(normal) / d0 / d1 / d2;
        let x = g01 + g02 + g12 - 2.0;
        (y > 0.0).then_some(Self { x, y })
    }

    /// Of this triangle and another of the same plane. Together they see at most 2π, where rounding
    /// may take y to the other side of 0.
    #[inline]
    pub fn plus(self, other: Self) -> Self {
        Self {
            x: self.x * other.x - self.y * other.y,
            y: (self.x * other.y + self.y * other.x).max(0.0),
        }
    }

    /// The solid angle in sr; `None` where it is less than `f32` can work with.
    #[inline]
    pub fn solid_angle(self) -> Option<f32> {
        let solid_angle = 2.0 * self.y.atan2(self.x);
        (solid_angle >= MIN_SOLID_ANGLE).then_some(solid_angle)
    }
}

/// A triangle seen from a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct SphericalTriangle {
    /// Corners in the order used here: index into the triangle's.
    order: [usize; 3],
    /// Distances of these corners from the point.
    distance: [f32; 3],
    /// 1 + cos of the arcs 01, 02 and 12.
    g: [f32; 3],
    /// Solid angle in sr, in (0, 2π).
    pub solid_angle: f32,
}

impl SphericalTriangle {
    /// The triangle of the corners `v`, with arcs and normal as for [`HalfAngle::new`]. `None` if
    /// the point is not in front, or sees nothing that `f32` can hold.
    #[inline]
    pub fn new(v: [&Sight; 3], arcs: [f32; 3], normal: Vec3A) -> Option<Self> {
        let solid_angle = HalfAngle::new(v, arcs, normal)?.solid_angle()?;
        let [g01, g02, g12] = arcs;
        // Corner 1 is the apex from which rays fan out over the side 02. An arc of nearly π at the
        // apex would let all of the fan start at its end: make such an arc the side.
        let order = if g02 <= g01.min(g12) || g01.min(g12) > LONG_ARC {
            [0, 1, 2]
        } else if g01 < g12 {
            [1, 2, 0]
        } else {
            [2, 0, 1]
        };
        let pair = |i: usize, j: usize| match i + j {
            1 => g01,
            2 => g02,
            _ => g12,
        };
        Some(Self {
            order,
            distance: order.map(|corner| v[corner].distance),
            g: [
                pair(order[0], order[1]),
                pair(order[0], order[2]),
                pair(order[1], order[2]),
            ],
            solid_angle,
        })
    }

    /// Barycentric coordinates of the point seen in a direction of density 1 / `solid_angle`.
    pub fn sample(&self, u: Vec2) -> Option<[f32; 3]> {
        let [g01, g02, g12] = self.g;
        // The point w of the arc 02 for which (0, 1, w) has the solid angle u.x · Ω. With h the
        // middle of 0 and w, h ∝ (e + b)·v0 + b·v2; w is v0 reflected at h.
        let half = 0.5 * self.solid_angle;
        let e = ((1.0 - u.x) * half).sin() / half.sin();
        let b = (u.x * half).sin() / half.sin() * (g01 / (2.0 * g02 * g12)).sqrt();
        let h2 = e * e + 2.0 * b * (e + b) * g02;
        let (w0, w2) = (e * (e + 2.0 * b) / h2, 2.0 * b * (e + b * g02) / h2);

        // A point of the arc from 1 to w, uniform in the cosine of its distance from 1.
        let drop = (1.0 - (w0 * (g01 - 1.0) + w2 * (g12 - 1.0))).clamp(0.0, 2.0);
        let t = (u.y * (2.0 - u.y * drop) / (2.0 - drop)).sqrt();
        let c1 = (1.0 - t) + drop * (t - u.y);

        // Coefficients of unit vectors become those of the corners, and sum to 1.
        let c = [
            t * w0 / self.distance[0],
            c1.max(0.0) / self.distance[1],
            t * w2 / self.distance[2],
        ];
        let sum = c[0] + c[1] + c[2];
        let mut barycentric = [0.0; 3];
        for (corner, value) in self.order.into_iter().zip(c) {
            barycentric[corner] = value / sum;
        }
        barycentric
            .iter()
            .all(|b| b.is_finite())
            .then_some(barycentric)
    }
}
