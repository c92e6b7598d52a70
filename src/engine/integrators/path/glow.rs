//! Light that media emit, looked for by shadow rays.
//!
//! Walk and shadow ray estimate the same thing, what is emitted along a whole ray, so they are
//! weighed by their densities of its direction alone.

use glam::Vec3A;

use super::walk::Walk;
use crate::engine::bsdf::{Bsdf, Transport};

use crate::engine::geometry::{Ray, SurfaceInteraction};
use crate::engine::integrators::Pass;
use crate::engine::integrators::replay::RadianceSink;
use crate::engine::math::Rgb;
use crate::engine::media::{Draws, Inside};
use crate::engine::sampling::mis;
use crate::engine::scene::VolumePoint;

/// Weight of light that the walk meets on its way along `d`.
pub(super) fn met_share(cx: &Pass<'_>, walk: &Walk, d: Vec3A) -> f32 {
    let found = walk.last_found();
    found.map_or(1.0, |(p, pdf)| {
        mis::power(pdf, cx.scene.media.glow.pdf_dir(p, d))
    })
}

/// Light of media that the medium scatters at `point`, with the walk's throughput.
pub(super) fn at_volume(
    cx: &Pass<'_>,
    walk: &Walk,
    point: &VolumePoint,
    inside: &Inside,
    draws: &mut Draws,
) -> Rgb {
    let Some((d, pdf)) = cx.scene.media.glow.sample_dir(point.p, draws) else {
        return Rgb::BLACK;
    };
    let phase = point.phase.pdf(point.wo, d);
    let ray = Ray::new(point.p, d);
    let emitted = cx.scene.fly(ray, *inside, walk.throughput, draws, |_| {});
    walk.throughput * emitted.emitted * (phase * mis::power(pdf, phase) / pdf)
}

/// Light of media at a surface, summed over the non-delta events there, each with the class and the
/// weight of its own; `inside` is true on the side the walk came from.
pub(super) fn at_surface(
    cx: &Pass<'_>,
    walk: &Walk,
    (si, bsdf, inside): (&SurfaceInteraction, &Bsdf, &Inside),
    draws: &mut Draws,
    out: &mut impl RadianceSink,
) {
    let Some((d, pdf)) = cx.scene.media.glow.sample_dir(si.p, draws) else {
        return;
    };
    let mut emitted = None;
    for event in bsdf.non_delta_events() {
        let class = cx.plan.classes.prepend(event.letter(), walk.suffix);
        let f_cos = bsdf.eval(event, si.wo, d, Transport::Radiance);
        if !cx.plan.is_wanted(class) || f_cos.is_black() {
            continue;
        }
        let emitted = *emitted.get_or_insert_with(|| {
            let inside = cx.scene.beyond(inside, si, d);
            let ray = si.spawn_ray(d);
            cx.scene
                .fly(ray, inside, walk.throughput, draws, |_| {})
                .emitted
        });
        let weight = mis::power(pdf, bsdf.pdf(event, si.wo, d));
        out.add(class, walk.throughput * f_cos * emitted * (weight / pdf));
    }
}
