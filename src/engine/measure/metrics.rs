//! Differences between a picture and its reference.
//!
//! All means run over pixels and channels, in f64. Pixels with a channel that is not finite, in
//! either picture, are left out and counted. A few pixels of many samples' brightness (fireflies)
//! can make up most of a mean square: [`Metrics::without_worst`] says what is left without them. Nothing is subtracted for the reference's own
//! noise; [`ReferenceNoise`] says how large that is.

use serde::Serialize;

/// Added to r² in the relative error, so that black pixels do not count without bound.
pub const RELMSE_FLOOR: f64 = 0.01;

/// Figures for picture x against reference r.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Metrics {
    /// √ mean (x − r)², in units of radiance.
    pub rmse: f64,
    /// mean |x − r|, in units of radiance.
    pub mae: f64,
    /// mean (x − r), in units of radiance.
    pub bias: f64,
    /// mean (x − r)² / (r² + 0.01).
    pub relmse: f64,
    /// mean (x − r)² / (mean r)², independent of exposure; none if the reference is black.
    pub nmse: Option<f64>,
    /// mean |x − r| / (|x| + |r|), in [0, 1], with 0/0 = 0 (Vogels et al. 2018, *Denoising with
    /// Kernel Prediction and Asymmetric Loss Functions*, without their ε).
    pub smape: f64,
    /// Pixels left out because a channel was not finite.
    pub non_finite: u64,
}

impl Metrics {
    /// Compares pixel by pixel; none if the pictures differ in size or no pixel is finite.
    pub fn new(image: &[[f32; 3]], reference: &[[f32; 3]]) -> Option<Self> {
        if image.len() != reference.len() {
            return None;
        }
        let mut sums = Sums::default();
        for (x, r) in image.iter().zip(reference) {
            if is_finite(x) && is_finite(r) {
                sums.add(x, r);
            }
        }
        let n = 3.0 * sums.pixels as f64;
        let mean_reference = sums.reference / n;
        (sums.pixels > 0).then(|| Self {
            rmse: (sums.squares / n).sqrt(),
            mae: sums.absolute / n,
            bias: sums.signed / n,
            relmse: sums.relative / n,
            nmse: over_square(sums.squares / n, mean_reference),
            smape: sums.symmetric / n,
            non_finite: image.len() as u64 - sums.pixels,
        })
    }
}

/// Share of the pixels that [`Metrics::without_worst`] leaves out.
pub const WORST_SHARE: f64 = 0.001;

impl Metrics {
    /// The figures without the thousandth of the finite pixels whose squared error, summed over
    /// channels, is largest (at least one pixel). The mean of the reference, by which nmse is
    /// divided, leaves them out too.
    pub fn without_worst(image: &[[f32; 3]], reference: &[[f32; 3]]) -> Option<Self> {
        if image.len() != reference.len() {
            return None;
        }
        let pairs = image.iter().zip(reference);
        let mut pairs: Vec<(f64, [f32; 3], [f32; 3])> = pairs
            .filter(|(x, r)| is_finite(x) && is_finite(r))
            .map(|(x, r)| (squared_error(x, r), *x, *r))
            .collect();
        let non_finite = (image.len() - pairs.len()) as u64;
        let worst = (pairs.len() as f64 * WORST_SHARE).ceil() as usize;
        let kept = pairs.len().checked_sub(worst).filter(|n| *n > 0)?;
        pairs.select_nth_unstable_by(kept, |a, b| a.0.total_cmp(&b.0));
        let (x, r): (Vec<_>, Vec<_>) = pairs[..kept].iter().map(|(_, x, r)| (*x, *r)).unzip();
        Self::new(&x, &r).map(|m| Self { non_finite, ..m })
    }
}

fn squared_error(x: &[f32; 3], r: &[f32; 3]) -> f64 {
    let square = |c: usize| (f64::from(x[c]) - f64::from(r[c])).powi(2);
    square(0) + square(1) + square(2)
}

