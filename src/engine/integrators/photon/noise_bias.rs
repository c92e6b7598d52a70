//! Noise and bias of the photon estimates, apart and without a reference.
//!
//! In the spirit of Hachisuka, Jarosz and Jensen 2010, *A Progressive Error Estimation Framework
//! for Photon Density Estimation*: the bias of a density estimate grows with the area A of its
//! disc: with A where the light is smooth, with √A at its edges. Several independent maps are read
//! twice, over A and over A/16, by the same camera samples. The spread of x_A over the maps is its
//! noise; 4/3 of the mean of x_A − x_(A/16) is what is reported as its bias, known to 4/3 of that
//! difference's own error: the bias, if it grows with √A, and 5/4 of it, if it grows with A. Either
//! alone is bounded; where both meet with opposite signs the report may be too small. Near a corner
//! the bias no longer depends on A: within about a sixth of the radius the report fades to nothing.

use std::sync::Arc;

use super::integrator::fresh_maps;
use super::params::{Indirect, PhotonSettings};
use super::walk::Estimator;
use crate::engine::film::Film;
use crate::engine::film::FrameLayer;
use crate::engine::integrators::tiled::{SamplerKind, Tiled};
use crate::engine::integrators::{Cancelled, Integrator, Pass, RenderStats};

/// Share of the area that the second estimate is read over.
const SHRUNK: f32 = 1.0 / 16.0;
/// Bias over the difference of the two estimates, if it grows with the radius: 1/(1 − √(1/16)).
const EXTRAPOLATE: f64 = 4.0 / 3.0;

/// What was found, per pixel and channel, row by row.
#[derive(Clone, Debug, Default)]
pub struct NoiseBias {
    /// Number of independent maps.
    pub maps: u32,
    /// Mean over the maps.
    pub mean: Vec<[f32; 3]>,
    /// Standard deviation of the picture of one map and one sample a pixel.
    pub noise: Vec<[f32; 3]>,
    /// Estimated bias; where light is smooth, a quarter more than that.
    pub bias: Vec<[f32; 3]>,
    /// Standard error of that estimate.
    pub bias_error: Vec<[f32; 3]>,
}

/// Sums over the maps of one value.
#[derive(Clone, Copy, Default)]
struct Sums {
    x: f64,
    x2: f64,
    d: f64,
    d2: f64,
}

/// Measures the whole and then each layer, as frames hold them, with `maps` ≥ 2 independent maps.
///
/// # Errors
/// [`Cancelled`], if the job of `cx` was.
pub fn noise_and_bias(
    cx: &Pass<'_>,
    settings: &PhotonSettings,
    maps: u32,
) -> Result<(Vec<NoiseBias>, RenderStats), Cancelled> {
    let size = cx.camera.size();
    let layer = vec![[Sums::default(); 3]; size.x as usize * size.y as usize];
    let mut sums = vec![layer; 1 + cx.plan.labels.len()];
    let mut stats = RenderStats::default();
    let maps = maps.max(2);
    // Interpolation adds an error of its own kind; what is measured are the photons.
    let indirect = match settings.indirect {
        Indirect::Cache => Indirect::Gather,
        other => other,
    };
    let settings = PhotonSettings {
        indirect,
        ..*settings
    };
    for index in 0..u64::from(maps) {
        let photons = Arc::new(fresh_maps(&settings, cx, index, &mut stats)?);
        let pass = Pass { index, ..*cx };
        let mut picture = |scale| {
            let estimator = Estimator::new(&settings, cx, Arc::clone(&photons), scale);
            let mut film = Film::new(size, cx.plan.planned);
            stats += Tiled::new(estimator, SamplerKind::Sobol).render_pass(&pass, &mut film)?;
            let mut layers: Vec<FrameLayer> = Vec::new();
            film.resolve(&cx.plan.labels, &mut layers);
            Ok(layers)
        };
        let (full, shrunk) = (picture(1.0)?, picture(SHRUNK)?);
        for ((sums, full), shrunk) in sums.iter_mut().zip(full).zip(shrunk) {
            for ((sums, x), y) in sums.iter_mut().zip(full.pixels).zip(shrunk.pixels) {
                (0..3).for_each(|c| sums[c].add(x[c], y[c]));
            }
        }
    }
    let found = sums.iter().map(|sums| NoiseBias::new(sums, maps)).collect();
    Ok((found, stats))
}

impl Sums {
    fn add(&mut self, x: f32, y: f32) {
        let (x, d) = (f64::from(x), f64::from(x) - f64::from(y));
        *self = Self {
            x: self.x + x,
            x2: self.x2 + x * x,
            d: self.d + d,
            d2: self.d2 + d * d,
        };
    }
}

impl NoiseBias {
    fn new(sums: &[[Sums; 3]], maps: u32) -> Self {
        let n = f64::from(maps);
        let variance = |s: f64, s2: f64| ((s2 - s * s / n) / (n - 1.0)).max(0.0);
        let each = |f: &dyn Fn(&Sums) -> f64| {
            let pixel = |p: &[Sums; 3]| [0, 1, 2].map(|c| f(&p[c]) as f32);
            sums.iter().map(pixel).collect()
        };
        Self {
            maps,
            mean: each(&|s| s.x / n),
            noise: each(&|s| variance(s.x, s.x2).sqrt()),
            bias: each(&|s| EXTRAPOLATE * s.d / n),
            bias_error: each(&|s| EXTRAPOLATE * (variance(s.d, s.d2) / n).sqrt()),
        }
    }

    /// Mean of the picture.
    pub fn mean_radiance(&self) -> f64 {
        mean(&self.mean)
    }

    /// Root mean square of the noise over pixels and channels.
    pub fn rms_noise(&self) -> f64 {
        rms(&self.noise)
    }

    /// Mean bias of the picture.
    pub fn mean_bias(&self) -> f64 {
        mean(&self.bias)
    }

    /// Root mean square of the bias over pixels and channels, what its own errors add taken off.
    pub fn rms_bias(&self) -> f64 {
        (rms(&self.bias).powi(2) - rms(&self.bias_error).powi(2))
            .max(0.0)
            .sqrt()
    }
}

fn mean(pixels: &[[f32; 3]]) -> f64 {
    let sum: f64 = pixels.iter().flatten().map(|x| f64::from(*x)).sum();
    sum / (3 * pixels.len()).max(1) as f64
}

fn rms(pixels: &[[f32; 3]]) -> f64 {
    let squares: f64 = pixels.iter().flatten().map(|x| f64::from(*x).powi(2)).sum();
    (squares / (3 * pixels.len()).max(1) as f64).sqrt()
}
