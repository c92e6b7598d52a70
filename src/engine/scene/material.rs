//! Materials prepared for rendering: a flat list of weighted lobes.

use arrayvec::ArrayVec;
use glam::Vec2;

use super::desc::{ColorDesc, MaterialDesc, NamedMaterial};
use super::texture::Texture;
use crate::engine::bsdf::{self, Bsdf, Lobe, MAX_LOBES, mean_transmittance};
use crate::engine::event::Letter;
use crate::engine::geometry::interaction::SurfaceInteraction;
use crate::engine::math::Rgb;

/// Indices of refraction that are computed with; far beyond any real one on both sides.
const IOR_RANGE: std::ops::RangeInclusive<f32> = 1e-4..=1e4;

/// A rough dielectric of an index closer to 1 than this is taken as smooth: it spreads light by
/// about α |η − 1|, less than `f32` directions resolve.
const MIN_ROUGH_CONTRAST: f32 = 1e-4;

/// What a material, or a scene, can do to light: a set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Features(u8);

impl Features {
    /// Nothing.
    pub const NONE: Self = Self(0);
    /// A diffuse lobe.
    pub const DIFFUSE: Self = Self(1);
    /// A microfacet lobe.
    pub const GLOSSY: Self = Self(1 << 1);
    /// A delta lobe.
    pub const SPECULAR: Self = Self(1 << 2);
    /// Light crosses the surface, scattered.
    pub const TRANSMISSIVE: Self = Self(1 << 3);
    /// A value that varies over texture coordinates.
    pub const TEXTURED: Self = Self(1 << 4);
    /// Opacity below 1: light passes unscattered.
    pub const TRANSPARENT: Self = Self(1 << 5);

    /// Both sets together.
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether every member of `other` is in this set.
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }
}

/// The colour of a lobe.
#[derive(Clone, Debug)]
enum Weight {
    Constant(Rgb),
    Textured {
        texture: Texture,
        /// Share of the lobe in the mixture.
        share: f32,
        /// Of a plastic's base.
        base: Option<Base>,
    },
}

/// A plastic's diffuse base.
#[derive(Clone, Copy, Debug)]
struct Base {
    /// 1 − Fdr, the cosine-weighted mean transmittance from within the coat.
    internal_transmittance: f32,
    nonlinear: bool,
}

impl Base {
    /// ρ (1 − Fdr)/(1 − k), the base's albedo under diffuse illumination that has entered.
    #[inline]
    fn albedo(self, rho: Rgb) -> Rgb {
        if !self.nonlinear {
            return rho; // k = Fdr
        }
        // 1 − k = 1 − ρ Fdr, written so that nothing cancels for ρ next to 1.
        let t = self.internal_transmittance;
        rho.map(|r| r * t / ((1.0 - r) + r * t))
    }
}

/// How a surface scatters, prepared.
///
/// Invariant: reflectances lie in [0, 1] and the shares of a mixture sum to 1.
#[derive(Clone, Debug)]
pub struct Material {
    lobes: ArrayVec<(Weight, Lobe), MAX_LOBES>,
    opacity: Option<Texture>,
    features: Features,
}

impl Material {
    /// Prepares material `index` of `all`.
    ///
    /// # Errors
    /// A sentence for the user: an index or a value out of range, a mixture that contains itself
    /// or has more than [`MAX_LOBES`] lobes.
    pub fn build(index: usize, all: &[NamedMaterial]) -> Result<Self, String> {
        let named = all
            .get(index)
            .ok_or_else(|| format!("There is no material number {index}."))?;
        let mut builder = Builder {
            all,
            parents: Vec::new(),
            lobes: ArrayVec::new(),
        };
        let describe = |what: String| format!("Material \"{}\": {what}.", named.name);
        builder.add(index, 1.0).map_err(describe)?;
        let mut lobes = builder.lobes;
        lobes.retain(|(w, _)| !matches!(w, Weight::Constant(c) if c.is_black()));

        let opacity = named.opacity.as_ref().map(build_color).transpose();
        let opacity = opacity
            .map_err(|e| describe(format!("opacity: {e}")))?
            .filter(|t| t.constant().is_none_or(|c| c.mean() < 1.0));
        let features = features(&lobes, opacity.as_ref());
        Ok(Self {
            lobes,
            opacity,
            features,
        })
    }

