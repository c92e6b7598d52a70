//! Rendering on a thread of its own.
//!
//! The window (or a test) hands over [`RenderJob`]s and sees immutable [`Frame`] snapshots.
//! The newest job wins: its epoch number is the cancellation of all older ones.

mod clock;
mod frames;
mod handle;
mod job;
mod priority;
mod renderer;
mod replay_command;
pub mod schedule;
mod worker;

pub use clock::RenderClock;
pub use handle::RenderSession;
pub use job::{RenderJob, Settings};
pub use renderer::Renderer;
pub use replay_command::replay_command;

pub use crate::engine::film::Frame;
