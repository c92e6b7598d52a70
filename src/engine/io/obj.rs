//! OBJ meshes, read by tobj, which only this file and `mtl_files` name.
//!
//! tobj keeps no line numbers: after an error our own scan finds the line. Polygons are split by
//! our own triangulation, which gets concave ones right.

use std::cell::RefCell;
use std::collections::HashSet;
use std::path::Path;

use glam::{Vec3, Vec3A};
use tobj::{LoadError, LoadOptions};

use super::error::{InputError, did_you_mean};
use super::materials::Colors;
use super::mtl;
use super::mtl_files::MtlFiles;
use super::source::{FileSource, reason};
use super::triangulate::triangulate;
use crate::engine::geometry::MAX_COORDINATE;
use crate::engine::math::Rgb;
use crate::engine::scene::desc::{CameraDesc, LightDesc, MeshDesc, NamedMaterial, SceneDesc};

/// Most names of unknown materials that are told: each is compared with all that are known.
const MOST_TOLD: usize = 100;

/// What an OBJ file holds.
#[derive(Clone, Debug, Default)]
pub struct ObjFile {
    /// One mesh a group and material.
    pub meshes: Vec<MeshDesc>,
    /// Its materials; mesh indices refer to them.
    pub materials: Vec<NamedMaterial>,
    /// What was assumed.
    pub warnings: Vec<String>,
}

/// Reads an OBJ file and the MTL files it names.
///
/// # Errors
/// A sentence with the line where it is known.
pub fn read(
    files: &dyn FileSource,
    path: &str,
    colors: &mut Colors<'_>,
) -> Result<ObjFile, InputError> {
    let bytes = files
        .read(path)
        .map_err(|e| InputError::in_file(path, reason(&e)))?;
    let options = LoadOptions {
        single_index: true,
        ignore_points: true,
        ignore_lines: true,
        ..LoadOptions::default()
    };
    refuse_wild_indices(path, &bytes)?;
    let mtl_files = RefCell::new(MtlFiles::default());
    let loaded = tobj::load_obj_buf(&mut &bytes[..], &options, |name| {
        mtl_files.borrow_mut().load(files, path, name)
    });
    let (models, materials) = loaded.map_err(|e| locate(path, &bytes, &e))?;
    let mut mtl_files = mtl_files.into_inner();
    if let Some(error) = mtl_files.error.take() {
        return Err(error);
    }
    let mut file = ObjFile {
        warnings: std::mem::take(&mut mtl_files.warnings),
        ..ObjFile::default()
    };
    let materials = materials.unwrap_or_default();
    let mapped = add_materials(&materials, &mtl_files, colors, &mut file);
    warn_of_unknown_names(path, &bytes, &materials, &mut file.warnings);
    for model in models {
        let known = model.mesh.material_id.and_then(|id| mapped.get(id));
        let mut mesh = convert(path, model.name, &model.mesh, &mut file.warnings);
        if mesh.triangles.is_empty() {
            continue;
        }
        mesh.material = match known {
            Some((index, _)) => *index,
            None => default_material(&mut file),
        };
        mesh.emission = known.and_then(|(_, emission)| *emission);
        file.meshes.push(mesh);
    }
    if file.meshes.is_empty() {
        let message = "it holds no faces; a mesh has lines `v x y z` and `f 1 2 3`";
        return Err(InputError::in_file(path, message));
    }
    Ok(file)
}

/// Maps the materials; returns the index and the emission of each.
fn add_materials(
    materials: &[tobj::Material],
    from: &MtlFiles,
    colors: &mut Colors<'_>,
    file: &mut ObjFile,
) -> Vec<(usize, Option<Rgb>)> {
    let mut mapped = Vec::new();
    for m in materials {
        let index = file.materials.len();
        let material = mtl::map(&from.placed(m), index, colors, &mut file.warnings);
        mapped.push((index, material.emission));
        file.materials.extend(material.materials);
    }
    mapped
}

/// The grey of faces without a material; added when first needed.
fn default_material(file: &mut ObjFile) -> usize {
    let grey = mtl::default_material();
    if let Some(known) = file.materials.iter().position(|m| m.name == grey.name) {
        return known;
    }
    file.materials.push(grey);
    file.materials.len() - 1
}

