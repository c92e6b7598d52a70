//! MTL materials, mapped to ours.
//!
//! | MTL | here |
//! |---|---|
//! | `Kd`, `map_Kd` | diffuse reflectance (times the texture, sRGB) |
//! | `Ks` with `Ns` or `Pr` | a GGX lobe of reflectance `Ks` beside the diffuse one; α = Pr², or α = √(2 / (Ns + 2)), the width of a Phong lobe of exponent Ns |
//! | `Pm` | metalness: that share of the material is a conductor of colour Kd |
//! | `Ke`, `map_Ke` | emission, of the mean colour of the texture |
//! | `illum` 0, 1 | no highlight: `Ks` is not looked at |
//! | `illum` 3, 5 | mirror of colour Ks (a conductor where Pr or Ns make it rough) |
//! | `illum` 4, 6, 7, 9 | dielectric of index `Ni` (1.5 if absent or 1), transmittance `Tf` |
//! | `d`, `Tr` | opacity, for the other `illum`s |
//!
//! Kd and Ks are scaled down together where a channel of their sum exceeds 1. What is not in this
//! table and would be seen is told in a warning.

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

/// A material of an MTL file and what it emits.
pub struct Mapped {
    /// The material itself comes first; parts of a mixture follow, with indices from its own.
    pub materials: Vec<NamedMaterial>,
    /// Ke.
    pub emission: Option<Rgb>,
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

/// Maps one material; `base` is the index it will have. What is lost goes into `warnings`.
pub fn map(
    mtl: &MtlMaterial,
    base: usize,
    colors: &mut Colors<'_>,
    warnings: &mut Vec<String>,
) -> Mapped {
    mtl.warn_of_the_rest(warnings);
    let metal = mtl.number("Pm").unwrap_or(0.0).clamp(0.0, 1.0);
    let glass = matches!(mtl.illum, Some(4 | 6 | 7 | 9));
    let mut materials = match mtl.illum {
        _ if glass => vec![mtl.named("", mtl.dielectric(warnings))],
        Some(3 | 5) => vec![mtl.named("", mtl.mirror(warnings))],
        _ => mtl.opaque(metal, base, colors, warnings),
    };
    let opacity = mtl.dissolve.or(mtl.number("Tr").map(|t| 1.0 - t));
    if let Some(d) = opacity.filter(|d| *d < 1.0 && !glass) {
        materials[0].opacity = Some(ColorDesc::Constant(Rgb::splat(d.max(0.0))));
    }
    Mapped {
        materials,
        emission: mtl.emission(colors, warnings),
    }
}

impl MtlMaterial {
    fn named(&self, part: &str, material: MaterialDesc) -> NamedMaterial {
        NamedMaterial {
            name: format!("{}{part}", self.name),
            material,
            opacity: None,
        }
    }

    /// A statement of one number that tobj does not know.
    fn number(&self, keyword: &str) -> Option<f32> {
        let number: f32 = self.unknown.get(keyword)?.trim().parse().ok()?;
        number.is_finite().then_some(number)
    }

    /// A reflectance, brought into [0, 1].
    fn share(&self, keyword: &str, c: [f32; 3], warnings: &mut Vec<String>) -> Rgb {
        if !c.iter().all(|x| (0.0..=1.0).contains(x)) {
            let place = self.place(keyword);
            warnings.push(format!("{place}: {keyword} is brought between 0 and 1"));
        }
        Rgb::from(c.map(|x| {
            if x.is_finite() {
                x.clamp(0.0, 1.0)
            } else {
                0.0
            }
        }))
    }

    fn place(&self, keyword: &str) -> String {
        let line = self.lines.get(keyword).copied().unwrap_or(1);
        format!("{}:{line}", self.file)
    }

    /// α of the highlight, if there is one.
    fn alpha(&self) -> Option<f32> {
        let phong = |n: f32| (2.0 / (n.max(0.0) + 2.0)).sqrt();
        let from_phong = self.shininess.filter(|n| n.is_finite()).map(phong);
        self.number("Pr")
            .map(|r| (r * r).clamp(0.0, 1.0))
            .or(from_phong)
    }

    fn dielectric(&self, warnings: &mut Vec<String>) -> MaterialDesc {
        let valid = |n: &f32| (1e-4..=1e4).contains(n) && *n != 1.0;
        let tint = self.unknown.get("Tf").and_then(|text| triple(text));
        MaterialDesc::Dielectric {
            ior: self.ior.filter(valid).unwrap_or(1.5),
            transmittance: self.share("Tf", tint.unwrap_or([1.0; 3]), warnings),
        }
    }

    fn mirror(&self, warnings: &mut Vec<String>) -> MaterialDesc {
        let reflectance = self.share("Ks", self.specular.unwrap_or([0.0; 3]), warnings);
        let reflectance = ColorDesc::Constant(reflectance);
        let sharp = |n: f32| n <= 0.0 || n >= 1000.0;
        let smooth = self.number("Pr").is_none() && self.shininess.is_none_or(sharp);
        match self.alpha() {
            Some(alpha) if !smooth => MaterialDesc::GgxConductor {
                specular_reflectance: reflectance,
                alpha,
            },
            _ => MaterialDesc::Mirror { reflectance },
        }
    }

