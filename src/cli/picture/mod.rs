//! Picture files of the command line: where they go, what they say, what is read back.

mod output;
mod read;
mod write;

pub use output::{Format, Output};
pub use read::{error_image_path, read, read_reference};
pub use write::{Attributes, write};

pub use crate::picture::{Layer, Picture, WHOLE};
