//! Everything that emits.
