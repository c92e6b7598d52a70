//! How fast an error falls, and when it will have fallen far enough.
//!
//! The mean square error of a picture is its variance plus the square of its bias. Independent
//! samples let the root of the variance fall as n^(−1/2); Sobol points let it fall at least as
//! fast where the integrand is smooth. The bias stays: of a biased method the curve levels off.

use serde::Serialize;

/// One look at a render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Completed passes.
    pub passes: u64,
    /// Seconds since the job was accepted.
    pub seconds: f64,
    /// Its error, of whatever measure falls with the root of the variance.
    pub error: f64,
}

/// A power law fitted to an error: `factor` · nˢ with s = `slope`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rate {
    /// s.
    pub slope: f64,
    /// The error at n = 1.
    pub factor: f64,
}

/// Least squares through the logarithms of positive pairs (n, error); none without two different n.
pub fn fit(points: impl IntoIterator<Item = (f64, f64)>) -> Option<Rate> {
    let logs = points.into_iter().filter(|(n, e)| *n > 0.0 && *e > 0.0);
    let logs: Vec<(f64, f64)> = logs.map(|(n, e)| (n.ln(), e.ln())).collect();
    let count = logs.len() as f64;
    let mean = |f: fn(&(f64, f64)) -> f64| logs.iter().map(f).sum::<f64>() / count;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let (mut xx, mut xy) = (0.0, 0.0);
    for p in &logs {
        xx += (p.0 - x) * (p.0 - x);
        xy += (p.0 - x) * (p.1 - y);
    }
    let slope = xy / xx;
    (xx > 0.0).then(|| Rate {
        slope,
        factor: (y - slope * x).exp(),
    })
}

/// The part of a root mean square error against a reference that the reference's own noise leaves.
/// Errors are shown with it; only fitted slopes go without.
pub fn without_reference_noise(rmse: f64, noise: f64) -> f64 {
    (rmse * rmse - noise * noise).max(0.0).sqrt()
}

/// A root mean square error taken apart.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NoiseAndBias {
    /// What more samples take away: the error estimated from independent halves.
    pub noise: f64,
    /// What stays: the root of what is left of the mean square error. For photon maps that are
    /// kept, it holds the noise of the maps too.
    pub bias: f64,
}

/// Takes an error against a reference apart, given the picture's estimated noise and the
/// reference's own.
pub fn noise_and_bias(rmse: f64, noise: f64, reference_noise: f64) -> NoiseAndBias {
    let bias = without_reference_noise(without_reference_noise(rmse, reference_noise), noise);
    NoiseAndBias { noise, bias }
}

/// When a target will be reached.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Prediction {
    /// Passes then.
    pub passes: f64,
    /// Seconds then, since the job was accepted.
    pub seconds: f64,
}

/// Slopes that a render may have.
const SLOPES: std::ops::RangeInclusive<f64> = -1.0..=-0.5;
/// The looks that say something of the rate: those since this share of the passes.
const RECENT: f64 = 1.0 / 16.0;
/// Looks needed before their slope is believed.
const LOOKS: usize = 5;

/// A slope between the bounds of theory, a quarter of the way nearer to −1/2, which looks at the
/// noise of a few pixels cannot tell from steeper ones.
fn pulled(slope: f64) -> f64 {
    let slope = slope.clamp(*SLOPES.start(), *SLOPES.end());
    0.75 * slope + 0.25 * SLOPES.end()
}

/// Predicts when the error falls to `target`, from looks in the order of their passes: it goes on
/// falling from the last look at the rate of the recent ones, and a pass takes as long as recent
/// ones took. What was prepared before the first pass counts once. None if there is nothing to
/// go by.
pub fn predict(looks: &[Look], target: f64) -> Option<Prediction> {
    let last = looks.last().filter(|l| l.error > 0.0 && l.passes > 0)?;
    if target.is_nan() || target <= 0.0 {
        return None;
    }
    let now = Prediction {
        passes: last.passes as f64,
        seconds: last.seconds,
    };
    if last.error <= target {
        return Some(now);
    }
    let recent = |l: &&Look| l.passes as f64 >= last.passes as f64 * RECENT && l.passes >= 2;
    let recent: Vec<&Look> = looks.iter().filter(recent).collect();
    // Noise in few looks makes slopes of any kind: between the bounds of theory it does no harm.
    let slope = fit(recent.iter().map(|l| (l.passes as f64, l.error)))
        .filter(|_| recent.len() >= LOOKS)
        .map_or(-0.5, |rate| pulled(rate.slope));
    let passes = now.passes * (last.error / target).powf(-1.0 / slope);
    let first = recent.first().filter(|l| l.passes < last.passes);
    let per_pass = first.map_or(now.seconds / now.passes, |l| {
        (last.seconds - l.seconds) / (last.passes - l.passes) as f64
    });
    let seconds = now.seconds + (passes - now.passes) * per_pass;
    Some(Prediction { passes, seconds })
}

/// Pass numbers to look at: 1, 2, 3, 4, 6, 8, 11, 16 …, two to an octave. Their times are a
/// geometric series too, and unlike times they are the same in every run.
pub fn is_looked_at(pass: u64) -> bool {
    if pass.is_power_of_two() {
        return true;
    }
    let below = (pass.max(1)).ilog2();
    pass == ((f64::from(below) + 0.5).exp2()).round() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn looks(error: impl Fn(f64) -> f64) -> Vec<Look> {
        let look = |passes: u64| Look {
            passes,
            seconds: 3.0 + 0.5 * passes as f64,
            error: error(passes as f64),
        };
        (1..=64).filter(|p| is_looked_at(*p)).map(look).collect()
    }

    #[test]
    fn a_power_law_is_found_again() {
        let rate = fit((1..9).map(|n| (f64::from(n), 3.0 * f64::from(n).powf(-0.7)))).unwrap();
        assert!((rate.slope + 0.7).abs() < 1e-12 && (rate.factor - 3.0).abs() < 1e-12);
        assert_eq!(fit([(1.0, 1.0), (1.0, 2.0)]), None);
        assert_eq!(fit([]), None);
    }

    #[test]
    fn what_is_prepared_once_is_not_counted_again() {
        for slope in [-0.5, -0.8] {
            let p = predict(&looks(|n| n.powf(slope)), 0.01).unwrap();
            let passes = 64.0 * (64f64.powf(slope) / 0.01).powf(-1.0 / pulled(slope));
            assert!((p.passes / passes - 1.0).abs() < 1e-9, "{p:?}");
            assert!(
                (p.seconds / (3.0 + 0.5 * passes) - 1.0).abs() < 1e-9,
                "{p:?}"
            );
        }
    }

    #[test]
    fn targets_that_are_reached_or_make_no_sense() {
        let looks = looks(|n| n.powf(-0.5));
        assert_eq!(predict(&looks, 1.0).unwrap().passes, 64.0);
        assert_eq!(predict(&looks, 0.0), None);
        assert_eq!(predict(&looks, f64::NAN), None);
        assert_eq!(predict(&[], 0.1), None);
    }

    #[test]
    fn two_looks_an_octave() {
        let all: Vec<u64> = (0..70).filter(|p| is_looked_at(*p)).collect();
        assert_eq!(all, [1, 2, 3, 4, 6, 8, 11, 16, 23, 32, 45, 64]);
    }

    #[test]
    fn an_error_is_noise_and_bias_and_the_reference() {
        let parts = noise_and_bias(13.0, 3.0, 4.0);
        assert!((parts.bias - 12.0).abs() < 1e-12);
        assert_eq!(noise_and_bias(3.0, 3.1, 0.0).bias, 0.0);
    }
}
