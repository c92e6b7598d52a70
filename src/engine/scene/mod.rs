//! Scenes: as authored (`desc`) and as prepared for rendering (`scene`).

pub mod desc;
