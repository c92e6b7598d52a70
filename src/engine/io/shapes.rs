//! The fields `meshes` and `spheres`.

use glam::Affine3A;

use super::error::InputError;
use super::fields::Fields;
use super::materials::{Colors, find};
use super::media::{self, Interior};
use super::source::{FileSource, beside};
use super::value::Node;
use super::{obj, transform};
use crate::engine::math::Rgb;
use crate::engine::scene::desc::media::SurfaceDesc;
use crate::engine::scene::desc::{MeshDesc, NamedMaterial, SceneDesc, SphereDesc};

/// Reads one entry of `meshes` into `scene`: one mesh, or as many as its file has materials.
pub fn read_mesh(
    file: &str,
    node: &Node,
    files: &dyn FileSource,
    colors: &mut Colors<'_>,
    scene: &mut SceneDesc,
) -> Result<(), InputError> {
    let mut f = Fields::new(file, node, "mesh")?;
    if let Some((name, _)) = f.text("name")? {
        f.what = format!("mesh \"{name}\"");
    }
    let (mesh_file, line) = f.required_text("file", "the name of an OBJ file")?;
    let material = f.text("material")?;
    let emission = f
        .take("emission")
        .map(|n| f.amounts(n, "emission"))
        .transpose()?;
    let transform = transform::read(&mut f)?;
    let interior = media::read_interior(&mut f, &scene.media.media)?;
    let what = f.what.clone();
    let material = material
        .map(|(name, line)| find_material(&f, line, name, interior.as_ref(), &mut scene.materials))
        .transpose()?;
    f.finish()?;
    let path = beside(file, mesh_file);
    let parsed = obj::read(files, &path, colors).map_err(|e| {
        // A missing file is the scene's mistake; a broken one is its own.
        if e.line.is_none() {
            InputError::at(file, line, format!("{what}: {}: {}", e.file, e.message))
        } else {
            e
        }
    })?;
    let first = scene.meshes.len();
    add_meshes(parsed, material, emission, transform, scene);
    if let Some(interior) = interior {
        let surface = SurfaceDesc::Meshes(first..scene.meshes.len());
        scene.media.interiors.push(interior.of(surface));
    }
    Ok(())
}

fn add_meshes(
    parsed: obj::ObjFile,
    material: Option<usize>,
    emission: Option<Rgb>,
    transform: Option<Affine3A>,
    scene: &mut SceneDesc,
) {
    let first = scene.materials.len();
    if material.is_none() {
        scene.materials.extend(parsed.materials);
        scene.warnings.extend(parsed.warnings);
    }
    for mesh in parsed.meshes {
        scene.meshes.push(MeshDesc {
            material: material.unwrap_or(first + mesh.material),
            emission: if material.is_some() {
                emission
            } else {
                emission.or(mesh.emission)
            },
            transform,
            ..mesh
        });
    }
}

fn find_material(
    f: &Fields<'_>,
    line: usize,
    name: &str,
    interior: Option<&Interior>,
    materials: &mut Vec<NamedMaterial>,
) -> Result<usize, InputError> {
    if name == media::NO_MATERIAL && !materials.iter().any(|m| m.name == name) {
        if interior.is_none() {
            let message = "material \"none\" is that of a medium's invisible boundary; give an \
                           interior, too";
            return Err(f.error_at(line, message));
        }
        materials.push(media::boundary_material());
        return Ok(materials.len() - 1);
    }
    let names: Vec<&str> = materials.iter().map(|m| m.name.as_str()).collect();
    find(f, line, name, &names)
}

/// Reads one entry of `spheres` into `scene`.
pub fn read_sphere(file: &str, node: &Node, scene: &mut SceneDesc) -> Result<(), InputError> {
    let mut f = Fields::new(file, node, "sphere")?;
    let name = f.text("name")?.map_or_else(String::new, |n| n.0.to_owned());
    if !name.is_empty() {
        f.what = format!("sphere \"{name}\"");
    }
    let mut center = f.vector("center")?;
    let mut radius = f.number("radius", "a length above 0", |x| x > 0.0)?;
    let (material, line) = f.required_text("material", "the name of a material")?;
    let interior = media::read_interior(&mut f, &scene.media.media)?;
    let materials = &mut scene.materials;
    let material = find_material(&f, line, material, interior.as_ref(), materials)?;
    let emission = f
        .take("emission")
        .map(|n| f.amounts(n, "emission"))
        .transpose()?;
    let inward = f.switch_or("inward", false)?;
    if let Some(transform) = transform::read(&mut f)? {
        let scale = transform::uniform_scale(&transform).ok_or_else(|| {
            f.error("a sphere stays a sphere: its transform scales all directions alike")
        })?;
        center = transform.transform_point3(center);
        radius *= scale;
    }
    f.finish()?;
    if let Some(interior) = interior {
        let surface = SurfaceDesc::Sphere(scene.spheres.len());
        scene.media.interiors.push(interior.of(surface));
    }
    scene.spheres.push(SphereDesc {
        name,
        center,
        radius,
        material,
        emission,
        inward,
    });
    Ok(())
}
