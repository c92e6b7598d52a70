//! The statistical test of agreement of two images.
//!
//! (a) The image mean of every layer differs by less than 1 % of the whole's mean, or than 4
//! combined standard errors. (b) Means of 8×8 blocks pass a t-test with Šidák's correction at a
//! family-wise rate of 1e-4. Standard errors come from independent runs; blocks of zero variance
//! must be equal to 1e-5, and blocks that are agree whatever their variance.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Rate at which two images that agree are told to differ.
const FAMILY_WISE_RATE: f64 = 1e-4;
const BLOCK: usize = 8;
/// Share of the image mean below which a block may be missed by all of a few thousand samples.
const UNLIT: f64 = 2e-4;

/// A layer known with its error: block means of each channel, their variances, and the degrees
/// of freedom those were estimated with.
pub struct Blocks {
    mean: Vec<[f64; 3]>,
    variance: Vec<[f64; 3]>,
    /// As far as single blocks are concerned: at least this much.
    least: Option<Vec<[f64; 3]>>,
    freedom: f64,
    weight: Vec<f64>,
}

/// Means over the blocks of an image.
fn block_means(pixels: &[[f32; 3]], width: usize) -> Vec<([f64; 3], f64)> {
    let height = pixels.len() / width;
    let mut blocks = Vec::new();
    for y0 in (0..height).step_by(BLOCK) {
        for x0 in (0..width).step_by(BLOCK) {
            let (mut sum, mut n) = ([0.0; 3], 0.0);
            for y in y0..(y0 + BLOCK).min(height) {
                for pixel in &pixels[y * width + x0..y * width + (x0 + BLOCK).min(width)] {
                    (0..3).for_each(|c| sum[c] += f64::from(pixel[c]));
                    n += 1.0;
                }
            }
            blocks.push((sum.map(|s| s / n), n));
        }
    }
    blocks
}

impl Blocks {
    /// From at least 16 independent runs of one layer.
    pub fn from_runs(runs: &[&[[f32; 3]]], width: usize) -> Self {
        assert!(runs.len() >= 16, "standard errors need at least 16 runs");
        let n = runs.len() as f64;
        let means: Vec<_> = runs.iter().map(|r| block_means(r, width)).collect();
        let count = means[0].len();
        let (mut mean, mut variance) = (vec![[0.0; 3]; count], vec![[0.0; 3]; count]);
        for b in 0..count {
            for c in 0..3 {
                let m = means.iter().map(|r| r[b].0[c]).sum::<f64>() / n;
                let squares = means.iter().map(|r| (r[b].0[c] - m).powi(2)).sum::<f64>();
                mean[b][c] = m;
                variance[b][c] = squares / (n - 1.0) / n;
            }
        }
        let weight = means[0].iter().map(|b| b.1).collect();
        Self {
            mean,
            variance,
            least: None,
            freedom: n - 1.0,
            weight,
        }
    }

    /// From a reference image and the standard error of each of its pixels, which are independent
    /// of each other.
    pub fn from_reference(pixels: &[[f32; 3]], se: &[[f32; 3]], width: usize) -> Self {
        let squares: Vec<[f32; 3]> = se.iter().map(|p| p.map(|x| x * x)).collect();
        let (mean, weight) = block_means(pixels, width).into_iter().unzip();
        let variance = block_means(&squares, width);
        let variance = variance
            .into_iter()
            .map(|(v, n)| v.map(|x| x / n))
            .collect();
        Self {
            mean,
            variance,
            least: None,
            freedom: 1e6,
            weight,
        }
    }

    /// Gives each block at least the variance that rare, bright samples have on average over the
    /// layer, in proportion to how many of them `expected` leads one to expect.
    ///
    /// Where a layer is found by chance hits of small lights, a block that had none, or few, knows
    /// nothing of its own variance: its runs agree on a value that is too low. A hit's brightness
    /// varies little over a layer, so the mean of a block is the number of its hits, and its
    /// variance is proportional to that.
    pub fn pool_variance(&mut self, expected: &Self) {
        let mut rate = [0.0; 3];
        for c in 0..3 {
            let variance: f64 = self.variance.iter().map(|v| v[c]).sum();
            let mean: f64 = expected.mean.iter().map(|m| m[c]).sum();
            rate[c] = if mean > 0.0 { variance / mean } else { 0.0 };
        }
        let least = |m: &[f64; 3]| [0, 1, 2].map(|c| rate[c] * m[c]);
        self.least = Some(expected.mean.iter().map(least).collect());
    }

