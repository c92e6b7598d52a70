//! A left-balanced kd-tree of photons, linear in memory: the root is photon 1, the children of
//! photon p are 2p and 2p + 1 (Jensen 2001, section 6.2 and appendix B).
//!
//! The build sorts in place: medians first, which leaves the tree in order, then one permutation
//! from in-order to level order. It needs one bit a photon beside the photons.

use super::record::Record;

/// How the axis of a split is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SplitRule {
    /// Along the longest side of the box that is left.
    Widest,
    /// x, y, z, x, … by depth.
    Cyclic,
}

/// Parts smaller than this are not worth a thread of their own.
const PARALLEL: usize = 8192;

/// The tree.
///
/// Invariant: along a photon's axis no photon of its left subtree lies above it and none of its
/// right subtree below it.
#[derive(Clone, Debug)]
pub struct KdTree<T> {
    nodes: Vec<T>,
}

impl<T: Record> KdTree<T> {
    /// Sorts the photons into a tree; the result does not depend on the number of threads.
    pub fn build(mut photons: Vec<T>, rule: SplitRule) -> Self {
        let (mut lo, mut hi) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for photon in &photons {
            for axis in 0..3 {
                lo[axis] = lo[axis].min(photon.position()[axis]);
                hi[axis] = hi[axis].max(photon.position()[axis]);
            }
        }
        sort(&mut photons, lo, hi, rule, 0);
        permute(&mut photons);
        Self { nodes: photons }
    }

    /// The photons: number p of the tree stands at index p − 1.
    #[inline]
    pub fn nodes(&self) -> &[T] {
        &self.nodes
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice())
    }

    /// Planes that split the box `lo`…`hi`, down to `depth` levels below the root: axis, position
    /// and the box that each splits.
    pub fn planes(&self, lo: [f32; 3], hi: [f32; 3], depth: u32) -> Vec<SplitPlane> {
        let mut planes = Vec::new();
        let mut open = vec![(1, lo, hi, 0)];
        while let Some((p, lo, hi, level)) = open.pop() {
            let Some(node) = self.nodes.get(p - 1).filter(|_| level <= depth) else {
                continue;
            };
            let (axis, at) = (node.axis(), node.position()[node.axis()]);
            if 2 * p > self.nodes.len() {
                continue; // a leaf splits nothing
            }
            planes.push(SplitPlane { axis, at, lo, hi });
            let (mut upper, mut lower) = (lo, hi);
            upper[axis] = at;
            lower[axis] = at;
            open.push((2 * p + 1, upper, hi, level + 1));
            open.push((2 * p, lo, lower, level + 1));
        }
        planes
    }
}

/// A splitting plane for display.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplitPlane {
    /// Its normal's axis.
    pub axis: usize,
    /// Its position on that axis.
    pub at: f32,
    /// Lower corner of the box that it splits.
    pub lo: [f32; 3],
    /// Upper corner.
    pub hi: [f32; 3],
}

/// Photons in the left subtree of a left-balanced tree of `n` > 0 photons.
fn left_size(n: usize) -> usize {
    let levels = n.ilog2();
    if levels == 0 {
        return 0;
    }
    // Half of the last level belongs to the left; the levels above it are full.
    let half = 1 << (levels - 1);
    let last = n - (2 * half - 1);
    half - 1 + last.min(half)
}

/// Puts the median of each part in its place and sets its axis.
fn sort<T: Record>(part: &mut [T], lo: [f32; 3], hi: [f32; 3], rule: SplitRule, depth: usize) {
    if part.is_empty() {
        return;
    }
    let axis = match rule {
        SplitRule::Cyclic => depth % 3,
        SplitRule::Widest => widest(lo, hi),
    };
    let middle = left_size(part.len());
    if part.len() > 1 {
        let along = |a: &T, b: &T| a.position()[axis].total_cmp(&b.position()[axis]);
        part.select_nth_unstable_by(middle, along);
    }
    part[middle].set_axis(axis);
    let at = part[middle].position()[axis];
    let (mut upper, mut lower) = (lo, hi);
    upper[axis] = at;
    lower[axis] = at;
    let parallel = part.len() > PARALLEL;
    let (left, right) = part.split_at_mut(middle);
    let mut left = || sort(left, lo, lower, rule, depth + 1);
    let mut right = || sort(&mut right[1..], upper, hi, rule, depth + 1);
    if parallel {
        rayon::join(left, right);
    } else {
        left();
        right();
    }
}

fn widest(lo: [f32; 3], hi: [f32; 3]) -> usize {
    let extent = [hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]];
    if extent[0] >= extent[1] && extent[0] >= extent[2] {
        0
    } else if extent[1] >= extent[2] {
        1
    } else {
        2
    }
}

/// Position in order of photon `p` (1-based, in level order) of a left-balanced tree of `n`.
fn rank(p: usize, n: usize) -> usize {
    let (height, depth) = (n.ilog2(), p.ilog2());
    // In a perfect tree of the same height …
    let perfect = (2 * (p - (1 << depth)) + 1) * (1 << (height - depth)) - 1;
    // … whose last level lacks the leaves from `leaves` on, which stand at every second place.
    let leaves = n + 1 - (1 << height);
    perfect - perfect.saturating_sub(2 * leaves).div_ceil(2)
}

/// From order to level order, in place, cycle by cycle.
fn permute<T: Copy>(photons: &mut [T]) {
    let n = photons.len();
    let mut done = vec![0_u64; n.div_ceil(64)];
    for start in 0..n {
        if done[start / 64] & (1 << (start % 64)) != 0 {
            continue;
        }
        let first = photons[start];
        let mut to = start;
        loop {
            done[to / 64] |= 1 << (to % 64);
            let from = rank(to + 1, n);
            if from == start {
                photons[to] = first;
                break;
            }
            photons[to] = photons[from];
            to = from;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_are_those_of_a_walk_in_order() {
        fn walk(p: usize, n: usize, order: &mut Vec<usize>) {
            if p <= n {
                walk(2 * p, n, order);
                order.push(p);
                walk(2 * p + 1, n, order);
            }
        }
        for n in 1..200 {
            let mut order = Vec::new();
            walk(1, n, &mut order);
            for (position, p) in order.iter().enumerate() {
                assert_eq!(rank(*p, n), position, "photon {p} of {n}");
            }
            assert_eq!(order.iter().position(|p| *p == 1), Some(left_size(n)));
            let mut sorted: Vec<usize> = (0..n).collect();
            permute(&mut sorted);
            for (i, in_order) in sorted.iter().enumerate() {
                assert_eq!(order[*in_order], i + 1);
            }
        }
    }
}
