//! The program itself: exit codes, sentences, files.

mod figures;
mod files;
mod running;
mod support;
mod usage;
