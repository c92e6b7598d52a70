//! Files: scenes, meshes and images in, pictures out. Uses `scene::desc` only.
//!
//! Invariant: an error is one sentence with the file, the line where it is known, what is wrong
//! and what would be right; no input makes it panic.

pub mod atomic;
mod camera;
pub mod embedded;
pub mod error;
mod fields;
mod generated;
pub mod image;
mod json;
mod lights;
mod materials;
mod mtl;
mod mtl_files;
pub mod obj;
pub mod scene_file;
mod shapes;
pub mod source;
mod toml;
mod transform;
mod triangulate;
mod value;

pub use error::InputError;
pub use source::{Disk, FileSource};
