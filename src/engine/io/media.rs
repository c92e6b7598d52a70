//! The fields `medium`, `media`, `interior` and `priority`.

use std::sync::Arc;

use glam::Vec3;

use super::density;
use super::error::{InputError, did_you_mean};
use super::fields::Fields;
use super::source::{FileSource, beside};
use super::value::{Node, Value};
use crate::engine::math::Rgb;
use crate::engine::scene::desc::media::{
    GridDesc, InteriorDesc, MediumDesc, NamedMedium, PhaseDesc, SurfaceDesc,
};
use crate::engine::scene::desc::{ColorDesc, MaterialDesc, MeshDesc, NamedMaterial, SceneDesc};

type Read<T> = Result<T, InputError>;

/// The material of a surface that only bounds a medium.
pub const NO_MATERIAL: &str = "none";
/// The interior that holds nothing.
const NOTHING: &str = "vacuum";
const TYPES: [&str; 2] = ["homogeneous", "grid"];
const PHASES: [&str; 3] = ["isotropic", "hg", "rayleigh"];

/// What fills a closed surface.
#[derive(Clone, Copy, Debug)]
pub struct Interior {
    medium: Option<usize>,
    priority: i32,
}

impl Interior {
    /// The same, with the surface.
    pub fn of(self, surface: SurfaceDesc) -> InteriorDesc {
        InteriorDesc {
            surface,
            medium: self.medium,
            priority: self.priority,
        }
    }
}

/// Where a medium of the field `medium` is.
#[derive(Clone, Copy, Debug)]
enum Region {
    Everywhere,
    Box(Vec3, Vec3),
}

/// Light meets nothing there.
pub fn boundary_material() -> NamedMaterial {
    NamedMaterial {
        name: NO_MATERIAL.to_owned(),
        material: MaterialDesc::Diffuse {
            reflectance: ColorDesc::Constant(Rgb::BLACK),
        },
        opacity: Some(ColorDesc::Constant(Rgb::BLACK)),
    }
}

/// Reads the table `media`.
pub fn read_all(file: &str, node: &Node, files: &dyn FileSource) -> Read<Vec<NamedMedium>> {
    let mut media = Vec::new();
    for (key, node) in Fields::new(file, node, "media")?.rest() {
        if key.name == NOTHING {
            let message = "\"vacuum\" is the medium that is nothing; choose another name";
            return Err(InputError::at(file, key.line, message));
        }
        let mut f = Fields::new(file, node, format!("medium \"{}\"", key.name))?;
        let (medium, _) = read_medium(&mut f, files)?;
        f.finish()?;
        media.push(NamedMedium {
            name: key.name.clone(),
            medium,
        });
    }
    Ok(media)
}

/// Reads the field `medium`, a table or the name of one of the media, into `scene`.
pub fn read_around(
    file: &str,
    node: &Node,
    files: &dyn FileSource,
    scene: &mut SceneDesc,
) -> Read<()> {
    let media = &mut scene.media.media;
    if let Value::Text(name) = &node.value {
        let index = find(name, media).map_err(|e| InputError::at(file, node.line, e))?;
        let grid = media[index].medium.grid.as_ref();
        let region = grid.map_or(Region::Everywhere, |g| Region::Box(g.min, g.max));
        place(scene, index, region);
        return Ok(());
    }
    let mut f = Fields::new(file, node, "medium")?;
    let (medium, region) = read_medium(&mut f, files)?;
    let Some(region) = region else {
        return Err(f.error(REGION_MISSING));
    };
    f.finish()?;
    media.push(NamedMedium {
        name: "medium".to_owned(),
        medium,
    });
    let index = media.len() - 1;
    place(scene, index, region);
    Ok(())
}

const REGION_MISSING: &str =
    "the field \"region\" is missing; it is \"everywhere\" or a table with min and max";

