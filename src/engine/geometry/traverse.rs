//! Walking the hierarchy: four boxes at once, four triangles at once, nearest box first.
//!
//! The boxes are tested conservatively (Ize 2013, *Robust BVH Ray Traversal*; Woop, Benthin and
//! Wald 2013, section 4), so a triangle that its own test accepts is never culled by a box around
//! it. A scene of few surfaces has no hierarchy: a ray is tested against all of them.

use arrayvec::ArrayVec;
use glam::{Vec3A, Vec4};

use super::bounds::Bounds3;
use super::ray::{Hit, Ray};
use super::sphere::Sphere;
use super::triangle::{Axis, ShearedRay, TriangleBlock};
use crate::engine::math::float::MACHINE_EPSILON;

/// Children of a node.
pub const WIDTH: usize = 4;

/// Marks a child that is a leaf: one block of triangles, or with [`SPHERE`] one sphere.
const LEAF: u32 = 1 << 31;
/// Marks a leaf that is a sphere.
const SPHERE: u32 = 1 << 30;
const INDEX: u32 = SPHERE - 1;

/// A child of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Child(u32);

impl Child {
    /// Fills unused slots.
    const NONE: Self = Self(LEAF | INDEX);

    /// An inner node.
    pub fn node(index: usize) -> Self {
        Self(index as u32 & INDEX)
    }

    /// A block of triangles.
    pub fn block(index: usize) -> Self {
        Self(index as u32 & INDEX | LEAF)
    }

    /// A sphere.
    pub fn sphere(index: usize) -> Self {
        Self(index as u32 & INDEX | LEAF | SPHERE)
    }

    /// Index of the inner node, where it is one.
    pub fn as_node(self) -> Option<usize> {
        (self.0 & LEAF == 0).then_some(self.0 as usize)
    }

    /// Index of the block of triangles, where it is one.
    pub fn as_block(self) -> Option<usize> {
        (self.is_leaf() && !self.is_sphere() && self != Self::NONE).then_some(self.index())
    }

    /// Index of the sphere, where it is one.
    pub fn as_sphere(self) -> Option<usize> {
        (self.is_leaf() && self.is_sphere()).then_some(self.index())
    }

    #[inline(always)]
    fn is_leaf(self) -> bool {
        self.0 & LEAF != 0
    }

    #[inline(always)]
    fn is_sphere(self) -> bool {
        self.0 & SPHERE != 0
    }

    #[inline(always)]
    fn index(self) -> usize {
        (self.0 & INDEX) as usize
    }
}

/// Four boxes, `planes[axis][lower or upper][child]`. An unused child has an empty box.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Node {
    planes: [[Vec4; 2]; 3],
    children: [Child; WIDTH],
}

impl Node {
    /// A node without children.
    pub fn empty() -> Self {
        Self {
            planes: [[Vec4::INFINITY, Vec4::NEG_INFINITY]; 3],
            children: [Child::NONE; WIDTH],
        }
    }

    /// Sets a child and its box.
    pub fn set(&mut self, slot: usize, child: Child, bounds: &Bounds3) {
        self.children[slot] = child;
        for axis in 0..3 {
            self.planes[axis][0][slot] = bounds.min[axis];
            self.planes[axis][1][slot] = bounds.max[axis];
        }
    }

    /// The child in a slot.
    pub fn child(&self, slot: usize) -> Child {
        self.children[slot]
    }

    /// The box around all children.
    pub fn bounds(&self) -> Bounds3 {
        let [x, y, z] = self.planes;
        Bounds3 {
            min: Vec3A::new(x[0].min_element(), y[0].min_element(), z[0].min_element()),
            max: Vec3A::new(x[1].max_element(), y[1].max_element(), z[1].max_element()),
        }
    }
}

/// The hierarchy in the order of traversal.
#[derive(Clone, Debug)]
pub struct Tree {
    /// Inner nodes; the first is the root. None for a scene of few surfaces: all leaves are met.
    pub nodes: Vec<Node>,
    /// Leaves of triangles.
    pub blocks: Vec<TriangleBlock>,
    /// All spheres, as primitives after the triangles.
    pub spheres: Vec<Sphere>,
    /// Primitive of the first sphere.
    pub first_sphere: u32,
    /// Box around all triangles.
    pub triangle_bounds: Bounds3,
}

