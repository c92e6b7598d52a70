//! Bad input by the million: no panic, no hang, no memory beyond a limit set by the input's size.
//!
//! Inputs are mutations of a corpus of the project's own files. Each is made from the name of its
//! target and its number alone, so that a failure repeats; the input is also written to a file.
//!
//! `LIGHTSCOPE_FUZZ=10` takes ten times as many, `LIGHTSCOPE_FUZZ_TRACE=1` writes every input down
//! before it is tried, for failures that end the process. Crashes that were found, and mended, are
//! tests of their own in `found`.

mod allocator;
mod corpus;
mod found;
mod harness;
mod mutate;
mod targets;
