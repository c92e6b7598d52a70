//! The projection map: where specular and glossy surfaces lie as seen from a light (Jensen 1996,
//! section 2.1; 2001, section 5.3).
//!
//! The surfaces are grouped into a few bounding spheres. From a point they are seen in cones,
//! along a direction as disks. An emission is drawn from one of them in proportion to its solid
//! angle or area; where they overlap, the density counts how many cover the sample. Nothing that
//! can meet such a surface is left out, so dividing by the density keeps the light unbiased, and
//! photons of one point on a light differ in power by the overlap alone.

use std::f32::consts::PI;

use arrayvec::ArrayVec;
use glam::{Vec2, Vec3A};

use crate::engine::geometry::{Bounds3, Geometry};
use crate::engine::math::Frame;
use crate::engine::sampling::warp::{pdf_cone, sample_cone, sample_unit_disk};
use crate::engine::scene::Scene;
use crate::engine::scene::material::Features;

/// Most groups.
const MAX_GROUPS: usize = 48;
/// Relative growth of a group's radius: covers the roundings between its sphere and the
/// intersection tests.
const MARGIN: f32 = 1.0 + 64.0 * f32::EPSILON;
/// 1 − cosθ of all directions.
const EVERYWHERE: f32 = 2.0;

#[derive(Clone, Copy, Debug)]
struct Group {
    center: Vec3A,
    radius: f32,
}

/// Where photons for the caustic map are sent.
#[derive(Clone, Debug, Default)]
pub struct ProjectionMap {
    groups: Vec<Group>,
}

/// A cone around an axis; `drop` = 1 − cos of its opening.
#[derive(Clone, Copy, Debug)]
struct Cone {
    axis: Vec3A,
    drop: f32,
}

impl Cone {
    fn holds(&self, d: Vec3A) -> bool {
        0.5 * (d - self.axis).length_squared() <= self.drop
    }

    fn solid_angle(&self) -> f32 {
        2.0 * PI * self.drop
    }
}

impl Group {
    /// The cone in which the sphere is seen from `p`: all directions from within.
    fn cone(&self, p: Vec3A) -> Cone {
        let to = self.center - p;
        let distance = to.length();
        let tangent2 = (distance - self.radius) * (distance + self.radius);
        if tangent2 <= 0.0 {
            return Cone {
                axis: Vec3A::Z,
                drop: EVERYWHERE,
            };
        }
        // 1 − cosθ = sin²θ / (1 + cosθ) keeps its digits where the cone is narrow.
        let sin = self.radius / distance;
        let drop = sin * sin / (1.0 + tangent2.sqrt() / distance);
        Cone {
            axis: to / distance,
            drop: drop * MARGIN,
        }
    }

    fn area(&self) -> f32 {
        PI * self.radius * self.radius
    }

    /// Whether the line through `p` along the unit vector `d` meets the sphere.
    fn is_met(&self, p: Vec3A, d: Vec3A) -> bool {
        (self.center - p).cross(d).length_squared() <= self.radius * self.radius
    }
}

impl ProjectionMap {
    /// The specular and glossy surfaces of a scene.
    pub fn new(scene: &Scene) -> Self {
        let wanted = |prim: &u32| {
            let material = scene.geometry.material(*prim);
            let features = material.map(|m| scene.materials[m as usize].features());
            features.is_some_and(|f| f.contains(Features::SPECULAR) || f.contains(Features::GLOSSY))
        };
        let count = scene.geometry.primitive_count() as u32;
        let prims: Vec<u32> = (0..count).filter(wanted).collect();
        Self {
            groups: groups(&scene.geometry, prims),
        }
    }