/// A ray as the box test wants it.
struct BoxRay {
    near_origin: [Vec4; 3],
    far_origin: [Vec4; 3],
    near_inverse: [Vec4; 3],
    far_inverse: [Vec4; 3],
    negative: [usize; 3],
}

/// Widening of reciprocal directions: covers the roundings of the reciprocal, the difference and
/// the product of a slab distance, and that of the closest distance to f32.
const SLAB_ERROR: f32 = 6.0 * MACHINE_EPSILON;

/// The shear of a vertex errs by less than this times its distance (Woop et al. 2013, section 4,
/// with one rounding added for the origin's own).
const SHEAR_ERROR: f32 = 6.0 * MACHINE_EPSILON;

/// Stands for 1/0: large enough to leave every slab that a box is wide, and times 0 no NaN.
const LARGEST_INVERSE: f32 = f32::MAX / 4.0;

impl BoxRay {
    fn new(ray: &Ray, triangles: &Bounds3) -> Self {
        let k = Axis::dominant(ray.d) as usize;
        let error = if triangles.is_empty() {
            Vec3A::ZERO
        } else {
            let extent = (triangles.min - ray.o)
                .abs()
                .max((triangles.max - ray.o).abs());
            (extent + Vec3A::splat(extent[k])) * SHEAR_ERROR
        };
        let mut new = Self {
            near_origin: [Vec4::ZERO; 3],
            far_origin: [Vec4::ZERO; 3],
            near_inverse: [Vec4::ZERO; 3],
            far_inverse: [Vec4::ZERO; 3],
            negative: [0; 3],
        };
        for axis in 0..3 {
            let inverse = (1.0 / ray.d[axis]).clamp(-LARGEST_INVERSE, LARGEST_INVERSE);
            let away = error[axis].copysign(inverse);
            new.near_origin[axis] = Vec4::splat(ray.o[axis] + away);
            new.far_origin[axis] = Vec4::splat(ray.o[axis] - away);
            new.near_inverse[axis] = Vec4::splat(inverse * (1.0 - SLAB_ERROR));
            new.far_inverse[axis] = Vec4::splat(inverse * (1.0 + SLAB_ERROR));
            new.negative[axis] = usize::from(inverse.is_sign_negative());
        }
        new
    }

    /// Bits of the children whose boxes the ray meets up to `t_max`, and where it enters them.
    #[inline(always)]
    fn meets(&self, node: &Node, t_max: f32) -> (u32, Vec4) {
        let near = |axis: usize| {
            let plane = node.planes[axis][self.negative[axis] & 1];
            (plane - self.near_origin[axis]) * self.near_inverse[axis]
        };
        let far = |axis: usize| {
            let plane = node.planes[axis][(self.negative[axis] & 1) ^ 1];
            (plane - self.far_origin[axis]) * self.far_inverse[axis]
        };
        let enter = near(0).max(near(1)).max(near(2)).max(Vec4::ZERO);
        let leave = far(0).min(far(1)).min(far(2)).min(Vec4::splat(t_max));
        (enter.cmple(leave).bitmask(), enter)
    }
}

/// What is still to visit, with the distance at which its box begins.
#[derive(Default)]
struct Stack {
    items: ArrayVec<(f32, Child), 64>,
    /// Takes over for a tree of absurd depth.
    spilled: Vec<(f32, Child)>,
}

impl Stack {
    #[inline(always)]
    fn push(&mut self, t: f32, child: Child) {
        if let Err(full) = self.items.try_push((t, child)) {
            self.spilled.push(full.element());
        }
    }

