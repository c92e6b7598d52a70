//! The program itself: exit codes, sentences, files.

mod bad_scenes;
mod figures;
mod files;
mod measuring;
mod running;
mod support;
mod usage;
