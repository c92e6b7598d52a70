//! Scenes: as authored (`desc`) and as prepared for rendering (`scene`).

pub mod desc;
pub mod material;
pub mod texture;
