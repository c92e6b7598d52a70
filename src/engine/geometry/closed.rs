//! What rays cannot do, so that a render can count it: meet the side of a sphere that they leave, or
//! slip out of a closed surface. Of the triangle that they leave they are kept clear.

use std::collections::HashMap;

use glam::DVec3;

use super::mesh::TriangleMesh;

/// Where a ray left a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Departure {
    /// The triangle or sphere.
    pub prim: u32,
    /// Whether it left the front side.
    pub front: bool,
}

impl Departure {
    /// From no surface: a lens, a light, a place in a medium.
    pub const NOWHERE: Self = Self {
        prim: u32::MAX,
        front: false,
    };
}

/// What went wrong with a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayFault {
    /// It met the surface that it left.
    SelfHit,
    /// It left the scene from within a closed surface.
    MissedEdge,
}

/// On which side of a triangle the space lies that its surface encloses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shell {
    /// Its surface has a rim, or is no surface: nothing is enclosed.
    Open,
    /// On the back.
    Behind,
    /// On the front.
    InFront,
}

/// Scenes of more triangles are not looked at: it would take longer than a first picture may.
pub const MOST_TRIANGLES: usize = 1 << 16;

/// What each triangle is part of. Surfaces are connected where corners have the same coordinates;
/// one is closed if each of its directed edges has exactly one opposite.
pub fn shells(mesh: &TriangleMesh) -> Vec<Shell> {
    let count = mesh.len();
    if count > MOST_TRIANGLES {
        return Vec::new();
    }
    let mut numbers = HashMap::new();
    let mut corners = Vec::with_capacity(count);
    let mut volumes = Vec::with_capacity(count);
    for prim in 0..count as u32 {
        let points = mesh.vertices(prim).unwrap_or_default();
        corners.push(points.map(|p| {
            // −0 and 0 are one place.
            let key = p.to_array().map(|x| (x + 0.0).to_bits());
            let next = numbers.len() as u32;
            *numbers.entry(key).or_insert(next)
        }));
        let [a, b, c] = points.map(|p| p.as_dvec3());
        volumes.push(a.dot(DVec3::cross(b, c)));
    }

    let mut parts = Parts::new(numbers.len());
    let mut edges = HashMap::with_capacity(3 * count);
    for &[a, b, c] in &corners {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *edges.entry((from, to)).or_insert(0_u32) += 1;
            parts.join(from, to);
        }
    }
    let (mut open, mut volume) = (vec![false; numbers.len()], vec![0.0; numbers.len()]);
    for (&(from, to), &times) in &edges {
        if times != 1 || edges.get(&(to, from)) != Some(&1) {
            open[parts.of(from)] = true;
        }
    }
    for (&[a, ..], v) in corners.iter().zip(&volumes) {
        volume[parts.of(a)] += v;
    }
    let mut shell = |&[a, ..]: &[u32; 3]| match parts.of(a) {
        part if open[part] || volume[part] == 0.0 => Shell::Open,
        part if volume[part] > 0.0 => Shell::Behind,
        _ => Shell::InFront,
    };
    corners.iter().map(&mut shell).collect()
}

/// Sets of connected corners (Tarjan 1975), each named by one of them.
struct Parts(Vec<u32>);

impl Parts {
    fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    /// The name of the set of `corner`; ways to it are halved.
    fn of(&mut self, corner: u32) -> usize {
        let mut at = corner as usize;
        while self.0[at] as usize != at {
            self.0[at] = self.0[self.0[at] as usize];
            at = self.0[at] as usize;
        }
        at
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.of(a), self.of(b));
        let (low, high) = (a.min(b), a.max(b));
        self.0[high] = low as u32;
    }
}
