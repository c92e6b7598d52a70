//! Whether two ways to compute a picture agree.
//!
//! Both sides render independent runs. Their layers are compared twice: the mean of the image, in
//! which a bias anywhere adds up, and 8×8 blocks, in which a bias somewhere stands out. Each
//! comparison is Welch's t-test over the runs; half of the rate of false alarms goes to the means
//! and half to the blocks, each divided among its tests as Šidák says.
//!
//! *Looking more than once.* Looks are taken at 16, 32, 64 … runs a side; look k may raise a false
//! alarm at the rate α/2ᵏ, k = 1, 2, …, so that all looks together stay below α (the union bound).
//!
//! *Blocks that no sample has met* know nothing of their variance. Of a block where light comes in
//! rare hits of like brightness, mean and variance are both in proportion to the number of hits;
//! so each block is given at least the ratio of the two that its layer has over the whole image.

use glam::UVec2;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::blocks::{BlockRuns, grid};
use crate::engine::film::Frame;

/// Runs a side at the first look.
pub const FIRST_LOOK: u64 = 16;
/// A difference of blocks or images without variance is one beyond this share of the mean.
const EXACT: f64 = 1e-5;

/// What is asked of the referee.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rules {
    /// Rate at which two sides that agree are told to differ.
    pub false_alarms: f64,
    /// Sides agree once a bias of the image mean of this share would have been found.
    pub tolerance: f64,
}

impl Default for Rules {
    fn default() -> Self {
        Self {
            false_alarms: 0.01,
            tolerance: 0.01,
        }
    }
}

/// What the referee says.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// These layers differ.
    Differ(Vec<String>),
    /// No layer differs, and a bias of the tolerance would have been found.
    Agree,
    /// Not known yet; so many more seconds, both sides together.
    Needs(f64),
}

/// One layer at the last look.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LayerFinding {
    /// Its label.
    pub label: String,
    /// Image mean of the first side less that of the second, over the mean of the whole.
    pub difference: f64,
    /// Standard error of that.
    pub standard_error: f64,
    /// The smallest difference that would have been found.
    pub detectable: f64,
    /// Blocks whose own test fails.
    pub blocks: usize,
    /// Whether the layers differ.
    pub differs: bool,
}

/// One side's runs.
#[derive(Clone, Debug)]
struct Side {
    layers: Vec<BlockRuns>,
    image: Vec<[f64; 3]>,
    seconds: f64,
}

/// Collects runs of two sides and judges them.
#[derive(Clone, Debug)]
pub struct Referee {
    rules: Rules,
    size: UVec2,
    labels: Vec<String>,
    sides: [Option<Side>; 2],
    looks: u32,
    findings: Vec<LayerFinding>,
    /// Once found, a difference stays.
    differ: Option<Vec<String>>,
}

impl Referee {
    /// No runs yet.
    pub fn new(rules: Rules) -> Self {
        Self {
            rules,
            size: UVec2::ZERO,
            labels: Vec::new(),
            sides: [None, None],
            looks: 0,
            findings: Vec::new(),
            differ: None,
        }
    }

    /// Adds a run of side 0 or 1 that took `seconds`. All runs have the same size and layers.
    pub fn add(&mut self, side: usize, frame: &Frame, seconds: f64) {
        self.size = frame.size;
        self.labels = frame.layers.iter().map(|l| l.label.clone()).collect();
        let side = self.sides[side].get_or_insert_with(|| Side {
            layers: vec![BlockRuns::new(frame.size); frame.layers.len()],
            image: vec![[0.0; 3]; frame.layers[0].pixels.len()],
            seconds: 0.0,
        });
        for (runs, layer) in side.layers.iter_mut().zip(&frame.layers) {
            runs.add(&layer.pixels);
        }
        for (sum, x) in side.image.iter_mut().zip(&frame.layers[0].pixels) {
            (0..3).for_each(|c| sum[c] += f64::from(x[c]));
        }
        side.seconds += seconds;
        if self.runs() >= FIRST_LOOK << self.looks {
            self.look();
        }
    }

