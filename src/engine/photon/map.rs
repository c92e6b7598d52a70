//! A photon map: how many photons were emitted, what was stored, and the tree of it.

use rayon::prelude::*;

use super::emission::Emission;
use super::kdtree::{KdTree, SplitPlane, SplitRule};
use super::record::{FullPhoton, PackedPhoton, Photon, Record};
use super::trace::{MapKind, Roulette, Walks, Witness};
use crate::engine::geometry::{RayFault, SurfaceInteraction};
use crate::engine::math::{Fault, FaultCounts, Rgb};
use crate::engine::path::PathClasses;
use crate::engine::sampling::{IndependentSampler, SobolSampler, Stream};
use crate::engine::scene::Scene;

/// How a photon is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Packing {
    /// Jensen's twenty bytes.
    Packed,
    /// Full precision, forty bytes: for tests.
    Full,
}

/// Where the random numbers of photons come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Numbers {
    /// Independent numbers: n photons in a radius r mean a density of (n − 1)/(πr²), unbiased.
    Independent,
    /// Owen-scrambled Sobol points: photons keep a distance of each other. Far less noise where
    /// few events lie between light and landing; the density is then underestimated by up to half
    /// a photon in n.
    Sobol,
}

/// What a map is made from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapSettings {
    /// About so many photons are stored.
    pub photons: usize,
    /// How a photon is scattered.
    pub roulette: Roulette,
    /// How it is stored.
    pub packing: Packing,
    /// How the tree splits.
    pub split: SplitRule,
    /// Where its random numbers come from.
    pub numbers: Numbers,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Which of several independent maps it is.
    pub index: u64,
}

/// Levels of rays that are counted apart.
pub const LEVELS: usize = 16;

/// What the first pass did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MapCounts {
    /// Photons emitted.
    pub emitted: u64,
    /// Photons stored.
    pub stored: u64,
    /// Those among them that come straight from a light.
    pub direct: u64,
    /// Power of those stored, W: what arrives at diffuse surfaces, each arrival counted.
    pub power: [f64; 3],
    /// Rays traced.
    pub rays: u64,
    /// Those of the photons themselves by the number of events before them; the last counts all
    /// longer ones, too. The rest belongs to the pilot.
    pub levels: [u64; LEVELS],
    /// How often photons played roulette, and survived.
    pub roulette: [u64; 2],
    /// Paths cut at the largest number of events.
    pub cut: u64,
    /// Photons whose power is not finite, which are left out, or negative.
    pub faults: FaultCounts,
    /// Rays that met the surface that they left, and that slipped out of a closed one.
    pub strayed: [u64; 2],
    /// Number of the first photon with an error, and which of [`MapCounts::errors`].
    pub first_bad: Option<(u64, usize)>,
}

impl MapCounts {
    /// Errors: not a number, infinite, negative, self-hits, missed edges, cut paths.
    pub fn errors(&self) -> [u64; 6] {
        let (f, [hits, edges]) = (self.faults, self.strayed);
        [f.nan, f.infinite, f.negative, hits, edges, self.cut]
    }

    fn add(&mut self, o: &Self) {
        self.emitted += o.emitted;
        self.stored += o.stored;
        self.direct += o.direct;
        (0..3).for_each(|c| self.power[c] += o.power[c]);
        self.rays += o.rays;
        (0..LEVELS).for_each(|i| self.levels[i] += o.levels[i]);
        (0..2).for_each(|i| self.roulette[i] += o.roulette[i]);
        self.cut += o.cut;
        self.faults += o.faults;
        (0..2).for_each(|i| self.strayed[i] += o.strayed[i]);
        self.first_bad = self.first_bad.or(o.first_bad);
    }
}

/// A map.
#[derive(Clone, Debug)]
pub struct PhotonMap {
    /// Which prefixes it holds.
    pub kind: MapKind,
    /// What the first pass did.
    pub counts: MapCounts,
    /// Watts of one unit of stored power.
    pub unit: f32,
    /// The photons.
    pub tree: Tree,
}

/// The photons by kind of record.
#[derive(Clone, Debug)]
pub enum Tree {
    /// Twenty bytes a photon.
    Packed(KdTree<PackedPhoton>),
    /// Full precision.
    Full(KdTree<FullPhoton>),
}

