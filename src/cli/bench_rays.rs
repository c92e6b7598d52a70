//! Ray throughput on one mesh, for comparison with other ray tracers that shoot the same rays.

use std::time::Instant;

use cpu_time::ThreadTime;
use glam::{Vec3, Vec3A};

use crate::engine::geometry::{Geometry, MeshInput, Ray};

/// A file of rays: coherent ones from a camera, and bounces from where those hit.
#[derive(Clone, Debug, Default)]
pub struct RayFile {
    /// Rays of a camera, row by row.
    pub primary: Vec<Ray>,
    /// Rays in random order.
    pub bounce: Vec<Ray>,
}

/// Parses two little-endian `u32` counts (primary, bounce), then rays of six little-endian `f32`
/// (origin, unit direction). The error says what is wrong.
pub fn parse_rays(bytes: &[u8]) -> Result<RayFile, String> {
    const RAY: usize = 24;
    let Some((counts, rays)) = bytes.split_at_checked(8) else {
        return Err(format!("{} bytes are too few for two counts", bytes.len()));
    };
    let count = |i: usize| {
        let four = [counts[i], counts[i + 1], counts[i + 2], counts[i + 3]];
        u32::from_le_bytes(four) as usize
    };
    let (primary, bounce) = (count(0), count(4));
    if rays.len() != (primary + bounce) * RAY {
        return Err(format!(
            "{primary} + {bounce} rays take {} bytes, not {}",
            (primary + bounce) * RAY,
            rays.len()
        ));
    }
    let mut all = rays.chunks_exact(RAY).map(|ray| {
        let mut values = [0.0; 6];
        for (value, bytes) in values.iter_mut().zip(ray.as_chunks::<4>().0) {
            *value = f32::from_le_bytes(*bytes);
        }
        let [ox, oy, oz, dx, dy, dz] = values;
        Ray::new(Vec3A::new(ox, oy, oz), Vec3A::new(dx, dy, dz))
    });
    Ok(RayFile {
        primary: all.by_ref().take(primary).collect(),
        bounce: all.collect(),
    })
}

/// What shooting a set of rays gave.
#[derive(Clone, Copy, Debug, Default)]
pub struct Throughput {
    /// Closest-hit queries, in millions a second of one thread.
    pub mrays_per_second: f64,
    /// The same for occlusion queries without end.
    pub mrays_per_second_occluded: f64,
    /// Rays that hit something.
    pub hits: usize,
    /// Sum of the distances of all hits: equal work gives an equal sum.
    pub sum_t: f64,
}

/// Figures of one mesh.
#[derive(Clone, Copy, Debug, Default)]
pub struct RayReport {
    /// Triangles that can be hit.
    pub triangles: usize,
    /// Seconds to prepare the mesh for rays.
    pub build_seconds: f64,
    /// Bytes held for shading and traversal.
    pub memory_bytes: usize,
    /// The camera's rays.
    pub primary: Throughput,
    /// The bounces.
    pub bounce: Throughput,
}

/// Shoots `rays` at a mesh, one at a time, on this thread; the best of `repeats`.
pub fn bench_rays(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    rays: &RayFile,
    repeats: usize,
) -> RayReport {
    let start = Instant::now();
    let mesh = MeshInput {
        positions,
        triangles,
        ..MeshInput::default()
    };
    let (geometry, _) = Geometry::build(&[mesh], &[]);
    RayReport {
        triangles: geometry.triangle_count(),
        build_seconds: start.elapsed().as_secs_f64(),
        memory_bytes: geometry.memory_bytes(),
        primary: shoot(&geometry, &rays.primary, repeats),
        bounce: shoot(&geometry, &rays.bounce, repeats),
    }
}

fn shoot(geometry: &Geometry, rays: &[Ray], repeats: usize) -> Throughput {
    let mut best = Throughput::default();
    for _ in 0..repeats.max(1) {
        let (mut hits, mut sum_t) = (0, 0.0);
        let start = ThreadTime::now();
        for hit in rays.iter().filter_map(|ray| geometry.intersect(ray)) {
            hits += 1;
            sum_t += f64::from(hit.t);
        }
        let rate = mrays(rays.len(), start);
        let start = ThreadTime::now();
        let occluded = rays.iter().filter(|ray| geometry.occluded(ray)).count();
        let rate_occluded = mrays(rays.len(), start);
        debug_assert_eq!(occluded, hits);
        best = Throughput {
            mrays_per_second: best.mrays_per_second.max(rate),
            mrays_per_second_occluded: best.mrays_per_second_occluded.max(rate_occluded),
            hits,
            // An occlusion query that disagrees shows as a sum that is no number.
            sum_t: if occluded == hits { sum_t } else { f64::NAN },
        };
    }
    best
}

/// Per second of this thread's own time: other work on the machine does not count.
fn mrays(count: usize, start: ThreadTime) -> f64 {
    count as f64 * 1e-6 / start.elapsed().as_secs_f64().max(1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(rays: &[[f32; 6]], primary: u32) -> Vec<u8> {
        let counts = [primary, rays.len() as u32 - primary];
        let mut bytes: Vec<u8> = counts.iter().flat_map(|c| c.to_le_bytes()).collect();
        bytes.extend(rays.iter().flatten().flat_map(|x| x.to_le_bytes()));
        bytes
    }

    #[test]
    fn sums_the_distances_of_the_rays_in_a_file() {
        let down = [0.2, 0.2, 3.0, 0.0, 0.0, -1.0];
        let up = [0.2, 0.2, 3.0, 0.0, 0.0, 1.0];
        let nearer = [0.1, 0.1, 1.5, 0.0, 0.0, -1.0];
        let rays = parse_rays(&file(&[down, up, nearer], 2)).unwrap();
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let report = bench_rays(&corners, &[[0, 1, 2]], &rays, 2);
        assert_eq!(report.triangles, 1);
        assert_eq!((report.primary.hits, report.primary.sum_t), (1, 3.0));
        assert_eq!((report.bounce.hits, report.bounce.sum_t), (1, 1.5));
    }

    #[test]
    fn a_file_cut_short_is_refused() {
        let bytes = file(&[[0.0; 6]], 1);
        assert!(parse_rays(&bytes).is_ok());
        assert!(parse_rays(&bytes[..bytes.len() - 1]).is_err());
        assert!(parse_rays(&bytes[..5]).is_err());
    }
}
