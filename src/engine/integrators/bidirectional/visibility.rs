//! What light gets through between two vertices, and what is met on the way.

use super::connect::{Connector, Sink, Technique};
use super::subpath::Subpath;
use crate::engine::geometry::Ray;
use crate::engine::math::Rgb;
use crate::engine::media::{Draws, Inside};
use crate::engine::scene::Scene;

impl<K: Sink> Connector<'_, K> {
    /// The share of light that gets through; `known` holds the answer once it is asked for. In
    /// scenes with media `from` tells what the ray's origin is within, and a key of random numbers.
    #[inline]
    pub(super) fn visible(
        &mut self,
        known: &mut Option<Rgb>,
        from: impl FnOnce(&Scene) -> (Inside, u64),
        ray: impl FnOnce() -> Ray,
    ) -> Rgb {
        *known.get_or_insert_with(|| {
            if !self.cx.plan.features.media {
                self.stats.rays += 1;
                return Rgb::splat(self.cx.scene.transmittance_along(ray()));
            }
            let (inside, key) = from(self.cx.scene);
            let mut draws = Draws::hashed(key);
            let visible = self
                .cx
                .scene
                .transmittance_in_media(ray(), inside, &mut draws);
            self.stats.rays += draws.rays;
            self.stats.exceeded_majorants += draws.exceeded;
            visible
        })
    }

    /// Light of media that the eye walk met on its way. No other strategy finds it.
    pub fn glow(&mut self, eye: &Subpath) {
        if !(2..=eye.len() + 1).any(|t| self.strategies.is_on(0, t)) {
            return;
        }
        for &(class, value) in &eye.glow {
            self.sink.add(Technique { s: 0, t: 2 }, class, value, 1.0);
        }
    }
}
