//! What reads photon maps along a walk through media.

use super::walk::Walk;
use crate::engine::bsdf::Bsdf;
use crate::engine::geometry::SurfaceInteraction;
use crate::engine::integrators::replay::RadianceSink;
use crate::engine::scene::{Span, VolumePoint};

/// What looks for light beside shadow rays, where a walk is to end at its first diffuse event or at
/// the first place where a medium scatters it.
pub(in crate::engine::integrators) trait Gather {
    /// Whether there is such a thing: else the walk goes on.
    const ENDS: bool;
    /// Light at a part of a flight within a medium; `walk` stands at the flight's begin.
    fn along(&mut self, _walk: &Walk, _span: &Span<'_>, _out: &mut impl RadianceSink) {}
    /// Light that the medium scatters at `point`; the collision is in `walk` already.
    fn at_volume(&mut self, _walk: &Walk, _point: &VolumePoint, _out: &mut impl RadianceSink) {}
    /// Light at the diffuse event of a surface.
    fn at_surface(
        &mut self,
        _walk: &Walk,
        _si: &SurfaceInteraction,
        _bsdf: &Bsdf,
        _out: &mut impl RadianceSink,
    ) {
    }
}

/// Path tracing goes on to the end.
impl Gather for () {
    const ENDS: bool = false;
}
