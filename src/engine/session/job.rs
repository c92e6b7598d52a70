//! What to render.

use std::sync::Arc;

use glam::UVec2;

use crate::engine::camera::Camera;
use crate::engine::integrators::{Entry, Params};
use crate::engine::plan::LayerSettings;
use crate::engine::scene::Scene;

/// Everything beside scene and view that decides the picture.
#[derive(Clone)]
pub struct Settings {
    /// The algorithm.
    pub integrator: &'static Entry,
    /// Its parameters.
    pub params: Params,
    /// Layers and depth.
    pub layers: LayerSettings,
    /// Seed of all random numbers.
    pub seed: u64,
}

/// Equal settings make equal pictures.
impl PartialEq for Settings {
    fn eq(&self, other: &Self) -> bool {
        self.same_integrator(other) && self.layers == other.layers
    }
}

impl Settings {
    /// The defaults of an integrator, with the four components.
    pub fn new(integrator: &'static Entry) -> Self {
        Self {
            integrator,
            params: Params::defaults(integrator.params),
            layers: LayerSettings {
                components: true,
                ..LayerSettings::default()
            },
            seed: 0,
        }
    }

    /// True if an integrator prepared for `other` serves here too.
    pub(super) fn same_integrator(&self, other: &Self) -> bool {
        // The registry is a constant: each use of it may have an address of its own.
        self.integrator.id == other.integrator.id
            && self.params == other.params
            && self.seed == other.seed
    }
}

/// A picture to be rendered.
#[derive(Clone)]
pub struct RenderJob {
    /// The scene.
    pub scene: Arc<Scene>,
    /// The view; its size is replaced by `size`.
    pub camera: Camera,
    /// Pixels.
    pub size: UVec2,
    /// The rest.
    pub settings: Settings,
    /// The user is moving: show something coarse at once, refine later.
    pub navigating: bool,
}
