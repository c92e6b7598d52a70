//! Smoke of the embedded scenes, written as a density file when it is read: a plume in a turbulent,
//! divergence-free wind (Bridson, Hourihan and Nordenstam 2007, *Curl-Noise for Procedural Fluid
//! Flow*).
//!
//! The smoke at a place and a moment is what the wind brought there: the place is followed against
//! the wind until it meets the source. No frame depends on another.

use std::fmt::Write;

use glam::{IVec3, Vec3};
use rayon::prelude::*;

use crate::engine::math::hash::{combine, unit_f32};

/// Voxels a side.
const SIZE: usize = 96;
/// Nodes a side of the grid that holds the wind.
const WIND: usize = 40;
/// Steps back in time, and the length of one in seconds.
const STEPS: usize = 56;
const STEP: f32 = 0.05;
/// Seconds between two frames.
const FRAME: f32 = 1.0 / 24.0;
/// Speed of the rising air in cubes a second.
const RISE: f32 = 0.42;
/// Centre and radius of the source.
const SOURCE: Vec3 = Vec3::new(0.5, 0.07, 0.5);
const SOURCE_RADIUS: f32 = 0.085;

/// The density file of that name, if it is `smoke-N.txt`, frame N of the plume.
pub fn density(name: &str) -> Option<String> {
    let frame: u32 = name
        .strip_prefix("smoke-")?
        .strip_suffix(".txt")?
        .parse()
        .ok()?;
    let wind = Wind::new(frame as f32 * FRAME);
    let slices: Vec<String> = (0..SIZE).into_par_iter().map(|k| slice(&wind, k)).collect();
    Some(format!("{SIZE} {SIZE} {SIZE}\n{}", slices.concat()))
}

/// The densities of one z, a line a row.
fn slice(wind: &Wind, k: usize) -> String {
    let mut text = String::new();
    for j in 0..SIZE {
        for i in 0..SIZE {
            let at = |n: usize| (n as f32 + 0.5) / SIZE as f32;
            let density = smoke(wind, Vec3::new(at(i), at(j), at(k)));
            // Writing to a string cannot fail.
            let _ = match density {
                d if d < 0.005 => write!(text, "0 "),
                d => write!(text, "{d:.2} "),
            };
        }
        text.push('\n');
    }
    text
}

/// What is left of the source's smoke at `p`.
fn smoke(wind: &Wind, p: Vec3) -> f32 {
    let mut x = p;
    let mut most = 0.0_f32;
    for step in 0..STEPS {
        let to = (x - SOURCE) / Vec3::new(1.0, 0.5, 1.0);
        let strength = 1.0 - to.length() / SOURCE_RADIUS;
        if strength > 0.0 {
            // It thins as it ages.
            let age = step as f32 / STEPS as f32;
            most = most.max(strength.min(0.5) * 2.0 * (1.0 - age * age));
        }
        if x.y < SOURCE.y - SOURCE_RADIUS {
            break;
        }
        x -= wind.at(x) * STEP;
    }
    most
}

/// Velocities on the nodes of a grid over the unit cube.
struct Wind {
    nodes: Vec<Vec3>,
}

impl Wind {
    fn new(time: f32) -> Self {
        let node = |i: usize| {
            let at = |n: usize| n as f32 / (WIND - 1) as f32;
            let p = Vec3::new(at(i % WIND), at(i / WIND % WIND), at(i / WIND / WIND));
            curl(p, time) + Vec3::Y * RISE
        };
        let nodes = (0..WIND.pow(3)).into_par_iter().map(node).collect();
        Self { nodes }
    }

    /// The velocity at `p`, trilinear.
    fn at(&self, p: Vec3) -> Vec3 {
        let x = (p * (WIND - 1) as f32).clamp(Vec3::ZERO, Vec3::splat(WIND as f32 - 1.001));
        let (low, f) = (x.floor().as_usizevec3(), x.fract());
        let node = |dx: usize, dy: usize, dz: usize| {
            self.nodes[((low.z + dz) * WIND + low.y + dy) * WIND + low.x + dx]
        };
        let row = |dy: usize, dz: usize| node(0, dy, dz).lerp(node(1, dy, dz), f.x);
        let plane = |dz: usize| row(0, dz).lerp(row(1, dz), f.y);
        plane(0).lerp(plane(1), f.z)
    }
}