    /// Diffuse, with a conductor beside it where there is metal or a highlight.
    fn opaque(
        &self,
        metal: f32,
        base: usize,
        colors: &mut Colors<'_>,
        warnings: &mut Vec<String>,
    ) -> Vec<NamedMaterial> {
        let or = if self.specular.is_some() { 0.0 } else { 0.7 };
        let mut kd = self.share("Kd", self.diffuse.unwrap_or([or; 3]), warnings);
        let texture = self.diffuse_texture.as_ref();
        let image = texture.and_then(|name| self.texture("map_Kd", name, colors, warnings));
        if image.is_some() && (self.diffuse.is_none() || kd.is_black()) {
            kd = Rgb::WHITE;
        }
        let highlight = !matches!(self.illum, Some(0 | 1)) && metal == 0.0;
        let ks = self.specular.filter(|_| highlight).zip(self.alpha());
        let (mut ks, alpha) = ks
            .map_or((Rgb::BLACK, self.alpha().unwrap_or(0.0)), |(ks, alpha)| {
                (self.share("Ks", ks, warnings), alpha)
            });
        let most = (kd + ks).max_component();
        if most > 1.0 {
            (kd, ks) = (kd / most, ks / most);
        }
        let diffuse_color = match image {
            Some(image) => ColorDesc::Texture { image, scale: kd },
            None => ColorDesc::Constant(kd),
        };
        let conductor = |specular_reflectance| MaterialDesc::GgxConductor {
            specular_reflectance,
            alpha,
        };
        let diffuse = MaterialDesc::Diffuse {
            reflectance: diffuse_color.clone(),
        };
        let materials = [base + 1, base + 2];
        let (whole, glossy) = if metal > 0.0 {
            let weight = metal;
            (
                MaterialDesc::Mix { materials, weight },
                conductor(diffuse_color),
            )
        } else if !ks.is_black() {
            let glossy = conductor(ColorDesc::Constant(ks));
            (MaterialDesc::Sum { materials }, glossy)
        } else {
            return vec![self.named("", diffuse)];
        };
        vec![
            self.named("", whole),
            self.named(", diffuse", diffuse),
            self.named(", glossy", glossy),
        ]
    }

    fn emission(&self, colors: &mut Colors<'_>, warnings: &mut Vec<String>) -> Option<Rgb> {
        let sane = |e: &[f32; 3]| e.iter().all(|x| x.is_finite() && *x >= 0.0);
        let ke = self
            .emissive
            .or_else(|| triple(self.unknown.get("Ke")?))
            .filter(sane)
            .map(Rgb::from)
            .filter(|e| !e.is_black());
        let Some(statement) = self.unknown.get("map_Ke") else {
            return ke;
        };
        let Some(image) = self.texture("map_Ke", statement, colors, warnings) else {
            return ke;
        };
        if image.pixels.iter().any(|p| *p != image.pixels[0]) {
            let place = self.place("map_Ke");
            warnings.push(format!(
                "{place}: a lamp has one colour, the mean of map_Ke"
            ));
        }
        let sum = image.pixels.iter().map(|p| Rgb::from(*p));
        let mean = sum.fold(Rgb::BLACK, |a, b| a + b) / image.pixels.len() as f32;
        Some(ke.unwrap_or(Rgb::WHITE) * mean).filter(|e| !e.is_black())
    }

    /// The image that the statement `keyword` names; without it the plain colour is left.
    fn texture(
        &self,
        keyword: &str,
        statement: &str,
        colors: &mut Colors<'_>,
        warnings: &mut Vec<String>,
    ) -> Option<Arc<ImageData>> {
        let line = self.lines.get(keyword).copied().unwrap_or(1);
        let image = colors.image(&self.file, line, texture_name(statement), Encoding::Srgb);
        let told = |e: &InputError| warnings.push(format!("{e}; the plain colour is used"));
        image.inspect_err(told).ok()
    }

    /// Statements that would be seen and are not looked at.
    fn warn_of_the_rest(&self, warnings: &mut Vec<String>) {
        let seen = [
            "map_Ks", "map_Ns", "map_d", "map_Bump", "map_bump", "bump", "norm", "map_Pr", "map_Pm",
        ];
        for keyword in seen.iter().filter(|k| self.lines.contains_key(**k)) {
            let place = self.place(keyword);
            warnings.push(format!("{place}: {keyword} is not looked at"));
        }
    }
}

/// The file of a texture statement, whose options come before it; its name may hold spaces.
fn texture_name(statement: &str) -> &str {
    let mut rest = statement.trim();
    while rest.starts_with('-') {
        let (option, after) = split_word(rest);
        rest = after;
        // The vectors have one to three numbers, the others a fixed count of values.
        let (values, numbers_only) = match option {
            "-o" | "-s" | "-t" => (3, true),
            "-mm" => (2, false),
            _ => (1, false),
        };
        for _ in 0..values {
            let (word, after) = split_word(rest);
            if after.is_empty() || numbers_only && word.parse::<f32>().is_err() {
                break;
            }
            rest = after;
        }
    }
    rest
}

/// The first word, and what comes after it.
fn split_word(text: &str) -> (&str, &str) {
    let (word, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    (word, rest.trim_start())
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_of_a_texture_are_not_its_name() {
        assert_eq!(texture_name(" my one.png "), "my one.png");
        assert_eq!(texture_name("-s 1 1 1 my one.png"), "my one.png");
        assert_eq!(texture_name("-o 0.5 -clamp on 1.png"), "1.png");
        assert_eq!(texture_name("-mm 0 1 -bm 2 a b.png"), "a b.png");
        assert_eq!(texture_name("-s"), "");
    }
}
