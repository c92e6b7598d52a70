//! Building the hierarchy. The only file that names obvhs.
//!
//! obvhs decides the topology of a binary tree (PLOC with parallel reinsertion: Meister and
//! Bittner 2018, *Parallel Locally-Ordered Clustering*) from boxes scaled into the unit cube, so
//! that scenes of any size get the same tree. The tree is then made four wide, and all boxes are
//! computed anew from the primitives: none of obvhs's rounding enters traversal.

use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use super::bounds::Bounds3;
use super::mesh::TriangleMesh;
use super::sphere::Sphere;
use super::traverse::{Child, Node, Tree, WIDTH};
use super::triangle::{LANES, TriangleBlock};

/// Up to here blocks of triangles and spheres together are met one by one, without boxes.
const FEW: usize = 8;

/// Share of the nodes that reinsertion tries to move: all in a small scene, where it costs a
/// fraction of a second and makes rays a tenth faster; few in a large one.
fn reinsertion_ratio(prims: usize) -> f32 {
    (100_000.0 / prims as f32).clamp(0.05, 1.0)
}

/// The hierarchy over all triangles and spheres. Triangles in `hidden` are left out.
pub fn build(mesh: &TriangleMesh, spheres: Vec<Sphere>, hidden: &[bool]) -> Tree {
    let triangles = mesh.len() as u32;
    let mut tree = Tree {
        nodes: Vec::new(),
        blocks: Vec::new(),
        first_sphere: triangles,
        triangle_bounds: Bounds3::EMPTY,
        spheres,
    };
    let prims: Vec<u32> = (0..triangles + tree.spheres.len() as u32)
        .filter(|&prim| !hidden.get(prim as usize).copied().unwrap_or(false))
        .collect();
    if prims.is_empty() {
        return tree;
    }
    tree.triangle_bounds = (0..triangles).fold(Bounds3::EMPTY, |all, prim| {
        all.union(&prim_bounds(mesh, &[], prim))
    });
    let blocks: Vec<&[u32]> = prims[..prims.len() - tree.spheres.len()]
        .chunks(LANES)
        .collect();
    if blocks.len() + tree.spheres.len() <= FEW {
        tree.blocks = blocks.into_iter().map(|prims| block(mesh, prims)).collect();
        return tree;
    }
    let bounds = |prim: u32| prim_bounds(mesh, &tree.spheres, prim);
    let all = prims
        .iter()
        .fold(Bounds3::EMPTY, |all, &prim| all.union(&bounds(prim)));
    let boxes = unit_boxes(&all, prims.iter().map(|&prim| bounds(prim)));
    let binary = binary_tree(&boxes, &prims);
    drop(boxes);
    let mut widening = Widening {
        counts: leaf_counts(&binary, triangles),
        binary,
        mesh,
        tree: &mut tree,
        leaf_bounds: Vec::new(),
    };
    widening.run();
    let leaf_bounds = widening.leaf_bounds;
    fit_boxes(&mut tree, &leaf_bounds);
    tree
}

/// The triangles `prims`, at most [`LANES`].
fn block(mesh: &TriangleMesh, prims: &[u32]) -> TriangleBlock {
    let corners = |&prim: &u32| mesh.vertices(prim).map(|corners| (prim, corners));
    TriangleBlock::new(prims.iter().filter_map(corners))
}

fn prim_bounds(mesh: &TriangleMesh, spheres: &[Sphere], prim: u32) -> Bounds3 {
    match mesh.vertices(prim) {
        Some(corners) => corners
            .into_iter()
            .fold(Bounds3::EMPTY, |all, p| all.including(p)),
        None => spheres
            .get(prim as usize - mesh.len())
            .map_or(Bounds3::EMPTY, Sphere::bounds),
    }
}

/// Boxes scaled by a power of two and moved so that all lie in about [−1, 1]³.
fn unit_boxes(all: &Bounds3, boxes: impl Iterator<Item = Bounds3>) -> Vec<Aabb> {
    let center = all.center();
    let extent = (all.max - center).max_element().max(f32::MIN_POSITIVE);
    // The exponent alone, so that a scene scaled by a power of two gets the same tree.
    let scale = f32::from_bits(extent.to_bits() & 0x7f80_0000);
    let unit = |p: Vec3A| ((p - center) / scale).clamp(Vec3A::splat(-2.0), Vec3A::splat(2.0));
    boxes.map(|b| Aabb::new(unit(b.min), unit(b.max))).collect()
}

fn binary_tree(boxes: &[Aabb], prims: &[u32]) -> Bvh2 {
    let mut bvh = PlocBuilder::with_capacity(boxes.len()).build(
        PlocSearchDistance::Medium,
        boxes,
        (0..boxes.len() as u32).collect(),
        SortPrecision::U64,
        3,
    );
    ReinsertionOptimizer::default().run(&mut bvh, reinsertion_ratio(prims.len()), None);
    // From here on leaves name primitives.
    for node in &mut bvh.nodes {
        if node.is_leaf() {
            node.first_index = prims[bvh.primitive_indices[node.first_index as usize] as usize];
        }
    }
    bvh
}