    /// The scattering at `si`.
    #[inline]
    pub fn bsdf(&self, si: &SurfaceInteraction) -> Bsdf {
        let mut bsdf = Bsdf::new(si);
        self.add_lobes(si, &mut bsdf);
        bsdf
    }

    /// Adds its lobes at `si` to `bsdf`.
    #[inline]
    pub fn add_lobes(&self, si: &SurfaceInteraction, bsdf: &mut Bsdf) {
        for (weight, lobe) in &self.lobes {
            let color = match weight {
                Weight::Constant(c) => *c,
                Weight::Textured {
                    texture,
                    share,
                    base,
                } => textured(texture, *share, *base, si.uv),
            };
            bsdf.push(color, *lobe);
        }
    }

    /// The probability in [0, 1] that a ray meets the surface at `si` at all.
    #[inline]
    pub fn opacity(&self, si: &SurfaceInteraction) -> f32 {
        match &self.opacity {
            None => 1.0,
            Some(t) => unit(t.eval(si.uv)).mean().min(1.0),
        }
    }

    /// What it can do to light.
    #[inline]
    pub const fn features(&self) -> Features {
        self.features
    }
}

#[inline(never)]
fn textured(texture: &Texture, share: f32, base: Option<Base>, uv: Vec2) -> Rgb {
    let color = unit(texture.eval(uv));
    base.map_or(color, |b| b.albedo(color)) * share
}

/// Clamped to [0, 1]; NaN is 0. An image's values are not checked before.
#[expect(clippy::manual_clamp, reason = "clamp would let NaN through")]
fn unit(c: Rgb) -> Rgb {
    c.map(|x| x.max(0.0).min(1.0))
}

fn features(lobes: &[(Weight, Lobe)], opacity: Option<&Texture>) -> Features {
    let mut features = Features::NONE;
    for (weight, lobe) in lobes {
        features = features.union(match lobe.letter() {
            Letter::D => Features::DIFFUSE,
            Letter::G => Features::GLOSSY,
            Letter::S | Letter::V => Features::SPECULAR,
        });
        if lobe.transmits() {
            features = features.union(Features::TRANSMISSIVE);
        }
        if matches!(weight, Weight::Textured { .. }) {
            features = features.union(Features::TEXTURED);
        }
    }
    if let Some(opacity) = opacity {
        features = features.union(Features::TRANSPARENT);
        if opacity.constant().is_none() {
            features = features.union(Features::TEXTURED);
        }
    }
    features
}

/// Prepares a colour whose values belong in [0, 1].
fn build_color(desc: &ColorDesc) -> Result<Texture, String> {
    let texture = Texture::build(desc)?;
    let known: &[Rgb] = match &texture {
        Texture::Constant(c) => std::slice::from_ref(c),
        Texture::Checker { colors, .. } => colors,
        Texture::Image { image, scale } => {
            let values = image
                .pixels
                .iter()
                .map(|p| (Rgb::from(*p) * *scale).max_component());
            let most = values.fold(0.0, f32::max);
            if most > 1.0 {
                let name = &image.name;
                return Err(format!(
                    "{name} times its scale reaches {most}; at most 1 is right"
                ));
            }
            &[]
        }
    };
    for value in known.iter().flat_map(|c| c.to_array()) {
        if !(0.0..=1.0).contains(&value) {
            return Err(format!("{value} does not lie between 0 and 1"));
        }
    }
    Ok(texture)
}

/// Flattens nested mixtures.
struct Builder<'a> {
    all: &'a [NamedMaterial],
    /// The mixtures around the material being added.
    parents: Vec<usize>,
    lobes: ArrayVec<(Weight, Lobe), MAX_LOBES>,
}