    /// Gives the blocks of a sum at least the variances that were given to those of a `part`.
    pub fn include_pooled(&mut self, part: &Self) {
        let Some(more) = &part.least else { return };
        let least = self.least.get_or_insert_with(|| vec![[0.0; 3]; more.len()]);
        for (sum, more) in least.iter_mut().zip(more) {
            (0..3).for_each(|c| sum[c] += more[c]);
        }
    }

    /// Variance of the mean of channel `c` of one block.
    fn block_variance(&self, block: usize, c: usize) -> f64 {
        let least = self.least.as_ref().map_or(0.0, |l| l[block][c]);
        self.variance[block][c].max(least)
    }

    /// The exact value `value` everywhere.
    pub fn exact(value: f32, width: usize, height: usize) -> Self {
        let pixels = vec![[value; 3]; width * height];
        Self::from_reference(&pixels, &vec![[0.0; 3]; width * height], width)
    }

    /// Mean and variance of the mean over the image, all channels together. Channels of a pixel
    /// are correlated, so their standard errors add up.
    fn image(&self) -> (f64, f64) {
        let total: f64 = self.weight.iter().sum();
        let (mut mean, mut se) = (0.0, 0.0);
        for c in 0..3 {
            let mut variance = 0.0;
            for (b, w) in self.weight.iter().enumerate() {
                mean += self.mean[b][c] * w / total / 3.0;
                variance += self.variance[b][c] * (w / total).powi(2);
            }
            se += variance.sqrt() / 3.0;
        }
        (mean, se * se)
    }
}

/// What the comparison of one layer found.
pub struct Verdict {
    /// Empty if the layers agree.
    pub complaints: Vec<String>,
    /// Smallest bias of the image mean that (a) would have caught, as a share of the whole.
    pub sensitivity: f64,
    /// Smallest bias of half the blocks that (b) would have caught, as a share of the whole.
    pub block_sensitivity: f64,
    /// Largest deviation of a block in standard errors.
    pub worst: f64,
}

/// Compares layer `label` of `a` with that of `b`; `whole` is the mean of the whole image and
/// `family` the number of layers tested together.
pub fn compare(label: &str, a: &Blocks, b: &Blocks, whole: f64, family: usize) -> Verdict {
    compare_within(label, a, b, None, whole, family)
}

/// How far `difference` is from all that lies between 0 and `bias`.
fn beyond(difference: f64, bias: f64) -> f64 {
    (difference - difference.clamp(bias.min(0.0), bias.max(0.0))).abs()
}

/// The same where `a` may be off by the bias that it reports of itself, in its direction.
pub fn compare_within(
    label: &str,
    a: &Blocks,
    b: &Blocks,
    bias: Option<&Blocks>,
    whole: f64,
    family: usize,
) -> Verdict {
    let mut complaints = Vec::new();
    let ((mean_a, var_a), (mean_b, var_b)) = (a.image(), b.image());
    let (slack, var_bias) = bias.map_or((0.0, 0.0), Blocks::image);
    let se = (var_a + var_b + var_bias).sqrt();
    let difference = beyond(mean_a - mean_b, slack);
    if difference > (0.01 * whole).max(4.0 * se) {
        complaints.push(format!(
            "{label}: image mean {mean_a} against {mean_b}, error {se}"
        ));
    }
    let tests = (a.mean.len() * 3 * family) as f64;
    // Šidák: each test at the rate 1 − (1 − α)^(1/n).
    let rate = -f64::exp_m1((-FAMILY_WISE_RATE).ln_1p() / tests);
    let mut worst: f64 = 0.0;
    let mut caught = Vec::new();
    for block in 0..a.mean.len() {
        for c in 0..3 {
            let (slack, var_bias) =
                bias.map_or((0.0, 0.0), |b| (b.mean[block][c], b.variance[block][c]));
            let va = a.block_variance(block, c) + var_bias;
            let vb = b.block_variance(block, c);
            let difference = beyond(a.mean[block][c] - b.mean[block][c], slack);
            // No sample of ours was lit there, so its error is unknown; where the reference is
            // next to black that is no wonder, and the image mean judges it.
            let unlit = bias.is_some() && a.variance[block][c] == 0.0 && a.mean[block][c] == 0.0;
            if unlit && b.mean[block][c] < UNLIT * whole {
                continue;
            }
            // Equal to 1e-5 is equal: a spread below that is not known from sixteen runs, which all
            // miss what roulette does to one path in ten thousand.
            let differs = difference > 1e-5 * whole.max(1e-30);
            if va + vb == 0.0 {
                if differs {
                    complaints.push(format!("{label}: block {block} differs by {difference}"));
                }
                continue;
            }
            let t = difference / (va + vb).sqrt();
            worst = worst.max(t);
            // Welch–Satterthwaite.
            let freedom = (va + vb).powi(2) / (va * va / a.freedom + vb * vb / b.freedom);
            let student = StudentsT::new(0.0, 1.0, freedom).expect("freedom");
            caught.push(student.inverse_cdf(1.0 - 0.5 * rate) * (va + vb).sqrt());
            if differs && 2.0 * student.sf(t) < rate {
                let (x, y) = (a.mean[block][c], b.mean[block][c]);
                complaints.push(format!(
                    "{label}: block {block} channel {c}: {x} against {y}, t = {t:.1}"
                ));
            }
        }
    }
    caught.sort_by(f64::total_cmp);
    let median = caught.get(caught.len() / 2).copied().unwrap_or(0.0);
    Verdict {
        complaints,
        block_sensitivity: median / whole,
        sensitivity: (0.01 * whole).max(4.0 * se) / whole,
        worst,
    }
}