/// Puts a medium into a region; a box gets an index-matched boundary.
fn place(scene: &mut SceneDesc, medium: usize, region: Region) {
    let Region::Box(min, max) = region else {
        scene.media.everywhere = Some(medium);
        return;
    };
    let known = scene.materials.iter().position(|m| m.name == NO_MATERIAL);
    let material = known.unwrap_or_else(|| {
        scene.materials.push(boundary_material());
        scene.materials.len() - 1
    });
    let first = scene.meshes.len();
    scene.meshes.push(box_mesh(min, max, material));
    scene.media.interiors.push(InteriorDesc {
        surface: SurfaceDesc::Meshes(first..first + 1),
        medium: Some(medium),
        priority: 0,
    });
}

/// A box with its normals outward.
fn box_mesh(min: Vec3, max: Vec3, material: usize) -> MeshDesc {
    let corner = |i: u32| {
        let pick = |bit: u32, low: f32, high: f32| if i >> bit & 1 == 0 { low } else { high };
        Vec3::new(
            pick(0, min.x, max.x),
            pick(1, min.y, max.y),
            pick(2, min.z, max.z),
        )
    };
    const FACES: [[u32; 4]; 6] = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    MeshDesc {
        name: "boundary of the medium".to_owned(),
        positions: (0..8).map(corner).collect(),
        triangles: FACES
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
            .collect(),
        material,
        ..MeshDesc::default()
    }
}

/// Reads what all media have; the region where one is given.
fn read_medium(f: &mut Fields<'_>, files: &dyn FileSource) -> Read<(MediumDesc, Option<Region>)> {
    f.text("name")?;
    let (kind, line) = f.required_text("type", "\"homogeneous\" or \"grid\"")?;
    let region = read_region(f)?;
    let (sigma_t, grid) = match kind {
        "homogeneous" => (amounts(f, "sigma_t", "extinction per length")?, None),
        "grid" => {
            let Some(Region::Box(min, max)) = region else {
                let message = "a grid fills a box: its region is a table with min and max";
                return Err(f.error(message));
            };
            let (name, line) = f.required_text("file", "the name of a density file")?;
            let data = density::read(files, &beside(f.file(), name)).map_err(|e| {
                // A missing file is the scene's mistake; a broken one is its own.
                match e.line {
                    None => f.error_at(line, &format!("{}: {}", e.file, e.message)),
                    Some(_) => e,
                }
            })?;
            let sigma_t = amounts(f, "sigma_t_scale", "extinction per length at density 1")?;
            let right = "a factor above 0";
            let majorant_scale = f.number_or("majorant_scale", 1.0, right, |x| x > 0.0)?;
            let grid = GridDesc {
                density: Arc::new(data),
                min,
                max,
                majorant_scale,
            };
            (sigma_t, Some(grid))
        }
        other => return Err(f.error_at(line, &unknown("type", other, &TYPES))),
    };
    let albedo = amounts(
        f,
        "albedo",
        "the share of the extinction that is scattering",
    )?;
    if let Some(x) = albedo.to_array().into_iter().find(|x| *x > 1.0) {
        let message = format!("albedo is at most 1, not {x}; more would make light out of nothing");
        return Err(f.error(&message));
    }
    let emission = match f.take("emission") {
        Some(node) => f.amounts(node, "emission")?,
        None => Rgb::BLACK,
    };
    let medium = MediumDesc {
        sigma_t,
        albedo,
        emission,
        phase: read_phase(f)?,
        grid,
    };
    Ok((medium, region))
}

fn amounts(f: &mut Fields<'_>, name: &'static str, right: &str) -> Read<Rgb> {
    let node = f.required(name, right)?;
    f.amounts(node, name)
}

