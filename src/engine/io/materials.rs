//! The field `materials`, and colours.

use std::collections::HashMap;
use std::sync::Arc;

use super::error::{InputError, did_you_mean};
use super::fields::Fields;
use super::image::{Encoding, read_from};
use super::source::{FileSource, beside};
use super::value::{Key, Node, Value};
use crate::engine::math::Rgb;
use crate::engine::scene::desc::{ColorDesc, ImageData, MaterialDesc, NamedMaterial};

/// Reads colours and keeps each image once.
pub struct Colors<'a> {
    files: &'a dyn FileSource,
    images: HashMap<(String, Encoding), Arc<ImageData>>,
}

impl<'a> Colors<'a> {
    /// Of files in `files`.
    pub fn new(files: &'a dyn FileSource) -> Self {
        Self {
            files,
            images: HashMap::new(),
        }
    }

    /// The image at `path`, which `file` names at `line`.
    pub fn image(
        &mut self,
        file: &str,
        line: usize,
        name: &str,
        encoding: Encoding,
    ) -> Result<Arc<ImageData>, InputError> {
        let path = beside(file, name);
        if let Some(known) = self.images.get(&(path.clone(), encoding)) {
            return Ok(Arc::clone(known));
        }
        let image = read_from(self.files, &path, encoding)
            .map_err(|e| InputError::at(file, line, format!("{}: {}", e.file, e.message)))?;
        let image = Arc::new(image);
        self.images.insert((path, encoding), Arc::clone(&image));
        Ok(image)
    }

    /// A share of light, each channel in [0, 1]: three numbers, one number, a texture or a
    /// checkerboard.
    pub fn color(
        &mut self,
        f: &Fields<'_>,
        node: &Node,
        name: &str,
    ) -> Result<ColorDesc, InputError> {
        if !matches!(node.value, Value::Table(_)) {
            return constant(f, node, name).map(ColorDesc::Constant);
        }
        let mut table = Fields::new(f.file(), node, format!("{}, {name}", f.what))?;
        let color = if let Some((file, line)) = table.text("texture")? {
            let encoding = match table.text("encoding")? {
                None | Some(("srgb", _)) => Encoding::Srgb,
                Some(("linear", _)) => Encoding::Linear,
                Some((other, line)) => {
                    let message = format!("encoding is \"srgb\" or \"linear\", not \"{other}\"");
                    return Err(table.error_at(line, &message));
                }
            };
            let scale = match table.take("scale") {
                Some(node) => table.amounts(node, "scale")?,
                None => Rgb::WHITE,
            };
            let image = self.image(f.file(), line, file, encoding)?;
            ColorDesc::Texture { image, scale }
        } else if let Some(node) = table.take("checker") {
            let Value::List(colors) = &node.value else {
                return Err(table.error_at(node.line, "checker is to be a list of two colours"));
            };
            let [a, b] = colors.as_slice() else {
                return Err(table.error_at(node.line, "checker is to be a list of two colours"));
            };
            let colors = [
                constant(&table, a, "checker")?,
                constant(&table, b, "checker")?,
            ];
            let scale = table.number_or("scale", 1.0, "a number above 0", |x| x > 0.0)?;
            ColorDesc::Checker { colors, scale }
        } else {
            return Err(table.error(
                "a colour is three numbers, { texture = \"file.png\" } or { checker = [c1, c2] }",
            ));
        };
        table.finish()?;
        Ok(color)
    }

    fn required(
        &mut self,
        f: &mut Fields<'_>,
        name: &'static str,
    ) -> Result<ColorDesc, InputError> {
        let node = f.required(name, "a colour, such as [0.5, 0.5, 0.5]")?;
        self.color(f, node, name)
    }
}

fn constant(f: &Fields<'_>, node: &Node, name: &str) -> Result<Rgb, InputError> {
    let color = f.amounts(node, name)?;
    if color.max_component() > 1.0 {
        let message = format!(
            "{name} is at most 1, not {}; more would make light out of nothing",
            color.max_component()
        );
        return Err(f.error_at(node.line, &message));
    }
    Ok(color)
}

const TYPES: [&str; 7] = [
    "diffuse",
    "mirror",
    "ggx_conductor",
    "dielectric",
    "rough_dielectric",
    "plastic",
    "mix",
];

/// Reads `materials`, a table of named materials.
pub fn read(
    file: &str,
    node: &Node,
    colors: &mut Colors<'_>,
) -> Result<Vec<NamedMaterial>, InputError> {
    let named = Fields::new(file, node, "materials")?.rest();
    let names: Vec<&str> = named.iter().map(|(k, _)| k.name.as_str()).collect();
    let mut materials = Vec::with_capacity(named.len());
    for (key, node) in &named {
        materials.push(read_one(file, key, node, &names, colors)?);
    }
    check_mixes(file, &named, &materials)?;
    Ok(materials)
}

