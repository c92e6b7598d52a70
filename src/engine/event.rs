//! The letters of a path's word and the events that carry them.

/// A letter of the words that describe paths, `L(D|G|S|V)*E`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Letter {
    /// Diffuse reflection or transmission.
    D = 0,
    /// Glossy: a microfacet lobe of roughness α > 0.
    G = 1,
    /// Specular: a delta lobe.
    S = 2,
    /// Scattering in a volume.
    V = 3,
}

impl Letter {
    /// All letters, in the order of their numbers.
    pub const ALL: [Self; 4] = [Self::D, Self::G, Self::S, Self::V];
}

/// What happens at one vertex of a path. All non-delta lobes of one letter at a point are one
/// event; each delta lobe is one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Event {
    /// The diffuse lobes together.
    Diffuse,
    /// The microfacet lobes together.
    Glossy,
    /// The delta lobe of this index in its `Bsdf`.
    Specular(u8),
    /// Scattering by a medium.
    Volume,
}

impl Event {
    /// Its letter.
    #[inline]
    pub const fn letter(self) -> Letter {
        match self {
            Self::Diffuse => Letter::D,
            Self::Glossy => Letter::G,
            Self::Specular(_) => Letter::S,
            Self::Volume => Letter::V,
        }
    }

    /// True if the event's directions have no density: it can be sampled, never evaluated.
    #[inline]
    pub const fn is_delta(self) -> bool {
        matches!(self, Self::Specular(_))
    }
}
