//! Everything that emits: how to choose a light, a point on it, a direction from it.
//!
//! Two families of densities stand side by side. `sample_li` and `pdf_li` see a light from a point
//! of the scene and count in solid angle there; `sample_le` and `pdf_le` start a path at the light
//! and count in area and solid angle at the light. Neither includes the probability with which
//! [`Lights`] selected the light.
//!
//! Invariant: each `pdf_*` is the density of its `sample_*`, which the tests check by chi-square;
//! surfaces emit from their front side only.

pub mod directional;
pub mod environment;
pub mod point;
pub mod select;
pub mod silhouette;
pub mod sphere;
mod spherical_triangle;
pub mod triangle;

pub use directional::DirectionalLight;
pub use environment::EnvironmentLight;
pub use point::{PointLight, SpotLight};
pub use select::{Emitter, Lights};
pub use silhouette::Silhouette;
pub use sphere::SphereLight;
pub use triangle::{QuadLight, TriangleLight};

use glam::{Vec2, Vec3A};

use super::geometry::{Ray, SurfaceInteraction};
use super::math::Rgb;

/// A light.
#[derive(Clone, Debug)]
pub enum Light {
    /// A triangle that emits from its front side.
    Triangle(TriangleLight),
    /// Two triangles of one plane and emission that share an edge.
    Quad(Box<QuadLight>),
    /// A sphere that emits outward or inward.
    Sphere(SphereLight),
    /// A point that emits the same in all directions.
    Point(PointLight),
    /// A point that emits into a cone.
    Spot(SpotLight),
    /// Parallel light from infinity.
    Directional(DirectionalLight),
    /// Radiance from all around.
    Environment(Box<EnvironmentLight>),
}

/// A point on a light, or a direction to one at infinity, as seen from a point of the scene.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit direction from the reference point to the light.
    pub wi: Vec3A,
    /// End of the shadow ray, moved off the light's surface already; for lights at infinity a
    /// point outside the scene.
    pub target: Vec3A,
    /// Distance to the light; infinite for lights at infinity.
    pub distance: f32,
    /// Normal of the emitting side, for lights that are surfaces.
    pub n: Option<Vec3A>,
    /// Radiance that arrives, W·sr⁻¹·m⁻²; for delta lights the irradiance on a surface
    /// perpendicular to `wi`, W·m⁻², to go with `pdf_dir` = 1.
    pub radiance: Rgb,
    /// Density of `wi` in 1/sr, > 0; 1 for delta lights.
    pub pdf_dir: f32,
    /// Whether no other strategy can find this direction: point, spot and directional lights.
    pub is_delta: bool,
    /// The triangle that it is a point of, as in [`Ray::clear_of`].
    pub prim: u32,
}

impl LightSample {
    /// The shadow ray from `si`.
    #[inline]
    pub fn ray_from(&self, si: &SurfaceInteraction) -> Ray {
        if !self.distance.is_finite() {
            return si.spawn_ray(self.wi);
        }
        Ray {
            clear_of: [si.prim, self.prim],
            ..si.spawn_ray_to(self.target)
        }
    }
}

/// The first vertex and direction of a path from a light.
#[derive(Clone, Copy, Debug)]
pub struct EmissionSample {
    /// The ray that leaves; its origin is moved off the light's surface.
    pub ray: Ray,
    /// The point on the light, before that move.
    pub p: Vec3A,
    /// Bound on the absolute error of each coordinate of `p`.
    pub p_error: Vec3A,
    /// Normal of the emitting side, for lights that are surfaces.
    pub n: Option<Vec3A>,
    /// Radiance along the ray; for a delta position intensity in W/sr, for a delta direction
    /// irradiance in W/m². The flux of a sample is radiance · (|cosθ| if there is a normal) /
    /// (`pdf_pos` · `pdf_dir`).
    pub radiance: Rgb,
    /// Density of the position, 1/m²; 1 for a delta position.
    pub pdf_pos: f32,
    /// Density of the direction, 1/sr; 1 for a delta direction.
    pub pdf_dir: f32,
    /// Whether all paths start at one point.
    pub is_delta_pos: bool,
    /// Whether all paths start in one direction.
    pub is_delta_dir: bool,
}

impl EmissionSample {
    /// The flux in W that this sample stands for, the estimator of [`Light::power`] but for
    /// images at infinity.
    #[inline]
    pub fn flux(&self) -> Rgb {
        let cos = self.n.map_or(1.0, |n| n.dot(self.ray.d).abs());
        // One factor at a time: the product of the densities may overflow where the flux does not.
        self.radiance * (cos / self.pdf_dir) / self.pdf_pos
    }
}

impl Light {
    /// A point in the middle of the light; None if it is at infinity.
    pub fn center(&self) -> Option<Vec3A> {
        match self {
            Self::Triangle(light) => Some(light.center()),
            Self::Quad(light) => Some(light.center()),
            Self::Sphere(light) => Some(light.center()),
            Self::Point(light) => Some(light.position),
            Self::Spot(light) => Some(light.position()),
            Self::Directional(_) | Self::Environment(_) => None,
        }
    }

