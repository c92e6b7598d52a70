//! Scenes: as authored (`desc`), as prepared for rendering (`Scene`), and the step between
//! (`build`).

pub mod build;
pub mod desc;

pub mod features;
mod limits;
pub mod material;
pub mod passage;
mod prepared;
pub mod texture;

pub use desc::SceneDesc;
pub use features::SceneFeatures;
pub use passage::{Arrival, Flight, Span, VolumePoint};
pub use prepared::Scene;
