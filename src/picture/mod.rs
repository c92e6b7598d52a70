//! Picture files that command line and window share: layered OpenEXR, and PNG and
//! Radiance with texts.

pub mod colors;
pub mod exr_file;
pub mod hdr_file;
pub mod origin;
pub mod png_file;

use glam::UVec2;

use crate::engine::path::COMPONENTS;

/// The name of the layer that holds every path.
pub const WHOLE: &str = "whole";

/// The whole and the components.
pub fn labels() -> impl Iterator<Item = &'static str> {
    std::iter::once(WHOLE).chain(COMPONENTS.iter().map(|(label, _)| *label))
}

/// A picture that was read.
#[derive(Debug)]
pub struct Picture {
    /// Pixels.
    pub size: UVec2,
    /// Its layers.
    pub layers: Vec<Layer>,
    /// Standard errors of the layers of the same labels, of a reference folder only.
    pub standard_errors: Vec<Layer>,
    /// Text attributes, sorted by name.
    pub attributes: Vec<(String, String)>,
}

/// Three channels of a picture.
#[derive(Clone, Debug)]
pub struct Layer {
    /// `whole`, or what stands before the dot in `direct.R`.
    pub label: String,
    /// The path expression of a layer `expr1` ….
    pub expression: Option<String>,
    /// Row by row from the top left.
    pub pixels: Vec<[f32; 3]>,
}

impl Layer {
    /// What tells the layer in any file: numbers of expressions depend on the order in which they
    /// were typed.
    pub fn key(&self) -> &str {
        self.expression.as_deref().unwrap_or(&self.label)
    }
}

impl Picture {
    /// The layer of every path.
    pub fn whole(&self) -> Option<&Layer> {
        self.layers.iter().find(|layer| layer.label == WHOLE)
    }
}