/// Photon paths of one piece of work.
const CHUNK: u64 = 4096;
/// Pieces of work between two looks at the number of photons stored.
const ROUND: u64 = 32;
/// Photon paths that measure how many photons a path stores.
const PILOT: u64 = 4 * CHUNK;
/// Most paths per photon wanted: where next to nothing is stored, the map stays small.
const MAX_PATHS_A_PHOTON: u64 = 32;

impl PhotonMap {
    /// Traces and sorts the photons of one map. `check` is asked once a piece of work.
    ///
    /// # Errors
    /// What `check` returns.
    pub fn build<E: Send>(
        scene: &Scene,
        classes: &PathClasses,
        kind: MapKind,
        emission: &Emission,
        settings: &MapSettings,
        check: &(impl Fn() -> Result<(), E> + Sync),
    ) -> Result<Self, E> {
        let walks = Walks {
            scene,
            classes,
            kind,
            roulette: settings.roulette,
            emission,
        };
        let unit = power_unit(scene, settings.photons);
        let (tree, counts) = match settings.packing {
            Packing::Packed => {
                let (photons, counts) = trace_photons(&walks, settings, check)?;
                (Tree::Packed(KdTree::build(photons, settings.split)), counts)
            }
            Packing::Full => {
                let (photons, counts) = trace_photons(&walks, settings, check)?;
                (Tree::Full(KdTree::build(photons, settings.split)), counts)
            }
        };
        check()?;
        Ok(Self {
            kind,
            counts,
            unit,
            tree,
        })
    }

    /// Number of photons.
    pub fn len(&self) -> usize {
        match &self.tree {
            Tree::Packed(tree) => tree.nodes().len(),
            Tree::Full(tree) => tree.nodes().len(),
        }
    }

    /// Whether nothing was stored.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bytes of the tree.
    pub fn memory_bytes(&self) -> usize {
        match &self.tree {
            Tree::Packed(tree) => tree.memory_bytes(),
            Tree::Full(tree) => tree.memory_bytes(),
        }
    }

    /// The photon at `index` of the tree.
    pub fn photon(&self, index: usize) -> Photon {
        match &self.tree {
            Tree::Packed(tree) => tree.nodes()[index].photon(self.unit),
            Tree::Full(tree) => tree.nodes()[index].photon(self.unit),
        }
    }

    /// All photons, in the order of the tree.
    pub fn photons(&self) -> impl ExactSizeIterator<Item = Photon> + '_ {
        (0..self.len()).map(|i| self.photon(i))
    }

    /// The planes that split the box `lo`…`hi`, down to `depth` levels below the root.
    pub fn planes(&self, lo: [f32; 3], hi: [f32; 3], depth: u32) -> Vec<SplitPlane> {
        match &self.tree {
            Tree::Packed(tree) => tree.planes(lo, hi, depth),
            Tree::Full(tree) => tree.planes(lo, hi, depth),
        }
    }
}

/// A power of two near the power of one photon: stored powers are near 1 in any scene.
fn power_unit(scene: &Scene, photons: usize) -> f32 {
    let mean = f64::from(scene.lights.power().mean()) / photons.max(1) as f64;
    let exponent = if mean > 0.0 && mean.is_finite() {
        mean.log2().round()
    } else {
        0.0
    };
    exponent.clamp(-100.0, 100.0).exp2() as f32
}

/// The photons of one piece of work.
struct Chunk<T> {
    photons: Vec<T>,
    counts: MapCounts,
    unit: f32,
}

impl<T> Chunk<T> {
    fn new(unit: f32) -> Self {
        Self {
            photons: Vec::new(),
            counts: MapCounts::default(),
            unit,
        }
    }
}

impl<T: Record> Witness for Chunk<T> {
    fn stored(&mut self, photon: Photon, si: &SurfaceInteraction, u: f32) {
        if matches!(
            self.counts.faults.look_at(photon.power),
            Some(Fault::Nan | Fault::Infinite)
        ) {
            return; // left out
        }
        self.counts.stored += 1;
        self.counts.direct += u64::from(photon.events == 0);
        let power: Rgb = photon.power;
        (0..3).for_each(|c| self.counts.power[c] += f64::from(power[c]));
        self.photons.push(T::pack(&photon, si.n_g, self.unit, u));
    }

