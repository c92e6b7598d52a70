//! Radiance that a medium scatters toward the eye, from the photons stored in it.
//!
//! At a point: from the photons in a ball around it (Jensen and Christensen 1998, eq. 8). Along a
//! beam: from those in a cylinder around a part of a ray, each by its distance from it (Jarosz,
//! Zwicker and Jensen 2008, *The Beam Radiance Estimate for Volumetric Photon Mapping*): no place
//! on the ray is left to chance.

use std::f32::consts::PI;

use glam::Vec3A;

use super::estimate::Contribution;
use super::kdtree::KdTree;
use super::map::{PhotonMap, Tree};
use super::nearest::Nearest;
use super::record::Record;
use crate::engine::geometry::Ray;
use crate::engine::media::Phase;

/// Levels of a tree with as many photons as a `u32` counts.
const MAX_LEVELS: usize = 33;

impl PhotonMap {
    /// What is scattered toward `wo` around `p`, radiance per length: σ_s ∫ p L dω, photon by
    /// photon. Photons straight from a light are left out: shadow rays count that light.
    pub fn estimate_point(
        &self,
        (p, wo): (Vec3A, Vec3A),
        phase: Phase,
        max_radius: f32,
        nearest: &mut Nearest,
        add: impl FnMut(Contribution),
    ) {
        match &self.tree {
            Tree::Packed(tree) => point(tree, self.unit, (p, wo), phase, max_radius, nearest, add),
            Tree::Full(tree) => point(tree, self.unit, (p, wo), phase, max_radius, nearest, add),
        }
    }

    /// What is scattered toward the origin of `ray` within `range`, as if nothing were lost on the
    /// way: the photons within `radius` of it, and the distance at which each of them lies.
    pub fn estimate_beam(
        &self,
        ray: &Ray,
        range: (f32, f32),
        phase: Phase,
        radius: f32,
        add: impl FnMut(f32, Contribution),
    ) {
        match &self.tree {
            Tree::Packed(tree) => beam(tree, self.unit, ray, range, phase, radius, add),
            Tree::Full(tree) => beam(tree, self.unit, ray, range, phase, radius, add),
        }
    }
}

fn contribution<T: Record>(photon: &T, scale: f32) -> Contribution {
    Contribution {
        class: photon.class(),
        events: photon.events(),
        radiance: photon.power() * scale,
    }
}

fn point<T: Record>(
    tree: &KdTree<T>,
    unit: f32,
    (p, wo): (Vec3A, Vec3A),
    phase: Phase,
    max_radius: f32,
    nearest: &mut Nearest,
    mut add: impl FnMut(Contribution),
) {
    nearest.begin(max_radius * max_radius);
    tree.locate_photons(p, nearest, |photon, _, d2| {
        (photon.events() > 0).then_some(d2)
    });
    // Once there are n photons the farthest gives the radius and is not counted.
    let full = nearest.is_full() && nearest.r2() > 0.0;
    let r2 = if nearest.r2() > 0.0 {
        nearest.r2()
    } else {
        max_radius * max_radius
    };
    let density = unit / (4.0 / 3.0 * PI * r2 * r2.sqrt());
    for (_, index) in nearest.found().skip(usize::from(full)) {
        let photon = &tree.nodes()[index];
        let scale = phase.pdf(wo, photon.direction()) * density;
        add(contribution(photon, scale));
    }
}

/// Visits the photons whose nearest points on the ray lie within `range`, no farther than `radius`.
/// Below a split, only the part of the ray is followed that is within `radius` of each side.
fn beam<T: Record>(
    tree: &KdTree<T>,
    unit: f32,
    ray: &Ray,
    range: (f32, f32),
    phase: Phase,
    radius: f32,
    mut add: impl FnMut(f32, Contribution),
) {
    let nodes = tree.nodes();
    let density = unit / (PI * radius * radius);
    let mut open = [(0_usize, 0.0_f32, 0.0_f32); MAX_LEVELS + 1];
    open[0] = (1, range.0, range.1);
    let mut height = 1;
    while height > 0 {
        height -= 1;
        let (node, begin, end) = open[height];
        let Some(photon) = nodes.get(node - 1).filter(|_| begin <= end) else {
            continue;
        };
        let to = Vec3A::from_array(*photon.position()) - ray.o;
        let t = to.dot(ray.d);
        let off2 = (to - ray.d * t).length_squared();
        let within = range.0 <= t && t < range.1 && off2 < radius * radius;
        if within && photon.events() > 0 {
            let scale = phase.pdf(-ray.d, photon.direction()) * density;
            add(t, contribution(photon, scale));
        }
        if 2 * node > nodes.len() {
            continue;
        }
        let axis = photon.axis();
        let (at, o, d) = (photon.position()[axis], ray.o[axis], ray.d[axis]);
        for (child, side) in [(2 * node, 1.0), (2 * node + 1, -1.0)] {
            // side · (o + t d) ≤ side · at + radius
            let (slope, room) = (side * d, side * (at - o) + radius);
            let (mut from, mut until) = (begin, end);
            if slope > 0.0 {
                until = until.min(room / slope);
            } else if slope < 0.0 {
                from = from.max(room / slope);
            } else if room < 0.0 {
                continue;
            }
            // Rounded outward: a photon on the rim is decided by its own distance.
            let slack = (from.abs().max(until.abs()) + radius) * (4.0 * f32::EPSILON);
            open[height] = (child, from - slack, until + slack);
            height += 1;
        }
    }
}
