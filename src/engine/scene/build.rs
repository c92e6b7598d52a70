//! From the authored scene to the one that is rendered.

use std::collections::HashSet;

use glam::{Affine3A, Vec3, Vec3A};

use super::desc::{MeshDesc, SceneDesc, SphereDesc};
use super::features::SceneFeatures;
use super::material::{Features, Material};
use super::prepared::Scene;
use crate::engine::geometry::{DropReport, Geometry, MeshInput, SphereInput};
use crate::engine::light::{Emitter, Lights, Silhouette};
use crate::engine::media::Media;

impl Scene {
    /// Prepares a scene: builds materials, the acceleration structure and the lights.
    ///
    /// # Errors
    /// A sentence that says which part cannot be used and what would be right.
    pub fn build(desc: &SceneDesc) -> Result<Self, String> {
        let count = desc.materials.len();
        let materials: Vec<Material> = (0..count)
            .map(|i| Material::build(i, &desc.materials))
            .collect::<Result<_, _>>()?;

        let world: Vec<WorldMesh> = desc.meshes.iter().map(WorldMesh::new).collect();
        // Of two triangles in one place the first is met: it is to be the one that shines.
        let mut order: Vec<usize> = (0..desc.meshes.len()).collect();
        order.sort_by_key(|i| desc.meshes[*i].emission.is_none());
        let meshes: Vec<MeshInput<'_>> = order
            .iter()
            .map(|i| world[*i].input(&desc.meshes[*i]))
            .collect();
        let spheres: Vec<SphereInput> = desc.spheres.iter().map(sphere_input).collect();
        let (mut geometry, dropped) = Geometry::build(&meshes, &spheres);

        let (emitters, covered) = emitters(desc, &order, &geometry);
        // A medium everywhere ends at the sphere around the scene.
        let silhouette = match desc.media.everywhere {
            Some(_) => Silhouette::of_sphere(&geometry),
            None => Silhouette::of_box(&geometry),
        };
        let lights = Lights::build(&desc.lights, &emitters, &geometry, silhouette)?;
        geometry.set_lights(|prim| lights.of_primitive(prim));
        let inward = |sphere: usize| desc.spheres[sphere].inward;
        let at_infinity = lights.as_slice().iter().any(|l| l.is_infinite());
        let media = Media::build(&desc.media, &geometry, inward, at_infinity)?;

        let mut warnings = desc.warnings.clone();
        warnings.extend(describe_dropped(&dropped));
        if covered > 0 {
            warnings.push(format!(
                "{covered} of the shapes that emit lie exactly on others and are left out"
            ));
        }
        warnings.extend(super::limits::warnings(desc, &lights));
        let features = features(desc, &materials, &lights, &media);
        if !features.textures {
            geometry.without_textures();
        }
        if !features.hittable_lights && !features.zero_size_lights && !features.shining_media {
            warnings.push("nothing in this scene emits light, so the picture is black".to_owned());
        }
        Ok(Self {
            name: desc.name.clone(),
            description: desc.description.clone(),
            frames: desc.frames,
            camera: desc.camera,
            geometry,
            materials,
            material_names: desc.materials.iter().map(|m| m.name.clone()).collect(),
            lights,
            media,
            features,
            warnings,
        })
    }
}

/// The vertices of a mesh in world space, where they differ from the authored ones.
struct WorldMesh {
    positions: Option<Vec<Vec3>>,
    normals: Option<Vec<Vec3>>,
    triangles: Option<Vec<[u32; 3]>>,
}

impl WorldMesh {
    fn new(desc: &MeshDesc) -> Self {
        let Some(transform) = desc.transform else {
            return Self {
                positions: None,
                normals: None,
                triangles: None,
            };
        };
        let positions = desc
            .positions
            .iter()
            .map(|p| transform.transform_point3(*p))
            .collect();
        let normals = desc
            .normals
            .iter()
            .map(|n| transform_normal(&transform, *n))
            .collect();
        // A reflection turns the order of the vertices; the front stays the front.
        let mirrored = transform.matrix3.determinant() < 0.0;
        let turned = || desc.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
        Self {
            positions: Some(positions),
            normals: Some(normals),
            triangles: mirrored.then(turned),
        }
    }

