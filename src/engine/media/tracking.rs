//! How far a ray gets in a medium.
//!
//! One channel is chosen in proportion to the throughput and tracked; what it finds is weighed by
//! the density with which any channel would have found it (Wilkie et al. 2014, *Hero Wavelength
//! Spectral Sampling*; Miller, Georgiev and Jarosz 2019, *A Null-Scattering Path Integral
//! Formulation of Light Transport*). With q_c ∝ β_c the weighed throughput of all channels together
//! never grows: β_k p_k / Σ q_c p_c ≤ Σ β.
//!
//! Where the density varies, collisions with as much invisible matter as fills the medium up to
//! its bound are drawn and most of them disregarded (Woodcock et al. 1965, delta tracking).
//! Transmittance multiplies what each of them lets through (Novák et al. 2014, ratio tracking).

use super::grid::Grid;
use super::medium::Medium;
use crate::engine::geometry::Ray;
use crate::engine::math::Rgb;
use crate::engine::math::hash::{mix64, unit_f32};

/// Transmittance below which ratio tracking is decided by roulette.
const ROULETTE_BELOW: f32 = 0.1;

/// The numbers of one flight: the first few from the sampler, where they are stratified, then as
/// many as it takes from a hash.
#[derive(Clone, Debug)]
pub struct Draws {
    first: [f32; 2],
    drawn: usize,
    state: u64,
    /// Times that a density was found above its bound.
    pub exceeded: u64,
    /// Rays traced.
    pub rays: u64,
}

impl Draws {
    /// `first` are taken first; `seed` are numbers of the sampler that belong to no one else.
    pub fn new(first: [f32; 2], seed: [f32; 2]) -> Self {
        let bits = u64::from(seed[0].to_bits()) << 32 | u64::from(seed[1].to_bits());
        Self {
            first,
            drawn: 0,
            state: mix64(bits),
            exceeded: 0,
            rays: 0,
        }
    }

    /// All of them from a hash of `key`.
    pub fn hashed(key: u64) -> Self {
        Self {
            first: [0.0; 2],
            drawn: 2,
            state: mix64(key),
            exceeded: 0,
            rays: 0,
        }
    }

    /// A key for [`Self::hashed`], other than those before.
    pub fn key(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mix64(self.state ^ 0x5851_f42d_4c95_7f2d)
    }

    /// Numbers for something else, from the hash alone.
    pub fn fork(&mut self) -> Self {
        Self::hashed(self.key())
    }

    /// The next number in [0, 1).
    #[inline]
    #[expect(
        clippy::should_implement_trait,
        reason = "it never ends, so it is no iterator"
    )]
    pub fn next(&mut self) -> f32 {
        self.drawn += 1;
        if let Some(u) = self.first.get(self.drawn - 1) {
            return *u;
        }
        // SplitMix64.
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        unit_f32(mix64(self.state))
    }
}

/// How a ray got on in a medium.
#[derive(Clone, Copy, Debug)]
pub struct Tracked {
    /// Where it was scattered; None if it got through.
    pub t: Option<f32>,
    /// What the throughput is multiplied by: the albedo is in it.
    pub weight: Rgb,
    /// Radiance that the medium emits toward the ray's origin.
    pub emitted: Rgb,
}

impl Tracked {
    const THROUGH: Self = Self {
        t: None,
        weight: Rgb::WHITE,
        emitted: Rgb::BLACK,
    };
}

impl Medium {
    /// Tracks the ray from `span.0` to `span.1` with the throughput `beta`.
    #[inline]
    pub fn track(&self, ray: &Ray, span: (f32, f32), beta: Rgb, draws: &mut Draws) -> Tracked {
        let Some(channel) = Channel::choose(beta, draws) else {
            return Tracked {
                weight: Rgb::BLACK,
                ..Tracked::THROUGH
            };
        };
        match &self.grid {
            // What only absorbs needs no chance to end a flight.
            None if !self.scatters => Tracked {
                t: None,
                weight: self.transmittance(ray, span, draws),
                emitted: self.emitted_within(span.1 - span.0),
            },
            Some(grid) if !self.scatters => self.attenuate(grid, ray, span, draws),
            None => self.track_homogeneous(span, &channel, draws),
            Some(grid) => self.track_grid(grid, ray, span, &channel, draws),
        }
    }

