//! Tabulated distributions.
