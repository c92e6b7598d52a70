//! Pearson's chi-square test of samplers against the densities they claim.

use glam::{DVec3, Vec3A};
use statrs::function::gamma::gamma_ur;

/// Bins that expect fewer samples are merged, as the statistic is chi-square only in the limit.
const MIN_EXPECTED: f64 = 8.0;
/// The probability that a family of tests fails although every density is right.
const FAMILY_RATE: f64 = 0.01;
/// Each bin is halved at least so often, since a horizon that falls between the nodes of the
/// quadrature goes unnoticed.
const MIN_DEPTH: u32 = 3;
/// And at most so often.
const MAX_DEPTH: u32 = 9;

/// A partition of the sphere into rows and columns around an axis.
pub struct SphereGrid {
    s: DVec3,
    t: DVec3,
    axis: DVec3,
    spread: f64,
    rows: usize,
    columns: usize,
}

impl SphereGrid {
    /// `spread` is the angle in radians at which the density of rows starts to fall: about the
    /// width of a peak at the axis; 1 or more makes them nearly uniform by solid angle.
    pub fn new(axis: Vec3A, spread: f64) -> Self {
        let axis = axis.as_dvec3().normalize();
        let (s, t) = axis.any_orthonormal_pair();
        Self {
            s,
            t,
            axis,
            spread,
            rows: 16,
            columns: 16,
        }
    }

    /// ε and L of the map x = ln(1 + h/ε)/L from h = (1 − cosθ)/2 to [0, 1].
    fn map(&self) -> (f64, f64) {
        let epsilon = (self.spread * self.spread).max(1e-12);
        (epsilon, (1.0 / epsilon).ln_1p())
    }

    /// The direction at (x, y) in the unit square and the solid angle per unit of its area.
    fn direction(&self, x: f64, y: f64) -> (Vec3A, f64) {
        let (epsilon, l) = self.map();
        let h = (epsilon * (x * l).exp_m1()).min(1.0);
        let sin = 2.0 * (h * (1.0 - h)).sqrt();
        let (sin_phi, cos_phi) = (std::f64::consts::TAU * y).sin_cos();
        let d = self.axis * (1.0 - 2.0 * h) + (self.s * cos_phi + self.t * sin_phi) * sin;
        let solid_angle = 4.0 * std::f64::consts::PI * epsilon * l * (x * l).exp();
        (d.as_vec3a(), solid_angle)
    }

    fn bin(&self, d: Vec3A) -> usize {
        let (epsilon, l) = self.map();
        let d = d.as_dvec3().normalize();
        let h = 0.25 * (d - self.axis).length_squared(); // (1 − cosθ)/2 by the chord
        let x = (h / epsilon).ln_1p() / l;
        let y = d.dot(self.t).atan2(d.dot(self.s)) / std::f64::consts::TAU;
        let row = ((x * self.rows as f64) as usize).min(self.rows - 1);
        let column = (y.rem_euclid(1.0) * self.columns as f64) as usize;
        row * self.columns + column.min(self.columns - 1)
    }

    /// The integral of `pdf` over each bin.
    pub fn integrate(&self, pdf: impl Fn(Vec3A) -> f64) -> Vec<f64> {
        let f = |x: f64, y: f64| {
            let (d, solid_angle) = self.direction(x, y);
            pdf(d) * solid_angle
        };
        let (w, h) = (1.0 / self.rows as f64, 1.0 / self.columns as f64);
        let mut bins = Vec::with_capacity(self.rows * self.columns);
        for i in 0..self.rows {
            for j in 0..self.columns {
                let cell = [i as f64 * w, j as f64 * h, w, h];
                bins.push(adaptive(&f, cell, gauss(&f, cell), 0));
            }
        }
        bins
    }

    /// How many of `n` samples fall into each bin, and how many were rejected.
    pub fn count(&self, n: u64, mut sample: impl FnMut() -> Option<Vec3A>) -> (Vec<u64>, u64) {
        let (mut bins, mut none) = (vec![0; self.rows * self.columns], 0);
        for _ in 0..n {
            match sample() {
                Some(d) => bins[self.bin(d)] += 1,
                None => none += 1,
            }
        }
        (bins, none)
    }
}

