//! The error of a picture without a reference, from two independent halves.
//!
//! Even and odd passes take scrambles (or streams) of their own. Let a and b be the means of the
//! two halves: x = (a + b)/2 is the picture, d = (a − b)/2 has the same variance as the error
//! s = x − E x, for Owen-scrambled Sobol points as for independent numbers, because nothing is
//! assumed about samples within a half. So the mean of d² over pixels and channels estimates the
//! mean square error of *this* picture, bias left aside.
//!
//! *Interval.* For independent a and b with errors α and β, s² − d² = αβ, so Var(s² − d²) =
//! Var a · Var b = 4σ⁴ whatever the distribution: heavy tails raise estimate and error together.
//! Over pixels and channels that is 4 Σ Cov(d_c, d_c')². What is needed is Σ σ⁴, and with one d a
//! pixel it is not known. Two estimates of it, each right where the other is not, and never much
//! too large; the larger one counts:
//!
//! - (dᵢ·dⱼ)² of neighbouring pixels, right where their noise is alike;
//! - (d'·d'')² of the same pixel, d' from the passes before a mark (a power of two) and d'' from
//!   those after it, right where single pixels or lines make up most of the error, such as the
//!   edges of lamps. Only ratios between pixels are taken from it: the passes of a Sobol sequence
//!   shrink differently. d' and d'' of Sobol points are correlated; E(d'd'')² = (1 + 2ρ²)σ'²σ''²
//!   for normal ones.
//!
//! Before there is a mark, d⁴/3 takes the place of the latter, right for normal d.
//!
//! Errors that are correlated between pixels (photons, splats) count as fewer pixels: the sum is
//! multiplied by Σ ρ² over lags within a tile (for normal d, Cov(dᵢ², dⱼ²) = 2 Cov(dᵢ, dⱼ)²).
//! Farther ones are not looked at: the light walks of one pass of `bdpt` and `vcm` are moved alike
//! for all pixels, and where nearly all of the error is theirs and smooth, the interval is too short
//! (in simulations without any noise of the eye walks it held in 8 of 10 cases).

use serde::Serialize;

use super::tiles::{TILE, TILE_PIXELS};

/// Largest distance between pixels whose correlation is looked at.
const LAGS: usize = 4;
/// Two-sided 95 % of the normal distribution.
const Z95: f64 = 1.959_963_985;

/// Estimated root mean square error over pixels and channels, in units of radiance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ErrorEstimate {
    /// The estimate.
    pub rmse: f64,
    /// The interval that holds the error of this picture in 95 of 100 cases.
    pub interval: [f64; 2],
    /// Mean of the picture over pixels and channels.
    pub mean: f64,
}

impl ErrorEstimate {
    /// RMSE / mean; none for a black picture.
    pub fn relative(&self) -> Option<f64> {
        (self.mean > 0.0).then(|| self.rmse / self.mean)
    }

    /// The interval divided by the mean; none for a black picture.
    pub fn relative_interval(&self) -> Option<[f64; 2]> {
        (self.mean > 0.0).then(|| self.interval.map(|x| x / self.mean))
    }
}

/// Sums over the pixels of one tile, and of all tiles.
#[derive(Clone, Copy, Default)]
pub(super) struct HalfSums {
    pixels: u64,
    mean: f64,
    squares: f64,
    /// Σ (dᵢ·dⱼ)² over neighbours, and their number.
    products: (f64, u64),
    /// Σ |d|⁴.
    fourth: f64,
    parts: PartSums,
    /// Σ dᵢ·dⱼ over pairs at a lag along x and along y, and their numbers.
    cross: [[(f64, u64); LAGS]; 2],
}

/// Of d before and after the mark, up to factors of their own: Σ d'², Σ d''², Σ d'·d'',
/// Σ (d'·d'')², and the pixels that have both.
#[derive(Clone, Copy, Default)]
struct PartSums {
    squares: [f64; 2],
    cross: f64,
    products: f64,
    pixels: u64,
}

/// A pixel that both halves have samples of.
#[derive(Clone, Copy)]
pub(super) struct PixelHalves {
    /// Half the difference of the halves.
    pub d: [f64; 3],
    /// The picture.
    pub mean: [f64; 3],
    /// d before and after the mark, each up to a factor that all pixels share.
    pub parts: Option<[[f64; 3]; 2]>,
}

/// The pixels of a tile; none where a half has no sample.
pub(super) type TileHalves = [Option<PixelHalves>; TILE_PIXELS];

