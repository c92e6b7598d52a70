//! Interpolated gathers: the irradiance cache (Ward, Rubinstein and Clear 1988, *A Ray Tracing
//! Solution for Diffuse Interreflection*) with neighbour clamping (Křivánek et al. 2006, *Making
//! Radiance and Irradiance Caching Practical*, section 4).
//!
//! A record holds one value a class, so layers can be told apart after interpolation, and serves
//! Lambertian lobes only.

use std::collections::HashMap;

use glam::{IVec3, Vec3A};

use crate::engine::math::Rgb;
use crate::engine::path::ClassId;

/// Values by class: a list, since a point sees few classes.
pub type ClassSums = Vec<(ClassId, Rgb)>;

/// Adds to the value of a class.
#[inline]
pub fn add_to(sums: &mut ClassSums, class: ClassId, value: Rgb) {
    match sums.iter_mut().find(|(c, _)| *c == class) {
        Some((_, sum)) => *sum += value,
        None => sums.push((class, value)),
    }
}

/// What was gathered at one point.
#[derive(Clone, Debug)]
pub struct CacheRecord {
    /// Position.
    pub p: Vec3A,
    /// Shading normal on the side that was gathered.
    pub n: Vec3A,
    /// Harmonic mean distance of the surfaces around, clamped.
    pub radius: f32,
    /// Irradiance over π by class of the events before: the radiance of a white surface.
    pub values: ClassSums,
}

/// Bounds on the distance that a record serves, in scene units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CacheSettings {
    /// Ward's error bound a: a record serves up to about a · its radius.
    pub error: f32,
    /// Least radius: a corner has a bounded number of records.
    pub min_radius: f32,
    /// Largest radius.
    pub max_radius: f32,
}

/// The records of a scene.
#[derive(Clone, Debug)]
pub struct IrradianceCache {
    settings: CacheSettings,
    records: Vec<CacheRecord>,
    /// Records by cell of a grid whose cells are as wide as the spheres that the records serve,
    /// a grid for each power of two.
    cells: HashMap<(i32, IVec3), Vec<u32>>,
    levels: Vec<i32>,
}

impl IrradianceCache {
    /// Without records.
    pub fn new(settings: CacheSettings) -> Self {
        Self {
            settings,
            records: Vec::new(),
            cells: HashMap::new(),
            levels: Vec::new(),
        }
    }

    /// All records, in the order they were added.
    pub fn records(&self) -> &[CacheRecord] {
        &self.records
    }

    /// Distance up to which a record serves points of its own normal.
    pub fn reach(&self, record: &CacheRecord) -> f32 {
        self.settings.error * record.radius
    }

    /// Bytes of the records.
    pub fn memory_bytes(&self) -> usize {
        let values = |r: &CacheRecord| r.values.capacity() * size_of::<(ClassId, Rgb)>();
        size_of_val(self.records.as_slice()) + self.records.iter().map(values).sum::<usize>()
    }

    /// Mean of the records around, weighed by Ward's metric; false if none serves `p`.
    pub fn interpolate(&self, p: Vec3A, n: Vec3A, values: &mut ClassSums) -> bool {
        values.clear();
        let mut total = 0.0;
        self.visit(p, |record| {
            if let Some(w) = self.weight(record, p, n) {
                total += w;
                for &(class, value) in &record.values {
                    add_to(values, class, value * w);
                }
            }
        });
        for (_, value) in values.iter_mut() {
            *value = *value / total;
        }
        total > 0.0
    }

    /// Whether some record serves `p`.
    pub fn serves(&self, p: Vec3A, n: Vec3A) -> bool {
        let mut served = false;
        self.visit(p, |record| served |= self.weight(record, p, n).is_some());
        served
    }

    /// Adds a record. Its radius is clamped by its neighbours' and clamps theirs: a surface that a
    /// neighbour saw close by cannot be far.
    pub fn insert(&mut self, mut record: CacheRecord) {
        let s = self.settings;
        record.radius = record.radius.clamp(s.min_radius, s.max_radius);
        // All records: next to a gather, looking at them costs nothing.
        for neighbour in &self.records {
            let reach = neighbour.radius + neighbour.p.distance(record.p);
            record.radius = record.radius.min(reach);
        }
        for neighbour in &mut self.records {
            let reach = record.radius + neighbour.p.distance(record.p);
            neighbour.radius = neighbour.radius.min(reach);
        }
        let level = level_of(s.error * record.radius);
        if let Err(at) = self.levels.binary_search(&level) {
            self.levels.insert(at, level);
        }
        let key = (level, cell_of(record.p, level));
        self.cells
            .entry(key)
            .or_default()
            .push(self.records.len() as u32);
        self.records.push(record);
    }