    /// Returns the nearest of the children in `mask` and keeps the others, farthest first.
    #[inline(always)]
    fn push_all_but_nearest(&mut self, node: &Node, mut mask: u32, enter: Vec4) -> Option<Child> {
        let enter = enter.to_array();
        let mut next = || {
            let slot = mask.trailing_zeros() as usize & (WIDTH - 1);
            let some = mask != 0;
            mask &= mask.wrapping_sub(1);
            some.then(|| (enter[slot], node.children[slot]))
        };
        let mut nearest = next()?;
        let Some(mut second) = next() else {
            return Some(nearest.1);
        };
        if second.0 < nearest.0 {
            std::mem::swap(&mut nearest, &mut second);
        }
        let Some(mut third) = next() else {
            self.push(second.0, second.1);
            return Some(nearest.1);
        };
        // Insertion into (nearest, second, third, fourth).
        sort_pair(&mut second, &mut third);
        sort_pair(&mut nearest, &mut second);
        if let Some(mut fourth) = next() {
            sort_pair(&mut third, &mut fourth);
            sort_pair(&mut second, &mut third);
            sort_pair(&mut nearest, &mut second);
            self.push(fourth.0, fourth.1);
        }
        self.push(third.0, third.1);
        self.push(second.0, second.1);
        Some(nearest.1)
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<(f32, Child)> {
        self.spilled.pop().or_else(|| self.items.pop())
    }
}

#[inline(always)]
fn sort_pair(a: &mut (f32, Child), b: &mut (f32, Child)) {
    if b.0 < a.0 {
        std::mem::swap(a, b);
    }
}

/// What a ray has met.
struct Found {
    /// The closest so far.
    hit: Hit,
    some: bool,
    /// One is enough.
    any: bool,
}

impl Found {
    /// Takes a hit. Returns the distance up to which more are wanted, and whether none is.
    #[inline(always)]
    fn meet(&mut self, hit: Hit) -> (f32, bool) {
        if hit.t < self.hit.t || (hit.t == self.hit.t && hit.prim < self.hit.prim) {
            self.hit = hit;
            self.some = true;
        }
        (self.hit.t, self.any && self.some)
    }
}

impl Tree {
    /// The closest hit in (0, `ray.t_max`), of the lowest primitive where several are equally far.
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.walk(ray, false)
    }

    /// Whether anything lies in (0, `ray.t_max`).
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.walk(ray, true).is_some()
    }

    /// The closest hit, or `any`. One function for both: the instruction cache holds it.
    #[inline(never)]
    fn walk(&self, ray: &Ray, any: bool) -> Option<Hit> {
        let mut found = Found {
            // The end of the ray counts as a hit of primitive 0: nothing replaces it at equal
            // distance.
            hit: Hit {
                t: ray.t_max,
                prim: 0,
                u: 0.0,
                v: 0.0,
            },
            some: false,
            any,
        };
        let sheared = ShearedRay::new(ray);
        if self.nodes.is_empty() {
            self.meet_all(&sheared, &mut found);
        } else {
            self.descend(ray, &sheared, &mut found);
        }
        found.some.then_some(found.hit)
    }

    /// Meets everything: quicker than boxes where there is little.
    #[inline]
    fn meet_all(&self, sheared: &ShearedRay, found: &mut Found) {
        for block in &self.blocks {
            if block.intersect(sheared, found.hit.t, |hit| found.meet(hit)) {
                return;
            }
        }
        for index in 0..self.spheres.len() {
            if self.meet_sphere(sheared, index, found) {
                return;
            }
        }
    }

    /// Meets what lies in the boxes that the ray meets.
    #[inline]
    fn descend(&self, ray: &Ray, sheared: &ShearedRay, found: &mut Found) {
        let mut child = Child::node(0);
        let boxes = BoxRay::new(ray, &self.triangle_bounds);
        let mut stack = Stack::default();
        loop {
            if child.is_leaf() {
                let done = if child.is_sphere() {
                    self.meet_sphere(sheared, child.index(), found)
                } else {
                    // Only what is no ray, with a direction that is 0 or NaN, meets an empty slot.
                    let Some(block) = self.blocks.get(child.index()) else {
                        return;
                    };
                    block.intersect(sheared, found.hit.t, |hit| found.meet(hit))
                };
                if done {
                    return;
                }
            } else {
                let node = &self.nodes[child.index()];
                let (mask, enter) = boxes.meets(node, found.hit.t);
                if let Some(nearest) = stack.push_all_but_nearest(node, mask, enter) {
                    child = nearest;
                    continue;
                }
            }
            // The nearest box that still begins before the closest hit, or at it: a lower
            // primitive may lie there.
            child = loop {
                match stack.pop() {
                    Some((enter, next)) if enter <= found.hit.t => break next,
                    Some(_) => {}
                    None => return,
                }
            };
        }
    }

    /// Whether the search is over with sphere `index`.
    #[inline]
    fn meet_sphere(&self, ray: &ShearedRay, index: usize, found: &mut Found) -> bool {
        let Some(t) = self.spheres[index].intersect(ray.o, ray.d) else {
            return false;
        };
        let (prim, u, v) = (self.first_sphere + index as u32, 0.0, 0.0);
        found.meet(Hit { t, prim, u, v }).1
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.nodes) + size_of_val(&*self.blocks) + size_of_val(&*self.spheres)
    }
}
