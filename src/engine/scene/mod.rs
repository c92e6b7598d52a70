//! Scenes: as authored (`desc`), as prepared for rendering (`Scene`), and the step between
//! (`build`).

pub mod build;
pub mod desc;

pub mod features;
pub mod material;
mod prepared;
pub mod texture;

pub use desc::SceneDesc;
pub use features::SceneFeatures;
pub use prepared::Scene;
