//! x
use super::SceneDesc;
/// x
pub struct EmbeddedScene {
    /// x
    pub id: &'static str,
}
/// x
pub fn all() -> &'static [EmbeddedScene] {
    &[]
}
/// x
pub fn read(_id: &str) -> Result<SceneDesc, String> {
    Err(String::new())
}
