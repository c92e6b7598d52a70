//! One sample of bidirectional path tracing: two walks, and all that joins them.

use glam::Vec2;

use super::connect::{Connector, Sink};
use super::merge::PhotonGrid;
use super::strategies::Strategies;
use super::subpath::{FIRST_LIGHT_VERTEX, LightStart, Subpath, Walker, vertex_dimensions};
use super::weight::Density;
use crate::engine::integrators::tiled::CAMERA_DIMENSIONS;
use crate::engine::integrators::{Pass, RenderStats};
use crate::engine::plan::RenderPlan;
use crate::engine::sampling::Sampler;

/// The estimator of one sample.
pub struct Bidirectional {
    /// Which strategies are on.
    pub strategies: Strategies,
    roulette: usize,
}

/// Memory of one sample, used again for the next.
#[derive(Default)]
pub struct Workspace {
    /// The walk from the lens.
    pub eye: Subpath,
    /// The walk from a light.
    pub light: Subpath,
    /// Where that began, if there is one.
    pub start: Option<LightStart>,
    densities: Vec<Density>,
}

impl Bidirectional {
    /// Only the strategies that are on; walks may end by roulette after `roulette` events.
    pub fn with(strategies: Strategies, roulette: usize) -> Self {
        Self {
            strategies,
            roulette,
        }
    }

    /// Takes one sample at the film position `film`: two walks and all their connections, and
    /// mergings with the photons of `grid`. The eye sampler stands behind film and lens.
    #[expect(
        clippy::too_many_arguments,
        reason = "what one sample needs and where it goes"
    )]
    pub fn sample(
        &self,
        cx: &Pass<'_>,
        (film, lens): (Vec2, Vec2),
        (eye_sampler, light_sampler): (&mut impl Sampler, &mut impl Sampler),
        grid: Option<&PhotonGrid>,
        work: &mut Workspace,
        sink: &mut impl Sink,
        stats: &mut RenderStats,
    ) {
        let walker = Walker {
            cx,
            roulette: self.roulette,
        };
        let (eye, light) = (&mut work.eye, &mut work.light);
        let ray = cx.camera.generate_ray(film, lens);
        sink.begin(film, &ray);
        let escape = walker.from_lens(ray, CAMERA_DIMENSIONS, eye_sampler, eye, stats);
        work.start = if cx.plan.shadow_rays && self.strategies.walk_from_lights() {
            walker.from_light(light_sampler, light, stats)
        } else {
            None
        };
        let mut connector = Connector {
            cx,
            strategies: &self.strategies,
            sink,
            stats,
        };

        // s = 0: light that the eye walk met by itself.
        connector.glow(eye);
        if let Some(escape) = escape {
            connector.escape(eye, &escape, &mut work.densities);
        }
        for t in 2..=eye.len() {
            connector.hit(eye, t);
        }
        if !cx.plan.shadow_rays {
            return;
        }
        connector.shadow_rays(eye, eye_sampler);
        if let Some(grid) = grid {
            for t in 2..=eye.len() {
                connector.merge(grid, eye, t);
            }
        }
        if let Some(start) = &work.start {
            connector.lens_joins((light, start), &eye.densities(1)[0], light_sampler);
            connector.connections((light, start), eye);
        }
    }
}

impl<K: Sink> Connector<'_, K> {
    /// s = 1.
    #[inline]
    fn shadow_rays(&mut self, eye: &Subpath, sampler: &mut impl Sampler) {
        let (plan, lights) = (self.cx.plan, &self.cx.scene.lights);
        for t in 2..=eye.len() {
            let vertex = eye.vertex(t - 1);
            if !vertex.has_non_delta() {
                continue;
            }
            sampler.seek(CAMERA_DIMENSIONS + vertex_dimensions(plan) * (t as u32 - 2) + 4);
            if let Some((id, pmf, sample)) = lights.sample_li(vertex.si.p, sampler) {
                self.shadow(eye, t, id, pmf, &sample);
            }
        }
    }

    /// t = 1: the light path ends on the lens.
    #[inline]
    fn lens_joins(
        &mut self,
        (light, start): (&Subpath, &LightStart),
        lens: &Density,
        sampler: &mut impl Sampler,
    ) {
        for s in 1..=light.len() {
            let u = if self.cx.plan.lens {
                sampler.seek(lens_dimension(self.cx.plan, s));
                sampler.next_2d()
            } else {
                Vec2::ZERO
            };
            if s == 1 {
                self.join_light(light, start, lens, u);
            } else {
                self.join_lens((light, start), s, lens, u);
            }
        }
    }

    /// s ≥ 2, t ≥ 2.
    #[inline]
    fn connections(&mut self, (light, start): (&Subpath, &LightStart), eye: &Subpath) {
        for t in 2..=eye.len() {
            if !eye.vertex(t - 1).has_non_delta() {
                continue;
            }
            for s in 2..=light.len() {
                self.connect((light, start), s, eye, t);
            }
        }
    }
}

/// Where the light sampler keeps the point of the lens for the vertex s − 1 of a light walk.
pub fn lens_dimension(plan: &RenderPlan, s: usize) -> u32 {
    match s {
        1 => 6,
        _ => FIRST_LIGHT_VERTEX + vertex_dimensions(plan) * (s as u32 - 2) + 4,
    }
}
