//! MTL materials, mapped to ours.
//!
//! | MTL | here |
//! |---|---|
//! | `Kd`, `map_Kd` | diffuse reflectance (times the texture, sRGB) |
//! | `Ks` with `Ns`, or `Pr` | a GGX lobe of weight `Ks` mixed over the diffuse one; α = Pr², or α = √(2 / (Ns + 2)), the width of a Phong lobe of exponent Ns |
//! | `Pm` | metalness: that share of the material is a conductor of colour Kd |
//! | `Ke`, `map_Ke` | emission (the texture's image must be one colour) |
//! | `illum` 3, 5 | mirror of colour Ks (a conductor where Pr or Ns make it rough) |
//! | `illum` 4, 6, 7, 9 | dielectric of index `Ni` (1.5 if absent or 1), transmittance `Tf` |
//! | `d`, `Tr` | opacity, for the other `illum`s |
//!
//! A mixture scatters at most what came in: weights are scaled down where Kd + Ks exceeds 1.

use std::collections::HashMap;
use std::sync::Arc;

use glam::Vec3;

use super::error::InputError;
use super::image::Encoding;
use super::materials::Colors;
use crate::engine::math::Rgb;
use crate::engine::scene::desc::{ColorDesc, ImageData, MaterialDesc, NamedMaterial};

/// One `newmtl` block as it stands in the file.
#[derive(Clone, Debug, Default)]
pub struct MtlMaterial {
    /// The file it stands in; its textures lie beside that.
    pub file: String,
    /// The line of each of its statements, from 1, by keyword.
    pub lines: HashMap<String, usize>,
    /// Its name.
    pub name: String,
    /// Kd.
    pub diffuse: Option<[f32; 3]>,
    /// Ks.
    pub specular: Option<[f32; 3]>,
    /// Ke.
    pub emissive: Option<[f32; 3]>,
    /// Ns.
    pub shininess: Option<f32>,
    /// d.
    pub dissolve: Option<f32>,
    /// Ni.
    pub ior: Option<f32>,
    /// illum.
    pub illum: Option<u8>,
    /// map_Kd.
    pub diffuse_texture: Option<String>,
    /// The rest, by name.
    pub unknown: HashMap<String, String>,
}

impl MtlMaterial {
    /// The image that the statement `keyword` names.
    fn texture(
        &self,
        keyword: &str,
        statement: &str,
        colors: &mut Colors<'_>,
    ) -> Result<Arc<ImageData>, InputError> {
        let line = self.lines.get(keyword).copied().unwrap_or(1);
        colors.image(&self.file, line, texture_name(statement), Encoding::Srgb)
    }
}

/// A material of an MTL file and what it emits.
pub struct Mapped {
    /// The material itself comes first; parts of a mixture follow, with indices from its own.
    pub materials: Vec<NamedMaterial>,
    /// Ke.
    pub emission: Option<ColorDesc>,
}

/// What is used where no material is named.
pub fn default_material() -> NamedMaterial {
    let reflectance = ColorDesc::Constant(Rgb::splat(0.7));
    let material = MaterialDesc::Diffuse { reflectance };
    NamedMaterial {
        name: "default".to_owned(),
        material,
        opacity: None,
    }
}