fn read_one(
    file: &str,
    key: &Key,
    node: &Node,
    names: &[&str],
    colors: &mut Colors<'_>,
) -> Result<NamedMaterial, InputError> {
    let mut f = Fields::new(file, node, format!("material \"{}\"", key.name))?;
    let right = "the kind of material, such as \"diffuse\"";
    let (kind, line) = f.required_text("type", right)?;
    const ALPHA: &str = "a roughness from 0 to 1";
    const IOR: &str = "an index of refraction from 0.0001 to 10000";
    let share = |x: f32| (0.0..=1.0).contains(&x);
    let index = |x: f32| (1e-4..=1e4).contains(&x);
    let material = match kind {
        "diffuse" => MaterialDesc::Diffuse {
            reflectance: colors.required(&mut f, "reflectance")?,
        },
        "mirror" => MaterialDesc::Mirror {
            reflectance: colors.required(&mut f, "reflectance")?,
        },
        "ggx_conductor" => MaterialDesc::GgxConductor {
            specular_reflectance: colors.required(&mut f, "specular_reflectance")?,
            alpha: f.number("alpha", ALPHA, share)?,
        },
        "dielectric" => MaterialDesc::Dielectric {
            ior: f.number("ior", IOR, index)?,
            transmittance: match f.take("transmittance") {
                Some(node) => constant(&f, node, "transmittance")?,
                None => Rgb::WHITE,
            },
        },
        "rough_dielectric" => MaterialDesc::RoughDielectric {
            ior: f.number("ior", IOR, index)?,
            alpha: f.number("alpha", ALPHA, share)?,
        },
        "plastic" => MaterialDesc::Plastic {
            diffuse_reflectance: colors.required(&mut f, "diffuse_reflectance")?,
            ior: f.number("ior", IOR, index)?,
            nonlinear: f.switch_or("nonlinear", false)?,
        },
        "mix" => mix(&mut f, names)?,
        other => {
            let hint = did_you_mean(other, TYPES);
            let message = format!("there is no type \"{other}\"{hint}");
            let list = format!("{message}; there are {}", TYPES.join(", "));
            return Err(f.error_at(line, if hint.is_empty() { &list } else { &message }));
        }
    };
    let opacity = f
        .take("opacity")
        .map(|n| colors.color(&f, n, "opacity"))
        .transpose()?;
    f.finish()?;
    Ok(NamedMaterial {
        name: key.name.clone(),
        material,
        opacity,
    })
}

fn mix(f: &mut Fields<'_>, names: &[&str]) -> Result<MaterialDesc, InputError> {
    let right = "a list of two names of materials";
    let node = f.required("materials", right)?;
    let Value::List(items) = &node.value else {
        return Err(f.error_at(node.line, &format!("materials is to be {right}")));
    };
    let mut parts = Vec::new();
    for item in items {
        let Value::Text(name) = &item.value else {
            return Err(f.error_at(item.line, &format!("materials is to be {right}")));
        };
        parts.push(find(f, item.line, name, names)?);
    }
    let [a, b] = parts[..] else {
        return Err(f.error_at(
            node.line,
            &format!("materials is to be {right}, not of {}", parts.len()),
        ));
    };
    let weight = f.number("weight", "a share of the second from 0 to 1", |x| {
        (0.0..=1.0).contains(&x)
    })?;
    Ok(MaterialDesc::Mix {
        materials: [a, b],
        weight,
    })
}

/// The index of a material that `f` names at `line`.
pub fn find(f: &Fields<'_>, line: usize, name: &str, names: &[&str]) -> Result<usize, InputError> {
    names.iter().position(|n| *n == name).ok_or_else(|| {
        let hint = did_you_mean(name, names.iter().copied());
        let known = if !hint.is_empty() {
            hint
        } else if names.is_empty() {
            "; no material is defined".to_owned()
        } else {
            format!("; there are {}", names.join(", "))
        };
        f.error_at(line, &format!("material \"{name}\" is not defined{known}"))
    })
}

/// A mixture must not contain itself.
fn check_mixes(
    file: &str,
    named: &[(&Key, &Node)],
    materials: &[NamedMaterial],
) -> Result<(), InputError> {
    for (start, (key, node)) in named.iter().enumerate() {
        let (mut open, mut seen) = (vec![start], vec![false; materials.len()]);
        while let Some(index) = open.pop() {
            let MaterialDesc::Mix {
                materials: parts, ..
            } = materials[index].material
            else {
                continue;
            };
            if parts.contains(&start) {
                let message = format!("material \"{}\": it is a mixture of itself", key.name);
                return Err(InputError::at(file, node.line, message));
            }
            for part in parts {
                if !std::mem::replace(&mut seen[part], true) {
                    open.push(part);
                }
            }
        }
    }
    Ok(())
}
