//! A scene as authored: plain data, decoded files included, nothing derived.
//!
//! `io` produces it from TOML, JSON or OBJ; `build` turns it into a `Scene`. Lengths have no unit;
//! colours are linear numbers per channel.

pub mod media;

use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};

use crate::engine::math::Rgb;
pub use media::MediaDesc;

/// Everything a scene file says.
#[derive(Clone, Debug, Default)]
pub struct SceneDesc {
    /// Kebab-case name.
    pub name: String,
    /// One line: what the scene shows.
    pub description: String,
    /// The view to open with.
    pub camera: CameraDesc,
    /// Materials by index; names are kept for messages and the pixel inspector.
    pub materials: Vec<NamedMaterial>,
    /// Triangle meshes.
    pub meshes: Vec<MeshDesc>,
    /// Exact spheres.
    pub spheres: Vec<SphereDesc>,
    /// Lights that are not surfaces.
    pub lights: Vec<LightDesc>,
    /// What is between the surfaces.
    pub media: MediaDesc,
    /// Number of frames, if it is a sequence; this is one of them.
    pub frames: Option<u32>,
    /// Sentences for the user about what was assumed or dropped while reading.
    pub warnings: Vec<String>,
}

/// Perspective camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraDesc {
    /// Eye point.
    pub position: Vec3,
    /// Point in the middle of the picture.
    pub target: Vec3,
    /// Up direction, not parallel to the view direction.
    pub up: Vec3,
    /// Full vertical opening angle in degrees, in (0, 180).
    pub vfov_deg: f32,
    /// Picture width in pixels.
    pub width: u32,
    /// Picture height in pixels.
    pub height: u32,
    /// Thin lens; a pinhole without.
    pub lens: Option<LensDesc>,
}

impl Default for CameraDesc {
    fn default() -> Self {
        Self {
            position: Vec3::new(0.0, 0.0, 5.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            vfov_deg: 40.0,
            width: 512,
            height: 512,
            lens: None,
        }
    }
}

/// Thin lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LensDesc {
    /// Aperture radius in scene units, > 0.
    pub radius: f32,
    /// Distance of the plane in focus along the view direction, > 0.
    pub focus_distance: f32,
}

/// A material and its name in the file.
#[derive(Clone, Debug)]
pub struct NamedMaterial {
    /// Unique name.
    pub name: String,
    /// What it does to light.
    pub material: MaterialDesc,
    /// Probability per channel mean that a ray meets the surface at all; absent is 1.
    pub opacity: Option<ColorDesc>,
}

/// Scattering at a surface. All are two-sided but the dielectrics, whose normal points to the
/// outside (IOR 1).
#[derive(Clone, Debug)]
pub enum MaterialDesc {
    /// f = reflectance / π.
    Diffuse {
        /// Albedo per channel in [0, 1].
        reflectance: ColorDesc,
    },
    /// Perfect mirror, the same at every angle.
    Mirror {
        /// Weight per channel in [0, 1].
        reflectance: ColorDesc,
    },
    /// GGX with separable Smith shadowing and Fresnel factor 1; α = 0 is a mirror.
    GgxConductor {
        /// Weight per channel in [0, 1].
        specular_reflectance: ColorDesc,
        /// Roughness α in [0, 1].
        alpha: f32,
    },
    /// Smooth dielectric with unpolarised Fresnel reflection.
    Dielectric {
        /// Index of refraction inside, > 0, against 1 outside.
        ior: f32,
        /// Weight of transmitted light per channel (1 unless an MTL file's Tf says less).
        transmittance: Rgb,
    },
    /// GGX microfacets of a dielectric (Walter et al. 2007).
    RoughDielectric {
        /// Index of refraction inside, > 0.
        ior: f32,
        /// Roughness α in [0, 1]; 0 is the smooth dielectric.
        alpha: f32,
    },
    /// Diffuse base under a smooth dielectric coat.
    Plastic {
        /// Albedo ρ of the base.
        diffuse_reflectance: ColorDesc,
        /// Index of refraction of the coat.
        ior: f32,
        /// Whether inner reflections shift the colour (k = ρ·Fdr instead of Fdr).
        nonlinear: bool,
    },
    /// Convex combination: `weight` of the second, 1 − `weight` of the first.
    Mix {
        /// Indices into [`SceneDesc::materials`].
        materials: [usize; 2],
        /// In [0, 1].
        weight: f32,
    },
    /// Two materials at full weight, whose reflectances sum to at most 1 in every channel.
    Sum {
        /// Indices into [`SceneDesc::materials`].
        materials: [usize; 2],
    },
}

