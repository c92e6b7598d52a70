//! Surfaces to scatter at, built from descriptions as scenes build them.

use glam::{Vec2, Vec3A};
use lightscope::engine::bsdf::Bsdf;
use lightscope::engine::geometry::interaction::SurfaceInteraction;
use lightscope::engine::math::Rgb;
use lightscope::engine::scene::desc::{ColorDesc, MaterialDesc, NamedMaterial};
use lightscope::engine::scene::material::Material;

/// A constant colour.
pub fn color(r: f32, g: f32, b: f32) -> ColorDesc {
    ColorDesc::Constant(Rgb::new(r, g, b))
}

pub fn diffuse(r: f32, g: f32, b: f32) -> MaterialDesc {
    MaterialDesc::Diffuse {
        reflectance: color(r, g, b),
    }
}

pub fn mirror() -> MaterialDesc {
    MaterialDesc::Mirror {
        reflectance: color(1.0, 1.0, 1.0),
    }
}

pub fn ggx(alpha: f32) -> MaterialDesc {
    MaterialDesc::GgxConductor {
        specular_reflectance: color(1.0, 0.8, 0.5),
        alpha,
    }
}

pub fn glass(ior: f32) -> MaterialDesc {
    MaterialDesc::Dielectric {
        ior,
        transmittance: Rgb::WHITE,
    }
}

pub fn rough_glass(ior: f32, alpha: f32) -> MaterialDesc {
    MaterialDesc::RoughDielectric { ior, alpha }
}

pub fn plastic(rho: f32, ior: f32, nonlinear: bool) -> MaterialDesc {
    MaterialDesc::Plastic {
        diffuse_reflectance: color(rho, rho, rho),
        ior,
        nonlinear,
    }
}

/// An even mixture of all of `parts`, nested.
pub fn mixed(parts: Vec<MaterialDesc>) -> Vec<NamedMaterial> {
    let mut all: Vec<_> = parts.into_iter().map(named).collect();
    let mut last = 0;
    for next in 1..all.len() {
        let weight = 1.0 / (next + 1) as f32;
        all.push(named(MaterialDesc::Mix {
            materials: [last, next],
            weight,
        }));
        last = all.len() - 1;
    }
    all
}

pub fn named(material: MaterialDesc) -> NamedMaterial {
    NamedMaterial {
        name: "test".into(),
        material,
        opacity: None,
    }
}

/// The scattering of the last of `materials` at a point with these normals.
pub fn bsdf_of(materials: &[NamedMaterial], n_g: Vec3A, n_s: Vec3A) -> Bsdf {
    let material = Material::build(materials.len() - 1, materials).expect("a valid material");
    material.bsdf(&interaction(n_g, n_s))
}

pub fn interaction(n_g: Vec3A, n_s: Vec3A) -> SurfaceInteraction {
    SurfaceInteraction {
        p: Vec3A::ZERO,
        p_error: Vec3A::ZERO,
        n_g,
        n_s,
        uv: Vec2::ZERO,
        wo: n_g,
        t: 1.0,
        material: 0,
        light: None,
        prim: 0,
    }
}

/// A direction by its cosine with +z and an azimuth in radians.
pub fn direction(cos: f32, phi: f32) -> Vec3A {
    let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
    Vec3A::new(sin * phi.cos(), sin * phi.sin(), cos).normalize()
}