#[derive(Default)]
struct Sums {
    pixels: u64,
    squares: f64,
    absolute: f64,
    signed: f64,
    relative: f64,
    symmetric: f64,
    reference: f64,
}

impl Sums {
    fn add(&mut self, image: &[f32; 3], reference: &[f32; 3]) {
        self.pixels += 1;
        for (&x, &r) in image.iter().zip(reference) {
            let (x, r) = (f64::from(x), f64::from(r));
            let d = x - r;
            self.squares += d * d;
            self.absolute += d.abs();
            self.signed += d;
            self.relative += d * d / (r * r + RELMSE_FLOOR);
            if d != 0.0 {
                self.symmetric += d.abs() / (x.abs() + r.abs());
            }
            self.reference += r;
        }
    }
}

/// What a perfect picture would get, from the standard errors of the reference alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ReferenceNoise {
    /// √ mean se², in units of radiance.
    pub rmse: f64,
    /// mean se² / (r² + 0.01).
    pub relmse: f64,
    /// mean se² / (mean r)²; none if the reference is black.
    pub nmse: Option<f64>,
}

impl ReferenceNoise {
    /// From a reference and its standard errors pixel by pixel; none if they differ in size or no
    /// pixel is finite.
    pub fn new(reference: &[[f32; 3]], standard_error: &[[f32; 3]]) -> Option<Self> {
        if reference.len() != standard_error.len() {
            return None;
        }
        let (mut pixels, mut squares, mut relative, mut sum) = (0u64, 0.0, 0.0, 0.0);
        for (r, se) in reference.iter().zip(standard_error) {
            if !(is_finite(r) && is_finite(se)) {
                continue;
            }
            pixels += 1;
            for (&r, &se) in r.iter().zip(se) {
                let (r, variance) = (f64::from(r), f64::from(se).powi(2));
                squares += variance;
                relative += variance / (r * r + RELMSE_FLOOR);
                sum += r;
            }
        }
        let n = 3.0 * pixels as f64;
        (pixels > 0).then(|| Self {
            rmse: (squares / n).sqrt(),
            relmse: relative / n,
            nmse: over_square(squares / n, sum / n),
        })
    }
}

/// Mean over pixels of each channel, finite pixels only; none if there are none.
pub fn channel_means(image: &[[f32; 3]]) -> Option<[f64; 3]> {
    let mut sums = [0.0; 3];
    let mut pixels = 0u64;
    for pixel in image.iter().filter(|p| is_finite(p)) {
        pixels += 1;
        for (sum, &x) in sums.iter_mut().zip(pixel) {
            *sum += f64::from(x);
        }
    }
    (pixels > 0).then(|| sums.map(|s| s / pixels as f64))
}

fn is_finite(pixel: &[f32; 3]) -> bool {
    pixel.iter().all(|x| x.is_finite())
}