/// A colour, constant or over the surface's texture coordinates.
#[derive(Clone, Debug)]
pub enum ColorDesc {
    /// One value.
    Constant(Rgb),
    /// An image, repeated; v = 0 at the bottom.
    Texture {
        /// Linear values.
        image: Arc<ImageData>,
        /// Factor on the values.
        scale: Rgb,
    },
    /// Checkerboard of unit squares of uv · `scale`.
    Checker {
        /// The two colours.
        colors: [Rgb; 2],
        /// Squares per unit of u and v.
        scale: f32,
    },
}

/// A decoded image: linear RGB, row 0 on top.
#[derive(Debug, PartialEq)]
pub struct ImageData {
    /// Where it came from, for messages.
    pub name: String,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `width * height` pixels, row by row from the top left.
    pub pixels: Vec<[f32; 3]>,
}

/// A triangle mesh with one material.
#[derive(Clone, Debug, Default)]
pub struct MeshDesc {
    /// For messages and the pixel inspector.
    pub name: String,
    /// Vertex positions.
    pub positions: Vec<Vec3>,
    /// A shading normal a vertex, or empty: flat facets.
    pub normals: Vec<Vec3>,
    /// Texture coordinates a vertex, or empty.
    pub uvs: Vec<[f32; 2]>,
    /// Vertices of each triangle, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Index into [`SceneDesc::materials`].
    pub material: usize,
    /// Radiance emitted from the front side.
    pub emission: Option<Rgb>,
    /// World from object.
    pub transform: Option<Affine3A>,
}

/// A sphere with an exact surface.
#[derive(Clone, Debug)]
pub struct SphereDesc {
    /// For messages and the pixel inspector.
    pub name: String,
    /// Centre in the world, `transform`s applied.
    pub center: Vec3,
    /// Radius, > 0.
    pub radius: f32,
    /// Index into [`SceneDesc::materials`].
    pub material: usize,
    /// Radiance emitted along the normal's side.
    pub emission: Option<Rgb>,
    /// The normal points to the centre and emission goes inward.
    pub inward: bool,
}

/// A light without surface.
#[derive(Clone, Debug)]
pub enum LightDesc {
    /// Irradiance I cosθ / r².
    Point {
        /// Where.
        position: Vec3,
        /// I in W/sr.
        intensity: Rgb,
    },
    /// A point light within a cone.
    Spot {
        /// Where.
        position: Vec3,
        /// Axis, any length.
        direction: Vec3,
        /// I on the axis in W/sr.
        intensity: Rgb,
        /// Half opening angle in degrees beyond which nothing is emitted.
        angle_deg: f32,
        /// Width in degrees of the smooth edge inside that angle.
        falloff_deg: f32,
    },
    /// Parallel light from infinity.
    Directional {
        /// The direction in which it travels, any length.
        direction: Vec3,
        /// W/m² on a surface perpendicular to it.
        irradiance: Rgb,
    },
    /// The same radiance from every direction.
    Constant {
        /// Radiance.
        radiance: Rgb,
    },
    /// Latitude–longitude image: up is +y, the image's centre lies toward −z.
    Environment {
        /// Radiance.
        image: Arc<ImageData>,
        /// Factor.
        scale: Rgb,
        /// Turn about +y, applied to the world.
        rotation: Quat,
    },
}
