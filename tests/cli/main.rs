//! The program itself: exit codes, sentences, files.

mod bad_scenes;
mod disk;
mod figures;
mod files;
mod measuring;
mod replaying;
mod running;
mod support;
mod usage;