impl HalfSums {
    /// Of one tile.
    pub fn of(tile: &TileHalves) -> Self {
        let mut sums = Self::default();
        let side = TILE as usize;
        for (i, pixel) in tile.iter().enumerate() {
            let Some(PixelHalves { d, mean, parts }) = pixel else {
                continue;
            };
            sums.pixels += 1;
            sums.mean += mean.iter().sum::<f64>();
            sums.squares += dot(d, d);
            sums.fourth += dot(d, d).powi(2);
            if let Some([before, after]) = parts {
                sums.parts.add(before, after);
            }
            let (x, y) = (i % side, i / side);
            for lag in 1..=LAGS {
                let right = (x + lag < side).then_some(i + lag);
                let below = (y + lag < side).then_some(i + lag * side);
                for (axis, other) in [right, below].into_iter().enumerate() {
                    let Some(PixelHalves { d: e, .. }) = other.and_then(|j| tile[j]) else {
                        continue;
                    };
                    let product = dot(d, &e);
                    add(&mut sums.cross[axis][lag - 1], product);
                    if lag == 1 {
                        add(&mut sums.products, product * product);
                    }
                }
            }
        }
        sums
    }

    /// Adds another tile's.
    pub fn add(&mut self, other: &Self) {
        self.pixels += other.pixels;
        self.mean += other.mean;
        self.squares += other.squares;
        self.fourth += other.fourth;
        self.parts.merge(&other.parts);
        self.products.0 += other.products.0;
        self.products.1 += other.products.1;
        for axis in 0..2 {
            for lag in 0..LAGS {
                self.cross[axis][lag].0 += other.cross[axis][lag].0;
                self.cross[axis][lag].1 += other.cross[axis][lag].1;
            }
        }
    }

    /// The estimate; none without pixels. Where all of the error is made by some thirty pixels or
    /// fewer its interval is short: sixteen with heavy tails are held in 89 cases of 100.
    pub fn estimate(&self) -> Option<ErrorEstimate> {
        if self.pixels == 0 {
            return None;
        }
        let n = self.pixels as f64;
        let square = self.squares / (3.0 * n);
        let rmse = square.sqrt();
        let spread = if square > 0.0 {
            self.relative_spread(square)
        } else {
            0.0
        };
        // ln r² − ln e² is closer to normal than the difference itself. The spread is known from
        // about ν = 4/spread² pixels only.
        let factor = (0.5 * student95(0.25 * spread * spread) * spread).exp();
        Some(ErrorEstimate {
            rmse,
            interval: [rmse / factor, rmse * factor],
            mean: self.mean / (3.0 * n),
        })
    }

    /// Standard deviation of s² − d² over d².
    fn relative_spread(&self, square: f64) -> f64 {
        let n = self.pixels as f64;
        let rho = |axis: usize, lag: usize| {
            let (sum, count) = self.cross[axis][lag];
            if count == 0 {
                return (0.0, 0.0);
            }
            let rho = sum / count as f64 / (3.0 * square);
            // Squares of correlations that are chance alone have the mean 1/count.
            (rho, (rho * rho - 1.0 / count as f64).clamp(0.0, 1.0))
        };
        let axis = |axis| 1.0 + 2.0 * (0..LAGS).map(|lag| rho(axis, lag).1).sum::<f64>();
        let correlation = axis(0) * axis(1);
        let neighbours = 0.5 * (rho(0, 0).1 + rho(1, 0).1);
        let alike = match self.products {
            (_, 0) => 0.0,
            (sum, count) => sum / count as f64 / (1.0 + 2.0 * neighbours),
        };
        let alone = match self.parts.fourth(self.squares) {
            Some(sum) => sum / n,
            None => self.fourth / (3.0 * n),
        };
        let each = alike.max(alone);
        (4.0 * each * correlation / (9.0 * n)).sqrt() / square
    }
}

impl PartSums {
    fn add(&mut self, before: &[f64; 3], after: &[f64; 3]) {
        let cross = dot(before, after);
        self.squares[0] += dot(before, before);
        self.squares[1] += dot(after, after);
        self.cross += cross;
        self.products += cross * cross;
        self.pixels += 1;
    }

    fn merge(&mut self, other: &Self) {
        (0..2).for_each(|i| self.squares[i] += other.squares[i]);
        self.cross += other.cross;
        self.products += other.products;
        self.pixels += other.pixels;
    }