    fn track_homogeneous(&self, span: (f32, f32), channel: &Channel, draws: &mut Draws) -> Tracked {
        let length = span.1 - span.0;
        let emitted = self.emitted_within(length);
        let t = free_path(draws.next()) / self.sigma_t[channel.index];
        if t < length {
            let density = self.sigma_t * channel.through(self.sigma_t, t);
            let weight = density * self.albedo / channel.mean(density);
            return Tracked {
                t: Some(span.0 + t),
                weight,
                emitted,
            };
        }
        let through = channel.through(self.sigma_t, length);
        Tracked {
            t: None,
            weight: through / channel.mean(through),
            emitted,
        }
    }

    /// ∫ ε exp(−σ t) dt over `length`.
    fn emitted_within(&self, length: f32) -> Rgb {
        if self.emission.is_black() {
            return Rgb::BLACK;
        }
        let channel = |c: usize| match (self.emission[c], self.sigma_t[c]) {
            (0.0, _) => 0.0,
            (e, 0.0) => e * length,
            (e, sigma) => e * -f32::exp_m1(-sigma * length) / sigma,
        };
        Rgb::new(channel(0), channel(1), channel(2))
    }

    fn track_grid(
        &self,
        grid: &Grid,
        ray: &Ray,
        span: (f32, f32),
        channel: &Channel,
        draws: &mut Draws,
    ) -> Tracked {
        let mut emitted = Rgb::BLACK;
        // Densities of what was found so far, channel by channel, up to a common factor.
        let mut found = channel.q.map(|q| f32::from(q > 0.0));
        let mut most = self.most(grid, found);
        let mut depth = free_path(draws.next());
        for (begin, end, bound) in grid.majorants.walk(ray, grid.clip(ray, span)) {
            let mut majorant = bound * most;
            let mut t = begin;
            while let Some(step) = step_within(depth, majorant, end - t) {
                t += step;
                let density = grid.density(ray.at(t));
                draws.exceeded += u64::from(density > bound);
                let weight = found / channel.mean(found);
                emitted += weight * self.emission * (density / majorant);
                // Probability of a collision with the medium itself.
                let real = (self.sigma_t * (density / majorant)).map(|p| p.min(1.0));
                if draws.next() < real[channel.index] {
                    let found = found * real;
                    return Tracked {
                        t: Some(t),
                        weight: found * self.albedo / channel.mean(found),
                        emitted,
                    };
                }
                found *= real.map(|p| 1.0 - p);
                found *= 1.0 / found.max_component();
                most = self.most(grid, found);
                majorant = bound * most;
                depth = free_path(draws.next());
            }
            depth -= (end - t) * majorant;
        }
        Tracked {
            t: None,
            weight: found / channel.mean(found),
            emitted,
        }
    }

    /// The largest extinction of the channels that something is left of: by it steps are taken, so
    /// that where red is gone at once, blue does not cross all of the space in red's steps.
    #[inline]
    fn most(&self, grid: &Grid, left: Rgb) -> f32 {
        let rate = |c: usize| match (left[c] > 0.0, self.sigma_t[c]) {
            (false, _) => 0.0,
            // It is only seen where something collides.
            (true, 0.0) if self.emission[c] > 0.0 => grid.majorants.once_a_cell(),
            (true, sigma) => sigma,
        };
        rate(0).max(rate(1)).max(rate(2))
    }

    /// The share of light that gets through, in the mean over `draws`.
    #[inline]
    pub fn transmittance(&self, ray: &Ray, span: (f32, f32), draws: &mut Draws) -> Rgb {
        match &self.grid {
            None => self.sigma_t.map(|sigma| through(sigma, span.1 - span.0)),
            Some(grid) => self.attenuate(grid, ray, span, draws).weight,
        }
    }