/// Maps one material; `base` is the index it will have.
pub fn map(mtl: &MtlMaterial, base: usize, colors: &mut Colors<'_>) -> Result<Mapped, InputError> {
    let share = |c: Option<[f32; 3]>, or: f32| {
        let c = c.unwrap_or([or; 3]);
        Rgb::from(c.map(|x| if x.is_finite() { x.clamp(0.0, 1.0) } else { or }))
    };
    let diffuse = share(mtl.diffuse, if mtl.specular.is_some() { 0.0 } else { 0.7 });
    let specular = share(mtl.specular, 0.0);
    let number = |name: &str| {
        mtl.unknown
            .get(name)
            .and_then(|t| t.trim().parse::<f32>().ok())
    };
    let roughness = number("Pr").filter(|r| r.is_finite());
    let metal = number("Pm")
        .filter(|m| m.is_finite())
        .unwrap_or(0.0)
        .clamp(0.0, 1.0);
    let alpha = match (roughness, mtl.shininess.filter(|n| n.is_finite())) {
        (Some(r), _) => (r * r).clamp(0.0, 1.0),
        (None, Some(n)) => (2.0 / (n.max(0.0) + 2.0)).sqrt(),
        (None, None) => 0.0,
    };
    let reflectance = match &mtl.diffuse_texture {
        Some(name) => {
            let image = mtl.texture("map_Kd", name, colors)?;
            let scale = if mtl.diffuse.is_some() && !diffuse.is_black() {
                diffuse
            } else {
                Rgb::WHITE
            };
            ColorDesc::Texture { image, scale }
        }
        None => ColorDesc::Constant(diffuse),
    };
    let emission = emission(mtl, colors)?;
    let named = |name: String, material| NamedMaterial {
        name,
        material,
        opacity: None,
    };
    let conductor = |specular_reflectance| MaterialDesc::GgxConductor {
        specular_reflectance,
        alpha,
    };
    let mut materials = match mtl.illum {
        Some(4 | 6 | 7 | 9) => {
            let ior = mtl
                .ior
                .filter(|n| (1e-4..=1e4).contains(n) && *n != 1.0)
                .unwrap_or(1.5);
            let transmittance = match mtl.unknown.get("Tf") {
                Some(text) => share(triple(text), 1.0),
                None => Rgb::WHITE,
            };
            vec![named(
                mtl.name.clone(),
                MaterialDesc::Dielectric { ior, transmittance },
            )]
        }
        Some(3 | 5) => {
            let rough = roughness.is_some() || mtl.shininess.is_some_and(|n| n < 1000.0 && n > 0.0);
            let material = if rough {
                conductor(ColorDesc::Constant(specular))
            } else {
                MaterialDesc::Mirror {
                    reflectance: ColorDesc::Constant(specular),
                }
            };
            vec![named(mtl.name.clone(), material)]
        }
        _ => opaque(mtl, reflectance, specular, metal, &conductor, base),
    };
    let opaque_illum = !matches!(mtl.illum, Some(4 | 6 | 7 | 9));
    let opacity = mtl
        .dissolve
        .or(number("Tr").map(|t| 1.0 - t))
        .filter(|d| d.is_finite());
    if let Some(d) = opacity.filter(|d| *d < 1.0 && opaque_illum) {
        materials[0].opacity = Some(ColorDesc::Constant(Rgb::splat(d.max(0.0))));
    }
    Ok(Mapped {
        materials,
        emission,
    })
}

/// Diffuse, conductor, or a mixture of both.
fn opaque(
    mtl: &MtlMaterial,
    reflectance: ColorDesc,
    specular: Rgb,
    metal: f32,
    conductor: &dyn Fn(ColorDesc) -> MaterialDesc,
    base: usize,
) -> Vec<NamedMaterial> {
    let named = |name: String, material| NamedMaterial {
        name,
        material,
        opacity: None,
    };
    let part = |what: &str| format!("{}, {what}", mtl.name);
    // The conductor's share: all of it for a metal, else the mean of Ks against that of Kd.
    let (share, color) = if metal > 0.0 {
        (metal, reflectance.clone())
    } else {
        (
            specular.mean().min(1.0),
            ColorDesc::Constant(specular / specular.max_component().max(f32::MIN_POSITIVE)),
        )
    };
    let diffuse = MaterialDesc::Diffuse { reflectance };
    if share <= 0.0 {
        return vec![named(mtl.name.clone(), diffuse)];
    }
    if share >= 1.0 {
        return vec![named(mtl.name.clone(), conductor(color))];
    }
    let mix = MaterialDesc::Mix {
        materials: [base + 1, base + 2],
        weight: share,
    };
    vec![
        named(mtl.name.clone(), mix),
        named(part("diffuse"), diffuse),
        named(part("glossy"), conductor(color)),
    ]
}

fn emission(mtl: &MtlMaterial, colors: &mut Colors<'_>) -> Result<Option<ColorDesc>, InputError> {
    let sane = |x: f32| x.is_finite() && x >= 0.0;
    let ke = mtl
        .emissive
        .or_else(|| triple(mtl.unknown.get("Ke")?))
        .filter(|e| e.iter().all(|x| sane(*x)));
    let ke = ke.map(Rgb::from).filter(|e| !e.is_black());
    let Some(name) = mtl.unknown.get("map_Ke") else {
        return Ok(ke.map(ColorDesc::Constant));
    };
    let image = mtl.texture("map_Ke", name, colors)?;
    Ok(Some(ColorDesc::Texture {
        image,
        scale: ke.unwrap_or(Rgb::WHITE),
    }))
}

/// The file of a texture statement, whose options come before it.
fn texture_name(statement: &str) -> &str {
    let statement = statement.trim();
    if statement.starts_with('-') {
        statement.rsplit(' ').next().unwrap_or(statement)
    } else {
        statement
    }
}

fn triple(text: &str) -> Option<[f32; 3]> {
    let v = text
        .split_whitespace()
        .map(|w| w.parse().ok())
        .collect::<Option<Vec<f32>>>()?;
    match v[..] {
        [x] => Some(Vec3::splat(x).to_array()),
        [x, y, z] => Some([x, y, z]),
        _ => None,
    }
}