    /// Σ σ⁴ of a picture whose Σ d² is `squares`; none without parts.
    fn fourth(&self, squares: f64) -> Option<f64> {
        let product = self.squares[0] * self.squares[1];
        (self.pixels > 0 && product > 0.0).then(|| {
            let rho2 = (self.cross * self.cross / product).min(1.0);
            self.products / product * squares * squares / (1.0 + 2.0 * rho2)
        })
    }
}

/// Student's two-sided 95 % quantile for ν degrees of freedom, by the first terms of its expansion in
/// `inverse` = 1/ν (Abramowitz and Stegun 26.7.5).
fn student95(inverse: f64) -> f64 {
    let z2 = Z95 * Z95;
    let first = (z2 + 1.0) / 4.0;
    let second = (5.0 * z2 * z2 + 16.0 * z2 + 3.0) / 96.0;
    Z95 * (1.0 + inverse * (first + inverse * second))
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn add(sum: &mut (f64, u64), value: f64) {
    sum.0 += value;
    sum.1 += 1;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::math::hash::{combine, unit_f32};

    /// A number of mean 0 and variance 1 from `key`, with heavy tails.
    fn noise(key: u64) -> f64 {
        let u = f64::from(unit_f32(combine(9, key)));
        // ±√10 in one case of ten.
        if u < 0.05 {
            -10f64.sqrt()
        } else if u < 0.1 {
            10f64.sqrt()
        } else {
            0.0
        }
    }

    /// Whether the interval of a picture of 16 tiles, of 32 with `line`, holds its error; the noise of a pixel is
    /// `passes` values, shared by `shared` pixels in a row.
    fn holds(seed: u64, shared: usize, channels_agree: bool, line: bool) -> bool {
        let (mut sums, mut square) = (HalfSums::default(), 0.0);
        let tiles = if line { 32 } else { 16 };
        for tile in 0..tiles {
            let mut halves: TileHalves = [None; TILE_PIXELS];
            for (i, pixel) in halves.iter_mut().enumerate() {
                // One pixel of 64 is all there is, or all are alike.
                let size = f64::from(u8::from(!line || i == 27));
                let value = |half: u64, c: u64, passes: std::ops::Range<u64>| -> f64 {
                    let c = if channels_agree { 0 } else { c };
                    let place = tile * 64 + (i / shared) as u64;
                    let key = |k| combine(combine(seed, half * 3 + c), place * 8 + k);
                    size * passes.map(|k| noise(key(k))).sum::<f64>()
                };
                let of = |half, range: &std::ops::Range<u64>| {
                    [0, 1, 2].map(|c| value(half, c, range.clone()))
                };
                let difference = |range: std::ops::Range<u64>| {
                    let (a, b) = (of(0, &range), of(1, &range));
                    [0, 1, 2].map(|c: usize| 0.5 * (a[c] - b[c]))
                };
                let (a, b) = (of(0, &(0..8)), of(1, &(0..8)));
                let mean = [0, 1, 2].map(|c: usize| 1.0 + 0.5 * (a[c] + b[c]));
                square += mean.iter().map(|m| (m - 1.0).powi(2)).sum::<f64>();
                *pixel = Some(PixelHalves {
                    d: difference(0..8),
                    mean,
                    parts: Some([difference(0..4), difference(4..8)]),
                });
            }
            sums.add(&HalfSums::of(&halves));
        }
        let error = (square / (3.0 * tiles as f64 * 64.0)).sqrt();
        let [low, high] = sums.estimate().unwrap().interval;
        low <= error && error <= high
    }

    #[test]
    fn intervals_hold_the_error_with_heavy_tails_and_correlated_pixels() {
        let cases = [(1, false), (1, true), (2, true), (4, true)];
        let alike = cases.map(|(shared, agree)| (shared, agree, false));
        for (shared, agree, line) in alike.into_iter().chain([(1, true, true)]) {
            let held = (0..400).filter(|s| holds(*s, shared, agree, line)).count();
            assert!(
                (360..=396).contains(&held),
                "{held} of 400, {shared} pixels"
            );
        }
    }

    #[test]
    fn a_black_picture_has_no_relative_error() {
        let black = PixelHalves {
            d: [0.0; 3],
            mean: [0.0; 3],
            parts: None,
        };
        let tile = [Some(black); TILE_PIXELS];
        let e = HalfSums::of(&tile).estimate().unwrap();
        assert_eq!(
            (e.rmse, e.relative(), e.relative_interval()),
            (0.0, None, None)
        );
        assert!(HalfSums::default().estimate().is_none());
    }
}
