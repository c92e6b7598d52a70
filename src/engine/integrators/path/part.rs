//! The part of a flight through a homogeneous medium that may hold one more place to look for light.

use super::equiangular::Equiangular;
use crate::engine::geometry::Ray;
use crate::engine::integrators::Pass;
use crate::engine::math::Rgb;
use crate::engine::media::{Inside, Medium};
use crate::engine::sampling::mis;

/// The part of a flight on which light is looked for at one more place: the first in a homogeneous
/// medium.
pub(super) struct Part<'a> {
    pub medium: &'a Medium,
    pub ray: Ray,
    pub range: (f32, f32),
    /// Throughput where it begins.
    pub beta: Rgb,
    pub inside: Inside,
    /// Its number among those of the flight.
    pub number: u32,
}

impl Part<'_> {
    /// Density of the distance `t` as tracking draws it, 1/m.
    pub fn pdf_tracked(&self, t: f32) -> f32 {
        self.medium.pdf_distance(t - self.range.0, self.beta)
    }

    pub fn equiangular(&self, cx: &Pass<'_>, light: u32) -> Option<Equiangular> {
        let sigmas = self.medium.sigma_t.to_array().into_iter();
        let least = sigmas.filter(|s| *s > 0.0).fold(f32::INFINITY, f32::min);
        let light = cx.scene.lights.get(light);
        Equiangular::new(light, &self.ray, self.range, least)
    }

    /// Weight of light that is found where tracking scattered at the distance `t`.
    pub fn tracked_share(&self, cx: &Pass<'_>, light: u32, t: f32) -> f32 {
        match self.equiangular(cx, light) {
            Some(e) => mis::power(self.pdf_tracked(t), e.pdf(t)),
            None => 1.0,
        }
    }
}
