//! Light vertices to be merged with eye vertices (Georgiev, Křivánek, Davidovič and Slusallek 2012,
//! *Light Transport Simulation with Vertex Connection and Merging*), in a grid.
//!
//! Only vertices whose event is D have a merging strategy (rule 9 of the code map): others are stored
//! nowhere and count in no weight.

use glam::{IVec3, Vec3A};
use rayon::prelude::*;

use super::ends::LightEnd;
use super::subpath::{LightStart, Subpath};
use super::weight::Density;
use crate::engine::event::Event;
use crate::engine::integrators::Fact;
use crate::engine::math::Rgb;
use crate::engine::math::hash::combine;
use crate::engine::path::ClassId;

/// A vertex of a light walk where some event is diffuse.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Photon {
    /// Where.
    pub p: Vec3A,
    /// Unit direction that it came from.
    pub wo: Vec3A,
    /// Flux in W, of all light paths if each were alone.
    pub flux: Rgb,
    /// Class of the events before.
    pub class: ClassId,
    /// See [`Vertex`](super::vertex::Vertex).
    pub back: f32,
    /// Number of vertices of its path up to here, the light included.
    pub s: u32,
    /// Its path within the store.
    path: u32,
}

/// What the weights need of the light path of a photon.
#[derive(Clone, Copy, Debug)]
pub struct PhotonPath {
    /// Its light.
    pub end: LightEnd,
    /// See [`LightStart`].
    pub shadow_ratio: f32,
    /// Where its densities begin.
    first: u32,
}

/// The photons of one chunk of light paths.
#[derive(Clone, Debug, Default)]
pub struct PhotonList {
    photons: Vec<Photon>,
    paths: Vec<PhotonPath>,
    densities: Vec<Density>,
}

impl PhotonList {
    /// Stores the vertices of a light walk.
    pub fn store(&mut self, light: &Subpath, start: &LightStart) {
        let path = self.paths.len() as u32;
        let before = self.photons.len();
        for s in 2..=light.len() {
            let y = light.vertex(s - 1);
            if y.bsdf.has(Event::Diffuse) {
                self.photons.push(Photon {
                    p: y.si.p,
                    wo: y.si.wo,
                    flux: y.throughput,
                    class: y.class,
                    back: y.back,
                    s: s as u32,
                    path,
                });
            }
        }
        if self.photons.len() > before {
            self.paths.push(PhotonPath {
                end: start.end,
                shadow_ratio: start.shadow_ratio,
                first: self.densities.len() as u32,
            });
            self.densities
                .extend_from_slice(light.densities(light.len()));
        }
    }

    /// Number of photons.
    pub fn len(&self) -> usize {
        self.photons.len()
    }

    /// Whether none was stored.
    pub fn is_empty(&self) -> bool {
        self.photons.is_empty()
    }

    fn append(&mut self, other: &Self) {
        let (paths, densities) = (self.paths.len() as u32, self.densities.len() as u32);
        self.photons.extend(other.photons.iter().map(|p| Photon {
            path: p.path + paths,
            ..*p
        }));
        self.paths.extend(other.paths.iter().map(|p| PhotonPath {
            first: p.first + densities,
            ..*p
        }));
        self.densities.extend_from_slice(&other.densities);
    }
}

/// Photons that can be found by place.
#[derive(Debug)]
pub struct PhotonGrid {
    /// Photons sorted by bucket: those that are visited together lie together.
    list: PhotonList,
    /// Their places alone: a search reads many and needs few of the photons.
    places: Vec<Vec3A>,
    /// Photons of a bucket: from the entry of its number to the next.
    buckets: Vec<u32>,
    /// Radius of merging, m.
    pub radius: f32,
    /// Light paths that were traced, those that stored nothing included.
    pub paths: u64,
}

impl PhotonGrid {
    /// Sorts the photons of `lists`, in their order, which `paths` light paths left.
    pub fn new(lists: &[PhotonList], radius: f32, paths: u64) -> Self {
        let mut list = PhotonList::default();
        lists.iter().for_each(|l| list.append(l));
        // Twice as many as photons: most of a ball's cells are empty, and found so.
        let count = (2 * list.photons.len()).next_power_of_two();
        let cell = 2.0 * radius;
        let hashes: Vec<u32> = list
            .photons
            .par_iter()
            .map(|p| bucket(cell_of(p.p, cell), count))
            .collect();
        let mut buckets = vec![0; count + 1];
        for h in &hashes {
            buckets[*h as usize + 1] += 1;
        }
        for i in 0..count {
            buckets[i + 1] += buckets[i];
        }
        let mut next = buckets.clone();
        let mut order = vec![0_u32; hashes.len()];
        for (i, h) in hashes.iter().enumerate() {
            let slot = &mut next[*h as usize];
            order[*slot as usize] = i as u32;
            *slot += 1;
        }
        list.photons = order.iter().map(|i| list.photons[*i as usize]).collect();
        Self {
            places: list.photons.iter().map(|photon| photon.p).collect(),
            list,
            buckets,
            radius,
            paths,
        }
    }

