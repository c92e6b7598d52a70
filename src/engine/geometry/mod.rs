//! Rays, surfaces and where they meet.

pub mod accel;
pub mod interaction;
pub mod mesh;
pub mod offset;
pub mod ray;
pub mod sphere;
pub mod triangle;

pub use interaction::SurfaceInteraction;
pub use ray::Ray;
