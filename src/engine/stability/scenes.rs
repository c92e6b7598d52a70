//! Small scenes built in code.

use std::sync::Arc;

use glam::{UVec2, Vec3};

use super::case::Run;
use crate::engine::camera::Camera;
use crate::engine::integrators::{self, Entry};
use crate::engine::math::Rgb;
use crate::engine::plan::LayerSettings;
use crate::engine::scene::Scene;
use crate::engine::scene::desc::media::{
    InteriorDesc, MediumDesc, NamedMedium, PhaseDesc, SurfaceDesc,
};
use crate::engine::scene::desc::{
    CameraDesc, ColorDesc, LightDesc, MaterialDesc, MeshDesc, NamedMaterial, SceneDesc, SphereDesc,
};
use crate::engine::session::{RenderJob, Settings};

/// A grey.
pub fn grey(value: f32) -> ColorDesc {
    ColorDesc::Constant(Rgb::splat(value))
}

/// A material under a name.
pub fn named(name: &str, material: MaterialDesc) -> NamedMaterial {
    NamedMaterial {
        name: name.into(),
        material,
        opacity: None,
    }
}

/// Grey Lambertian.
pub fn diffuse(name: &str, reflectance: f32) -> NamedMaterial {
    let reflectance = grey(reflectance);
    named(name, MaterialDesc::Diffuse { reflectance })
}

/// Grey mirror.
pub fn mirror(name: &str, reflectance: f32) -> NamedMaterial {
    let reflectance = grey(reflectance);
    named(name, MaterialDesc::Mirror { reflectance })
}

/// Smooth clear glass.
pub fn glass(name: &str, ior: f32) -> NamedMaterial {
    let transmittance = Rgb::WHITE;
    named(name, MaterialDesc::Dielectric { ior, transmittance })
}

/// White GGX reflector.
pub fn ggx(name: &str, alpha: f32) -> NamedMaterial {
    let specular_reflectance = grey(1.0);
    named(
        name,
        MaterialDesc::GgxConductor {
            specular_reflectance,
            alpha,
        },
    )
}

/// A parallelogram from `corner` along `a` and `b`; its front is the side of a × b.
pub fn quad(material: usize, corner: Vec3, a: Vec3, b: Vec3) -> MeshDesc {
    MeshDesc {
        name: "quad".into(),
        positions: vec![corner, corner + a, corner + a + b, corner + b],
        normals: Vec::new(),
        uvs: Vec::new(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        material,
        emission: None,
        transform: None,
    }
}

/// A parallelogram around `center`, of half edges `u` and `v`.
pub fn square(material: usize, center: Vec3, u: Vec3, v: Vec3) -> MeshDesc {
    quad(material, center - u - v, 2.0 * u, 2.0 * v)
}

/// A sphere.
pub fn sphere(material: usize, center: Vec3, radius: f32, inward: bool) -> SphereDesc {
    SphereDesc {
        name: "sphere".into(),
        center,
        radius,
        material,
        emission: None,
        inward,
    }
}

/// A grey point light.
pub fn point_light(position: Vec3, intensity: f32) -> LightDesc {
    LightDesc::Point {
        position,
        intensity: Rgb::splat(intensity),
    }
}

/// The same grey radiance from everywhere.
pub fn sky(radiance: f32) -> LightDesc {
    LightDesc::Constant {
        radiance: Rgb::splat(radiance),
    }
}

/// A square view of `pixels` × `pixels`.
pub fn view(position: Vec3, target: Vec3, vfov_deg: f32, pixels: u32) -> CameraDesc {
    let along = (target - position).normalize();
    CameraDesc {
        position,
        target,
        up: if along.y.abs() > 0.9 {
            Vec3::Z
        } else {
            Vec3::Y
        },
        vfov_deg,
        width: pixels,
        height: pixels,
        lens: None,
    }
}

/// A uniform medium of grey coefficients.
pub fn medium(sigma_t: f32, albedo: f32, phase: PhaseDesc) -> NamedMedium {
    NamedMedium {
        name: "medium".into(),
        medium: MediumDesc {
            sigma_t: Rgb::splat(sigma_t),
            albedo: Rgb::splat(albedo),
            emission: Rgb::BLACK,
            phase,
            grid: None,
        },
    }
}

/// Fills the closed surface made of the last `count` meshes with medium 0; they must be invisible.
pub fn fill_meshes(desc: &mut SceneDesc, count: usize) {
    let end = desc.meshes.len();
    fill(desc, SurfaceDesc::Meshes(end - count..end));
}

/// Fills a surface with medium 0.
pub fn fill(desc: &mut SceneDesc, surface: SurfaceDesc) {
    desc.media.interiors.push(InteriorDesc {
        surface,
        medium: Some(0),
        priority: 0,
    });
}

/// A material that rays go through.
pub fn nothing(name: &str) -> NamedMaterial {
    NamedMaterial {
        opacity: Some(grey(0.0)),
        ..diffuse(name, 0.0)
    }
}

/// The six faces of a box, fronts outward.
pub fn block(material: usize, min: Vec3, max: Vec3) -> MeshDesc {
    let corner = |i: u32| {
        let pick = |bit: u32, axis: usize| if i & bit == 0 { min[axis] } else { max[axis] };
        Vec3::new(pick(4, 0), pick(2, 1), pick(1, 2))
    };
    const FACES: [[u32; 4]; 6] = [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
    ];
    let halves = |q: &[u32; 4]| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]];
    MeshDesc {
        name: "block".into(),
        positions: (0..8).map(corner).collect(),
        triangles: FACES.iter().flat_map(halves).collect(),
        material,
        ..MeshDesc::default()
    }
}

