//! What `f32` and the choice of lights cannot hold, told before anybody waits for a picture.
//!
//! The points of failure are measured by `lightscope stability`: cases `translate` and
//! `light-dynamic-range`.

use glam::Vec3;

use super::desc::SceneDesc;
use crate::engine::light::Lights;

/// Distance from the origin over size of a shape, from which on its coordinates, of 24 bits, know
/// it to a tenth of a per cent only. At ten times this the error of a picture passes one per cent.
const FAR: f32 = 1e4;
/// Ratio of the powers of two lights from which on the fainter one is drawn less than once in as
/// many samples.
const RANGE: f32 = 1e6;

/// Sentences about what of a scene lies beyond these limits.
pub(super) fn warnings(desc: &SceneDesc, lights: &Lights) -> Vec<String> {
    far(desc).into_iter().chain(range(lights)).collect()
}

fn far(desc: &SceneDesc) -> Option<String> {
    let meshes = desc.meshes.iter().map(|mesh| {
        let world = |p: &Vec3| mesh.transform.map_or(*p, |t| t.transform_point3(*p));
        let points = mesh.positions.iter().map(world).filter(|p| p.is_finite());
        let (low, high) = points.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| {
            (low.min(p), high.max(p))
        });
        let place = low.abs().max(high.abs()).max_element();
        (mesh.name.as_str(), place, (high - low).max_element())
    });
    let spheres = desc.spheres.iter().map(|sphere| {
        let place = sphere.center.abs().max_element();
        (sphere.name.as_str(), place, 2.0 * sphere.radius)
    });
    let shapes = meshes
        .chain(spheres)
        .filter(|(_, _, size)| *size > 0.0 && size.is_finite());
    let ratios = shapes.map(|(name, place, size)| (name, place / size));
    let (name, worst) = ratios.max_by(|a, b| a.1.total_cmp(&b.1))?;
    (worst > FAR).then(|| {
        format!(
            "\"{name}\" is {worst:.0e} times its size away from the origin, and numbers of 24 bits \
             know it to {:.1} % of its size; move the scene to the origin",
            100.0 * worst * f32::EPSILON
        )
    })
}

fn range(lights: &Lights) -> Option<String> {
    let powers = lights.as_slice().iter().map(|light| light.power().mean());
    let (low, high) = powers.fold((f32::INFINITY, 0.0_f32), |(low, high), p| {
        (low.min(p), high.max(p))
    });
    (high / low > RANGE).then(|| {
        format!(
            "the strongest light has {:.0e} times the power of the faintest: lights are drawn in \
             proportion to their power, so that the faint ones are noisy; path with mode=kajiya \
             asks all of them",
            high / low
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::math::Rgb;
    use crate::engine::scene::Scene;
    use crate::engine::scene::desc::{
        ColorDesc, LightDesc, MaterialDesc, NamedMaterial, SphereDesc,
    };

    fn scene(place: f32, ratio: f32) -> Vec<String> {
        let light = |power: f32| LightDesc::Point {
            position: Vec3::ZERO,
            intensity: Rgb::splat(power),
        };
        let desc = SceneDesc {
            materials: vec![NamedMaterial {
                name: "grey".into(),
                material: MaterialDesc::Diffuse {
                    reflectance: ColorDesc::Constant(Rgb::splat(0.5)),
                },
                opacity: None,
            }],
            spheres: vec![SphereDesc {
                name: "ball".into(),
                center: Vec3::X * place,
                radius: 0.5,
                material: 0,
                emission: None,
                inward: false,
            }],
            lights: vec![light(1.0), light(ratio)],
            ..SceneDesc::default()
        };
        Scene::build(&desc).map_or_else(|error| vec![error], |scene| scene.warnings)
    }

    #[test]
    fn what_passes_a_limit_is_told() {
        assert!(scene(9e3, 9e5).is_empty());
        let far = scene(1e6, 1.0);
        assert!(
            far.len() == 1 && far[0].contains("\"ball\" is 1e6 times"),
            "{far:?}"
        );
        let range = scene(0.0, 1e9);
        assert!(
            range.len() == 1 && range[0].contains("1e9 times the power"),
            "{range:?}"
        );
    }
}
