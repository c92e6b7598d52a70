use super::*;
use glam::Vec3A;

fn named(material: MaterialDesc) -> NamedMaterial {
    NamedMaterial {
        name: "m".into(),
        material,
        opacity: None,
    }
}

fn diffuse(r: f32) -> NamedMaterial {
    named(MaterialDesc::Diffuse {
        reflectance: ColorDesc::Constant(Rgb::splat(r)),
    })
}

fn mix(a: usize, b: usize, weight: f32) -> NamedMaterial {
    named(MaterialDesc::Mix {
        materials: [a, b],
        weight,
    })
}

fn at(uv: Vec2) -> SurfaceInteraction {
    SurfaceInteraction {
        p: Vec3A::ZERO,
        p_error: Vec3A::ZERO,
        n_g: Vec3A::Z,
        n_s: Vec3A::Z,
        uv,
        wo: Vec3A::Z,
        t: 1.0,
        material: 0,
        light: None,
        prim: 0,
    }
}

#[test]
fn nested_mixtures_become_one_list() {
    let glass = named(MaterialDesc::Dielectric {
        ior: 1.5,
        transmittance: Rgb::WHITE,
    });
    let all = [
        diffuse(0.8),
        glass,
        mix(0, 1, 0.25),
        diffuse(0.4),
        mix(2, 3, 0.5),
    ];
    let material = Material::build(4, &all).unwrap();
    let weights: Vec<f32> = material
        .bsdf(&at(Vec2::ZERO))
        .lobes()
        .map(|(w, _)| w[0])
        .collect();
    assert_eq!(weights, [0.8 * 0.375, 0.125, 0.125, 0.4 * 0.5]);
    let f = material.features();
    let all = Features::DIFFUSE
        .union(Features::SPECULAR)
        .union(Features::TRANSMISSIVE);
    assert!(f == all && !f.contains(Features::TEXTURED));
}

#[test]
fn mixtures_without_end_or_too_long_are_refused() {
    let error = |i, all: &[NamedMaterial]| Material::build(i, all).unwrap_err();
    assert!(error(0, &[mix(0, 0, 0.5)]).contains("contains itself"));
    assert!(error(0, &[mix(1, 1, 0.5), mix(0, 0, 0.5)]).contains("contains itself"));
    assert!(error(0, &[mix(7, 7, 0.5)]).contains("does not exist"));
    assert!(error(3, &[]).contains("no material"));
    // Each mixture doubles the lobes; forty of them must not take 2⁴⁰ steps to refuse.
    let mut all = vec![diffuse(0.5)];
    all.extend((0..40).map(|i| mix(i, i, 0.5)));
    assert!(Material::build(3, &all).is_ok());
    assert!(error(4, &all).contains("more than 8 lobes"));
    assert!(error(40, &all).contains("more than 8 lobes"));
}

#[test]
fn values_out_of_range_are_named() {
    for r in [-0.1, 1.5, f32::NAN, f32::INFINITY] {
        let error = Material::build(0, &[diffuse(r)]).unwrap_err();
        assert!(error.contains("between 0 and 1") && error.starts_with("Material \"m\""));
    }
    for ior in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e30] {
        let glass = named(MaterialDesc::RoughDielectric { ior, alpha: 0.1 });
        assert!(Material::build(0, &[glass]).unwrap_err().contains("ior"));
    }
    for alpha in [-1.0, 2.0, f32::NAN] {
        let glass = named(MaterialDesc::RoughDielectric { ior: 1.5, alpha });
        assert!(Material::build(0, &[glass]).unwrap_err().contains("alpha"));
    }
    assert!(Material::build(1, &[diffuse(0.5), mix(0, 0, 2.0)]).is_err());
}

#[test]
fn textures_are_looked_up_where_the_ray_met_the_surface() {
    let checker = ColorDesc::Checker {
        colors: [Rgb::splat(0.25), Rgb::BLACK],
        scale: 1.0,
    };
    let mut material = named(MaterialDesc::Diffuse {
        reflectance: checker.clone(),
    });
    material.opacity = Some(checker);
    let material = Material::build(0, &[material]).unwrap();
    let bsdf = material.bsdf(&at(Vec2::splat(0.5)));
    assert_eq!(bsdf.lobes().next().map(|l| l.0), Some(Rgb::splat(0.25)));
    let dark = at(Vec2::new(1.5, 0.5));
    assert!(material.bsdf(&dark).is_empty());
    assert_eq!(material.opacity(&dark), 0.0);
    assert_eq!(material.opacity(&at(Vec2::splat(0.5))), 0.25);
    let features = material.features();
    assert!(features.contains(Features::TEXTURED.union(Features::TRANSPARENT)));
}

#[test]
fn a_plastic_of_large_index_keeps_its_albedo() {
    for ior in [1.0, 1.5, 1e3] {
        for nonlinear in [false, true] {
            let plastic = named(MaterialDesc::Plastic {
                diffuse_reflectance: ColorDesc::Constant(Rgb::WHITE),
                ior,
                nonlinear,
            });
            let material = Material::build(0, &[plastic]).unwrap();
            let bsdf = material.bsdf(&at(Vec2::ZERO));
            assert!((bsdf.lobes().next().unwrap().0[0] - 1.0).abs() < 1e-6);
        }
    }
}
