//! What the integration tests share.
#![allow(dead_code, reason = "each test binary uses a part of it")]

pub mod agreement;
pub mod reference;
pub mod render;
pub mod volumes;
