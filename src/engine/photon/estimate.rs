//! The radiance that the photons around a point are scattered into (Jensen 2001, eq. 7.6).

use std::f32::consts::PI;

use glam::Vec3A;

use super::kernel::Kernel;
use super::map::{PhotonMap, Tree};
use super::nearest::Nearest;
use super::record::Record;
use crate::engine::bsdf::{Bsdf, Transport};
use crate::engine::event::Event;
use crate::engine::geometry::SurfaceInteraction;
use crate::engine::math::Rgb;
use crate::engine::path::ClassId;

/// Factor on distances along the normal. Photons count within a flat ellipsoid whose equator is
/// the disc that the density refers to: those of an adjoining wall are mostly left out, and a
/// sphere of ten times the radius still fits.
const FLATTENING: f32 = 4.0;

/// Which photons a search may see.
#[derive(Clone, Copy, Debug)]
pub struct Disc {
    /// Centre.
    pub p: Vec3A,
    /// Geometric normal on the side that is seen.
    pub n: Vec3A,
    /// Largest radius.
    pub max_radius: f32,
    /// Leave out photons that come straight from a light: shadow rays count that light.
    pub without_direct: bool,
}

impl Disc {
    /// The disc at `si` on the side it is seen from.
    #[inline]
    pub fn new(si: &SurfaceInteraction, max_radius: f32, without_direct: bool) -> Self {
        let n = if si.n_g.dot(si.wo) < 0.0 {
            -si.n_g
        } else {
            si.n_g
        };
        Self {
            p: si.p,
            n,
            max_radius,
            without_direct,
        }
    }

    /// Squared distance in the flattened metric; `None` for a photon that must not count: one
    /// that arrived from the other side, or straight from a light where those are left out.
    #[inline]
    pub fn metric<T: Record>(&self, photon: &T, d: Vec3A, d2: f32) -> Option<f32> {
        if self.without_direct && photon.events() == 0 || photon.direction().dot(self.n) <= 0.0 {
            return None;
        }
        let height = d.dot(self.n);
        Some(d2 + (FLATTENING * FLATTENING - 1.0) * height * height)
    }
}

/// What one photon of an estimate brings.
#[derive(Clone, Copy, Debug)]
pub struct Contribution {
    /// Class of the events before its landing.
    pub class: ClassId,
    /// Number of the events before its landing.
    pub events: u32,
    /// Radiance toward the eye.
    pub radiance: Rgb,
}

/// One photon of a query, for display.
#[derive(Clone, Copy, Debug)]
pub struct Weighed {
    /// Its place in the tree.
    pub index: usize,
    /// Distance in the flattened metric over the radius, squared.
    pub x: f32,
    /// Kernel over area: its weight in 1/m²; 0 for the one that only sets the radius.
    pub density: f32,
}

/// The radius of a finished search and the photons to be counted.
///
/// Once there are n photons, the farthest gives the radius and is not counted: for evenly spread
/// photons, (n − 1)/(πr²) is the unbiased estimate of their density, also where a largest radius
/// cuts the search short.
fn weighed<'a>(
    nearest: &'a Nearest,
    disc: &Disc,
    kernel: Kernel,
) -> (f32, impl Iterator<Item = Weighed> + 'a) {
    let full = nearest.is_full();
    let mut r2 = nearest.r2();
    // All at one point: no disc of theirs has an area. They are spread over the largest one.
    let degenerate = r2 <= 0.0;
    if degenerate {
        r2 = disc.max_radius * disc.max_radius;
    }
    let skipped = usize::from(full && !degenerate);
    let area = PI * r2;
    let photons = nearest.found().enumerate().map(move |(i, (d2, index))| {
        let x = d2 / r2;
        let density = if i < skipped {
            0.0
        } else {
            kernel.weight(x) / area
        };
        Weighed { index, x, density }
    });
    (r2.sqrt(), photons)
}

impl PhotonMap {
    /// Finds the photons that count at `disc`.
    #[inline]
    pub fn locate(&self, disc: &Disc, nearest: &mut Nearest) {
        nearest.begin(disc.max_radius * disc.max_radius);
        if disc.without_direct && self.counts.direct == self.counts.stored {
            return; // the search would reject every photon around
        }
        match &self.tree {
            Tree::Packed(tree) => {
                tree.locate_photons(disc.p, nearest, |t, d, d2| disc.metric(t, d, d2))
            }
            Tree::Full(tree) => {
                tree.locate_photons(disc.p, nearest, |t, d, d2| disc.metric(t, d, d2))
            }
        }
    }

    /// Radiance scattered toward `si.wo` by the D lobes of `bsdf`, photon by photon. Returns the
    /// radius of the estimate.
    #[inline]
    pub fn estimate(
        &self,
        si: &SurfaceInteraction,
        bsdf: &Bsdf,
        disc: &Disc,
        kernel: Kernel,
        nearest: &mut Nearest,
        mut add: impl FnMut(Contribution),
    ) -> f32 {
        self.locate(disc, nearest);
        match &self.tree {
            Tree::Packed(tree) => sum(
                tree.nodes(),
                self.unit,
                si,
                bsdf,
                weighed(nearest, disc, kernel),
                &mut add,
            ),
            Tree::Full(tree) => sum(
                tree.nodes(),
                self.unit,
                si,
                bsdf,
                weighed(nearest, disc, kernel),
                &mut add,
            ),
        }
    }

    /// The photons of a query with their weights, and the radius: what the estimate is made of.
    pub fn inspect(&self, disc: &Disc, n: usize, kernel: Kernel) -> (f32, Vec<Weighed>) {
        let mut nearest = Nearest::new(n);
        self.locate(disc, &mut nearest);
        let (radius, photons) = weighed(&nearest, disc, kernel);
        (radius, photons.collect())
    }
}

#[inline]
fn sum<T: Record>(
    nodes: &[T],
    unit: f32,
    si: &SurfaceInteraction,
    bsdf: &Bsdf,
    (radius, photons): (f32, impl Iterator<Item = Weighed>),
    add: &mut impl FnMut(Contribution),
) -> f32 {
    for w in photons {
        if w.density == 0.0 {
            continue;
        }
        let photon = &nodes[w.index];
        let wi = photon.direction();
        // A photon stands for flux through the geometric surface: f of the shading normal's
        // cosine over the geometric one's (Veach 1997, section 5.3).
        let f_cos = bsdf.eval(Event::Diffuse, si.wo, wi, Transport::Radiance);
        let f = f_cos / wi.dot(si.n_g).abs();
        add(Contribution {
            class: photon.class(),
            events: photon.events(),
            radiance: f * photon.power() * (unit * w.density),
        });
    }
    radius
}
