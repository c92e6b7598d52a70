//! The density of a finished path under each strategy, by its definition: no recursion, no ratio,
//! and delta events by a rule of their own.

use glam::{Vec2, Vec3A};

use super::scenes::GLASS;
use crate::engine::bsdf::Bsdf;
use crate::engine::event::Event;
use crate::engine::geometry::{Ray, SurfaceInteraction};
use crate::engine::integrators::Pass;
use crate::engine::integrators::bidirectional::{LightEnd, Vertex};

/// A complete path, from the light to the lens.
pub(super) struct Full<'a> {
    pub pass: &'a Pass<'a>,
    pub end: LightEnd,
    /// v₁ … vₙ₋₂ and the event at each.
    pub inner: Vec<(&'a Vertex, Event)>,
    /// Unit directions from each vertex to the next.
    pub edges: Vec<Vec3A>,
    pub lens: Vec3A,
}

impl Full<'_> {
    pub fn n(&self) -> usize {
        self.inner.len() + 2
    }

    /// Index of refraction on the side of a surface that `w` points to.
    fn index(&self, v: &Vertex, w: Vec3A) -> f64 {
        let name = &self.pass.scene.material_names[v.si.material as usize];
        let inside = w.dot(v.si.n_g) < 0.0;
        if name == "glass" && inside {
            f64::from(GLASS)
        } else {
            1.0
        }
    }

    /// Density in 1/sr of drawing `to` at vertex `i`, coming from `from`. The delta of a specular
    /// event is one of the measure n² cosθ dω, the same for both ways, and left out.
    fn pdf_dir(&self, i: usize, from: Vec3A, to: Vec3A) -> f64 {
        let (v, event) = self.inner[i - 1];
        let bsdf: &Bsdf = &v.bsdf;
        if event.is_delta() {
            let basis = self.index(v, to).powi(2) * f64::from(v.si.n_s.dot(to).abs());
            return f64::from(bsdf.event_probability(event, from)) * basis;
        }
        f64::from(bsdf.pdf(event, from, to))
    }

    pub fn point(&self, i: usize) -> Vec3A {
        match i {
            0 => self.end.p,
            _ if i + 1 == self.n() => self.lens,
            _ => self.inner[i - 1].0.si.p,
        }
    }

    fn normal(&self, i: usize) -> Option<Vec3A> {
        match i {
            0 => self.end.n,
            _ if i + 1 == self.n() => Some(self.pass.camera.forward()),
            _ => Some(self.inner[i - 1].0.si.n_g),
        }
    }

    /// Area density of vertex `to`, next to `from`.
    fn area(&self, pdf_dir: f64, from: usize, to: usize) -> f64 {
        // From the positions: next to each other they are rounded, and the direction sampled
        // between them is another one.
        let between = self.point(to).as_dvec3() - self.point(from).as_dvec3();
        let (w, distance2) = (between.normalize(), between.length_squared());
        let cos = self.normal(to).map_or(1.0, |n| n.as_dvec3().dot(w).abs());
        pdf_dir * cos / distance2
    }

    /// The density of the strategy (s, n − s).
    pub fn density(&self, s: usize) -> f64 {
        let (n, scene) = (self.n(), self.pass.scene);
        let light = scene.lights.get(self.end.id);
        let open = |v: usize| v == 0 || v + 1 == n || !self.inner[v - 1].1.is_delta();
        let possible = match s {
            0 => !light.is_delta(),
            1 if n == 2 => !light.is_delta() && !light.is_infinite(),
            _ => open(s - 1) && open(s),
        };
        if !possible {
            return 0.0;
        }
        let (pdf_pos, pdf_dir) = light.pdf_le(self.end.n, self.edges[0]);
        let pmf = f64::from(scene.lights.pmf(self.end.id));
        let mut p = 1.0;
        for i in 0..s {
            p *= match i {
                0 if light.is_infinite() => pmf * f64::from(pdf_dir),
                0 if s == 1 && n > 2 && !light.is_delta() => {
                    let hit = self.light_point();
                    let li = light.pdf_li(self.point(1), -self.edges[0], Some(&hit));
                    pmf * self.area(f64::from(li), 1, 0)
                }
                0 => pmf * f64::from(pdf_pos),
                1 if light.is_infinite() => {
                    let cos = self.normal(1).map_or(1.0, |n| n.dot(self.edges[0]).abs());
                    f64::from(pdf_pos) * f64::from(cos)
                }
                1 => self.area(f64::from(pdf_dir), 0, 1),
                _ => {
                    let out = self.pdf_dir(i - 1, -self.edges[i - 2], self.edges[i - 1]);
                    self.area(out, i - 1, i)
                }
            };
        }
        let first = Ray::new(self.lens, -self.edges[n - 2]);
        let we = self.pass.camera.pdf_we(&first);
        for i in (s..n).rev() {
            p *= if i == n - 1 {
                f64::from(we.0)
            } else {
                let out = if i == n - 2 {
                    f64::from(we.1)
                } else {
                    self.pdf_dir(i + 1, self.edges[i + 1], -self.edges[i])
                };
                if i == 0 && light.is_infinite() {
                    out
                } else {
                    self.area(out, i + 1, i)
                }
            };
        }
        p
    }

    fn light_point(&self) -> SurfaceInteraction {
        let n = self.end.n.unwrap_or(Vec3A::Z);
        SurfaceInteraction {
            p: self.end.p,
            p_error: Vec3A::ZERO,
            n_g: n,
            n_s: n,
            uv: Vec2::ZERO,
            wo: self.edges[0],
            t: 0.0,
            material: 0,
            light: Some(self.end.id),
            prim: 0,
        }
    }
}