    fn input<'a>(&'a self, desc: &'a MeshDesc) -> MeshInput<'a> {
        MeshInput {
            positions: self.positions.as_deref().unwrap_or(&desc.positions),
            normals: self.normals.as_deref().unwrap_or(&desc.normals),
            uvs: &desc.uvs,
            triangles: self.triangles.as_deref().unwrap_or(&desc.triangles),
            material: desc.material as u32,
        }
    }
}

/// Normals go with the cofactor matrix, the inverse transpose up to a factor: it exists for
/// singular transforms too.
fn transform_normal(transform: &Affine3A, n: Vec3) -> Vec3 {
    let m = transform.matrix3;
    let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
    let n = Vec3A::from(n);
    let cofactor = y.cross(z) * n.x + z.cross(x) * n.y + x.cross(y) * n.z;
    Vec3::from(cofactor * m.determinant().signum())
}

fn sphere_input(desc: &SphereDesc) -> SphereInput {
    SphereInput {
        center: desc.center,
        radius: desc.radius,
        inward: desc.inward,
        material: desc.material as u32,
    }
}

/// Every primitive that emits, with what it emits, and how many are left out because no ray would
/// meet them: shadow rays would find light that walks cannot. `order` is that of the meshes.
fn emitters(desc: &SceneDesc, order: &[usize], geometry: &Geometry) -> (Vec<Emitter>, usize) {
    let (mut emitters, mut covered) = (Vec::new(), 0);
    for (index, mesh) in order.iter().map(|i| &desc.meshes[*i]).enumerate() {
        let Some(radiance) = mesh.emission else {
            continue;
        };
        let (hidden, met): (Vec<u32>, Vec<u32>) = geometry
            .mesh_triangles(index)
            .partition(|prim| geometry.is_hidden(*prim));
        covered += hidden.len();
        emitters.extend(met.into_iter().map(|prim| Emitter { prim, radiance }));
    }
    let mut places = HashSet::new();
    for (index, sphere) in desc.spheres.iter().enumerate() {
        let place = sphere.center.extend(sphere.radius).to_array();
        let first = places.insert(place.map(|x| (x + 0.0).to_bits()));
        let (Some(radiance), Some(prim)) = (sphere.emission, geometry.sphere_prim(index)) else {
            continue;
        };
        if first {
            emitters.push(Emitter { prim, radiance });
        } else {
            covered += 1;
        }
    }
    (emitters, covered)
}

fn describe_dropped(dropped: &DropReport) -> Option<String> {
    let shape = |n: usize, one: &str| match n {
        1 => format!("1 {one}"),
        n => format!("{n} {one}s"),
    };
    let reasons = [
        (
            dropped.bad_index,
            "triangle",
            "with a vertex that is not there",
        ),
        (
            dropped.non_finite,
            "triangle",
            "with coordinates that are no numbers",
        ),
        (
            dropped.out_of_range,
            "triangle",
            "with coordinates beyond 1e18",
        ),
        (dropped.zero_area, "triangle", "without area"),
        (
            dropped.invalid_sphere,
            "sphere",
            "whose centre or radius cannot be used",
        ),
    ];
    let list: Vec<String> = reasons
        .iter()
        .filter(|r| r.0 > 0)
        .map(|(n, one, why)| format!("{} {why}", shape(*n, one)))
        .collect();
    (!list.is_empty()).then(|| format!("dropped: {}", list.join(", ")))
}

/// What the materials on surfaces and the lights can do; a material that nothing wears counts not.
fn features(
    desc: &SceneDesc,
    materials: &[Material],
    lights: &Lights,
    media: &Media,
) -> SceneFeatures {
    let on_meshes = desc.meshes.iter().map(|m| m.material);
    let worn = on_meshes.chain(desc.spheres.iter().map(|s| s.material));
    let all = worn.fold(Features::NONE, |all, m| all.union(materials[m].features()));
    SceneFeatures {
        diffuse: all.contains(Features::DIFFUSE),
        glossy: all.contains(Features::GLOSSY),
        specular: all.contains(Features::SPECULAR),
        opacity: all.contains(Features::TRANSPARENT),
        textures: all.contains(Features::TEXTURED),
        hittable_lights: lights.as_slice().iter().any(|l| !l.is_delta()),
        zero_size_lights: lights.as_slice().iter().any(|l| l.is_delta()),
        environment: !lights.environments().is_empty(),
        media: !media.is_empty(),
        volume: media.placed().any(|m| m.scatters()),
        shining_media: media.placed().any(|m| !m.emission.is_black()),
    }
}
