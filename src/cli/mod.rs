//! The command line.

pub mod bench_rays;
