//! Directions toward media that emit.
//!
//! A place is drawn in proportion to what it may emit; what is sampled is the direction toward it,
//! and the whole ray is then integrated (Simon, Hanika, Zirr and Dachsbacher 2017, *Line Integration
//! for Rendering Heterogeneous Emissive Volumes*): the density of a direction sums the places along
//! it, so that walks which meet the same light by themselves can be weighed against it.

use glam::Vec3A;

use super::grid::clip;
use super::majorant::Majorants;
use super::medium::Medium;
use super::tracking::Draws;
use crate::engine::geometry::{Bounds3, Ray};
use crate::engine::math::distribution::Discrete;

/// The boxes with media that emit, and how they are sampled.
#[derive(Clone, Debug, Default)]
pub struct Glow {
    boxes: Vec<GlowBox>,
    cells: Option<Discrete>,
}

/// A box and its cells.
#[derive(Clone, Debug)]
struct GlowBox {
    bounds: Bounds3,
    /// Density of places in each cell, in 1/`unit`³: it has no scale that could overflow.
    cells: Majorants,
    /// Longest side, in m.
    unit: f64,
}

impl Glow {
    /// Of the media and the boxes that hold them. A medium without bounds is met by every ray and
    /// needs no search: it is left to walks.
    pub(super) fn new<'a>(placed: impl Iterator<Item = (&'a Medium, Bounds3)>) -> Self {
        let mut boxes: Vec<GlowBox> = Vec::new();
        for (medium, bounds) in placed {
            let emission = medium.emission.max_component();
            let extent = bounds.max - bounds.min;
            if !(emission > 0.0 && extent.min_element() > 0.0 && extent.is_finite()) {
                continue;
            }
            let (bounds, cells) = match &medium.grid {
                Some(grid) => (grid.bounds(), grid.majorants.scaled(emission)),
                None => (bounds, Majorants::uniform(bounds, emission)),
            };
            let unit = f64::from((bounds.max - bounds.min).max_element());
            boxes.push(GlowBox {
                bounds,
                cells,
                unit,
            });
        }
        let weights: Vec<f64> = boxes
            .iter()
            .flat_map(|b| {
                let volume = b.cells.cell_volume(1.0);
                b.cells.values().iter().map(move |e| f64::from(*e) * volume)
            })
            .collect();
        let cells = Discrete::new(&weights);
        if let Some(cells) = &cells {
            let mut first = 0;
            for b in &mut boxes {
                let volume = b.cells.cell_volume(b.unit);
                for (i, value) in b.cells.values_mut().iter_mut().enumerate() {
                    *value = (f64::from(cells.pmf(first + i)) / volume) as f32;
                }
                first += b.cells.values().len();
            }
        }
        Self { boxes, cells }
    }

    /// Whether there is nothing to look for.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.cells.is_none()
    }

    /// A direction from `p` toward a place that emits, and its density in 1/sr.
    pub fn sample_dir(&self, p: Vec3A, draws: &mut Draws) -> Option<(Vec3A, f32)> {
        let choice = self.cells.as_ref()?.sample(draws.next());
        let mut cell = choice.index;
        let b = self.boxes.iter().find(|b| {
            let within = cell < b.cells.values().len();
            cell -= if within { 0 } else { b.cells.values().len() };
            within
        })?;
        let u = Vec3A::new(draws.next(), draws.next(), draws.next());
        let d = (b.cells.place(cell, u) - p).try_normalize()?;
        let pdf = self.pdf_dir(p, d);
        (pdf > 0.0 && pdf.is_finite()).then_some((d, pdf))
    }

    /// Density of [`Self::sample_dir`] in 1/sr: Σ ∫ p(x) t² dt over the cells along the ray.
    pub fn pdf_dir(&self, p: Vec3A, d: Vec3A) -> f32 {
        let ray = Ray::new(p, d);
        let mut pdf = 0.0;
        for b in &self.boxes {
            let span = clip(&b.bounds, &ray, (0.0, f32::INFINITY));
            for (begin, end, density) in b.cells.walk(&ray, span) {
                let (s, t) = (f64::from(begin) / b.unit, f64::from(end) / b.unit);
                pdf += f64::from(density) * (t - s) * (s * s + s * t + t * t) / 3.0;
            }
        }
        pdf as f32
    }
}