fn over_square(squares: f64, mean: f64) -> Option<f64> {
    (mean != 0.0).then(|| squares / (mean * mean))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_near(a: f64, b: f64) {
        assert!((a - b).abs() <= 1e-12 * b.abs().max(1.0), "{a} is not {b}");
    }

    #[test]
    fn figures_agree_with_values_computed_by_hand() {
        // Differences 1, 0, −2 | 0, 0, 3; reference 1, 2, 4 | 0, 0, 1: mean 8/6.
        let m = Metrics::new(
            &[[2.0, 2.0, 2.0], [0.0, 0.0, 4.0]],
            &[[1.0, 2.0, 4.0], [0.0, 0.0, 1.0]],
        )
        .unwrap();
        assert_near(m.rmse, (14.0f64 / 6.0).sqrt());
        assert_near(m.mae, 1.0);
        assert_near(m.bias, 2.0 / 6.0);
        assert_near(m.relmse, (1.0 / 1.01 + 4.0 / 16.01 + 9.0 / 1.01) / 6.0);
        assert_near(m.nmse.unwrap(), (14.0 / 6.0) / (64.0 / 36.0));
        assert_near(m.smape, (1.0 / 3.0 + 2.0 / 6.0 + 3.0 / 5.0) / 6.0);
        assert_eq!(m.non_finite, 0);
    }

    #[test]
    fn black_references_have_no_normalised_error() {
        let m = Metrics::new(&[[1.0; 3]], &[[0.0; 3]]).unwrap();
        assert_eq!(m.nmse, None);
        assert_near(m.relmse, 100.0);
        assert_near(m.smape, 1.0);
    }

    #[test]
    fn pixels_that_are_not_finite_are_left_out_and_counted() {
        let x = [[f32::NAN, 1.0, 1.0], [3.0; 3], [1.0; 3]];
        let r = [[1.0; 3], [1.0; 3], [f32::INFINITY; 3]];
        let m = Metrics::new(&x, &r).unwrap();
        assert_eq!(m.non_finite, 2);
        assert_near(m.rmse, 2.0);
        assert_eq!(Metrics::new(&[[f32::NAN; 3]], &[[1.0; 3]]), None);
        assert_eq!(channel_means(&x), Some([2.0; 3]));
        assert_eq!(channel_means(&[[f32::NAN; 3]]), None);
    }

    #[test]
    fn the_worst_thousandth_is_left_out() {
        let mut x = vec![[1.0f32, 2.0, 3.0]; 2000];
        let r = vec![[1.0f32, 2.0, 2.0]; 2000];
        (x[7], x[1234]) = ([1e6; 3], [0.0, 2.0, 1000.0]);
        let all = Metrics::new(&x, &r).unwrap();
        let most = Metrics::without_worst(&x, &r).unwrap();
        assert!(all.rmse > 1e4);
        assert_near(most.rmse, (1.0f64 / 3.0).sqrt());
        assert_near(most.bias, 1.0 / 3.0);
        x[7][0] = f32::NAN;
        assert_eq!(Metrics::without_worst(&x, &r).unwrap().non_finite, 1);
        assert_eq!(Metrics::without_worst(&x[..1], &r[..1]), None);
    }

    #[test]
    fn different_sizes_are_not_compared() {
        assert_eq!(Metrics::new(&[[1.0; 3]], &[[1.0; 3]; 2]), None);
        assert_eq!(ReferenceNoise::new(&[[1.0; 3]], &[]), None);
    }

    #[test]
    fn normalised_error_does_not_depend_on_exposure() {
        let (x, r) = (
            [[2.0, 3.0, 5.0], [1.0, 0.5, 0.25]],
            [[2.5, 2.0, 5.5], [0.5; 3]],
        );
        let brighter = |image: [[f32; 3]; 2]| image.map(|p| p.map(|v| v * 1024.0));
        let (a, b) = (
            Metrics::new(&x, &r).unwrap(),
            Metrics::new(&brighter(x), &brighter(r)).unwrap(),
        );
        assert_near(a.nmse.unwrap(), b.nmse.unwrap());
        assert!(b.relmse < a.relmse * 2.0 && b.rmse > a.rmse * 1000.0);
    }

    #[test]
    fn noise_of_the_reference_is_the_error_of_a_perfect_picture() {
        // se 0.1, 0.2, 0.2 on 1, 2, 0: Σ se² = 0.09.
        let n = ReferenceNoise::new(&[[1.0, 2.0, 0.0]], &[[0.1, 0.2, 0.2]]).unwrap();
        assert!((n.rmse - 0.03f64.sqrt()).abs() < 1e-8);
        assert!((n.nmse.unwrap() - 0.03).abs() < 1e-8);
        let relmse = (0.01 / 1.01 + 0.04 / 4.01 + 0.04 / 0.01) / 3.0;
        assert!((n.relmse - relmse).abs() < 1e-6);
    }
}
