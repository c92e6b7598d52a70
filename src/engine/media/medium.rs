//! A medium, prepared.

use glam::Vec3A;

use super::grid::Grid;
use super::phase::Phase;
use crate::engine::math::Rgb;
use crate::engine::scene::desc::media::{NamedMedium, PhaseDesc};

/// Scattering, absorption and emission in a volume.
#[derive(Clone, Debug)]
pub struct Medium {
    /// Extinction at density 1, 1/m.
    pub sigma_t: Rgb,
    /// σ_s / σ_t, in [0, 1].
    pub albedo: Rgb,
    /// Emitted radiance per length at density 1.
    pub emission: Rgb,
    /// Where scattered light goes.
    pub phase: Phase,
    pub(super) scatters: bool,
    /// The density, 1 if absent.
    pub(super) grid: Option<Grid>,
}

impl Medium {
    /// Prepares `desc`.
    ///
    /// # Errors
    /// A sentence, where a number makes no sense.
    pub fn new(desc: &NamedMedium) -> Result<Self, String> {
        let (name, desc) = (&desc.name, &desc.medium);
        let all = |c: Rgb, valid: fn(f32) -> bool| c.to_array().into_iter().all(valid);
        let amount = |x: f32| x.is_finite() && x >= 0.0;
        let wrong = |what: &str| Err(format!("medium \"{name}\": {what}"));
        if !all(desc.sigma_t, amount) || !all(desc.emission, amount) {
            return wrong("sigma_t and emission are finite and not negative");
        }
        if !all(desc.albedo, |x| (0.0..=1.0).contains(&x)) {
            return wrong("its albedo lies between 0 and 1");
        }
        if let PhaseDesc::HenyeyGreenstein { g } = desc.phase
            && (g.is_nan() || g.abs() >= 1.0)
        {
            return wrong("g of its phase function lies between -1 and 1, both excluded");
        }
        if let Some(grid) = &desc.grid {
            let count: usize = grid.density.size.iter().product();
            let values = &grid.density.values;
            if count == 0 || values.len() != count || !values.iter().all(|x| amount(*x)) {
                return wrong("its densities are finite, not negative, and as many as voxels");
            }
            if desc.sigma_t.is_black() && !desc.emission.is_black() {
                return wrong(
                    "a grid that emits has an extinction, by which it is stepped through",
                );
            }
            if !grid.min.cmplt(grid.max).all() || !grid.min.is_finite() || !grid.max.is_finite() {
                return wrong("the upper corner of its box lies above the lower one");
            }
        }
        Ok(Self {
            sigma_t: desc.sigma_t,
            albedo: desc.albedo,
            emission: desc.emission,
            phase: desc.phase.into(),
            scatters: !(desc.sigma_t * desc.albedo).is_black(),
            grid: desc.grid.as_ref().map(Grid::new),
        })
    }

    /// Whether the density is the same everywhere, so that distances have a density in closed form.
    #[inline]
    pub fn is_homogeneous(&self) -> bool {
        self.grid.is_none()
    }

    /// Whether light that meets it may go on in another direction.
    #[inline]
    pub fn scatters(&self) -> bool {
        self.scatters
    }

    /// Density at `p`.
    #[inline]
    pub fn density(&self, p: Vec3A) -> f32 {
        self.grid.as_ref().map_or(1.0, |g| g.density(p))
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        self.grid.as_ref().map_or(0, Grid::memory_bytes)
    }
}
