//! Walks through media: from one event to the next.

use super::subpath::{Flight, Walker};
use crate::engine::geometry::{Ray, SurfaceInteraction};
use crate::engine::integrators::RenderStats;
use crate::engine::math::Rgb;
use crate::engine::media::{Draws, Phase};
use crate::engine::sampling::Sampler;
use crate::engine::scene::Arrival;

/// Where a flight through media ended.
pub(super) struct Landing {
    /// None if it left the scene.
    pub met: Option<(SurfaceInteraction, Option<Phase>)>,
    /// Radiance of media on the way.
    pub emitted: Rgb,
    /// See [`super::Vertex::key`].
    pub key: u64,
}

impl Walker<'_> {
    /// Flies through media to the next event; what is lost on the way is in the throughput then.
    pub(super) fn fly<S: Sampler>(
        &self,
        flight: &mut Flight,
        first: u32,
        sampler: &mut S,
        stats: &mut RenderStats,
    ) -> Landing {
        sampler.seek(first + 8);
        let (numbers, seed) = (sampler.next_2d(), sampler.next_2d());
        let mut draws = Draws::new(numbers.into(), seed.into());
        let (ray, beta) = (flight.ray, flight.throughput);
        let flown = self
            .cx
            .scene
            .fly(ray, flight.inside, beta, &mut draws, |_| {});
        flight.throughput *= flown.weight;
        flight.kept *= flown.weight;
        flight.inside = flown.inside;
        stats.rays += draws.rays - 1;
        stats.exceeded_majorants += draws.exceeded;
        Landing {
            met: match flown.arrival {
                Arrival::Surface(si) => Some((si, None)),
                Arrival::Volume(point) => {
                    let ray = Ray::new(point.p, -point.wo);
                    Some((SurfaceInteraction::in_volume(&ray, 0.0), Some(point.phase)))
                }
                Arrival::Escape => None,
            },
            emitted: flown.emitted,
            key: draws.key(),
        }
    }
}