/// Mean of all pixels and channels.
pub fn mean(pixels: &[[f32; 3]]) -> f64 {
    let sum: f64 = pixels.iter().flatten().map(|&x| f64::from(x)).sum();
    sum / (3 * pixels.len()) as f64
}

mod tests {
    use super::*;
    use lightscope::engine::math::hash::{combine, unit_f32};

    const RUNS: u64 = 16;

    /// What the test says of 64×64 pixels of `value(run, pixel)` that should be 1.
    fn verdict(value: impl Fn(u64, u64) -> f32) -> Verdict {
        let run = |r| (0..4096).map(|i| [value(r, i); 3]).collect();
        let runs: Vec<Vec<[f32; 3]>> = (0..RUNS).map(run).collect();
        let runs: Vec<&[[f32; 3]]> = runs.iter().map(Vec::as_slice).collect();
        let exact = Blocks::exact(1.0, 64, 64);
        compare("whole", &Blocks::from_runs(&runs, 64), &exact, 1.0, 5)
    }

    fn noise(run: u64, pixel: u64) -> f32 {
        0.2 * (unit_f32(combine(run, pixel)) - 0.5)
    }

    #[test]
    fn a_bias_of_one_percent_is_caught_and_none_is_not() {
        for (bias, agrees) in [(0.0, true), (0.009, true), (0.011, false), (-0.011, false)] {
            let v = verdict(|r, i| 1.0 + bias + noise(r, i));
            let image = v.complaints.iter().any(|c| c.contains("image mean"));
            assert_eq!(!image, agrees, "{bias}: {:?}", v.complaints);
            if bias == 0.0 {
                assert!(v.complaints.is_empty(), "{:?}", v.complaints);
            }
        }
    }

    #[test]
    fn a_bias_of_one_block_is_caught() {
        let quiet = verdict(noise_around_one);
        // In block 9 alone: the image mean moves by a 64th of it.
        let bias = 1.5 * quiet.block_sensitivity as f32;
        assert!(bias < 0.1, "{bias}");
        let v = verdict(|r, i| {
            let block = (i / 64 / 8, i % 64 / 8) == (1, 1);
            noise_around_one(r, i) + if block { bias } else { 0.0 }
        });
        assert_eq!(v.complaints.len(), 3, "{:?}", v.complaints);
        assert!(v.complaints.iter().all(|c| c.contains("block 9 ")));
    }

    fn noise_around_one(run: u64, pixel: u64) -> f32 {
        1.0 + noise(run, pixel)
    }

    #[test]
    fn rare_hits_need_the_variance_of_the_layer() {
        // Samples of brightness 100 at a rate of 1 in 100: ten in a block of all runs.
        let hit = |seed: u64, r: u64, i: u64| {
            let u = unit_f32(combine(combine(seed, r), i));
            if u < 0.01 { 100.0 } else { 0.0 }
        };
        let exact = Blocks::exact(1.0, 64, 64);
        for (factor, agrees) in [(1.0, true), (1.3, false)] {
            let run = |r| (0..4096).map(|i| [factor * hit(7, r, i); 3]).collect();
            let runs: Vec<Vec<[f32; 3]>> = (0..RUNS).map(run).collect();
            let runs: Vec<&[[f32; 3]]> = runs.iter().map(Vec::as_slice).collect();
            let mut blocks = Blocks::from_runs(&runs, 64);
            blocks.pool_variance(&exact);
            let v = compare("caustic", &blocks, &exact, 1.0, 5);
            assert_eq!(v.complaints.is_empty(), agrees, "{:?}", v.complaints);
        }
    }
}
