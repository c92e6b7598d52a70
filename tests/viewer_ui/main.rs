//! Every control of the window, found by its accessible name, without a window.
#![cfg(feature = "viewer")]

mod controls;
mod desk;
mod expressions;
mod files;
mod hand;
mod measuring;
mod media;
mod photons;
mod stress;
