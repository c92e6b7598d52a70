#![doc = include_str!("ARCHITECTURE.md")]
#![deny(unsafe_code)]
#![warn(missing_docs)]

pub mod cli;
pub mod engine;
pub mod picture;
mod plot;
#[cfg(feature = "viewer")]
pub mod viewer;
