//! Radiance from all around: constant, or a latitude–longitude image.

use std::f32::consts::{FRAC_1_PI, PI};
use std::sync::Arc;

use glam::{Quat, Vec2, Vec3A};

use super::silhouette::Silhouette;
use super::{EmissionSample, LightSample};
use crate::engine::geometry::NO_TRIANGLE;
use crate::engine::math::Rgb;
use crate::engine::math::distribution::Discrete2d;
use crate::engine::math::float::safe_sqrt;
use crate::engine::sampling::warp::{pdf_sphere, sample_sphere};
use crate::engine::scene::desc::ImageData;

/// An environment.
#[derive(Clone, Debug)]
pub struct EnvironmentLight {
    source: Source,
    scene: Silhouette,
}

#[derive(Clone, Debug)]
enum Source {
    Constant(Rgb),
    Image(Map),
}

/// A latitude–longitude image, constant over each texel: sampled in proportion to what it shows,
/// so that radiance / density is the same for all texels and directions.
#[derive(Clone, Debug)]
struct Map {
    image: Arc<ImageData>,
    scale: Rgb,
    /// Image from world.
    to_image: Quat,
    texels: Discrete2d,
    mean: Rgb,
}

impl EnvironmentLight {
    /// The same radiance from every direction.
    pub fn constant(radiance: Rgb, scene: Silhouette) -> Self {
        Self {
            source: Source::Constant(radiance),
            scene,
        }
    }

    /// An image that is turned by `rotation` in the world. `Ok(None)` if it is black.
    ///
    /// # Errors
    /// A sentence, if a texel is negative, infinite or not a number, or the size is wrong.
    pub fn image(
        image: Arc<ImageData>,
        scale: Rgb,
        rotation: Quat,
        scene: Silhouette,
    ) -> Result<Option<Self>, String> {
        let (width, height) = (image.width, image.height);
        let name = &image.name;
        if width == 0 || height == 0 || image.pixels.len() != width * height {
            return Err(format!("The environment image {name} has no pixels."));
        }
        let to_image = rotation.inverse();
        if !to_image.is_finite() {
            return Err(format!("The rotation of environment {name} is not finite."));
        }
        let mut weights = Vec::with_capacity(width * height);
        let mut sum = [0.0; 3];
        for (i, pixel) in image.pixels.iter().enumerate() {
            let radiance = Rgb::from(*pixel) * scale;
            if !is_radiance(radiance) {
                return Err(format!(
                    "The environment image {name} holds {pixel:?} at column {}, row {}: \
                     radiance must be finite and not negative.",
                    i % width,
                    i / width
                ));
            }
            let solid_angle = texel_solid_angle(i / width, width, height);
            let channels = radiance.to_array().map(f64::from);
            weights.push(channels.iter().sum::<f64>() * solid_angle);
            for (sum, c) in sum.iter_mut().zip(channels) {
                *sum += c * solid_angle;
            }
        }
        let Some(texels) = Discrete2d::new(&weights, width) else {
            return Ok(None);
        };
        let mean = sum.map(|s| (s / (4.0 * std::f64::consts::PI)) as f32);
        Ok(Some(Self {
            source: Source::Image(Map {
                image,
                scale,
                to_image,
                texels,
                mean: mean.into(),
            }),
            scene,
        }))
    }

    /// Radiance that arrives from the direction `d`.
    #[inline]
    pub fn radiance(&self, d: Vec3A) -> Rgb {
        match &self.source {
            Source::Constant(radiance) => *radiance,
            Source::Image(map) => {
                let (row, column) = map.texel(d);
                map.texel_radiance(row, column)
            }
        }
    }

    /// Density of the directions of [`EnvironmentLight::sample_li`], 1/sr.
    #[inline]
    pub fn pdf_dir(&self, d: Vec3A) -> f32 {
        match &self.source {
            Source::Constant(_) => pdf_sphere(),
            Source::Image(map) => {
                let (row, column) = map.texel(d);
                map.texels.pmf(row, column) / map.solid_angle(row)
            }
        }
    }

    /// Direction towards the environment, its density in 1/sr, and the radiance from there.
    #[inline]
    fn sample_dir(&self, u: Vec2) -> Option<(Vec3A, f32, Rgb)> {
        match &self.source {
            Source::Constant(radiance) => Some((sample_sphere(u), pdf_sphere(), *radiance)),
            Source::Image(map) => map.sample(u),
        }
    }

