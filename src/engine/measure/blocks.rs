//! Means over blocks of pixels and their spread over independent runs.
//!
//! Pixels are not tested one by one: the noise of single pixels is far from normal. Means of 8×8
//! pixels over whole runs are nearer to it. Runs take other seeds, which for Sobol points are other
//! scrambles: nothing is assumed about the samples within a run.

use glam::UVec2;

/// Pixels of a block each way.
pub const BLOCK: u32 = 8;

/// Sum and sum of squares over the runs of one number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sum {
    sum: f64,
    squares: f64,
}

impl Sum {
    /// Adds the number of one run.
    pub fn add(&mut self, x: f64) {
        self.sum += x;
        self.squares += x * x;
    }

    /// Mean over `runs` runs.
    pub fn mean(&self, runs: u64) -> f64 {
        self.sum / runs as f64
    }

    /// Variance of that mean; 0 below two runs.
    pub fn variance_of_mean(&self, runs: u64) -> f64 {
        let n = runs as f64;
        if runs < 2 {
            return 0.0;
        }
        let spread = self.squares - self.sum * self.sum / n;
        // What is left of equal numbers by rounding is no variance.
        let rounding = 1e-13 * self.squares;
        if spread <= rounding {
            0.0
        } else {
            spread / (n - 1.0) / n
        }
    }
}

/// Block means of one layer over independent runs.
#[derive(Clone, Debug)]
pub struct BlockRuns {
    size: UVec2,
    runs: u64,
    blocks: Vec<[Sum; 3]>,
    image: Sum,
}

/// Blocks of a picture of `size` pixels each way.
pub fn grid(size: UVec2) -> UVec2 {
    UVec2::new(size.x.div_ceil(BLOCK), size.y.div_ceil(BLOCK))
}

impl BlockRuns {
    /// No run of pictures of `size` pixels.
    pub fn new(size: UVec2) -> Self {
        let grid = grid(size);
        Self {
            size,
            runs: 0,
            blocks: vec![[Sum::default(); 3]; grid.x as usize * grid.y as usize],
            image: Sum::default(),
        }
    }

    /// Adds the picture of a run. Pixels that are not finite are left out of their block's mean.
    pub fn add(&mut self, pixels: &[[f32; 3]]) {
        let columns = grid(self.size).x as usize;
        let mut sums = vec![([0.0f64; 3], 0u32); self.blocks.len()];
        for (i, pixel) in pixels.iter().enumerate() {
            if !pixel.iter().all(|x| x.is_finite()) {
                continue;
            }
            let (x, y) = (i % self.size.x as usize, i / self.size.x as usize);
            let (sum, n) = &mut sums[y / BLOCK as usize * columns + x / BLOCK as usize];
            (0..3).for_each(|c| sum[c] += f64::from(pixel[c]));
            *n += 1;
        }
        let (mut total, mut count) = (0.0, 0u64);
        for (block, (sum, n)) in self.blocks.iter_mut().zip(&sums) {
            let pixels = f64::from(*n).max(1.0);
            (0..3).for_each(|c| block[c].add(sum[c] / pixels));
            total += sum[0] + sum[1] + sum[2];
            count += u64::from(*n);
        }
        self.image.add(total / (3.0 * count.max(1) as f64));
        self.runs += 1;
    }

    /// Runs so far.
    pub fn runs(&self) -> u64 {
        self.runs
    }

    /// Mean of the picture over pixels and channels, and the variance of that mean.
    pub fn image(&self) -> (f64, f64) {
        let runs = self.runs;
        (self.image.mean(runs), self.image.variance_of_mean(runs))
    }

    /// Mean of each block and channel, and the variance of that mean.
    pub fn blocks(&self) -> impl Iterator<Item = [(f64, f64); 3]> {
        let each = |s: Sum| (s.mean(self.runs), s.variance_of_mean(self.runs));
        self.blocks.iter().map(move |b| b.map(each))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_means_of_their_own_pixels() {
        let size = UVec2::new(9, 8);
        let mut runs = BlockRuns::new(size);
        for value in [1.0f32, 3.0] {
            let pixel = |i: usize| [if i % 9 == 8 { 10.0 } else { value }, 0.0, 0.0];
            runs.add(&(0..72).map(pixel).collect::<Vec<_>>());
        }
        let blocks: Vec<_> = runs.blocks().collect();
        assert_eq!(grid(size), UVec2::new(2, 1));
        assert_eq!((blocks[0][0], blocks[1][0]), ((2.0, 1.0), (10.0, 0.0)));
        let mean = |v: f64| (64.0 * v + 80.0) / 72.0 / 3.0;
        let (found, variance) = runs.image();
        assert!((found - mean(2.0)).abs() < 1e-12);
        assert!((variance - (mean(3.0) - mean(1.0)).powi(2) / 4.0).abs() < 1e-12);
    }

    #[test]
    fn what_is_not_finite_is_left_out() {
        let mut runs = BlockRuns::new(UVec2::new(2, 1));
        runs.add(&[[f32::NAN; 3], [3.0; 3]]);
        assert_eq!(runs.image().0, 3.0);
    }
}
