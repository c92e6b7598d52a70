//! Bounds on a density in the cells of a coarse grid, and the walk of a ray through them
//! (Amanatides and Woo 1987, *A Fast Voxel Traversal Algorithm for Ray Tracing*).
//!
//! Tracking takes steps by the bound of the cell it is in: empty space costs a division, and a wisp
//! of dense smoke makes small steps nowhere but there.

use glam::Vec3A;

use crate::engine::geometry::{Bounds3, Ray};
use crate::engine::scene::desc::media::DensityData;

/// Most cells along an axis.
const CELLS: usize = 16;

/// The bounds.
#[derive(Clone, Debug)]
pub struct Majorants {
    size: [usize; 3],
    values: Vec<f32>,
    min: Vec3A,
    cell: Vec3A,
    once_a_cell: f32,
}

impl Majorants {
    /// Of `data` over `bounds`, times `scale`.
    pub fn new(data: &DensityData, bounds: Bounds3, scale: f32) -> Self {
        let voxels = data.size.map(|n| n.div_ceil(CELLS));
        let size = [0, 1, 2].map(|a| data.size[a].div_ceil(voxels[a]));
        // Interpolation at a cell's rim looks one voxel beyond it.
        let range = |a: usize, i: usize| {
            (i * voxels[a]).saturating_sub(1)..((i + 1) * voxels[a] + 1).min(data.size[a])
        };
        let mut values = Vec::with_capacity(size.iter().product());
        for k in 0..size[2] {
            for j in 0..size[1] {
                for i in 0..size[0] {
                    let mut most = 0.0_f32;
                    for z in range(2, k) {
                        for y in range(1, j) {
                            let row = (z * data.size[1] + y) * data.size[0];
                            let voxels = range(0, i);
                            let row = &data.values[row + voxels.start..row + voxels.end];
                            most = row.iter().fold(most, |m, v| m.max(*v));
                        }
                    }
                    // Interpolation rounds: a constant density stays below its bound.
                    values.push(most * scale * (1.0 + 4.0 * f32::EPSILON));
                }
            }
        }
        let per_voxel = (bounds.max - bounds.min)
            / Vec3A::new(
                data.size[0] as f32,
                data.size[1] as f32,
                data.size[2] as f32,
            );
        let voxels = Vec3A::new(voxels[0] as f32, voxels[1] as f32, voxels[2] as f32);
        Self {
            size,
            values,
            min: bounds.min,
            cell: per_voxel * voxels,
            once_a_cell: 0.0,
        }
        .with_rate()
    }

    fn with_rate(mut self) -> Self {
        let most = self.values.iter().fold(0.0_f32, |m, v| m.max(*v));
        if most > 0.0 {
            self.once_a_cell = 1.0 / (most * self.cell.min_element());
        }
        self
    }

    /// The extinction by which a ray collides once in a cell of the highest bound, 1/m.
    #[inline]
    pub fn once_a_cell(&self) -> f32 {
        self.once_a_cell
    }

    /// One cell with a value.
    pub fn uniform(bounds: Bounds3, value: f32) -> Self {
        Self {
            size: [1; 3],
            values: vec![value],
            min: bounds.min,
            cell: bounds.max - bounds.min,
            once_a_cell: 0.0,
        }
        .with_rate()
    }

    /// The same cells with their values times `factor`.
    pub fn scaled(&self, factor: f32) -> Self {
        let mut scaled = self.clone();
        scaled.values.iter_mut().for_each(|v| *v *= factor);
        scaled
    }

    /// The values: x fastest, then y, then z.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// To be changed.
    pub fn values_mut(&mut self) -> &mut [f32] {
        &mut self.values
    }

    /// Volume of a cell in units of `unit`³.
    pub fn cell_volume(&self, unit: f64) -> f64 {
        let side = self.cell.as_dvec3() / unit;
        side.x * side.y * side.z
    }

    /// A place in the cell of number `index`, uniform if `u` is in the unit cube.
    pub fn place(&self, index: usize, u: Vec3A) -> Vec3A {
        let [nx, ny, _] = self.size;
        let (i, j, k) = (index % nx, index / nx % ny, index / (nx * ny));
        self.min + (Vec3A::new(i as f32, j as f32, k as f32) + u) * self.cell
    }

    /// The cells along `span` of the ray, in order: where each begins and ends, and its bound.
    #[inline]
    pub fn walk(&self, ray: &Ray, span: (f32, f32)) -> CellWalk<'_> {
        let from = ray.o - self.min;
        let start = (from + ray.d * span.0) / self.cell;
        let index = [0, 1, 2].map(|a| (start[a].max(0.0) as usize).min(self.size[a] - 1));
        CellWalk {
            grid: self,
            from,
            d: ray.d,
            index,
            t: span.0,
            end: span.1,
        }
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.values)
    }
}

/// See [`Majorants::walk`].
pub struct CellWalk<'a> {
    grid: &'a Majorants,
    from: Vec3A,
    d: Vec3A,
    index: [usize; 3],
    t: f32,
    end: f32,
}

impl Iterator for CellWalk<'_> {
    type Item = (f32, f32, f32);

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        // A comparison that ends a walk at NaN, too.
        let goes_on = self.t < self.end;
        if !goes_on {
            return None;
        }
        let (mut axis, mut leave) = (0, f32::INFINITY);
        for a in 0..3 {
            let d = self.d[a];
            if d == 0.0 {
                continue;
            }
            let plane = (self.index[a] + usize::from(d > 0.0)) as f32 * self.grid.cell[a];
            let t = (plane - self.from[a]) / d;
            if t < leave {
                (axis, leave) = (a, t);
            }
        }
        let [i, j, k] = self.index;
        let bound = self.grid.values[(k * self.grid.size[1] + j) * self.grid.size[0] + i];
        let begin = self.t;
        let next = if self.d[axis] > 0.0 {
            Some(self.index[axis] + 1).filter(|i| *i < self.grid.size[axis])
        } else {
            self.index[axis].checked_sub(1)
        };
        match next {
            Some(i) => {
                self.index[axis] = i;
                self.t = leave.clamp(begin, self.end);
            }
            // The last cell: what rounding leaves of the span belongs to it.
            None => self.t = self.end,
        }
        Some((begin, self.t, bound))
    }
}