/// Faces of a material that no MTL file defines are grey; where no file could be read, that has
/// been said.
fn warn_of_unknown_names(
    path: &str,
    bytes: &[u8],
    materials: &[tobj::Material],
    warnings: &mut Vec<String>,
) {
    if materials.is_empty() {
        return;
    }
    let mut told = HashSet::new();
    for (number, line) in String::from_utf8_lossy(bytes).lines().enumerate() {
        let Some(name) = line.trim().strip_prefix("usemtl ").map(str::trim) else {
            continue;
        };
        let known = materials.iter().any(|m| m.name == name);
        if !known && told.len() < MOST_TOLD && told.insert(name.to_owned()) {
            let names = materials.iter().map(|m| m.name.as_str());
            let hint = did_you_mean(name, names);
            let line = number + 1;
            warnings.push(format!(
                "{path}:{line}: no material is called \"{name}\", so its faces are grey{hint}"
            ));
        }
    }
}

fn convert(path: &str, name: String, mesh: &tobj::Mesh, warnings: &mut Vec<String>) -> MeshDesc {
    let triples = |v: &[f32]| v.chunks_exact(3).map(Vec3::from_slice).collect::<Vec<_>>();
    let positions = triples(&mesh.positions);
    let mut all_or_none = |count: usize, what: &str| {
        if count != 0 && count != positions.len() {
            warnings.push(format!(
                "{path}: mesh \"{name}\": some faces have no {what}, so those of the others are not used"
            ));
        }
        count == positions.len()
    };
    let mut normals = triples(&mesh.normals);
    if !all_or_none(normals.len(), "normals") {
        normals.clear();
    }
    let mut uvs: Vec<[f32; 2]> = mesh
        .texcoords
        .chunks_exact(2)
        .map(|t| [t[0], t[1]])
        .collect();
    if !all_or_none(uvs.len(), "texture coordinates") {
        uvs.clear();
    }
    let mut triangles = Vec::with_capacity(mesh.indices.len() / 3);
    if mesh.face_arities.is_empty() {
        triangles.extend(mesh.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]));
    } else {
        let mut rest = &mesh.indices[..];
        for arity in &mesh.face_arities {
            let (face, after) = rest.split_at((*arity as usize).min(rest.len()));
            rest = after;
            let corners: Vec<Vec3> = face.iter().map(|i| positions[*i as usize]).collect();
            triangles.extend(triangulate(&corners).iter().map(|t| t.map(|i| face[i])));
        }
    }
    MeshDesc {
        name,
        normals,
        uvs,
        positions,
        triangles,
        ..MeshDesc::default()
    }
}

fn words(error: &LoadError) -> &'static str {
    match error {
        LoadError::PositionParseError => "a vertex is `v x y z` with three numbers",
        LoadError::NormalParseError => "a normal is `vn x y z` with three numbers",
        LoadError::TexcoordParseError => "a texture coordinate is `vt u v` with two numbers",
        LoadError::FaceParseError => "a face is `f a b c` with whole numbers",
        LoadError::FaceVertexOutOfBounds => "a face names a vertex that is not there",
        LoadError::FaceTexCoordOutOfBounds => "a face names a texture coordinate that is not there",
        LoadError::FaceNormalOutOfBounds => "a face names a normal that is not there",
        LoadError::InvalidPolygon => "a face has at least three vertices",
        LoadError::ReadError => "it is no text",
        LoadError::InvalidObjectName => "an object has no name",
        _ => "it cannot be understood as OBJ",
    }
}

/// Finds the line of an error by reading the file again, statement by statement.
fn locate(path: &str, bytes: &[u8], error: &LoadError) -> InputError {
    let text = String::from_utf8_lossy(bytes);
    let (mut counts, mut found) = ([0i64; 3], None);
    for (number, line) in text.lines().enumerate() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let numbers =
            |n: usize| words.len() > n && words[1..=n].iter().all(|w| w.parse::<f32>().is_ok());
        let bad = match words.first() {
            Some(&"v") => {
                counts[0] += 1;
                !numbers(3)
            }
            Some(&"vt") => {
                counts[1] += 1;
                !numbers(2) && !numbers(1)
            }
            Some(&"vn") => {
                counts[2] += 1;
                !numbers(3)
            }
            Some(&"f") => words.len() < 4 || words[1..].iter().any(|w| !is_corner(w, counts)),
            Some(&"o" | &"g") if matches!(error, LoadError::InvalidObjectName) => words.len() < 2,
            _ => false,
        };
        if bad {
            found = Some(number + 1);
            break;
        }
    }
    // An error that only the whole file shows (an index beyond the end) has no line of its own.
    InputError {
        file: path.to_owned(),
        line: found,
        message: words(error).to_owned(),
    }
}

