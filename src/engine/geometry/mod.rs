//! Rays, surfaces and where they meet.
//!
//! [`Geometry`] holds every triangle and sphere of a scene. Its answers do not depend on how the
//! hierarchy was built: the closest hit is the one of the smallest `t`, then of the lowest
//! primitive.

pub mod accel;
pub mod bounds;
mod closed;
pub mod interaction;
pub mod mesh;
pub mod offset;
pub mod ray;
pub mod sphere;
pub mod surfaces;
pub mod traverse;
pub mod triangle;

pub use bounds::Bounds3;
pub use closed::{Departure, RayFault};
pub use interaction::SurfaceInteraction;
pub use mesh::{DropReport, MAX_COORDINATE, MeshInput};
pub use offset::{inset, offset_origin};
pub use ray::{Hit, NO_TRIANGLE, Ray};
pub use sphere::{Sphere, SphereInput};
pub use surfaces::Geometry;
