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
    /// The event drawn there has a density, so that a connection may end there.
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

impl Join<'_> {
    /// Whether the connection between the vertices i − 1 and i of the path has a density. The two
    /// ends that were connected have: their events are those that were evaluated.
    #[inline]
    fn connects(&self, i: usize) -> bool {
        let (s, n) = (self.light.len(), self.light.len() + self.eye.len());
        match i {
            0 => !self.zero_size,
            1 if n == 2 => !self.zero_size && !self.infinite,
            _ => {
                let open = |v: usize| {
                    v + 1 == s
                        || v == s && self.meeting == Meeting::Connection
                        || v == 0
                        || v + 1 == n
                        || if v < s {
                            self.light[v].connectible
                        } else {
                            self.eye[n - 1 - v].connectible
                        }
                };
                open(i - 1) && open(i)
            }
        }
    }

    /// Whether vertex `i` of the path may be one that was merged.
    #[inline]
    fn merges(&self, i: usize) -> bool {
        let (s, n) = (self.light.len(), self.light.len() + self.eye.len());
        if i == 0 || i + 1 == n {
            false
        } else if i + 1 == s {
            self.diffuse[0]
        } else if i == s && self.meeting == Meeting::Connection {
            self.diffuse[1]
        } else if i < s {
            self.light[i].mergeable
        } else {
            self.eye[n - 1 - i].mergeable
        }
    }

    /// What stands beside p(i) for shadow rays; they draw v₀ by a density of their own. A light
    /// joined straight to the lens is drawn as the walks from lights start.
    #[inline]
    fn start_ratio(&self, i: usize) -> f64 {
        if i == 1 && self.light.len() + self.eye.len() > 2 {
            f64::from(self.shadow_ratio)
        } else {
            1.0
        }
    }
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
    let (s, n) = (join.light.len(), join.light.len() + join.eye.len());
    let merging = strategies.merging;
    let connection = |i: usize, ratio: f64| {
        if join.connects(i) && strategies.is_on(i, n - i) {
            strategies.heuristic.share(ratio * join.start_ratio(i))
        } else {
            0.0
        }
    };
    let merge = |i: usize, ratio: f64, eye: f32| {
        if merging > 0.0 && join.merges(i) {
            strategies.heuristic.share(ratio * f64::from(eye) * merging)
        } else {
            0.0
        }
    };
    let (own, mut sum) = match join.meeting {
        Meeting::Connection => {
            let own = strategies.heuristic.share(join.start_ratio(s));
            (own, own)
        }
        // The sum meets the merging itself on its way.
        Meeting::Merging => (merge(s - 1, 1.0, join.light_other[0]), connection(s, 1.0)),
    };

    // Fewer and fewer vertices from the light: s − 1, s − 2 … 0.
    let mut ratio = 1.0;
    for (i, v) in join.light.iter().enumerate().rev() {
        let eye = other(join.light, join.light_other, i);
        sum += merge(i, ratio, eye);
        ratio *= f64::from(eye) / f64::from(v.own);
        if ratio == 0.0 {
            break;
        }
        sum += connection(i, ratio);
    }

    // More and more of them: s + 1, s + 2 … n − 1; the lens itself is never met.
    let mut ratio = 1.0;
    for (i, v) in join.eye.iter().enumerate().skip(1).rev() {
        ratio *= f64::from(other(join.eye, join.eye_other, i)) / f64::from(v.own);
        if ratio == 0.0 {
            break;
        }
        sum += merge(n - 1 - i, ratio, v.own) + connection(n - i, ratio);
    }
    if own == 0.0 { 0.0 } else { (own / sum) as f32 }
}
