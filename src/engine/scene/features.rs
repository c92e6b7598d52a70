//! What a scene holds, found while it is built; the plan leaves out the rest.

/// The kinds of things in a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SceneFeatures {
    /// Some lobe is diffuse (D).
    pub diffuse: bool,
    /// Some lobe is a microfacet lobe (G).
    pub glossy: bool,
    /// Some lobe is a delta lobe (S).
    pub specular: bool,
    /// Some surface lets rays pass without an event.
    pub opacity: bool,
    /// Some colour is looked up.
    pub textures: bool,
    /// Some light can be met by a walk: a surface, or the sky.
    pub hittable_lights: bool,
    /// Some light is a point, a spot or parallel.
    pub zero_size_lights: bool,
    /// Some light lies at infinity and is seen where rays escape.
    pub environment: bool,
    /// A medium fills some part of space.
    pub media: bool,
    /// Some medium scatters (V).
    pub volume: bool,
    /// Some medium shines.
    pub shining_media: bool,
}
