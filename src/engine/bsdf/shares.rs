//! The probabilities of the events at a point.

use super::scatter::MAX_LOBES;
use crate::engine::event::Event;
use crate::engine::math::float::ONE_MINUS_EPSILON;

/// The estimated albedo of each lobe for one known direction, and their sums over the events.
/// The probability of an event is its share of the total.
///
/// The estimates have a closed form, are exact for all but microfacet lobes and vanish only where
/// the lobe does. A weight f|cos|/pdf therefore stays within the lobes' total albedo times the
/// ratio of a lobe's largest to its mean channel.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Shares {
    /// By lobe.
    pub lobe: [f32; MAX_LOBES],
    /// Of the diffuse lobes.
    pub diffuse: f32,
    /// Of the microfacet lobes.
    pub glossy: f32,
    /// Of all.
    pub total: f32,
    /// Bit i: lobe i is a delta lobe.
    pub delta_lobes: u8,
}

impl Shares {
    /// The share of an event, not divided by the total.
    #[inline]
    pub fn of(&self, event: Event) -> f32 {
        match event {
            Event::Diffuse => self.diffuse,
            Event::Glossy => self.glossy,
            Event::Specular(i) if self.is_delta(usize::from(i)) => self.lobe[usize::from(i)],
            Event::Specular(_) | Event::Volume => 0.0,
        }
    }

    /// P(event | wo); 0 everywhere on a black surface.
    #[inline]
    pub fn probability(&self, event: Event) -> f32 {
        if self.total > 0.0 {
            self.of(event) / self.total
        } else {
            0.0
        }
    }

    /// Picks an event, and makes a uniform number of what is left of `u`.
    #[inline]
    pub fn pick_event(&self, u: f32) -> Option<(Event, f32)> {
        let delta = (0..MAX_LOBES)
            .filter(|&i| self.is_delta(i))
            .map(|i| (Event::Specular(i as u8), self.lobe[i]));
        let density = [(Event::Diffuse, self.diffuse), (Event::Glossy, self.glossy)];
        pick(density.into_iter().chain(delta), self.total, u)
    }

    /// Picks one of `lobes`, whose shares sum to `total`, likewise.
    #[inline]
    pub fn pick_lobe(
        &self,
        lobes: impl Iterator<Item = usize>,
        total: f32,
        u: f32,
    ) -> Option<(usize, f32)> {
        pick(lobes.map(|i| (i, self.lobe[i])), total, u)
    }

    #[inline]
    fn is_delta(&self, lobe: usize) -> bool {
        lobe < MAX_LOBES && self.delta_lobes & (1 << lobe) != 0
    }
}

/// Picks by share; one without share never, whatever the rounding.
#[inline]
fn pick<T: Copy>(choices: impl Iterator<Item = (T, f32)>, total: f32, u: f32) -> Option<(T, f32)> {
    let mut x = u * total;
    let mut last = None;
    for (choice, share) in choices {
        if share > 0.0 {
            if x < share {
                return Some((choice, (x / share).min(ONE_MINUS_EPSILON)));
            }
            x -= share;
            last = Some((choice, ONE_MINUS_EPSILON));
        }
    }
    last
}