    /// Samples the light as seen from `p`. `None` if nothing of it can be seen from there, the
    /// scene left aside.
    #[inline]
    pub fn sample_li(&self, p: Vec3A, u: Vec2) -> Option<LightSample> {
        match self {
            Self::Triangle(light) => light.sample_li(p, u),
            Self::Quad(light) => light.sample_li(p, u),
            Self::Sphere(light) => light.sample_li(p, u),
            Self::Point(light) => light.sample_li(p),
            Self::Spot(light) => light.sample_li(p),
            Self::Directional(light) => Some(light.sample_li(p)),
            Self::Environment(light) => light.sample_li(p, u),
        }
    }

    /// Density in 1/sr with which [`Light::sample_li`] at `p` draws the direction `wi`: towards
    /// the point `hit` of this light, or past the scene for a light at infinity. 0 for delta
    /// lights. `p` must be the very point given to `sample_li`.
    #[inline]
    pub fn pdf_li(&self, p: Vec3A, wi: Vec3A, hit: Option<&SurfaceInteraction>) -> f32 {
        match (self, hit) {
            (Self::Triangle(light), Some(_)) => light.pdf_li(p),
            (Self::Quad(light), Some(_)) => light.pdf_li(p),
            (Self::Sphere(light), Some(hit)) => light.pdf_li(p, hit.p, hit.n_g),
            (Self::Environment(light), None) => light.pdf_dir(wi),
            _ => 0.0,
        }
    }

    /// Radiance that leaves the point `si` of this light in the direction `wo`.
    #[inline]
    pub fn emitted(&self, si: &SurfaceInteraction, wo: Vec3A) -> Rgb {
        if si.n_g.dot(wo) <= 0.0 {
            return Rgb::BLACK;
        }
        match self {
            Self::Triangle(light) => light.radiance,
            Self::Quad(light) => light.radiance(),
            Self::Sphere(light) => light.radiance,
            _ => Rgb::BLACK,
        }
    }

    /// Radiance of a light at infinity along a ray that leaves the scene in the direction `d`.
    /// Parallel light has no density of directions and is not seen.
    #[inline]
    pub fn escaped(&self, d: Vec3A) -> Rgb {
        match self {
            Self::Environment(light) => light.radiance(d),
            _ => Rgb::BLACK,
        }
    }

    /// Samples a ray that leaves the light.
    #[inline]
    pub fn sample_le(&self, u_pos: Vec2, u_dir: Vec2) -> Option<EmissionSample> {
        match self {
            Self::Triangle(light) => Some(light.sample_le(u_pos, u_dir)),
            Self::Quad(light) => Some(light.sample_le(u_pos, u_dir)),
            Self::Sphere(light) => Some(light.sample_le(u_pos, u_dir)),
            Self::Point(light) => Some(light.sample_le(u_dir)),
            Self::Spot(light) => Some(light.sample_le(u_dir)),
            Self::Directional(light) => Some(light.sample_le(u_pos)),
            Self::Environment(light) => light.sample_le(u_pos, u_dir),
        }
    }

    /// Densities `(pdf_pos, pdf_dir)` with which [`Light::sample_le`] draws a ray in the direction
    /// `d` from a point whose emitting side has the normal `n`; 1 in place of each delta.
    #[inline]
    pub fn pdf_le(&self, n: Option<Vec3A>, d: Vec3A) -> (f32, f32) {
        let cosine = n.map_or(0.0, |n| n.dot(d));
        let pdf_dir = super::sampling::warp::pdf_cosine_hemisphere(cosine);
        match self {
            Self::Triangle(light) => (1.0 / light.area, pdf_dir),
            Self::Quad(light) => (1.0 / light.area(), pdf_dir),
            Self::Sphere(light) => (1.0 / light.area(), pdf_dir),
            Self::Point(_) => (1.0, super::sampling::warp::pdf_sphere()),
            Self::Spot(light) => (1.0, light.pdf_dir(d)),
            Self::Directional(light) => (light.pdf_pos(), 1.0),
            Self::Environment(light) => (light.pdf_pos(d), light.pdf_dir(-d)),
        }
    }

    /// Whether the light has no extent that a ray could meet: a point or a parallel beam.
    #[inline]
    pub fn is_delta(&self) -> bool {
        matches!(self, Self::Point(_) | Self::Spot(_) | Self::Directional(_))
    }

    /// Whether the light stands outside the scene.
    #[inline]
    pub fn is_infinite(&self) -> bool {
        matches!(self, Self::Directional(_) | Self::Environment(_))
    }

    /// Emitted flux in W; of lights at infinity that through the scene's
    /// silhouette, of images as if they were alike all around.
    pub fn power(&self) -> Rgb {
        match self {
            Self::Triangle(light) => light.power(),
            Self::Quad(light) => light.power(),
            Self::Sphere(light) => light.power(),
            Self::Point(light) => light.power(),
            Self::Spot(light) => light.power(),
            Self::Directional(light) => light.power(),
            Self::Environment(light) => light.power(),
        }
    }
}
