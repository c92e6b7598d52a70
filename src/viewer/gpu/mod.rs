//! The picture on the graphics card: buffers, pipeline, shader. Panels are drawn by egui.

mod canvas;
mod layers;
mod layout;
pub mod painter;
mod picture;
mod pipelines;
mod points;
#[cfg(test)]
mod tests;

pub use layout::{PixelRect, Placement, picture_point, place};
pub use picture::{PictureCallback, Resources};
pub use points::{Depths, Point, Points, PointsLayer};