    /// Whether there is nothing to send photons to.
    pub fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// Centres and radii of the groups, for display.
    pub fn spheres(&self) -> impl Iterator<Item = (Vec3A, f32)> + '_ {
        self.groups.iter().map(|g| (g.center, g.radius))
    }

    /// The share of all directions at `p` that the groups fill, overlaps counted twice, at most 1.
    pub fn share_from(&self, p: Vec3A) -> f32 {
        let sum: f32 = self.groups.iter().map(|g| g.cone(p).solid_angle()).sum();
        (sum / (4.0 * PI)).min(1.0)
    }

    /// Sum of the groups' cross sections, m².
    pub fn area(&self) -> f32 {
        self.groups.iter().map(Group::area).sum()
    }

    /// A direction from `p` towards a group, and its density in 1/sr.
    pub fn sample_from(&self, p: Vec3A, u_group: f32, u: Vec2) -> Option<(Vec3A, f32)> {
        let cones: ArrayVec<Cone, MAX_GROUPS> = self.groups.iter().map(|g| g.cone(p)).collect();
        let (chosen, total) = pick(cones.iter().map(Cone::solid_angle), u_group)?;
        let cone = cones[chosen];
        let local = sample_cone(u, cone.drop);
        let d = Frame::from_normal(cone.axis).to_world(local).normalize();
        // The cone it was drawn from holds it, whatever rounding says.
        let others = cones.iter().enumerate();
        let covered = others.filter(|(i, c)| *i == chosen || c.holds(d)).count();
        Some((d, covered as f32 / total))
    }

    /// Density of [`Self::sample_from`], 1/sr.
    pub fn pdf_from(&self, p: Vec3A, d: Vec3A) -> f32 {
        let cones = self.groups.iter().map(|g| g.cone(p));
        let (mut covered, mut total) = (0.0, 0.0);
        for cone in cones {
            // Summed in 1/pdf_cone so that both densities are the same number.
            total += 1.0 / pdf_cone(cone.drop);
            covered += f32::from(u8::from(cone.holds(d)));
        }
        if covered > 0.0 { covered / total } else { 0.0 }
    }

    /// A point through which a ray along the unit vector `d` may meet a group, in the plane
    /// through that group's centre across `d`; with its density in 1/m².
    pub fn sample_along(&self, d: Vec3A, u_group: f32, u: Vec2) -> Option<(Vec3A, f32)> {
        let (chosen, total) = pick(self.groups.iter().map(Group::area), u_group)?;
        let group = self.groups[chosen];
        let disk = sample_unit_disk(u) * group.radius;
        let frame = Frame::from_normal(d);
        let p = group.center + frame.s * disk.x + frame.t * disk.y;
        let others = self.groups.iter().enumerate();
        let covered = others
            .filter(|(i, g)| *i == chosen || g.is_met(p, d))
            .count();
        Some((p, covered as f32 / total))
    }

    /// Density of [`Self::sample_along`] across `d`, 1/m².
    pub fn pdf_along(&self, d: Vec3A, p: Vec3A) -> f32 {
        let covered = self.groups.iter().filter(|g| g.is_met(p, d)).count();
        covered as f32 / self.area()
    }
}

/// An index in proportion to its weight, and the sum of all.
fn pick(weights: impl Iterator<Item = f32> + Clone, u: f32) -> Option<(usize, f32)> {
    let total: f32 = weights.clone().sum();
    let mut x = u * total;
    let mut last = None;
    for (i, w) in weights.enumerate() {
        if w > 0.0 {
            last = Some(i);
            if x < w {
                break;
            }
            x -= w;
        }
    }
    last.map(|i| (i, total))
}

/// Halves the largest group until there are enough.
fn groups(geometry: &Geometry, prims: Vec<u32>) -> Vec<Group> {
    if prims.is_empty() {
        return Vec::new();
    }
    let mut parts = vec![prims];
    let mut spheres = vec![bounding(geometry, &parts[0])];
    while parts.len() < MAX_GROUPS {
        let splittable = (0..parts.len()).filter(|i| parts[*i].len() > 1);
        let largest = splittable.max_by(|a, b| spheres[*a].radius.total_cmp(&spheres[*b].radius));
        let Some(i) = largest else { break };
        let (left, right) = halves(geometry, std::mem::take(&mut parts[i]));
        spheres[i] = bounding(geometry, &left);
        spheres.push(bounding(geometry, &right));
        parts[i] = left;
        parts.push(right);
    }
    spheres
}

/// Splits at the median along the longest side of the box around the centres.
fn halves(geometry: &Geometry, mut prims: Vec<u32>) -> (Vec<u32>, Vec<u32>) {
    let centre = |prim: u32| bounds(geometry, prim).center();
    let around = prims
        .iter()
        .fold(Bounds3::EMPTY, |b, p| b.including(centre(*p)));
    let extent = around.max - around.min;
    let axis = (0..3).fold(0, |best, a| if extent[a] > extent[best] { a } else { best });
    let middle = prims.len() / 2;
    let along = |p: &u32| centre(*p)[axis];
    prims.select_nth_unstable_by(middle, |a, b| along(a).total_cmp(&along(b)).then(a.cmp(b)));
    let right = prims.split_off(middle);
    (prims, right)
}

fn bounding(geometry: &Geometry, prims: &[u32]) -> Group {
    if let [prim] = prims
        && let Some(sphere) = geometry.sphere(*prim)
    {
        return Group {
            center: sphere.center,
            radius: sphere.radius * MARGIN,
        };
    }
    let all = prims
        .iter()
        .fold(Bounds3::EMPTY, |b, p| b.union(&bounds(geometry, *p)));
    Group {
        center: all.center(),
        radius: all.radius() * MARGIN,
    }
}

fn bounds(geometry: &Geometry, prim: u32) -> Bounds3 {
    if let Some(sphere) = geometry.sphere(prim) {
        return sphere.bounds();
    }
    let corners = geometry.triangle_vertices(prim).unwrap_or_default();
    corners.iter().fold(Bounds3::EMPTY, |b, p| b.including(*p))
}