fn read_region(f: &mut Fields<'_>) -> Read<Option<Region>> {
    let Some(node) = f.take("region") else {
        return Ok(None);
    };
    if let Value::Text(text) = &node.value {
        if text == "everywhere" {
            return Ok(Some(Region::Everywhere));
        }
        let message =
            format!("region is to be \"everywhere\" or a table with min and max, not \"{text}\"");
        return Err(f.error_at(node.line, &message));
    }
    let mut r = Fields::new(f.file(), node, format!("{}, region", f.what))?;
    r.text("type")?;
    let (min, max) = (r.vector("min")?, r.vector("max")?);
    if !min.cmplt(max).all() {
        return Err(r.error("max is to lie above min along every axis"));
    }
    r.finish()?;
    Ok(Some(Region::Box(min, max)))
}

fn read_phase(f: &mut Fields<'_>) -> Read<PhaseDesc> {
    let Some(node) = f.take("phase") else {
        return Ok(PhaseDesc::Isotropic);
    };
    let mut p = Fields::new(f.file(), node, format!("{}, phase", f.what))?;
    let (kind, line) = p.required_text("type", "\"isotropic\", \"hg\" or \"rayleigh\"")?;
    let phase = match kind {
        "isotropic" => PhaseDesc::Isotropic,
        "rayleigh" => PhaseDesc::Rayleigh,
        "hg" => PhaseDesc::HenyeyGreenstein {
            g: p.number("g", "a mean cosine between -1 and 1", |x| x.abs() < 1.0)?,
        },
        other => return Err(p.error_at(line, &unknown("type", other, &PHASES))),
    };
    p.finish()?;
    Ok(phase)
}

/// Takes the fields of a closed surface that say what fills it.
pub fn read_interior(f: &mut Fields<'_>, media: &[NamedMedium]) -> Read<Option<Interior>> {
    let interior = f.text("interior")?;
    let priority = f.take("priority");
    let Some((name, line)) = interior else {
        return match priority {
            Some(node) => {
                let message = "priority decides between interiors that overlap; give an interior, \
                               too";
                Err(f.error_at(node.line, message))
            }
            None => Ok(None),
        };
    };
    let whole = |x: f32| x.fract() == 0.0 && x.abs() <= 1e6;
    let right = "a whole number from -1000000 to 1000000";
    let priority = match priority {
        Some(node) => f.number_in(node, "priority", right, whole)? as i32,
        None => 0,
    };
    let medium = if name == NOTHING {
        None
    } else {
        Some(find(name, media).map_err(|e| f.error_at(line, &e))?)
    };
    Ok(Some(Interior { medium, priority }))
}

/// The medium of that name, or what is wrong.
fn find(name: &str, media: &[NamedMedium]) -> Result<usize, String> {
    let names: Vec<&str> = media.iter().map(|m| m.name.as_str()).collect();
    names.iter().position(|n| *n == name).ok_or_else(|| {
        let hint = did_you_mean(name, names.iter().copied());
        let known = match (hint.is_empty(), names.is_empty()) {
            (false, _) => hint,
            (true, true) => "; media are defined in the table media".to_owned(),
            (true, false) => format!("; there are {}", names.join(", ")),
        };
        format!("medium \"{name}\" is not defined{known}")
    })
}

fn unknown(what: &str, word: &str, known: &[&str]) -> String {
    let hint = did_you_mean(word, known.iter().copied());
    if hint.is_empty() {
        format!(
            "there is no {what} \"{word}\"; there are {}",
            known.join(", ")
        )
    } else {
        format!("there is no {what} \"{word}\"{hint}")
    }
}

/// Tells of media that nothing is filled with.
pub fn warn_of_unused(scene: &mut SceneDesc) {
    let media = &scene.media;
    let used = |i: usize| {
        media.everywhere == Some(i) || media.interiors.iter().any(|r| r.medium == Some(i))
    };
    let unused = media.media.iter().enumerate().filter(|(i, _)| !used(*i));
    let warnings: Vec<String> = unused
        .map(|(_, m)| {
            format!(
                "medium \"{}\" is nowhere: no interior and no field medium names it",
                m.name
            )
        })
        .collect();
    scene.warnings.extend(warnings);
}
