//! The radiance one camera sample brought, layer by layer.

use crate::engine::math::Rgb;
use crate::engine::path::{ClassId, PathClasses};

/// Most layers a render can hold beside the whole.
pub const MAX_LAYERS: usize = 32;

/// The sink of one camera sample. Integrators add radiance under the class of its path and never
/// name a component.
#[derive(Clone, Debug)]
pub struct SampleRadiance<'a> {
    classes: &'a PathClasses,
    /// The layers that are accumulated; others are provably zero or were not asked for.
    planned: u32,
    whole: Rgb,
    layers: [Rgb; MAX_LAYERS],
}

impl<'a> SampleRadiance<'a> {
    /// An empty sink for the layers of the bit mask `planned`.
    pub fn new(classes: &'a PathClasses, planned: u32) -> Self {
        Self {
            classes,
            planned,
            whole: Rgb::BLACK,
            layers: [Rgb::BLACK; MAX_LAYERS],
        }
    }

    /// Forgets the last sample.
    #[inline]
    pub fn clear(&mut self) {
        self.whole = Rgb::BLACK;
        let mut mask = self.planned;
        while mask != 0 {
            self.layers[mask.trailing_zeros() as usize] = Rgb::BLACK;
            mask &= mask - 1;
        }
    }

    /// Adds the radiance of one complete path (or of all with the same word) of class `class`.
    #[inline]
    pub fn add(&mut self, class: ClassId, radiance: Rgb) {
        self.whole += radiance;
        let mut mask = self.classes.layers(class) & self.planned;
        while mask != 0 {
            self.layers[mask.trailing_zeros() as usize] += radiance;
            mask &= mask - 1;
        }
    }

    /// The sum over all paths, kept apart from the layers.
    #[inline]
    pub fn whole(&self) -> Rgb {
        self.whole
    }

    /// The sum over the paths of layer `index`.
    #[inline]
    pub fn layer(&self, index: usize) -> Rgb {
        self.layers[index]
    }

    /// True if the whole is finite: then every layer is, as a sum of some of its terms, unless
    /// infinities of both signs met, which makes the whole NaN.
    #[inline]
    pub fn is_finite(&self) -> bool {
        self.whole.is_finite()
    }
}