    /// Area of merging times the number of light paths: what turns the density of a pair of walks
    /// into that of their merging.
    pub fn merging(&self) -> f64 {
        let r = f64::from(self.radius);
        std::f64::consts::PI * r * r * self.paths as f64
    }

    /// The light path of a photon, and the densities of its vertices up to it.
    pub fn path(&self, photon: &Photon) -> (&PhotonPath, &[Density]) {
        let path = &self.list.paths[photon.path as usize];
        let first = path.first as usize;
        (path, &self.list.densities[first..first + photon.s as usize])
    }

    /// Visits the photons within the radius around `p`.
    pub fn within(&self, p: Vec3A, mut visit: impl FnMut(&Photon)) {
        let (cell, r2) = (2.0 * self.radius, self.radius * self.radius);
        let count = self.buckets.len() - 1;
        // A ball of the radius meets two cells a side at most, of which the two along x are
        // neighbours here, too.
        let low = cell_of(p - Vec3A::splat(self.radius), cell);
        for i in 0..4 {
            let row = low.wrapping_add(IVec3::new(0, i & 1, i >> 1));
            let b = bucket(row, count) as usize;
            let (first, end) = (self.buckets[b], self.buckets[(b + 2).min(count)]);
            self.visit_row((first, end), row, p, r2, &mut visit);
            if b + 2 > count {
                self.visit_row((0, self.buckets[1]), row, p, r2, &mut visit);
            }
        }
    }

    /// Visits those of the photons `first` to `end` that lie near `p` and in the cell `row` or the
    /// next one along x: cells of the same bucket are told apart, or a photon would count twice.
    #[inline(always)]
    fn visit_row(
        &self,
        (first, end): (u32, u32),
        row: IVec3,
        p: Vec3A,
        r2: f32,
        visit: &mut impl FnMut(&Photon),
    ) {
        let range = first as usize..end as usize;
        for (i, &place) in self.places[range.clone()].iter().enumerate() {
            if place.distance_squared(p) < r2 {
                let cell = cell_of(place, 2.0 * self.radius);
                if (cell.y, cell.z) == (row.y, row.z) && cell.x.wrapping_sub(row.x) as u32 <= 1 {
                    visit(&self.list.photons[range.start + i]);
                }
            }
        }
    }

    /// What is stored, for the user to read.
    pub fn fact(&self) -> Fact {
        Fact {
            label: "photons of the last pass",
            value: format!(
                "{} of {} light paths, {:.1} MB, radius {:.3e}",
                self.list.photons.len(),
                self.paths,
                self.bytes() as f64 * 1e-6,
                self.radius
            ),
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.list.photons)
            + size_of_val(&*self.list.paths)
            + size_of_val(&*self.list.densities)
            + size_of_val(&*self.places)
            + size_of_val(&*self.buckets)
    }
}

fn cell_of(p: Vec3A, cell: f32) -> IVec3 {
    let c = (p / cell).floor();
    IVec3::new(c.x as i32, c.y as i32, c.z as i32)
}

/// Neighbours along x lie in neighbouring buckets.
fn bucket(cell: IVec3, count: usize) -> u32 {
    let row = combine(u64::from(cell.y as u32), u64::from(cell.z as u32)) as u32;
    row.wrapping_add(cell.x as u32) & (count - 1) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::sampling::{IndependentSampler, Sampler, Stream};

    #[test]
    fn the_grid_finds_each_photon_once() {
        let mut list = PhotonList::default();
        let mut s = IndependentSampler::new(1, Stream::Test, (0, 0));
        for i in 0..5000 {
            let p = Vec3A::new(s.next_1d(), s.next_1d(), 0.2 * s.next_1d()) - Vec3A::splat(0.5);
            list.photons.push(Photon {
                p,
                wo: Vec3A::Z,
                flux: Rgb::WHITE,
                class: ClassId::EMPTY,
                back: 0.0,
                s: i,
                path: 0,
            });
        }
        for radius in [0.003, 0.05, 0.4, 3.0] {
            let grid = PhotonGrid::new(std::slice::from_ref(&list), radius, 1);
            for _ in 0..50 {
                let p = Vec3A::new(s.next_1d(), s.next_1d(), 0.0) - Vec3A::splat(0.5);
                let mut found = Vec::new();
                grid.within(p, |photon| found.push(photon.s));
                found.sort_unstable();
                let near = |q: &&Photon| q.p.distance_squared(p) < radius * radius;
                let expected: Vec<u32> = list.photons.iter().filter(near).map(|q| q.s).collect();
                assert_eq!(found, expected);
            }
        }
    }
}