/// Tests that `sample` draws directions by `pdf` (1/sr) and is rejected with the probability that
/// is missing to 1. Returns the p-value.
pub fn test_directions(
    grid: &SphereGrid,
    n: u64,
    pdf: impl Fn(Vec3A) -> f64,
    sample: impl FnMut() -> Option<Vec3A>,
) -> f64 {
    let mut probabilities = grid.integrate(pdf);
    let total: f64 = probabilities.iter().sum();
    assert!(total < 1.0 + 2e-3, "the density integrates to {total}");
    let (mut counts, none) = grid.count(n, sample);
    // The bin of the rejected samples; quadrature leaves a total that is 1 only nearly.
    let missing = 1.0 - total;
    probabilities.push(if missing < 2e-3 && none == 0 {
        0.0
    } else {
        missing
    });
    counts.push(none);
    p_value(&probabilities, &counts)
}

/// The probability of counts at least as far from `probabilities` as these.
pub fn p_value(probabilities: &[f64], counts: &[u64]) -> f64 {
    let n: u64 = counts.iter().sum();
    let mut bins: Vec<(f64, f64)> = probabilities
        .iter()
        .zip(counts)
        .map(|(p, &c)| (p * n as f64, c as f64))
        .collect();
    bins.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut statistic, mut used) = (0.0, 0_u32);
    let mut pool = (0.0, 0.0);
    for (expected, observed) in bins {
        pool = (pool.0 + expected, pool.1 + observed);
        if pool.0 >= MIN_EXPECTED {
            statistic += (pool.1 - pool.0).powi(2) / pool.0;
            used += 1;
            pool = (0.0, 0.0);
        }
    }
    // The rest is too little for a term of its own; the Poisson tail beyond this is below 1e-10.
    let (expected, observed) = pool;
    assert!(
        observed <= 4.0 * MIN_EXPECTED,
        "{observed} samples where {expected} are expected"
    );
    if used < 2 {
        return 1.0; // all samples fall into one bin, as they should
    }
    gamma_ur(f64::from(used - 1) * 0.5, statistic * 0.5)
}

/// Panics if the smallest p-value of a family is too small for its size (Šidák).
pub fn assert_family(p_values: &[(String, f64)]) {
    let least = 1.0 - (1.0 - FAMILY_RATE).powf(1.0 / p_values.len() as f64);
    let failed: Vec<_> = p_values
        .iter()
        .filter(|(_, p)| p.is_nan() || *p <= least)
        .collect();
    assert!(
        failed.is_empty(),
        "{} of {} fail at {least:.2e}: {failed:#?}",
        failed.len(),
        p_values.len()
    );
}

/// Gauss–Legendre with 3 × 3 nodes over [x, y, width, height].
fn gauss(f: &impl Fn(f64, f64) -> f64, [x, y, w, h]: [f64; 4]) -> f64 {
    let node = 0.5 * 0.6_f64.sqrt();
    let nodes = [
        (0.5 - node, 5.0 / 18.0),
        (0.5, 8.0 / 18.0),
        (0.5 + node, 5.0 / 18.0),
    ];
    let mut sum = 0.0;
    for (a, wa) in nodes {
        for (b, wb) in nodes {
            sum += wa * wb * f(x + a * w, y + b * h);
        }
    }
    sum * w * h
}

fn adaptive(f: &impl Fn(f64, f64) -> f64, cell: [f64; 4], whole: f64, depth: u32) -> f64 {
    let [x, y, w, h] = [cell[0], cell[1], 0.5 * cell[2], 0.5 * cell[3]];
    let quarters = [
        [x, y, w, h],
        [x + w, y, w, h],
        [x, y + h, w, h],
        [x + w, y + h, w, h],
    ];
    let parts = quarters.map(|q| gauss(f, q));
    let sum: f64 = parts.iter().sum();
    let close = (sum - whole).abs() <= 2e-7 + 1e-3 * sum.abs();
    if depth >= MAX_DEPTH || (close && depth >= MIN_DEPTH) {
        return sum;
    }
    quarters
        .iter()
        .zip(parts)
        .map(|(&q, part)| adaptive(f, q, part, depth + 1))
        .sum()
}
