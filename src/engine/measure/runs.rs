//! A picture as the mean of independent runs, known pixel by pixel with its standard error: how
//! references are made.

use rayon::prelude::*;

use super::blocks::Sum;
use crate::engine::film::FrameLayer;

/// Layers summed over independent runs.
#[derive(Clone, Debug, Default)]
pub struct RunMeans {
    runs: u64,
    layers: Vec<(String, Vec<[Sum; 3]>)>,
}

/// A layer and the standard error of each of its pixels.
#[derive(Clone, Debug)]
pub struct KnownLayer {
    /// `whole`, a component, or `expr1` ….
    pub label: String,
    /// Means.
    pub mean: Vec<[f32; 3]>,
    /// Their standard errors.
    pub standard_error: Vec<[f32; 3]>,
}

impl RunMeans {
    /// Adds the layers of a run; every run has the same ones.
    pub fn add(&mut self, layers: &[FrameLayer]) {
        if self.layers.is_empty() {
            let empty =
                |l: &FrameLayer| (l.label.clone(), vec![[Sum::default(); 3]; l.pixels.len()]);
            self.layers = layers.iter().map(empty).collect();
        }
        for ((_, sums), layer) in self.layers.iter_mut().zip(layers) {
            let pairs = sums.par_iter_mut().zip(&layer.pixels);
            pairs.for_each(|(sum, x)| (0..3).for_each(|c| sum[c].add(f64::from(x[c]))));
        }
        self.runs += 1;
    }

    /// Runs so far.
    pub fn runs(&self) -> u64 {
        self.runs
    }

    /// Root mean square of the standard errors of the first layer, the whole, over the mean of the
    /// picture; pixels that are not finite are left out. None below two runs, or if it is black.
    pub fn relative_error(&self) -> Option<f64> {
        let (_, whole) = self.layers.first().filter(|_| self.runs > 1)?;
        let (mut sum, mut squares, mut n) = (0.0, 0.0, 0u64);
        for x in whole.iter().flatten() {
            let mean = x.mean(self.runs);
            if mean.is_finite() {
                sum += mean;
                squares += x.variance_of_mean(self.runs);
                n += 1;
            }
        }
        let n = n as f64;
        (sum > 0.0).then(|| (squares / n).sqrt() / (sum / n))
    }

    /// All layers with their errors.
    pub fn known(&self) -> Vec<KnownLayer> {
        let runs = self.runs;
        let layer = |(label, sums): &(String, Vec<[Sum; 3]>)| KnownLayer {
            label: label.clone(),
            mean: sums
                .iter()
                .map(|p| p.map(|s| s.mean(runs) as f32))
                .collect(),
            standard_error: sums
                .iter()
                .map(|p| p.map(|s| s.variance_of_mean(runs).sqrt() as f32))
                .collect(),
        };
        self.layers.iter().map(layer).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_and_standard_errors_of_three_runs() {
        let mut runs = RunMeans::default();
        for value in [1.0, 2.0, 6.0] {
            let label = "whole".to_owned();
            let pixels = vec![[value, 3.0, 0.0]];
            runs.add(&[FrameLayer { label, pixels }]);
        }
        let known = &runs.known()[0];
        assert_eq!(known.mean, [[3.0, 3.0, 0.0]]);
        // Variance 7 of one run, 7/3 of the mean.
        let se = (7.0f32 / 3.0).sqrt();
        assert!((known.standard_error[0][0] - se).abs() < 1e-6);
        assert_eq!(known.standard_error[0][1..], [0.0, 0.0]);
        let relative = (7.0f64 / 9.0).sqrt() / 2.0;
        assert!((runs.relative_error().unwrap() - relative).abs() < 1e-12);
        assert_eq!(RunMeans::default().relative_error(), None);
    }
}
