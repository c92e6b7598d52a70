//! `locate_photons`: the n photons nearest to a point, with a bounded max-heap (Jensen 2001,
//! section 7.2.2).

use glam::Vec3A;

use super::kdtree::KdTree;
use super::record::Record;

/// Levels of a tree with as many photons as a `u32` counts.
const MAX_LEVELS: usize = 33;

/// The nearest photons found so far. It is made once and used for many queries: none of them
/// allocates.
#[derive(Clone, Debug)]
pub struct Nearest {
    n: usize,
    /// Squared distance in the upper half (the bits of non-negative floats sort as they do), index
    /// of the photon in the lower; a max-heap once there are `n`.
    keys: Vec<u64>,
    /// Photons at this squared distance or farther are of no interest.
    r2: f32,
}

impl Nearest {
    /// Room for `n` photons, at least one.
    pub fn new(n: usize) -> Self {
        let n = n.max(1);
        Self {
            n,
            keys: Vec::with_capacity(n),
            r2: f32::INFINITY,
        }
    }

    /// Forgets the last query; the next one looks within the squared distance `r2`.
    #[inline]
    pub fn begin(&mut self, r2: f32) {
        self.keys.clear();
        self.r2 = r2;
    }

    /// Whether as many photons as wanted were found: only then the radius shrinks.
    #[inline]
    pub fn is_full(&self) -> bool {
        self.keys.len() == self.n
    }

    /// Squared radius of the search: the farthest photon's squared distance once there are `n`.
    #[inline]
    pub fn r2(&self) -> f32 {
        self.r2
    }

    /// Squared distances and indices of what was found; once full, the farthest one comes first.
    #[inline]
    pub fn found(&self) -> impl ExactSizeIterator<Item = (f32, usize)> + '_ {
        self.keys
            .iter()
            .map(|&key| (distance(key), (key as u32) as usize))
    }

    #[inline]
    fn push(&mut self, d2: f32, index: usize) {
        let key = u64::from(d2.to_bits()) << 32 | index as u64;
        if self.keys.len() < self.n {
            self.keys.push(key);
            if self.keys.len() == self.n {
                for i in (0..self.n / 2).rev() {
                    self.sift(i);
                }
                self.r2 = self.r2.min(distance(self.keys[0]));
            }
        } else {
            self.keys[0] = key;
            self.sift(0);
            self.r2 = distance(self.keys[0]);
        }
    }

    /// Lets key `i` sink to where its children are smaller.
    #[inline]
    fn sift(&mut self, mut i: usize) {
        let keys = self.keys.as_mut_slice();
        let key = keys[i];
        loop {
            let mut child = 2 * i + 1;
            if child >= keys.len() {
                break;
            }
            if child + 1 < keys.len() && keys[child + 1] > keys[child] {
                child += 1;
            }
            if keys[child] <= key {
                break;
            }
            keys[i] = keys[child];
            i = child;
        }
        keys[i] = key;
    }
}

#[inline]
fn distance(key: u64) -> f32 {
    f32::from_bits((key >> 32) as u32)
}

/// A split whose photon and far side are still to be looked at.
#[derive(Clone, Copy, Default)]
struct Open {
    /// The child across the split.
    far: usize,
    /// Distance from the query to that child's region along each axis.
    offset: Vec3A,
    d2: f32,
}

impl<T: Record> KdTree<T> {
    /// Finds the photons nearest to `p` that `metric` accepts. It is given a photon, the vector to
    /// it and its squared length, and returns a squared distance that is no smaller, or `None` for
    /// a photon that must not count.
    ///
    /// Exact: rounding is monotone, so no bound of a subtree exceeds the distance of a photon in
    /// it. Of photons equally far any may be taken.
    #[inline]
    pub fn locate_photons(
        &self,
        p: Vec3A,
        nearest: &mut Nearest,
        metric: impl Fn(&T, Vec3A, f32) -> Option<f32>,
    ) {
        let nodes = self.nodes();
        let query = p.to_array();
        let mut stack = [Open::default(); MAX_LEVELS];
        let mut height = 0;
        let (mut node, mut offset) = (1, Vec3A::ZERO);
        let look = |photon: &T, node: usize, nearest: &mut Nearest| {
            let d = Vec3A::from_array(*photon.position()) - p;
            let d2 = d.length_squared();
            if d2 < nearest.r2
                && let Some(d2) = metric(photon, d, d2)
                && d2 < nearest.r2
            {
                nearest.push(d2, node - 1);
            }
        };
        loop {
            // Down to a leaf, always to the side of the query first.
            while let Some(photon) = nodes.get(node - 1) {
                if 2 * node > nodes.len() {
                    look(photon, node, nearest);
                    break;
                }
                let axis = photon.axis();
                let beyond = query[axis] - photon.position()[axis];
                let near = 2 * node + usize::from(beyond > 0.0);
                let mut across = offset;
                across[axis] = beyond;
                stack[height] = Open {
                    far: near ^ 1,
                    offset: across,
                    d2: across.length_squared(),
                };
                height += 1;
                node = near;
            }
            // Back to the last split that something nearer may lie beyond; the photon that splits
            // lies there, too.
            loop {
                if height == 0 {
                    return;
                }
                height -= 1;
                if stack[height].d2 < nearest.r2 {
                    break;
                }
            }
            (node, offset) = (stack[height].far, stack[height].offset);
            if let Some(photon) = nodes.get(node / 2 - 1) {
                look(photon, node / 2, nearest);
            }
        }
    }
}
