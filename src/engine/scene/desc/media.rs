//! Participating media as authored.

use std::ops::Range;
use std::sync::Arc;

use glam::Vec3;

use crate::engine::math::Rgb;

/// The media of a scene and where they are.
#[derive(Clone, Debug, Default)]
pub struct MediaDesc {
    /// By index; names are kept for messages.
    pub media: Vec<NamedMedium>,
    /// The medium wherever no interior is, an index into `media`.
    pub everywhere: Option<usize>,
    /// Closed surfaces and what fills them.
    pub interiors: Vec<InteriorDesc>,
}

/// A medium and its name in the file.
#[derive(Clone, Debug)]
pub struct NamedMedium {
    /// Unique name.
    pub name: String,
    /// What it does to light.
    pub medium: MediumDesc,
}

/// Scattering, absorption and emission in a volume.
#[derive(Clone, Debug)]
pub struct MediumDesc {
    /// Extinction σ_t in 1/length, at density 1.
    pub sigma_t: Rgb,
    /// σ_s / σ_t, in [0, 1].
    pub albedo: Rgb,
    /// Emitted radiance per length, at density 1.
    pub emission: Rgb,
    /// Where scattered light goes.
    pub phase: PhaseDesc,
    /// How the density varies; 1 everywhere if absent.
    pub grid: Option<GridDesc>,
}

/// Phase functions; all integrate to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PhaseDesc {
    /// The same in all directions.
    Isotropic,
    /// Henyey and Greenstein, of mean cosine g; g > 0 scatters forward.
    HenyeyGreenstein {
        /// In (−1, 1).
        g: f32,
    },
    /// Particles much smaller than the wavelength.
    Rayleigh,
}

/// A density over a box, trilinear between voxel centres at (i + ½)/n, clamped at the faces.
#[derive(Clone, Debug)]
pub struct GridDesc {
    /// The values.
    pub density: Arc<DensityData>,
    /// Lower corner of the box.
    pub min: Vec3,
    /// Upper corner.
    pub max: Vec3,
    /// Factor on the bounds that tracking takes its steps by. 1 is right; more costs time, and less
    /// is found out and reported.
    pub majorant_scale: f32,
}

/// Densities, x fastest, then y, then z.
#[derive(Debug, PartialEq)]
pub struct DensityData {
    /// Where they came from, for messages.
    pub name: String,
    /// Numbers of voxels, each > 0.
    pub size: [usize; 3],
    /// Finite, ≥ 0.
    pub values: Vec<f32>,
}

/// A closed surface and what it is filled with.
#[derive(Clone, Debug)]
pub struct InteriorDesc {
    /// Which surface.
    pub surface: SurfaceDesc,
    /// Index into [`MediaDesc::media`]; nothing if absent.
    pub medium: Option<usize>,
    /// Where interiors overlap, the higher one is there; of equal ones the later.
    pub priority: i32,
}

/// A closed surface of the scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SurfaceDesc {
    /// Meshes that together close it; normals point outward.
    Meshes(Range<usize>),
    /// A sphere.
    Sphere(usize),
}