    /// Ratio tracking: nothing is scattered, all that is met attenuates.
    fn attenuate(&self, grid: &Grid, ray: &Ray, span: (f32, f32), draws: &mut Draws) -> Tracked {
        let mut tracked = Tracked::THROUGH;
        let mut most = self.most(grid, tracked.weight);
        let mut depth = free_path(draws.next());
        for (begin, end, bound) in grid.majorants.walk(ray, grid.clip(ray, span)) {
            let mut majorant = bound * most;
            let mut t = begin;
            while let Some(step) = step_within(depth, majorant, end - t) {
                t += step;
                let density = grid.density(ray.at(t));
                draws.exceeded += u64::from(density > bound);
                let share = density / majorant;
                tracked.emitted += tracked.weight * self.emission * share;
                tracked.weight *= (self.sigma_t * share).map(|p| 1.0 - p.min(1.0));
                let left = tracked.weight.max_component();
                if left < ROULETTE_BELOW {
                    if draws.next() * ROULETTE_BELOW >= left {
                        tracked.weight = Rgb::BLACK;
                        return tracked;
                    }
                    tracked.weight *= ROULETTE_BELOW / left;
                }
                most = self.most(grid, tracked.weight);
                majorant = bound * most;
                depth = free_path(draws.next());
            }
            depth -= (end - t) * majorant;
        }
        tracked
    }

    /// exp(−σ_t t), where the medium is homogeneous.
    #[inline]
    pub fn transmittance_over(&self, t: f32) -> Rgb {
        self.sigma_t.map(|sigma| through(sigma, t))
    }

    /// σ_s exp(−σ_t t): the share of light per length that is scattered at the distance `t` of a
    /// span's begin, where the medium is homogeneous.
    #[inline]
    pub fn scattered_at(&self, t: f32) -> Rgb {
        self.albedo * self.sigma_t * self.sigma_t.map(|sigma| through(sigma, t))
    }

    /// Density in 1/m with which [`Medium::track`] scatters at the distance `t` after a span's
    /// begin, where the medium is homogeneous and the throughput `beta`.
    #[inline]
    pub fn pdf_distance(&self, t: f32, beta: Rgb) -> f32 {
        let density = self.sigma_t * self.sigma_t.map(|sigma| through(sigma, t));
        let sum: f32 = beta.to_array().iter().sum();
        if sum > 0.0 {
            (beta * density).to_array().iter().sum::<f32>() / sum
        } else {
            0.0
        }
    }
}

/// Optical thickness until the next collision; > 0 and finite. The smallest number stands for all
/// that round to it: at 0 light would be scattered where it is.
#[inline]
fn free_path(u: f32) -> f32 {
    -f32::ln_1p(-u.max(0.25 * f32::EPSILON))
}

/// How far it is to the next collision, if that is within `length`. Nothing collides where the
/// bound is 0.
#[inline]
fn step_within(depth: f32, majorant: f32, length: f32) -> Option<f32> {
    let step = depth / majorant;
    (step < length).then_some(step)
}

/// exp(−σ t); 1 for σ = 0 at infinity, too.
#[inline]
fn through(sigma: f32, t: f32) -> f32 {
    if sigma == 0.0 {
        1.0
    } else {
        (-sigma * t).exp()
    }
}

/// The channel that is tracked.
struct Channel {
    index: usize,
    /// Probability of each.
    q: Rgb,
}

impl Channel {
    /// Chooses in proportion to `beta`; None if all is black.
    #[inline]
    fn choose(beta: Rgb, draws: &mut Draws) -> Option<Self> {
        // Scaled first: the sum of huge throughputs may overflow.
        let most = beta.max_component();
        let q = beta * (1.0 / most);
        let sum: f32 = q.to_array().iter().sum();
        if !(most > 0.0 && sum.is_finite()) {
            return None;
        }
        let q = q * (1.0 / sum);
        let u = draws.next();
        let last = (0..3).rev().find(|&c| q[c] > 0.0)?;
        let index = if u < q[0] {
            0
        } else if u < q[0] + q[1] {
            1
        } else {
            2
        };
        Some(Self {
            index: index.min(last),
            q,
        })
    }

    /// Σ q_c p_c; exact where all channels are alike, so that light that is only scattered keeps its
    /// strength to the last digit.
    #[inline]
    fn mean(&self, p: Rgb) -> f32 {
        if p[0] == p[1] && p[1] == p[2] {
            return p[0];
        }
        (self.q * p).to_array().iter().sum()
    }

    /// exp(−σ t) of every channel that is there. The tracked one is among them, which met a chance
    /// of 2⁻²⁴ at the least, so that the mean is never 0.
    #[inline]
    fn through(&self, sigma: Rgb, t: f32) -> Rgb {
        let share = |c: usize| {
            if self.q[c] > 0.0 {
                through(sigma[c], t)
            } else {
                0.0
            }
        };
        Rgb::new(share(0), share(1), share(2))
    }
}
