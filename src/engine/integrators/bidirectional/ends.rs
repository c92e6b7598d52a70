//! The light end v₀ of a path, and the densities between it and v₁.

use glam::Vec3A;

use crate::engine::geometry::SurfaceInteraction;
use crate::engine::light::Light;

/// Largest inverse of a distance whose square `f32` holds with room for densities of directions:
/// where two points round to one, they keep a density.
pub const LARGEST_INVERSE: f32 = 1e15;

/// The direction of `to` and the inverse of its square; `otherwise`, where it has none.
#[inline]
fn polar(to: Vec3A, otherwise: Vec3A) -> (Vec3A, f32) {
    let distance2 = to.length_squared();
    let inverse = 1.0 / distance2.sqrt();
    let near = inverse.min(LARGEST_INVERSE);
    let direction = if distance2 > 0.0 {
        to * inverse
    } else {
        otherwise
    };
    (direction, near * near)
}

/// What lies between two points.
#[derive(Clone, Copy, Debug)]
pub struct Span {
    /// Unit direction from the first to the second.
    pub direction: Vec3A,
    /// One over their squared distance, 1/m².
    pub inverse2: f32,
}

impl Span {
    /// From `a` to `b`.
    #[inline]
    pub fn new(a: &SurfaceInteraction, b: &SurfaceInteraction) -> Self {
        let (direction, inverse2) = polar(b.p - a.p, b.wo);
        Self {
            direction,
            inverse2,
        }
    }

    /// What turns densities of directions between two points, in 1/sr, into those of the points, in
    /// 1/m²: first that of `a`, seen from `b`, then that of `b`, seen from `a`. It is |cosθ| over the
    /// squared distance; places in a medium have no cosine. The density of distances is in none
    /// (CONTRACT rule 6): for places in a medium it is the same factor in all strategies, but for
    /// transmittance.
    #[inline]
    pub fn areas(&self, a: &SurfaceInteraction, b: &SurfaceInteraction) -> (f32, f32) {
        (
            cosine(a, self.direction) * self.inverse2,
            cosine(b, self.direction) * self.inverse2,
        )
    }
}

/// Density in 1/m² of the point `si` if a walk at `from` draws the direction to it with the
/// density `pdf_dir` in 1/sr.
#[inline]
pub fn area_density(pdf_dir: f32, from: Vec3A, si: &SurfaceInteraction) -> f32 {
    let (direction, inverse2) = polar(si.p - from, si.wo);
    pdf_dir * (cosine(si, direction) * inverse2)
}

/// |cosθ| of the unit direction `d`; 1 in a medium.
#[inline]
pub fn cosine(si: &SurfaceInteraction, d: Vec3A) -> f32 {
    if si.is_in_volume() {
        1.0
    } else {
        si.n_g.dot(d).abs()
    }
}

/// The light end of a path.
#[derive(Clone, Copy, Debug)]
pub struct LightEnd {
    /// The light.
    pub id: u32,
    /// Where, if it is not at infinity.
    pub p: Vec3A,
    /// Normal of the emitting side, if it is a surface.
    pub n: Option<Vec3A>,
    /// It lies at infinity.
    pub infinite: bool,
    /// It has no size: no walk from the lens meets it.
    pub zero_size: bool,
}

impl LightEnd {
    /// The point `p` of `light`, number `id`; `n` is the normal there if it is a surface.
    #[inline]
    pub fn new(id: u32, light: &Light, p: Vec3A, n: Option<Vec3A>) -> Self {
        Self {
            id,
            p,
            n,
            infinite: light.is_infinite(),
            zero_size: light.is_delta(),
        }
    }

    /// Density with which walks from lights start at this end, the choice of the light (`pmf`)
    /// included: 1/m², at infinity 1/sr. `le` are the densities of [`Light::pdf_le`].
    #[inline]
    pub fn start(&self, pmf: f32, le: (f32, f32)) -> f32 {
        pmf * if self.infinite { le.1 } else { le.0 }
    }

    /// Density in 1/m² with which a walk that started here goes on to v₁ = `si`.
    #[inline]
    pub fn depart(&self, le: (f32, f32), d: Vec3A, si: &SurfaceInteraction) -> f32 {
        if self.infinite {
            le.0 * cosine(si, d)
        } else {
            area_density(le.1, self.p, si)
        }
    }

    /// Density of this end if a walk at v₁ = `from` draws the direction to it with the density
    /// `pdf_dir` in 1/sr: 1/m², at infinity 1/sr; 0 where no walk can meet it.
    #[inline]
    pub fn arrive(&self, pdf_dir: f32, from: Vec3A) -> f32 {
        if self.zero_size {
            return 0.0;
        }
        let Some(n) = self.n.filter(|_| !self.infinite) else {
            return pdf_dir;
        };
        let (direction, inverse2) = polar(self.p - from, n);
        pdf_dir * (n.dot(direction).abs() * inverse2)
    }

    /// Density of a shadow ray to this end, drawn with `pdf_li` in 1/sr at `from`, over that of
    /// walks that start here; `pmf` is the same for both. They differ for surfaces alone.
    #[inline]
    pub fn shadow_ratio(&self, pdf_li: f32, le: (f32, f32), from: Vec3A) -> f32 {
        if self.infinite || self.zero_size {
            1.0
        } else {
            self.arrive(pdf_li, from) / le.0
        }
    }
}
