//! A density over a box.

use std::sync::Arc;

use glam::Vec3A;

use super::majorant::Majorants;
use crate::engine::geometry::{Bounds3, Ray};
use crate::engine::scene::desc::media::{DensityData, GridDesc};

/// Density per place, and bounds on it.
#[derive(Clone, Debug)]
pub struct Grid {
    data: Arc<DensityData>,
    bounds: Bounds3,
    /// Voxels per length.
    scale: Vec3A,
    /// Bounds on the density in coarse cells.
    pub majorants: Majorants,
}

impl Grid {
    /// Prepares `desc`.
    pub fn new(desc: &GridDesc) -> Self {
        let bounds = Bounds3 {
            min: desc.min.into(),
            max: desc.max.into(),
        };
        let [nx, ny, nz] = desc.density.size.map(|n| n as f32);
        Self {
            data: Arc::clone(&desc.density),
            bounds,
            scale: Vec3A::new(nx, ny, nz) / (bounds.max - bounds.min),
            majorants: Majorants::new(&desc.density, bounds, desc.majorant_scale),
        }
    }

    /// Density at `p`: trilinear between voxel centres, constant beyond the outermost.
    #[inline]
    pub fn density(&self, p: Vec3A) -> f32 {
        let [nx, ny, nz] = self.data.size;
        let last = Vec3A::new((nx - 1) as f32, (ny - 1) as f32, (nz - 1) as f32);
        let x = ((p - self.bounds.min) * self.scale - 0.5).clamp(Vec3A::ZERO, last);
        let low = x.floor();
        let f = x - low;
        let (i, j, k) = (low.x as usize, low.y as usize, low.z as usize);
        let (i1, j1, k1) = (
            (i + 1).min(nx - 1),
            (j + 1).min(ny - 1),
            (k + 1).min(nz - 1),
        );
        let row = |j: usize, k: usize| {
            let start = (k * ny + j) * nx;
            let (a, b) = (self.data.values[start + i], self.data.values[start + i1]);
            a + (b - a) * f.x
        };
        let plane = |k: usize| {
            let (a, b) = (row(j, k), row(j1, k));
            a + (b - a) * f.y
        };
        let (a, b) = (plane(k), plane(k1));
        a + (b - a) * f.z
    }

    /// The part of `span` of the ray that lies in the box; the first is not below the second if
    /// none does.
    #[inline]
    pub fn clip(&self, ray: &Ray, span: (f32, f32)) -> (f32, f32) {
        clip(&self.bounds, ray, span)
    }

    /// The box.
    pub fn bounds(&self) -> Bounds3 {
        self.bounds
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.data.values) + self.majorants.memory_bytes()
    }
}

/// The part of `span` of the ray that lies in a box; the first is not below the second if none does.
#[inline]
pub fn clip(bounds: &Bounds3, ray: &Ray, span: (f32, f32)) -> (f32, f32) {
    let (mut begin, mut end) = span;
    for axis in 0..3 {
        let (o, d) = (ray.o[axis], ray.d[axis]);
        let (low, high) = (bounds.min[axis], bounds.max[axis]);
        if d == 0.0 {
            if o < low || o > high {
                return (1.0, 0.0);
            }
            continue;
        }
        let (a, b) = ((low - o) / d, (high - o) / d);
        begin = begin.max(a.min(b));
        end = end.min(a.max(b));
    }
    (begin, end)
}
