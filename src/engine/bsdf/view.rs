//! The two directions of a scattering event against the two normals of a surface.
//!
//! The geometric normal decides which lobes may carry light: those of reflection if both
//! directions lie on its same side, those of transmission otherwise (Veach 1997, section 5.3.4).
//! The cosines of the lobes are those with the shading normal.

use glam::Vec3A;

use super::Transport;
use crate::engine::math::Frame;

/// The known direction at a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    pub wo: Vec3A,
    /// The shading normal, turned to the side of `wo`.
    pub n: Vec3A,
    /// wo·n, in [0, 1].
    pub cos: f32,
    /// The geometric normal of the front side.
    n_g: Vec3A,
    /// |wo·n_g|, in (0, 1].
    cos_g: f32,
    /// `wo` lies on the front side, the outside of a dielectric.
    pub outside: bool,
    /// The shading normal was not turned against the geometric normal on `wo`'s side.
    aligned: bool,
}

impl View {
    /// None if `wo` lies in the surface.
    #[inline]
    pub fn new(n_g: Vec3A, n_s: Vec3A, wo: Vec3A) -> Option<Self> {
        let (cos_g, cos) = (wo.dot(n_g), wo.dot(n_s));
        let (outside, above) = (cos_g > 0.0, cos >= 0.0);
        // A comparison that refuses NaN, too.
        (cos_g.abs() > 0.0).then_some(Self {
            wo,
            n: if above { n_s } else { -n_s },
            cos: cos.abs().min(1.0),
            n_g,
            cos_g: cos_g.abs().min(1.0),
            outside,
            aligned: outside == above,
        })
    }

    /// An orthonormal basis around `n`.
    #[inline]
    pub fn frame(&self) -> Frame {
        Frame::from_normal(self.n)
    }

    /// Whether `wi` lies on `wo`'s side of the geometric normal.
    #[inline]
    pub fn same_side(&self, wi: Vec3A) -> bool {
        (wi.dot(self.n_g) > 0.0) == self.outside
    }

    /// The second direction; None if it lies in the surface.
    #[inline]
    pub fn crossing(&self, wi: Vec3A) -> Option<Crossing> {
        let (cos_g, cos) = (wi.dot(self.n_g), wi.dot(self.n));
        (cos_g.abs() > 0.0 && cos.abs() > 0.0).then_some(Crossing {
            wi,
            cos: cos.abs().min(1.0),
            cos_g: cos_g.abs().min(1.0),
            same_side: (cos_g > 0.0) == self.outside,
            same_shading_side: cos > 0.0,
        })
    }

    /// Both directions exchanged; None if `wo` lies in the surface.
    #[inline]
    pub fn reversed(&self, crossing: &Crossing) -> Option<(Self, Crossing)> {
        let outside = crossing.same_side == self.outside;
        let above = (self.aligned == self.outside) == crossing.same_shading_side;
        (self.cos > 0.0).then_some((
            Self {
                wo: crossing.wi,
                n: if crossing.same_shading_side {
                    self.n
                } else {
                    -self.n
                },
                cos: crossing.cos,
                n_g: self.n_g,
                cos_g: crossing.cos_g,
                outside,
                aligned: outside == above,
            },
            Crossing {
                wi: self.wo,
                cos: self.cos,
                cos_g: self.cos_g,
                ..*crossing
            },
        ))
    }

    /// Whether light arrives above the horizon of the shading normal: diffuse lobes are dark
    /// where it does not. The direction towards the light is `wi` of a camera walk and `wo` of a
    /// light walk; the other one is free, which leaves no dark rim where a smooth mesh is seen at
    /// a grazing angle.
    #[inline]
    pub fn lit(&self, crossing: &Crossing, transport: Transport) -> bool {
        match transport {
            Transport::Radiance => crossing.same_shading_side == self.aligned,
            Transport::Importance => self.aligned,
        }
    }

    /// The factor on f·|wi·n_s| that makes a light walk the adjoint of a camera walk:
    /// |wo·n_s| |wi·n_g| / (|wo·n_g| |wi·n_s|), `wo` being the direction towards the light
    /// (Veach 1997, eq. 5.19). It is 1 where both normals are the same.
    #[inline]
    pub fn adjoint(&self, crossing: &Crossing, transport: Transport) -> f32 {
        match transport {
            Transport::Radiance => 1.0,
            Transport::Importance => (self.cos / self.cos_g) * (crossing.cos_g / crossing.cos),
        }
    }
}

/// Both directions at a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    pub wi: Vec3A,
    /// |wi·n_s|, in (0, 1].
    pub cos: f32,
    /// |wi·n_g|, in (0, 1].
    cos_g: f32,
    /// `wi` and `wo` lie on the same side of the geometric normal.
    pub same_side: bool,
    /// `wi` and `wo` lie on the same side of the shading normal.
    pub same_shading_side: bool,
}