/// The curl of three noises: a velocity without sources.
fn curl(p: Vec3, time: f32) -> Vec3 {
    let h = 0.01;
    let potential = |p: Vec3| {
        // Calm at the source, wilder as it rises; eddies rise with the air.
        let strength = 0.05 * (p.y * 2.0).min(1.0);
        let moved = p - Vec3::Y * (RISE * 0.7 * time);
        let channel = |c: u64| {
            let offset = Vec3::splat(17.3 * c as f32);
            noise(moved * 4.0 + offset, c) + 0.4 * noise(moved * 9.0 + offset, c + 3)
        };
        strength * Vec3::new(channel(0), channel(1), channel(2))
    };
    let along = |axis: Vec3| (potential(p + axis * h) - potential(p - axis * h)) / (2.0 * h);
    let (dx, dy, dz) = (along(Vec3::X), along(Vec3::Y), along(Vec3::Z));
    Vec3::new(dy.z - dz.y, dz.x - dx.z, dx.y - dy.x)
}

/// Gradient noise in about [−1, 1] (Perlin 2002, *Improving Noise*).
fn noise(p: Vec3, seed: u64) -> f32 {
    let cell = p.floor();
    let f = p - cell;
    let corner = |i: i32| {
        let d = IVec3::new(i & 1, i >> 1 & 1, i >> 2);
        let place = (cell.as_ivec3() + d).to_array();
        let key = place.iter().fold(seed, |h, x| combine(h, *x as u64));
        let unit = |n: u64| 2.0 * unit_f32(combine(key, n)) - 1.0;
        Vec3::new(unit(0), unit(1), unit(2)).dot(f - d.as_vec3())
    };
    let fade = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let row = |i: i32| mix(corner(i), corner(i + 1), fade.x);
    let plane = |i: i32| mix(row(i), row(i + 2), fade.y);
    mix(plane(0), plane(4), fade.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smoke_is_the_same_each_time_moves_and_stays_within_its_cube() {
        let read = |frame: u32| -> Vec<f32> {
            let text = density(&format!("smoke-{frame}.txt")).expect("a frame");
            let mut words = text.split_ascii_whitespace();
            assert!(words.by_ref().take(3).all(|n| n == "96"));
            words.map(|w| w.parse().expect("a number")).collect()
        };
        let (a, again, b) = (read(0), read(0), read(12));
        assert_eq!(a.len(), SIZE.pow(3));
        assert!(a == again && a != b);
        assert!(a.iter().all(|d| (0.0..=1.0).contains(d)));
        let filled = a.iter().filter(|d| **d > 0.0).count() as f32 / a.len() as f32;
        assert!((0.01..0.5).contains(&filled), "{filled}");
        // None at the sides, where the cube ends.
        let side = |i: usize| [0, SIZE - 1].contains(&(i % SIZE));
        assert!(a.iter().enumerate().all(|(i, d)| !side(i) || *d == 0.0));
        assert_eq!(density("smoke-x.txt"), None);
    }

    #[test]
    fn the_wind_has_no_sources() {
        let p = Vec3::new(0.41, 0.66, 0.52);
        let h = 1e-2;
        let along = |axis: Vec3| (curl(p + axis * h, 0.3) - curl(p - axis * h, 0.3)) / (2.0 * h);
        let gradient = [Vec3::X, Vec3::Y, Vec3::Z].map(along);
        let divergence = gradient[0].x + gradient[1].y + gradient[2].z;
        let size = gradient.iter().map(|v| v.length()).sum::<f32>();
        assert!(divergence.abs() < 0.02 * size, "{divergence} of {size}");
    }
}