/// Refuses indices that tobj computes with as if they fitted: relative ones that point before the
/// first vertex, and numbers of more digits than any file has vertices.
fn refuse_wild_indices(path: &str, bytes: &[u8]) -> Result<(), InputError> {
    let mut counts = [0_i64; 3];
    for (number, line) in bytes.split(|b| *b == b'\n').enumerate() {
        let line = line.trim_ascii_start();
        let is = |word: &[u8]| {
            let rest = line.strip_prefix(word);
            rest.is_some_and(|rest| rest.first().is_some_and(u8::is_ascii_whitespace))
        };
        for (count, word) in counts.iter_mut().zip([b"v".as_slice(), b"vt", b"vn"]) {
            *count += i64::from(is(word));
        }
        let long = |line: &[u8]| line.split(|b| !b.is_ascii_digit()).any(|n| n.len() > 12);
        if !is(b"f") || !(line.contains(&b'-') || long(line)) {
            continue;
        }
        let text = String::from_utf8_lossy(line);
        let wild = |word: &str| {
            let parts = word.split('/').zip(counts);
            let mut indices = parts.filter_map(|(part, count)| Some((part.parse().ok()?, count)));
            long(word.as_bytes()) || indices.any(|(i, count): (i64, i64)| i < -count)
        };
        if text.split_whitespace().skip(1).any(wild) {
            let message = words(&LoadError::FaceVertexOutOfBounds);
            return Err(InputError::at(path, number + 1, message));
        }
    }
    Ok(())
}

/// Whether `v`, `v/vt`, `v//vn` or `v/vt/vn` refers to what stands before it.
fn is_corner(word: &str, counts: [i64; 3]) -> bool {
    let parts: Vec<&str> = word.split('/').collect();
    parts.len() <= 3
        && parts
            .iter()
            .zip(counts)
            .enumerate()
            .all(|(i, (part, count))| match part.parse::<i64>() {
                Ok(index) => index != 0 && index <= count && -index <= count,
                Err(_) => i > 0 && part.is_empty(),
            })
}

/// Opens an OBJ file as a scene: the camera sees all of it, and a soft sky shines if nothing else
/// does.
///
/// # Errors
/// As [`read`].
pub fn open_alone(files: &dyn FileSource, path: &str) -> Result<SceneDesc, InputError> {
    let file = read(files, path, &mut Colors::new(files))?;
    let name = Path::new(path)
        .file_stem()
        .map_or(String::new(), |s| s.to_string_lossy().into_owned());
    let mut scene = SceneDesc {
        name,
        description: "A mesh opened by itself.".to_owned(),
        camera: frame_all(&file.meshes),
        materials: file.materials,
        meshes: file.meshes,
        warnings: file.warnings,
        ..SceneDesc::default()
    };
    if scene.meshes.iter().all(|m| m.emission.is_none()) {
        scene.lights.push(LightDesc::Constant {
            radiance: Rgb::splat(1.0),
        });
        let message = "nothing in this file emits light, so a soft sky of radiance 1 was added";
        scene.warnings.push(message.to_owned());
    }
    Ok(scene)
}

/// A three-quarter view in which the bounding sphere fits.
fn frame_all(meshes: &[MeshDesc]) -> CameraDesc {
    let used = meshes.iter().flat_map(|m| {
        m.triangles
            .iter()
            .flatten()
            .map(|i| m.positions[*i as usize])
    });
    // What the geometry drops is not framed either.
    let kept = used.filter(|p| p.abs().max_element() <= MAX_COORDINATE);
    let (lo, hi) = kept.fold((Vec3A::INFINITY, Vec3A::NEG_INFINITY), |(lo, hi), p| {
        (lo.min(p.into()), hi.max(p.into()))
    });
    if !(lo.is_finite() && hi.is_finite()) {
        return CameraDesc::default();
    }
    let centre = (lo + hi) * 0.5;
    let radius = ((hi - lo).length() * 0.5).max(f32::MIN_POSITIVE);
    let camera = CameraDesc::default();
    // The sphere touches the cone of the view: sin(half angle) = radius / distance.
    let distance = radius / (0.5 * camera.vfov_deg).to_radians().sin();
    let direction = Vec3A::new(0.6, 0.45, 1.0).normalize();
    CameraDesc {
        position: (centre + direction * distance).into(),
        target: centre.into(),
        ..camera
    }
}