impl Builder<'_> {
    /// Adds the lobes of material `index`, scaled by `share`.
    fn add(&mut self, index: usize, share: f32) -> Result<(), String> {
        if self.parents.contains(&index) {
            return Err("it is a mixture that contains itself".into());
        }
        let named = self
            .all
            .get(index)
            .ok_or_else(|| format!("it mixes material number {index}, which does not exist"))?;
        if named.opacity.is_some() && !self.parents.is_empty() {
            let name = &named.name;
            return Err(format!(
                "it mixes \"{name}\", which has an opacity; give the opacity to the mixture"
            ));
        }
        match &named.material {
            MaterialDesc::Diffuse { reflectance } => {
                self.push(Lobe::Lambert, reflectance, share, None)
            }
            MaterialDesc::Mirror { reflectance } => {
                self.push(Lobe::Mirror, reflectance, share, None)
            }
            MaterialDesc::GgxConductor {
                specular_reflectance,
                alpha,
            } => {
                let lobe = match roughness(*alpha)? {
                    None => Lobe::Mirror,
                    Some(alpha) => Lobe::Ggx { alpha },
                };
                self.push(lobe, specular_reflectance, share, None)
            }
            MaterialDesc::Dielectric { ior, transmittance } => {
                self.add_smooth_dielectric(*ior, *transmittance, share)
            }
            MaterialDesc::RoughDielectric { ior, alpha } => {
                let ior = index_of_refraction(*ior)?;
                match roughness(*alpha)? {
                    Some(alpha) if (ior - 1.0).abs() >= MIN_ROUGH_CONTRAST => {
                        let lobe = Lobe::RoughDielectric { alpha, ior };
                        self.push(lobe, &ColorDesc::Constant(Rgb::WHITE), share, None)
                    }
                    _ => self.add_smooth_dielectric(ior, Rgb::WHITE, share),
                }
            }
            MaterialDesc::Plastic {
                diffuse_reflectance,
                ior,
                nonlinear,
            } => self.add_plastic(diffuse_reflectance, *ior, *nonlinear, share),
            MaterialDesc::Mix { materials, weight } => {
                if !(0.0..=1.0).contains(weight) {
                    return Err(format!("the weight {weight} does not lie between 0 and 1"));
                }
                self.parents.push(index);
                for (part, w) in [(materials[0], 1.0 - weight), (materials[1], *weight)] {
                    // A part without share adds no lobe.
                    if share * w > 0.0 {
                        self.add(part, share * w)?;
                    }
                }
                self.parents.pop();
                Ok(())
            }
            MaterialDesc::Sum { materials } => {
                self.parents.push(index);
                for part in materials {
                    self.add(*part, share)?;
                }
                self.parents.pop();
                Ok(())
            }
        }
    }

    fn add_smooth_dielectric(&mut self, ior: f32, tint: Rgb, share: f32) -> Result<(), String> {
        let ior = index_of_refraction(ior)?;
        let white = ColorDesc::Constant(Rgb::WHITE);
        self.push(Lobe::Reflection { ior }, &white, share, None)?;
        let tint = ColorDesc::Constant(tint);
        self.push(Lobe::Transmission { ior }, &tint, share, None)
    }

    fn add_plastic(
        &mut self,
        rho: &ColorDesc,
        ior: f32,
        nonlinear: bool,
        share: f32,
    ) -> Result<(), String> {
        let ior = index_of_refraction(ior)?;
        let mean = mean_transmittance(f64::from(ior));
        let base = Base {
            internal_transmittance: (mean / f64::from(ior).powi(2)) as f32,
            nonlinear,
        };
        // f = ρ T(θi) T(θo) / (π η² (1 − k)) with η² (1 − Fdr) = mean.
        let diffuse = Lobe::CoatedDiffuse {
            ior,
            scale: (1.0 / mean) as f32,
        };
        self.push(diffuse, rho, share, Some(base))?;
        let white = ColorDesc::Constant(Rgb::WHITE);
        self.push(Lobe::Coat { ior }, &white, share, None)
    }

    fn push(
        &mut self,
        lobe: Lobe,
        color: &ColorDesc,
        share: f32,
        base: Option<Base>,
    ) -> Result<(), String> {
        let weight = match build_color(color)? {
            Texture::Constant(c) => Weight::Constant(base.map_or(c, |b| b.albedo(c)) * share),
            texture => Weight::Textured {
                texture,
                share,
                base,
            },
        };
        self.lobes
            .try_push((weight, lobe))
            .map_err(|_| format!("it mixes more than {MAX_LOBES} lobes; mix fewer materials"))
    }
}

/// None: smooth.
fn roughness(alpha: f32) -> Result<Option<f32>, String> {
    if !(0.0..=1.0).contains(&alpha) {
        return Err(format!("alpha = {alpha} does not lie between 0 and 1"));
    }
    Ok((alpha > 0.0).then(|| alpha.max(bsdf::MIN_ALPHA)))
}

fn index_of_refraction(ior: f32) -> Result<f32, String> {
    if IOR_RANGE.contains(&ior) {
        Ok(ior)
    } else {
        let (low, high) = (IOR_RANGE.start(), IOR_RANGE.end());
        Err(format!("ior = {ior} does not lie between {low} and {high}"))
    }
}

#[cfg(test)]
mod tests;
