//! What a scene and its settings need computed, and why the rest is left out.
//!
//! Invariant: only what is provably zero, or was not asked for, is left out. What is left out
//! shifts no random number, so that the picture is the same bit for bit.

use std::sync::Arc;

use crate::engine::event::Letter;
use crate::engine::path::{ClassId, Expression, ExpressionError, PathClasses};
use crate::engine::scene::{Scene, SceneFeatures};

/// Settings of a render that are no integrator's own.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LayerSettings {
    /// Typed expressions, a layer each after the four components.
    pub expressions: Vec<Expression>,
    /// Whether the four components are wanted.
    pub components: bool,
    /// Leave out the whole: walks may stop when they can reach no wanted layer.
    pub no_whole: bool,
    /// Most events of a path; unlimited if absent.
    pub max_depth: Option<u32>,
}

/// Something that is not computed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// What.
    pub what: String,
    /// Why the picture is the same without it.
    pub why: String,
}

/// The work that is left.
#[derive(Clone, Debug)]
pub struct RenderPlan {
    /// What the scene holds.
    pub features: SceneFeatures,
    /// Classes of paths over all layers: the components, then the expressions.
    pub classes: Arc<PathClasses>,
    /// Labels of all layers that frames hold.
    pub labels: Vec<String>,
    /// Bit mask of the layers that have sums of their own; the others are zero.
    pub planned: u32,
    /// Bit mask of the layers asked for.
    pub asked: u32,
    /// Whether the whole is asked for.
    pub whole: bool,
    /// Shadow rays can find light.
    pub shadow_rays: bool,
    /// The camera has a lens.
    pub lens: bool,
    /// Most events of a path.
    pub max_depth: Option<u32>,
    /// What is left out.
    pub left_out: Vec<LeftOut>,
}

impl RenderPlan {
    /// Plans a render of `scene`.
    ///
    /// # Errors
    /// If the expressions together need too large a table.
    pub fn new(
        scene: &Scene,
        lens: bool,
        settings: &LayerSettings,
    ) -> Result<Self, ExpressionError> {
        let features = scene.features;
        let classes = PathClasses::with_components(&settings.expressions)?;
        let labels = classes.labels().to_vec();
        let asked = asked_mask(settings);
        let letters = letters_of(&features);
        let possible = classes.possible(&letters, settings.max_depth);
        let lamps = !scene.lights.is_empty();
        let lit = lamps || features.shining_media;
        let planned = if lit { asked & possible } else { 0 };
        let mut plan = Self {
            features,
            labels,
            planned,
            asked,
            whole: !settings.no_whole,
            shadow_rays: lamps && settings.max_depth != Some(0),
            lens,
            max_depth: settings.max_depth,
            left_out: Vec::new(),
            classes: Arc::new(classes),
        };
        plan.left_out = plan.reasons(lit, possible);
        Ok(plan)
    }

    /// The plan of a render that failed before it began.
    pub fn nothing() -> Self {
        let classes = PathClasses::components();
        Self {
            features: SceneFeatures::default(),
            labels: classes.labels().to_vec(),
            planned: 0,
            asked: 0,
            whole: false,
            shadow_rays: false,
            lens: false,
            max_depth: None,
            left_out: Vec::new(),
            classes: Arc::new(classes),
        }
    }

    /// A plan that leaves nothing out: the same picture, for the test that proves it.
    #[must_use]
    pub fn with_everything_on(mut self) -> Self {
        self.planned = self.asked;
        self.left_out.clear();
        self
    }

    /// True if radiance of that class reaches a layer that is asked for.
    #[inline]
    pub fn is_wanted(&self, class: ClassId) -> bool {
        self.whole || self.classes.layers(class) & self.planned != 0
    }

    /// True if no path that ends in the events of `suffix` reaches a layer that is asked for.
    #[inline]
    pub fn is_pointless(&self, suffix: ClassId) -> bool {
        !self.whole && self.classes.reachable_from_eye(suffix) & self.planned == 0
    }

    /// True if no path that begins with the events of `prefix` reaches a layer that is asked for.
    #[inline]
    pub fn is_pointless_from_light(&self, prefix: ClassId) -> bool {
        !self.whole && self.classes.reachable_from_light(prefix) & self.planned == 0
    }

    fn reasons(&self, lit: bool, possible: u32) -> Vec<LeftOut> {
        let mut list = Vec::new();
        let mut leave = |what: &str, why: &str| {
            list.push(LeftOut {
                what: what.to_owned(),
                why: why.to_owned(),
            });
        };
        if !lit {
            leave(
                "shadow rays and all layers",
                "nothing in the scene emits light",
            );
        }
        for (i, label) in self.labels.iter().enumerate() {
            let bit = 1 << i;
            if self.asked & bit != 0 && possible & bit == 0 && lit {
                leave(
                    &format!("layer {label}"),
                    "no path of this scene has such a word",
                );
            }
        }
        let f = &self.features;
        if !f.textures {
            leave("texture lookups", "every colour is constant");
        }
        if !f.opacity {
            leave("opacity tests", "every surface stops every ray");
        }
        if !f.environment {
            leave("the sky", "rays that escape meet no light");
        }
        if !f.zero_size_lights && !f.hittable_lights && !f.shining_media && lit {
            leave("hits of lights", "no light can be met");
        }
        if !self.lens {
            leave("lens samples", "the camera is a pinhole");
        }
        if !f.media {
            leave("media", "no medium: rays are straight and lossless");
        }
        if !self.whole {
            leave("the whole", "only layers were asked for");
        }
        list
    }
}

fn asked_mask(settings: &LayerSettings) -> u32 {
    let components = if settings.components { 0b1111 } else { 0 };
    let expressions = ((1u64 << settings.expressions.len()) - 1) as u32;
    components | (expressions << 4)
}

/// The letters that can occur in this scene.
fn letters_of(features: &SceneFeatures) -> Vec<Letter> {
    let present = [
        (features.diffuse, Letter::D),
        (features.glossy, Letter::G),
        (features.specular, Letter::S),
        (features.volume, Letter::V),
    ];
    present
        .into_iter()
        .filter(|(on, _)| *on)
        .map(|(_, letter)| letter)
        .collect()
}