/// For each binary node the number of triangles below it; a sphere counts more than a leaf holds.
fn leaf_counts(binary: &Bvh2, triangles: u32) -> Vec<u32> {
    let mut order = Vec::with_capacity(binary.nodes.len());
    let mut open = vec![0_u32];
    while let Some(index) = open.pop() {
        order.push(index);
        let node = &binary.nodes[index as usize];
        if !node.is_leaf() {
            open.extend([node.first_index, node.first_index + 1]);
        }
    }
    let mut counts = vec![0_u32; binary.nodes.len()];
    for &index in order.iter().rev() {
        let node = &binary.nodes[index as usize];
        let first = node.first_index as usize;
        counts[index as usize] = match node.is_leaf() {
            true if node.first_index < triangles => 1,
            true => LANES as u32 + 1,
            false => counts[first].saturating_add(counts[first + 1]),
        };
    }
    counts
}

/// Makes the binary tree four wide, from the root down.
struct Widening<'a> {
    binary: Bvh2,
    counts: Vec<u32>,
    mesh: &'a TriangleMesh,
    tree: &'a mut Tree,
    leaf_bounds: Vec<Bounds3>,
}

impl Widening<'_> {
    fn run(&mut self) {
        // (binary node, node and slot that wait for it)
        let mut open: Vec<(u32, Option<(usize, usize)>)> = vec![(0, None)];
        while let Some((index, parent)) = open.pop() {
            let node = self.tree.nodes.len();
            if let Some((above, slot)) = parent {
                let nothing_yet = Bounds3::EMPTY;
                self.tree.nodes[above].set(slot, Child::node(node), &nothing_yet);
            }
            self.tree.nodes.push(Node::empty());
            for (slot, child) in self.children(index).into_iter().enumerate() {
                if self.is_leaf(child) {
                    let leaf = self.leaf(child);
                    self.tree.nodes[node].set(slot, leaf, &Bounds3::EMPTY);
                } else {
                    open.push((child, Some((node, slot))));
                }
            }
        }
    }

    /// Whether a binary node becomes a leaf: one sphere, or as many triangles as are tested at once.
    fn is_leaf(&self, index: u32) -> bool {
        self.counts[index as usize] <= LANES as u32 || self.binary.nodes[index as usize].is_leaf()
    }

    /// At most four descendants that replace a binary node: the largest is opened first.
    fn children(&self, index: u32) -> Vec<u32> {
        if self.is_leaf(index) {
            return vec![index];
        }
        let below = |index: u32| {
            let first = self.binary.nodes[index as usize].first_index;
            [first, first + 1]
        };
        let mut children = below(index).to_vec();
        while children.len() < WIDTH {
            let area = |i: &usize| {
                let node = &self.binary.nodes[children[*i] as usize];
                node.aabb().half_area()
            };
            let largest = (0..children.len())
                .filter(|&i| !self.is_leaf(children[i]))
                .max_by(|i, j| area(i).total_cmp(&area(j)));
            let Some(largest) = largest else { break };
            let [left, right] = below(children[largest]);
            children[largest] = left;
            children.push(right);
        }
        children
    }

    /// Makes the leaf for a binary node.
    fn leaf(&mut self, index: u32) -> Child {
        let mut prims = Vec::with_capacity(LANES);
        let mut open = vec![index];
        while let Some(index) = open.pop() {
            let node = &self.binary.nodes[index as usize];
            if node.is_leaf() {
                prims.push(node.first_index);
            } else {
                open.extend([node.first_index, node.first_index + 1]);
            }
        }
        prims.sort_unstable();
        let first_sphere = self.tree.first_sphere;
        if prims[0] >= first_sphere {
            return Child::sphere((prims[0] - first_sphere) as usize);
        }
        let bounds = prims.iter().fold(Bounds3::EMPTY, |all, &prim| {
            all.union(&prim_bounds(self.mesh, &[], prim))
        });
        self.leaf_bounds.push(bounds);
        self.tree.blocks.push(block(self.mesh, &prims));
        Child::block(self.tree.blocks.len() - 1)
    }
}

/// Computes every box from the leaves up; children stand behind their parents.
fn fit_boxes(tree: &mut Tree, leaf_bounds: &[Bounds3]) {
    for index in (0..tree.nodes.len()).rev() {
        let mut node = tree.nodes[index];
        for slot in 0..WIDTH {
            let child = node.child(slot);
            let bounds = match (child.as_node(), child.as_block(), child.as_sphere()) {
                (Some(i), _, _) if i > index => tree.nodes[i].bounds(),
                (_, Some(i), _) => leaf_bounds[i],
                (_, _, Some(i)) => tree.spheres[i].bounds(),
                _ => continue,
            };
            node.set(slot, child, &bounds);
        }
        tree.nodes[index] = node;
    }
}