    /// Runs that both sides have.
    pub fn runs(&self) -> u64 {
        let runs = |s: &Option<Side>| s.as_ref().map_or(0, |s| s.layers[0].runs());
        self.sides.iter().map(runs).min().unwrap_or(0)
    }

    /// Seconds of both sides together.
    pub fn seconds(&self) -> f64 {
        self.sides.iter().flatten().map(|s| s.seconds).sum()
    }

    /// Pixels of the pictures.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// The rules.
    pub fn rules(&self) -> Rules {
        self.rules
    }

    /// The layers at the last look; none before the first.
    pub fn findings(&self) -> &[LayerFinding] {
        &self.findings
    }

    /// The mean picture of a side so far.
    pub fn image(&self, side: usize) -> Option<Vec<[f32; 3]>> {
        let side = self.sides[side].as_ref()?;
        let runs = side.layers[0].runs() as f64;
        Some(
            side.image
                .iter()
                .map(|p| p.map(|x| (x / runs) as f32))
                .collect(),
        )
    }

    /// What can be said.
    pub fn verdict(&self) -> Verdict {
        if let Some(labels) = &self.differ {
            return Verdict::Differ(labels.clone());
        }
        let worst = self
            .findings
            .iter()
            .map(|f| f.detectable)
            .fold(0.0, f64::max);
        let runs = self.runs().max(1) as f64;
        let next_look = (FIRST_LOOK << self.looks) as f64;
        let seconds = |runs_needed: f64| self.seconds() * (runs_needed / runs - 1.0).max(0.0);
        if self.findings.is_empty() {
            return Verdict::Needs(seconds(next_look));
        }
        if worst <= self.rules.tolerance {
            return Verdict::Agree;
        }
        // Standard errors fall with the root of the runs; looks are taken at powers of two.
        let last_look = next_look / 2.0;
        let needed = last_look * (worst / self.rules.tolerance).powi(2);
        let octaves = (needed / next_look).log2().ceil().max(0.0);
        Verdict::Needs(seconds(next_look * octaves.exp2()))
    }

    fn look(&mut self) {
        self.looks += 1;
        let rate = self.rules.false_alarms / f64::from(self.looks).exp2();
        let [Some(a), Some(b)] = &self.sides else {
            return;
        };
        let whole = 0.5 * (a.layers[0].image().0 + b.layers[0].image().0);
        let layers = self.labels.len() as f64;
        let grid = grid(self.size);
        let blocks = layers * f64::from(grid.x) * f64::from(grid.y) * 3.0;
        let rates = [sidak(0.5 * rate, layers), sidak(0.5 * rate, blocks)];
        let pairs = a.layers.iter().zip(&b.layers).zip(&self.labels);
        self.findings = pairs
            .map(|((a, b), label)| finding(label, a, b, whole, rates))
            .collect();
        let differing: Vec<&LayerFinding> = self.findings.iter().filter(|f| f.differs).collect();
        if !differing.is_empty() {
            let labels = differing.iter().map(|f| f.label.clone());
            self.differ = Some(labels.collect());
        }
    }

    /// Signed differences of the blocks of a layer in standard errors, row by row: the channel that
    /// differs most. None before both sides have two runs.
    pub fn z_map(&self, layer: usize) -> Option<Vec<f32>> {
        let [Some(a), Some(b)] = &self.sides else {
            return None;
        };
        let (a, b) = (a.layers.get(layer)?, b.layers.get(layer)?);
        if a.runs() < 2 || b.runs() < 2 {
            return None;
        }
        let floor = pooled(a, b);
        let z = |a: [(f64, f64); 3], b: [(f64, f64); 3]| {
            let channel = |c: usize| {
                let difference = a[c].0 - b[c].0;
                let variance = with_floor(&floor, c, a[c], b[c]);
                let z = difference / variance.iter().sum::<f64>().sqrt();
                if z.is_nan() { 0.0 } else { z as f32 }
            };
            (0..3)
                .map(channel)
                .fold(0.0f32, |m, z| if z.abs() > m.abs() { z } else { m })
        };
        Some(a.blocks().zip(b.blocks()).map(|(a, b)| z(a, b)).collect())
    }
}