    /// Ward's weight 1/(|p − pᵢ|/Rᵢ + √(1 − n·nᵢ)) beyond that at the border of what the record
    /// serves, so that records fade in and out.
    fn weight(&self, record: &CacheRecord, p: Vec3A, n: Vec3A) -> Option<f32> {
        let d = p - record.p;
        // A record before the surface does not see what the point sees (Ward 1988, section 3).
        let before = -d.dot(n + record.n) * 0.5;
        if before > 0.05 * record.radius {
            return None;
        }
        let turn = (1.0 - n.dot(record.n)).max(0.0).sqrt();
        let error = d.length() / record.radius + turn;
        let rest = self.settings.error - error;
        // 1/error − 1/a, finite at the record itself.
        (rest > 0.0).then(|| rest / (error + f32::EPSILON))
    }

    /// Every record whose sphere may hold `p`, in an order that does not depend on hashing.
    fn visit<'a>(&'a self, p: Vec3A, mut f: impl FnMut(&'a CacheRecord)) {
        for &level in &self.levels {
            let middle = cell_of(p, level);
            for step in 0..27 {
                let step = IVec3::new(step % 3, step / 3 % 3, step / 9) - IVec3::ONE;
                if let Some(records) = self.cells.get(&(level, middle + step)) {
                    records.iter().for_each(|&i| f(&self.records[i as usize]));
                }
            }
        }
    }
}

/// The grid whose cells are at least `reach` wide.
fn level_of(reach: f32) -> i32 {
    reach.log2().ceil() as i32
}

fn cell_of(p: Vec3A, level: i32) -> IVec3 {
    (p * (-level as f32).exp2()).floor().as_ivec3()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: CacheSettings = CacheSettings {
        error: 0.25,
        min_radius: 0.04,
        max_radius: 2.0,
    };

    fn record(p: Vec3A, n: Vec3A, radius: f32, value: f32) -> CacheRecord {
        CacheRecord {
            p,
            n,
            radius,
            values: vec![(ClassId::EMPTY, Rgb::splat(value))],
        }
    }

    /// Along a line towards a corner the harmonic distance falls to 0.
    #[test]
    fn a_corner_has_a_bounded_number_of_records() {
        let mut cache = IrradianceCache::new(SETTINGS);
        let points = 100_000;
        for i in 0..points {
            let p = Vec3A::X * (i as f32 / points as f32);
            if !cache.serves(p, Vec3A::Y) {
                cache.insert(record(p, Vec3A::Y, p.x, 1.0));
            }
        }
        // Two records stand at least a · the least radius apart.
        let most = 1.0 / (SETTINGS.error * SETTINGS.min_radius) + 1.0;
        let count = cache.records().len();
        assert!(count as f32 <= most && count > 10, "{count} of {most}");
        assert!(
            cache
                .records()
                .iter()
                .all(|r| r.radius >= SETTINGS.min_radius)
        );
    }

    #[test]
    fn means_are_weighed_by_class_and_fade_at_the_border() {
        let mut cache = IrradianceCache::new(SETTINGS);
        cache.insert(record(Vec3A::ZERO, Vec3A::Y, 1.0, 2.0));
        cache.insert(record(Vec3A::X * 0.2, Vec3A::Y, 1.0, 4.0));
        let mut values = ClassSums::new();
        let mut at = |x: f32, n: Vec3A| {
            let served = cache.interpolate(Vec3A::X * x, n, &mut values);
            served.then(|| values[0].1[0])
        };
        assert_eq!(at(0.1, Vec3A::Y), Some(3.0));
        let near = at(1e-6, Vec3A::Y).expect("a record");
        assert!((near - 2.0).abs() < 1e-3);
        // Beyond 0.25 of one record only the other is left; then none.
        assert_eq!(at(0.3, Vec3A::Y), Some(4.0));
        assert_eq!(at(0.5, Vec3A::Y), None);
        assert_eq!(at(0.1, Vec3A::X), None, "another normal");
        assert_eq!(at(-0.2, Vec3A::Y), Some(2.0));
    }

    #[test]
    fn neighbours_clamp_each_other() {
        let mut cache = IrradianceCache::new(SETTINGS);
        cache.insert(record(Vec3A::ZERO, Vec3A::Y, 2.0, 1.0));
        cache.insert(record(Vec3A::X * 0.3, Vec3A::Y, 0.1, 1.0));
        // The first saw nothing nearer than 2; the second shows that something is.
        assert!((cache.records()[0].radius - 0.4).abs() < 1e-6);
        cache.insert(record(Vec3A::X * 0.1, Vec3A::Y, 2.0, 1.0));
        assert!((cache.records()[2].radius - 0.3).abs() < 1e-6);
    }

    #[test]
    fn a_record_before_the_surface_does_not_serve() {
        let mut cache = IrradianceCache::new(SETTINGS);
        cache.insert(record(Vec3A::ZERO, Vec3A::Y, 2.0, 1.0));
        assert!(cache.serves(Vec3A::Y * 0.2, Vec3A::Y));
        assert!(!cache.serves(Vec3A::Y * -0.2, Vec3A::Y));
    }
}