    fn survived(&mut self, _: f32, power: Option<Rgb>) {
        self.counts.roulette[0] += 1;
        self.counts.roulette[1] += u64::from(power.is_some());
    }

    fn strayed(&mut self, fault: RayFault) {
        self.counts.strayed[usize::from(fault == RayFault::MissedEdge)] += 1;
    }

    fn cut(&mut self) {
        self.counts.cut += 1;
    }
}

/// Follows photon `number` of a map, or of the pilot that counts how many a map needs. Returns
/// the number of rays.
pub(super) fn follow(
    walks: &Walks<'_>,
    settings: &MapSettings,
    (pilot, number): (bool, u64),
    share: f32,
    to: &mut impl Witness,
) -> u64 {
    let kind = match walks.kind {
        MapKind::Global => 0,
        MapKind::Caustic => 1,
        // Apart from all numbers of the other two.
        MapKind::Volume => 1 << 40,
    };
    let item = (settings.index * 2 + kind) * 2 + u64::from(pilot);
    let index = (item, number);
    match settings.numbers {
        Numbers::Independent => {
            let mut sampler = IndependentSampler::new(settings.seed, Stream::Light, index);
            walks.follow(share, &mut sampler, to)
        }
        Numbers::Sobol => {
            let mut sampler = SobolSampler::new(settings.seed, Stream::Light, index);
            walks.follow(share, &mut sampler, to)
        }
    }
}

/// Emits as many photons as it takes to store about the number wanted. How many is told by a
/// pilot of other random numbers, so that the number does not depend on the photons themselves:
/// the estimate stays unbiased.
///
/// # Errors
/// What `check` returns; it is asked once a piece of work.
pub fn trace_photons<T: Record, E: Send>(
    walks: &Walks<'_>,
    settings: &MapSettings,
    check: &(impl Fn() -> Result<(), E> + Sync),
) -> Result<(Vec<T>, MapCounts), E> {
    let unit = power_unit(walks.scene, settings.photons);
    let wanted = settings.photons as u64;
    let run = |pilot, range: std::ops::Range<u64>, end: u64, share| {
        let pieces: Result<Vec<Chunk<T>>, E> = range
            .into_par_iter()
            .map(|i| {
                check()?;
                let mut chunk = Chunk::new(unit);
                for path in i * CHUNK..((i + 1) * CHUNK).min(end) {
                    let number = (pilot, path);
                    let before = chunk.counts.errors();
                    let rays = follow(walks, settings, number, share, &mut chunk);
                    let after = chunk.counts.errors();
                    if let Some(what) = (0..after.len()).find(|i| after[*i] != before[*i]) {
                        chunk.counts.first_bad.get_or_insert((path, what));
                    }
                    chunk.counts.rays += rays;
                    // A photon has a ray before each of its events, and one after the last.
                    for level in 0..rays {
                        chunk.counts.levels[(level as usize).min(LEVELS - 1)] += 1;
                    }
                    chunk.counts.emitted += 1;
                }
                Ok(chunk)
            })
            .collect();
        pieces
    };
    let pilot = run(true, 0..PILOT / CHUNK, PILOT, 1.0)?;
    let stored: u64 = pilot.iter().map(|c| c.counts.stored).sum();
    let rays: u64 = pilot.iter().map(|c| c.counts.rays).sum();
    let paths = (wanted * PILOT / stored.max(1)).clamp(1, wanted * MAX_PATHS_A_PHOTON);

    let mut counts = MapCounts {
        rays,
        ..MapCounts::default()
    };
    // Room for a little more than expected: the vector must not grow by copying.
    let expected = (stored * paths / PILOT).min(wanted);
    let room = expected + 4 * expected.isqrt() + expected / 100;
    let mut photons = Vec::with_capacity(room as usize);
    let share = (1.0 / paths as f64) as f32;
    let chunks = paths.div_ceil(CHUNK);
    let mut next = 0;
    while next < chunks {
        let end = (next + ROUND).min(chunks);
        for piece in run(false, next..end, paths, share)? {
            counts.add(&piece.counts);
            photons.extend_from_slice(&piece.photons);
        }
        next = end;
    }
    Ok((photons, counts))
}