/// Mean and variance of the mean of each channel.
type Channels = [(f64, f64); 3];

/// Rate of each of `n` tests that together have `rate`.
fn sidak(rate: f64, n: f64) -> f64 {
    -f64::exp_m1((-rate).ln_1p() / n)
}

/// Ratio of variance and mean over all blocks of a layer, of each side and channel.
fn pooled(a: &BlockRuns, b: &BlockRuns) -> [[f64; 3]; 2] {
    [a, b].map(|runs| {
        let mut sums = [(0.0, 0.0); 3];
        for block in runs.blocks() {
            for c in 0..3 {
                sums[c].0 += block[c].0;
                sums[c].1 += block[c].1;
            }
        }
        sums.map(|(mean, variance)| if mean > 0.0 { variance / mean } else { 0.0 })
    })
}

/// Variances of channel `c` of a block of both sides.
fn with_floor(floor: &[[f64; 3]; 2], c: usize, a: (f64, f64), b: (f64, f64)) -> [f64; 2] {
    // Where one side has met no light, the other says how much there may be.
    let mean = a.0.max(b.0).max(0.0);
    [a.1.max(floor[0][c] * mean), b.1.max(floor[1][c] * mean)]
}

fn finding(
    label: &str,
    a: &BlockRuns,
    b: &BlockRuns,
    whole: f64,
    [image_rate, block_rate]: [f64; 2],
) -> LayerFinding {
    let ((mean_a, var_a), (mean_b, var_b)) = (a.image(), b.image());
    let runs = [a.runs(), b.runs()];
    let (difference, se) = (mean_a - mean_b, (var_a + var_b).sqrt());
    let image = Test::new([var_a, var_b], runs, image_rate, whole);
    let floor = pooled(a, b);
    let failed = |(a, b): &(Channels, Channels)| {
        (0..3).any(|c| {
            let variances = with_floor(&floor, c, a[c], b[c]);
            Test::new(variances, runs, block_rate, whole).fails(a[c].0 - b[c].0)
        })
    };
    let blocks = a.blocks().zip(b.blocks()).filter(failed).count();
    let scale = if whole > 0.0 { 1.0 / whole } else { 1.0 };
    LayerFinding {
        label: label.to_owned(),
        difference: difference * scale,
        standard_error: se * scale,
        detectable: image.least() * scale,
        blocks,
        differs: blocks > 0 || image.fails(difference),
    }
}

/// One two-sided t-test of a difference.
struct Test {
    se: f64,
    freedom: f64,
    rate: f64,
    exact: f64,
}

impl Test {
    fn new([a, b]: [f64; 2], runs: [u64; 2], rate: f64, whole: f64) -> Self {
        let [na, nb] = runs.map(|n| n as f64 - 1.0);
        // Welch–Satterthwaite.
        let freedom = (a + b).powi(2) / (a * a / na + b * b / nb);
        Self {
            se: (a + b).sqrt(),
            freedom: if freedom.is_finite() {
                freedom.max(1.0)
            } else {
                1.0
            },
            rate,
            exact: EXACT * whole.abs(),
        }
    }

    fn student(&self) -> Option<StudentsT> {
        StudentsT::new(0.0, 1.0, self.freedom).ok()
    }

    fn fails(&self, difference: f64) -> bool {
        let beyond = difference.abs() > self.exact;
        if self.se == 0.0 {
            return beyond;
        }
        let p = self
            .student()
            .map_or(1.0, |s| 2.0 * s.sf(difference.abs() / self.se));
        beyond && p < self.rate
    }

    /// The smallest difference that fails.
    fn least(&self) -> f64 {
        let quantile = self
            .student()
            .map_or(f64::INFINITY, |s| s.inverse_cdf(1.0 - 0.5 * self.rate));
        if self.se == 0.0 {
            self.exact
        } else {
            quantile * self.se
        }
    }
}
