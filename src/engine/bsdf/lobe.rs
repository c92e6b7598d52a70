//! The lobes a surface scatters by.

use std::f32::consts::FRAC_1_PI;

use glam::{Vec2, Vec3A};

use super::fresnel::Interface;
use super::view::{Crossing, View};
use super::{Transport, ggx};
use crate::engine::event::Letter;
use crate::engine::sampling::warp;

/// One way of scattering; its colour is a weight beside it. An `ior` is that of the inside
/// against 1 outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lobe {
    /// f = 1/π.
    Lambert,
    /// The diffuse base under a smooth coat, f = scale · T(θi) T(θo)/π, whose albedo at θo is
    /// T(θo).
    CoatedDiffuse {
        /// Index of the coat.
        ior: f32,
        /// One over the cosine-weighted mean of the coat's transmittance.
        scale: f32,
    },
    /// Perfect mirror.
    Mirror,
    /// Fresnel reflection off a coat, from either side as if from outside.
    Coat {
        /// Index of the coat.
        ior: f32,
    },
    /// Fresnel reflection at a smooth dielectric.
    Reflection {
        /// Index of the inside.
        ior: f32,
    },
    /// Fresnel transmission through a smooth dielectric.
    Transmission {
        /// Index of the inside.
        ior: f32,
    },
    /// GGX reflection with Fresnel factor 1.
    Ggx {
        /// Roughness α, at least [`ggx::MIN_ALPHA`].
        alpha: f32,
    },
    /// GGX reflection and transmission.
    RoughDielectric {
        /// Roughness α, at least [`ggx::MIN_ALPHA`].
        alpha: f32,
        /// Index of the inside, not next to 1.
        ior: f32,
    },
}

/// The outcome of a delta lobe.
#[derive(Clone, Copy, Debug)]
pub(super) struct DeltaSample {
    pub wi: Vec3A,
    /// What a radiance or importance is multiplied by.
    pub weight: f32,
    /// Ratio of indices on transmission, 1 on reflection.
    pub eta: f32,
}

impl Lobe {
    /// The letter of the event it belongs to.
    #[inline]
    pub const fn letter(self) -> Letter {
        match self {
            Self::Lambert | Self::CoatedDiffuse { .. } => Letter::D,
            Self::Ggx { .. } | Self::RoughDielectric { .. } => Letter::G,
            Self::Mirror
            | Self::Coat { .. }
            | Self::Reflection { .. }
            | Self::Transmission { .. } => Letter::S,
        }
    }

    /// True if light crosses the surface.
    #[inline]
    pub const fn transmits(self) -> bool {
        matches!(
            self,
            Self::Transmission { .. } | Self::RoughDielectric { .. }
        )
    }

    /// Its directional albedo at weight 1 in closed form: exact but for the microfacets, where it
    /// is an upper bound.
    #[inline]
    pub(super) fn albedo(self, view: &View) -> f32 {
        match self {
            Self::Lambert | Self::Mirror | Self::Ggx { .. } | Self::RoughDielectric { .. } => 1.0,
            Self::CoatedDiffuse { ior, .. } => coat_transmittance(ior, view.cos),
            Self::Coat { ior } => Interface::new(ior, true).fresnel(view.cos).0,
            Self::Reflection { ior } => Interface::new(ior, view.outside).fresnel(view.cos).0,
            Self::Transmission { ior } => Interface::new(ior, view.outside).fresnel(view.cos).1,
        }
    }

    /// Index on the far side over the index on the side of `wo`; 1 if light does not cross.
    #[inline]
    pub(super) fn eta(self, view: &View) -> f32 {
        match self {
            Self::Transmission { ior } | Self::RoughDielectric { ior, .. } => {
                Interface::new(ior, view.outside).eta()
            }
            _ => 1.0,
        }
    }

    /// The direction and weight of a delta lobe.
    #[inline]
    pub(super) fn sample_delta(self, view: &View, transport: Transport) -> Option<DeltaSample> {
        let reflection = |weight| DeltaSample {
            wi: (view.n * (2.0 * view.cos) - view.wo).normalize(),
            weight,
            eta: 1.0,
        };
        match self {
            Self::Mirror | Self::Coat { .. } | Self::Reflection { .. } => {
                Some(reflection(self.albedo(view)))
            }
            Self::Transmission { ior } => {
                let interface = Interface::new(ior, view.outside);
                let eta = interface.eta();
                let scale = match transport {
                    Transport::Radiance => 1.0 / (eta * eta),
                    Transport::Importance => 1.0,
                };
                Some(DeltaSample {
                    wi: interface.refract(view.wo, view.n)?,
                    weight: interface.fresnel(view.cos).1 * scale,
                    eta,
                })
            }
            _ => None,
        }
    }

    /// A direction of a lobe with a density; None if it was masked.
    #[inline]
    pub(super) fn sample(self, view: &View, u_lobe: f32, u: Vec2) -> Option<Vec3A> {
        match self {
            Self::Lambert | Self::CoatedDiffuse { .. } => {
                let wi = view.frame().to_world(warp::sample_cosine_hemisphere(u));
                // The density |wi·n_s|/π does not change under wi → −wi, so that turning a
                // direction from behind the surface back covers the whole visible hemisphere of
                // the geometric normal with it, for any shading normal.
                Some(if view.same_side(wi) { wi } else { -wi })
            }
            Self::Ggx { alpha } => {
                let frame = view.frame();
                let wi = ggx::sample_reflection(alpha, frame.to_local(view.wo), u)?;
                Some(frame.to_world(wi))
            }
            Self::RoughDielectric { alpha, ior } => {
                let frame = view.frame();
                let wo = frame.to_local(view.wo);
                let interface = Interface::new(ior, view.outside);
                let wi = ggx::sample_dielectric(alpha, interface, wo, u_lobe, u)?;
                Some(frame.to_world(wi))
            }
            _ => None,
        }
    }

    /// f·|cosθi| and the density of [`Self::sample`], both in 1/sr; 0 for delta lobes.
    #[inline]
    pub(super) fn eval(self, view: &View, crossing: &Crossing, transport: Transport) -> (f32, f32) {
        match self {
            Self::Lambert | Self::CoatedDiffuse { .. } => {
                if !crossing.same_side {
                    return (0.0, 0.0);
                }
                let pdf = crossing.cos * FRAC_1_PI;
                if !view.lit(crossing, transport) {
                    return (0.0, pdf);
                }
                let Self::CoatedDiffuse { ior, scale } = self else {
                    return (pdf, pdf);
                };
                let coat = coat_transmittance(ior, view.cos)
                    * coat_transmittance(ior, crossing.cos)
                    * scale;
                (pdf * coat, pdf)
            }
            Self::Ggx { alpha } if crossing.same_side && crossing.same_shading_side => {
                let frame = view.frame();
                ggx::reflection(alpha, frame.to_local(view.wo), frame.to_local(crossing.wi))
            }
            Self::RoughDielectric { alpha, ior }
                if crossing.same_side == crossing.same_shading_side =>
            {
                let frame = view.frame();
                let (wo, wi) = (frame.to_local(view.wo), frame.to_local(crossing.wi));
                let interface = Interface::new(ior, view.outside);
                ggx::dielectric(alpha, interface, wo, wi, transport)
            }
            _ => (0.0, 0.0),
        }
    }
}

#[inline]
fn coat_transmittance(ior: f32, cos: f32) -> f32 {
    Interface::new(ior, true).fresnel(cos).1
}
