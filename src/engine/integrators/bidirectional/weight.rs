//! The weight of one strategy among all that could have sampled the same path (Veach 1997,
//! sections 9.2 and 10.2).
//!
//! The density p(s) of a path under the strategy (s, n − s) is the product of the forward densities
//! of v₀ … vₛ₋₁, as the walk from the light draws them, and of the reverse ones of vₛ … vₙ₋₁, as
//! the walk from the lens does. Neighbouring strategies differ in one vertex, so that all ratios
//! p(i) / p(s) follow by one division a step from the densities that both walks keep (Veach,
//! equation 10.9).
//!
//! A vertex is (point, event): its density contains the probability of the event (rule 2 of the code map).
//! Roulette, absorption and transmittance are in no density.

use super::strategies::Strategies;

/// The densities of one vertex of a subpath.
#[derive(Clone, Copy, Debug)]
pub struct Density {
    /// As its own walk draws it; > 0, 1/m² (at infinity 1/sr).
    pub own: f32,
    /// As the walk from the other end would draw it, 0 if it cannot.
    pub other: f32,
    /// The event drawn there has a density, so that a connection may end there. True at both ends
    /// of a path.
    pub connectible: bool,
    /// It is diffuse, so that vertices may be merged there.
    pub mergeable: bool,
}

/// How two subpaths make one path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meeting {
    /// Their last vertices are connected.
    Connection,
    /// The last vertex of `light` was merged with one that the eye walk drew after `eye`.
    Merging,
}

/// A complete path of n = s + t vertices, with what the connection of its two parts decides.
#[derive(Clone, Copy, Debug)]
pub struct Join<'a> {
    /// The s vertices from the light on.
    pub light: &'a [Density],
    /// The t vertices from the lens on.
    pub eye: &'a [Density],
    /// Densities `other` of the last and the last but one vertex of `light`.
    pub light_other: [f32; 2],
    /// The same of `eye`.
    pub eye_other: [f32; 2],
    /// Density of a shadow ray to v₀ over that of a walk that starts there.
    pub shadow_ratio: f32,
    /// The events at the ends of `light` and `eye` that meet are diffuse.
    pub diffuse: [bool; 2],
    /// How the two parts meet.
    pub meeting: Meeting,
    /// The light has no size: s = 0 cannot find it.
    pub zero_size: bool,
    /// The light lies at infinity: v₀ is joined to no lens.
    pub infinite: bool,
}

/// Density `other` of vertex `i` of a subpath whose last two are decided by the connection.
#[inline]
fn other(path: &[Density], ends: [f32; 2], i: usize) -> f32 {
    match path.len() - i {
        1 => ends[0],
        2 => ends[1],
        _ => path[i].other,
    }
}

/// The weight of the strategy that sampled `join`: its density, or a power of it, over the sum of
/// those of all strategies that are on.
///
/// Merging at vᵢ has the density p(i + 1) times that of vᵢ from the eye times the number of light
/// paths that fall on the area of merging (Georgiev et al. 2012, equation 11).
pub fn weight(join: &Join<'_>, strategies: &Strategies) -> f32 {
    let sum = Sum { join, strategies };
    let (own, met) = match join.meeting {
        Meeting::Connection => {
            let own = strategies
                .heuristic
                .share(sum.start_ratio(join.light.len()));
            (own, own)
        }
        // The sum over the light's vertices meets the merging itself on its way.
        Meeting::Merging => {
            let own = sum.merging(1.0, join.light_other[0], join.diffuse[0]);
            let ends = join.eye.last().is_none_or(|v| v.connectible);
            (own, sum.connection(join.light.len(), 1.0, ends))
        }
    };
    if own == 0.0 {
        return 0.0;
    }
    (own / (met + sum.toward_light() + sum.toward_lens())) as f32
}

/// Adds up strategies.
struct Sum<'a> {
    join: &'a Join<'a>,
    strategies: &'a Strategies,
}

impl Sum<'_> {
    /// Number of vertices of the whole path.
    #[inline]
    fn n(&self) -> usize {
        self.join.light.len() + self.join.eye.len()
    }

    /// What stands beside p(i) for shadow rays; they draw v₀ by a density of their own. A light
    /// joined straight to the lens is drawn as the walks from lights start.
    #[inline]
    fn start_ratio(&self, i: usize) -> f64 {
        if i == 1 && self.n() > 2 {
            f64::from(self.join.shadow_ratio)
        } else {
            1.0
        }
    }

    /// The share of the strategy (i, n − i), of a density `ratio` times that which sampled the
    /// path; `open`: the events at both ends of its connection have densities.
    #[inline]
    fn connection(&self, i: usize, ratio: f64, open: bool) -> f64 {
        let (join, n) = (self.join, self.n());
        let exists = match i {
            0 => !join.zero_size,
            1 if n == 2 => !join.zero_size && !join.infinite,
            _ => open,
        };
        if exists && self.strategies.is_on(i, n - i) {
            self.strategies.heuristic.share(ratio * self.start_ratio(i))
        } else {
            0.0
        }
    }

    /// The share of merging at a vertex that walks from the eye draw with the density `eye`.
    #[inline]
    fn merging(&self, ratio: f64, eye: f32, diffuse: bool) -> f64 {
        if diffuse && self.strategies.merging > 0.0 {
            let density = ratio * f64::from(eye) * self.strategies.merging;
            self.strategies.heuristic.share(density)
        } else {
            0.0
        }
    }

    /// Strategies of fewer and fewer vertices from the light: s − 1, s − 2 … 0. The events at the
    /// ends that were connected are those that were evaluated, the others those that were drawn.
    #[inline]
    fn toward_light(&self) -> f64 {
        let join = self.join;
        let (mut sum, mut ratio, mut open) = (0.0, 1.0, true);
        let mut diffuse = join.diffuse[0];
        for (i, v) in join.light.iter().enumerate().rev() {
            let eye = other(join.light, join.light_other, i);
            // v₀ is never merged.
            sum += self.merging(ratio, eye, diffuse && i > 0);
            ratio *= f64::from(eye) / f64::from(v.own);
            if ratio == 0.0 {
                break;
            }
            let before = i.checked_sub(1).map(|before| join.light[before]);
            let next_open = before.is_none_or(|v| v.connectible);
            sum += self.connection(i, ratio, open && next_open);
            open = next_open;
            diffuse = before.is_some_and(|v| v.mergeable);
        }
        sum
    }

    /// Of more and more of them: s + 1, s + 2 … n − 1; the lens itself is never met.
    #[inline]
    fn toward_lens(&self) -> f64 {
        let (join, n) = (self.join, self.n());
        let (mut sum, mut ratio) = (0.0, 1.0);
        let (mut open, mut diffuse) = match join.meeting {
            Meeting::Connection => (true, join.diffuse[1]),
            Meeting::Merging => join
                .eye
                .last()
                .map_or((true, false), |v| (v.connectible, v.mergeable)),
        };
        for (i, v) in join.eye.iter().enumerate().skip(1).rev() {
            ratio *= f64::from(other(join.eye, join.eye_other, i)) / f64::from(v.own);
            if ratio == 0.0 {
                break;
            }
            let next = &join.eye[i - 1];
            sum += self.merging(ratio, v.own, diffuse && i + 1 < n)
                + self.connection(n - i, ratio, open && next.connectible);
            (open, diffuse) = (next.connectible, next.mergeable);
        }
        sum
    }
}