/// The scene, prepared.
///
/// # Panics
/// If it is not valid: the cases are.
pub fn build(desc: &SceneDesc) -> Arc<Scene> {
    Arc::new(Scene::build(desc).unwrap_or_else(|error| panic!("a case's scene: {error}")))
}

/// A job of an integrator with parameters at the scene's own view.
///
/// # Panics
/// If a parameter does not exist, or the view is none.
pub fn job_of(entry: &'static Entry, set: &[(&str, &str)], desc: &SceneDesc) -> RenderJob {
    let mut settings = Settings {
        layers: LayerSettings::default(),
        ..Settings::new(entry)
    };
    for (name, value) in set {
        let set = settings.params.set(entry.params, name, value);
        set.unwrap_or_else(|error| panic!("a case's settings: {error}"));
    }
    let camera = Camera::new(&desc.camera).unwrap_or_else(|error| panic!("a case's view: {error}"));
    RenderJob {
        scene: build(desc),
        camera,
        size: UVec2::new(desc.camera.width, desc.camera.height),
        settings,
        navigating: false,
    }
}

impl Run {
    /// A job of the integrator that is asked.
    pub fn job(&self, desc: &SceneDesc) -> RenderJob {
        let entry = self.entry.unwrap_or(&integrators::path::ENTRY);
        job_of(entry, self.variant.set, desc)
    }
}

/// A closed room with something of everything: diffuse, glass, a mirror, a GGX metal and a lamp,
/// all scaled by `size`.
pub fn room(size: f32) -> SceneDesc {
    let at = |x: f32, y: f32, z: f32| size * Vec3::new(x, y, z);
    let mut lamp = sphere(4, at(0.5, 1.6, 0.4), 0.4 * size, false);
    lamp.emission = Some(Rgb::new(9.0, 8.0, 7.0));
    SceneDesc {
        camera: view(at(0.0, 0.25, 2.5), Vec3::ZERO, 60.0, 16),
        materials: vec![
            diffuse("wall", 0.7),
            glass("glass", 1.5),
            mirror("mirror", 0.9),
            ggx("metal", 0.3),
            diffuse("lamp", 0.0),
        ],
        spheres: vec![
            sphere(0, Vec3::ZERO, 4.0 * size, true),
            sphere(1, at(-1.0, 0.0, 0.25), 0.7 * size, false),
            sphere(2, at(0.25, -0.75, -1.0), 0.6 * size, false),
            sphere(3, at(1.1, -0.25, 0.5), 0.5 * size, false),
            lamp,
        ],
        ..SceneDesc::default()
    }
}

/// A closed, bumpy sphere of `n` rows, not convex.
pub fn bumpy_sphere(n: u32, scale: f32, center: Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    use std::f32::consts::PI;
    let mut positions = vec![Vec3::Y, Vec3::NEG_Y];
    for row in 1..n {
        for column in 0..2 * n {
            let (theta, phi) = (PI * row as f32 / n as f32, PI * column as f32 / n as f32);
            let bump = 1.0 + 0.2 * (5.0 * phi).sin() * (4.0 * theta).sin();
            let (sin, cos) = theta.sin_cos();
            positions.push(bump * Vec3::new(sin * phi.cos(), cos, sin * phi.sin()));
        }
    }
    let at = |row: u32, column: u32| 2 + (row - 1) * 2 * n + column % (2 * n);
    let mut triangles = Vec::new();
    for column in 0..2 * n {
        triangles.push([0, at(1, column + 1), at(1, column)]);
        triangles.push([1, at(n - 1, column), at(n - 1, column + 1)]);
        for row in 1..n - 1 {
            let (a, b) = (at(row, column), at(row, column + 1));
            let (c, d) = (at(row + 1, column), at(row + 1, column + 1));
            triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    for p in &mut positions {
        *p = center + scale * *p;
    }
    (positions, triangles)
}

/// A closed cube of half edge `scale` around `center`, each face `n` × `n` squares in one plane:
/// boxes around their parts have no thickness, and end where their neighbours begin.
pub fn tessellated_cube(n: u32, scale: f32, center: Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let step = |i: u32| 2.0 * i as f32 / n as f32 - 1.0;
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for (axis, side) in [0, 1, 2].into_iter().flat_map(|a| [(a, -1.0), (a, 1.0)]) {
        let first = positions.len() as u32;
        for (i, j) in (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))) {
            let mut p = Vec3::ZERO;
            p[axis] = side;
            p[(axis + 1) % 3] = step(i);
            p[(axis + 2) % 3] = step(j);
            positions.push(center + scale * p);
        }
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let at = |i: u32, j: u32| first + i * (n + 1) + j;
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1));
            triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    (positions, triangles)
}
