//! Where radiance is added up, and the pictures that are taken of it.
//!
//! A pass writes into a [`PassBuffer`] (f32, one sample per pixel and layer); only a pass that
//! was completed is added to the [`Film`] (f64 sums), so a cancelled one leaves no trace. Paths that
//! end on pixels of their own choice go through a [`SplatBuffer`].

pub mod accumulator;
pub mod frame;
pub mod halves;
pub mod pass_buffer;
pub mod sample;
pub mod splats;
pub mod tiles;
pub mod tonemap;

pub use accumulator::Film;
pub use frame::{Frame, FrameLayer, Memory};
pub use halves::ErrorEstimate;
pub use pass_buffer::PassBuffer;
pub use sample::SampleRadiance;
pub use splats::{SplatBuffer, SplatList};
pub use tonemap::ToneMap;