    /// See [`super::Light::sample_li`].
    #[inline]
    pub fn sample_li(&self, p: Vec3A, u: Vec2) -> Option<LightSample> {
        let (wi, pdf_dir, radiance) = self.sample_dir(u)?;
        Some(LightSample {
            wi,
            target: self.scene.beyond(p, wi),
            distance: f32::INFINITY,
            n: None,
            radiance,
            pdf_dir,
            is_delta: false,
            prim: NO_TRIANGLE,
        })
    }

    /// See [`super::Light::sample_le`].
    pub fn sample_le(&self, u_pos: Vec2, u_dir: Vec2) -> Option<EmissionSample> {
        let (wi, pdf_dir, radiance) = self.sample_dir(u_dir)?;
        let ray = self.scene.enter(-wi, u_pos);
        Some(EmissionSample {
            ray,
            p: ray.o,
            p_error: Vec3A::ZERO,
            n: None,
            radiance,
            pdf_pos: self.scene.pdf_pos(wi),
            pdf_dir,
            is_delta_pos: false,
            is_delta_dir: false,
        })
    }

    /// Density of the start points of the rays of [`EnvironmentLight::sample_le`] along `d`, 1/m².
    #[inline]
    pub fn pdf_pos(&self, d: Vec3A) -> f32 {
        self.scene.pdf_pos(d)
    }

    /// 4π · mean radiance · mean area of the scene's shadow: the flux of even light.
    pub fn power(&self) -> Rgb {
        let mean = match &self.source {
            Source::Constant(radiance) => *radiance,
            Source::Image(map) => map.mean,
        };
        mean * (4.0 * PI * self.scene.mean_area())
    }
}

/// Whether no channel is negative, infinite or not a number.
pub(super) fn is_radiance(c: Rgb) -> bool {
    c.is_finite() && c.to_array().iter().all(|c| *c >= 0.0)
}

/// Solid angle in sr of a texel of `row`. cosθ falls by 2 sin(½Δθ) sin(θ) over the row.
fn texel_solid_angle(row: usize, width: usize, height: usize) -> f64 {
    let step = std::f64::consts::PI / height as f64;
    let drop = 2.0 * (0.5 * step).sin() * ((row as f64 + 0.5) * step).sin();
    2.0 * std::f64::consts::PI / width as f64 * drop
}

impl Map {
    fn solid_angle(&self, row: usize) -> f32 {
        texel_solid_angle(row, self.image.width, self.image.height) as f32
    }

    fn texel_radiance(&self, row: usize, column: usize) -> Rgb {
        Rgb::from(self.image.pixels[row * self.image.width + column]) * self.scale
    }

    /// Row and column of the texel seen in the direction `d`: rows from +y down, the middle of
    /// the image towards −z, its right towards +x.
    #[inline]
    fn texel(&self, d: Vec3A) -> (usize, usize) {
        let d = self.to_image * d;
        let v = d.x.hypot(d.z).atan2(d.y) * FRAC_1_PI;
        let u = 0.5 + d.x.atan2(-d.z) * (0.5 * FRAC_1_PI);
        let (width, height) = (self.image.width, self.image.height);
        let index = |x: f32, n: usize| ((x * n as f32) as usize).min(n - 1);
        (index(v, height), index(u, width))
    }

    /// A texel in proportion to its flux, then a direction uniform over its solid angle.
    #[inline]
    fn sample(&self, u: Vec2) -> Option<(Vec3A, f32, Rgb)> {
        let (row, column) = self.texels.sample(u.y, u.x)?;
        // cosθ runs evenly from one edge of the row to the other; the distance from the nearer
        // pole, 1 − |cosθ| = 2 sin²(θ/2), keeps its digits at the poles.
        let (width, height) = (self.image.width, self.image.height);
        let step = 0.5 * PI / height as f32;
        let upper = 2 * row.index < height;
        let edge = |k: usize| {
            let from_pole = if upper { k } else { height - k };
            let s = (from_pole as f32 * step).sin();
            2.0 * s * s
        };
        let (a, b) = (edge(row.index), edge(row.index + 1));
        let h = a + (b - a) * row.rest;
        let (sin, cos) = (
            safe_sqrt(h * (2.0 - h)),
            if upper { 1.0 - h } else { h - 1.0 },
        );
        let phi = 2.0 * PI * ((column.index as f32 + column.rest) / width as f32 - 0.5);
        let (sin_phi, cos_phi) = phi.sin_cos();
        let local = Vec3A::new(sin * sin_phi, cos, -sin * cos_phi);
        let pdf = row.pmf * column.pmf / self.solid_angle(row.index);
        let radiance = self.texel_radiance(row.index, column.index);
        Some((self.to_image.inverse() * local, pdf, radiance))
    }
}
