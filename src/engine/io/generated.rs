//! Meshes of the embedded scenes that are shorter as a rule than as a list, written as OBJ text so
//! that they are read like any other.

use std::f32::consts::TAU;
use std::fmt::Write;

use glam::{Vec2, Vec3};

/// The OBJ file of that name, if it is one of those made here.
pub fn obj(name: &str) -> Option<String> {
    let mut mesh = ObjText::default();
    match name {
        "ring.obj" => mesh.lathe(&[ring_profile()], 256),
        "cognac-glass.obj" => mesh.lathe(&[smooth(GLASS)], 128),
        "cognac.obj" => {
            mesh.text.push_str("mtllib cognac.mtl\nusemtl cognac\n");
            let (wall, level) = (smooth(LIQUID), LIQUID[LIQUID.len() - 1]);
            mesh.lathe(&[wall, vec![level, Vec2::new(0.0, level.y)]], 128);
        }
        "water.obj" => mesh.grid(192, 144, false, water),
        // 1000 · 50 quads are 100 000 triangles.
        "knot.obj" => mesh.grid(1000, 50, true, knot),
        _ => return None,
    }
    Some(mesh.text)
}

/// OBJ text under way.
#[derive(Default)]
struct ObjText {
    text: String,
    vertices: usize,
}

impl ObjText {
    fn vertex(&mut self, p: Vec3, n: Vec3) {
        // Writing to a string cannot fail.
        let _ = writeln!(
            self.text,
            "v {} {} {}\nvn {} {} {}",
            p.x, p.y, p.z, n.x, n.y, n.z
        );
        self.vertices += 1;
    }

    fn face(&mut self, corners: &[usize]) {
        self.text.push('f');
        for c in corners {
            let _ = write!(self.text, " {c}//{c}");
        }
        self.text.push('\n');
    }

    /// Turns curves of (radius, height) about the y axis; going up, a curve's right side is out.
    fn lathe(&mut self, curves: &[Vec<Vec2>], segments: usize) {
        for curve in curves {
            let first = self.vertices + 1;
            for (i, p) in curve.iter().enumerate() {
                let (before, after) = (curve[i.max(1) - 1], curve[(i + 1).min(curve.len() - 1)]);
                let along = (after - before).normalize_or(Vec2::Y);
                for s in 0..segments {
                    let (sin, cos) = (s as f32 / segments as f32 * TAU).sin_cos();
                    let n = Vec3::new(along.y * cos, -along.x, along.y * sin);
                    self.vertex(Vec3::new(p.x * cos, p.y, p.x * sin), n);
                }
            }
            for i in 1..curve.len() {
                for s in 0..segments {
                    let next = (s + 1) % segments;
                    let at = |ring: usize, s: usize| first + ring * segments + s;
                    let (a, b, c, d) = (at(i - 1, s), at(i, s), at(i, next), at(i - 1, next));
                    // On the axis a side of the quad is a point.
                    match (curve[i - 1].x == 0.0, curve[i].x == 0.0) {
                        (true, _) => self.face(&[a, b, c]),
                        (_, true) => self.face(&[a, b, d]),
                        _ => self.face(&[a, b, c, d]),
                    }
                }
            }
        }
    }

    /// A surface over the unit square, `columns` by `rows` quads; a closed one meets itself at both
    /// ends.
    fn grid(&mut self, columns: usize, rows: usize, closed: bool, at: impl Fn(f32, f32) -> Vec3) {
        let (nu, nv) = if closed {
            (columns, rows)
        } else {
            (columns + 1, rows + 1)
        };
        for j in 0..nv {
            for i in 0..nu {
                let (u, v) = (i as f32 / columns as f32, j as f32 / rows as f32);
                let h = 1e-3;
                let du = at(u + h, v) - at(u - h, v);
                let dv = at(u, v + h) - at(u, v - h);
                self.vertex(at(u, v), du.cross(dv).normalize_or(Vec3::Y));
            }
        }
        for j in 0..rows {
            for i in 0..columns {
                let id = |i: usize, j: usize| (j % nv) * nu + i % nu + 1;
                self.face(&[id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)]);
            }
        }
    }
}

/// A band of radius 1 with upright walls and round rims.
fn ring_profile() -> Vec<Vec2> {
    let power = |x: f32| x.signum() * x.abs().powf(0.25);
    let at = |i: u32| {
        let (sin, cos) = (i as f32 / 48.0 * TAU).sin_cos();
        Vec2::new(1.04 + 0.04 * power(cos), 0.3 + 0.299 * power(sin))
    };
    // The last point is the first again.
    (0..48).chain([0]).map(at).collect()
}

/// Outside of a cognac glass from below its foot to the rim, then its inside, in cm.
const GLASS: &[Vec2] = &[
    Vec2::new(0.0, 0.02),
    Vec2::new(2.6, 0.02),
    Vec2::new(3.1, 0.12),
    Vec2::new(2.6, 0.32),
    Vec2::new(0.75, 0.7),
    Vec2::new(0.42, 1.4),
    Vec2::new(0.55, 2.2),
    Vec2::new(1.5, 2.8),
    Vec2::new(2.9, 3.7),
    Vec2::new(3.85, 5.0),
    Vec2::new(4.1, 6.3),
    Vec2::new(3.75, 7.9),
    Vec2::new(3.1, 9.3),
    Vec2::new(2.8, 10.3),
    Vec2::new(2.71, 10.4),
    Vec2::new(2.64, 10.3),
    Vec2::new(2.94, 9.3),
    Vec2::new(3.59, 7.9),
    Vec2::new(3.94, 6.3),
    Vec2::new(3.69, 5.0),
    Vec2::new(2.74, 3.83),
    Vec2::new(1.4, 3.05),
    Vec2::new(0.0, 2.75),
];

/// The cognac from below to its level, 0.03 cm within the glass.
const LIQUID: &[Vec2] = &[
    Vec2::new(0.0, 2.79),
    Vec2::new(1.38, 3.08),
    Vec2::new(2.7, 3.85),
    Vec2::new(3.64, 5.0),
    Vec2::new(3.83, 5.6),
];

/// A Catmull–Rom spline through the points.
fn smooth(points: &[Vec2]) -> Vec<Vec2> {
    const STEPS: usize = 8;
    let last = points.len() - 1;
    let mut curve = Vec::new();
    for i in 0..last {
        let p = [i.max(1) - 1, i, i + 1, (i + 2).min(last)].map(|k| points[k]);
        for s in 0..STEPS {
            let t = s as f32 / STEPS as f32;
            let (t2, t3) = (t * t, t * t * t);
            let q = p[1]
                + 0.5 * t * (p[2] - p[0])
                + t2 * (p[0] - 2.5 * p[1] + 2.0 * p[2] - 0.5 * p[3])
                + t3 * (0.5 * (p[3] - p[0]) + 1.5 * (p[1] - p[2]));
            curve.push(q.max(Vec2::ZERO));
        }
    }
    curve.push(points[last]);
    curve
}

/// Waves on 8 by 6 m, up.
fn water(u: f32, v: f32) -> Vec3 {
    /// Wave vector in 1/m, amplitude in m, phase.
    const WAVES: [(f32, f32, f32, f32); 6] = [
        (2.1, 0.9, 0.020, 0.3),
        (-1.3, 2.6, 0.016, 1.9),
        (3.7, -2.2, 0.010, 4.1),
        (-4.4, -3.1, 0.007, 2.2),
        (1.0, 5.3, 0.006, 5.5),
        (6.6, 1.7, 0.004, 0.9),
    ];
    let (x, z) = (8.0 * u - 4.0, 3.0 - 6.0 * v);
    let height = WAVES
        .iter()
        .map(|(kx, kz, a, phase)| a * (kx * x + kz * z + phase).sin());
    Vec3::new(x, height.sum(), z)
}

/// A tube along the (2, 3) torus knot, with grooves.
fn knot(u: f32, v: f32) -> Vec3 {
    let center = |t: f32| {
        let r = 1.0 + 0.42 * (3.0 * t).cos();
        Vec3::new(
            r * (2.0 * t).cos(),
            0.75 * (3.0 * t).sin(),
            r * (2.0 * t).sin(),
        )
    };
    let t = u * TAU;
    let along = (center(t + 1e-2) - center(t - 1e-2)).normalize();
    // The direction away from the axis of the torus never runs along the knot.
    let out = Vec3::new((2.0 * t).cos(), 0.0, (2.0 * t).sin());
    let side = along.cross(out).normalize();
    let up = side.cross(along);
    let angle = v * TAU;
    let radius = 0.25 + 0.012 * (10.0 * angle + 60.0 * t).sin();
    center(t) + radius * (angle.cos() * up + angle.sin() * side)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_agree_with_the_order_of_the_corners() {
        for name in [
            "ring.obj",
            "cognac-glass.obj",
            "cognac.obj",
            "water.obj",
            "knot.obj",
        ] {
            let text = obj(name).expect("a mesh");
            let vectors = |key: &str| -> Vec<Vec3> {
                let lines = text.lines().filter_map(|l| l.strip_prefix(key));
                let numbers = |l: &str| -> Vec<f32> {
                    l.split(' ').map(|x| x.parse().expect("a number")).collect()
                };
                lines.map(|l| Vec3::from_slice(&numbers(l))).collect()
            };
            let (p, n) = (vectors("v "), vectors("vn "));
            let mut faces = 0;
            for line in text.lines().filter_map(|l| l.strip_prefix("f ")) {
                let corner = |c: &str| c.split("//").next().and_then(|i| i.parse::<usize>().ok());
                let c: Vec<usize> = line.split(' ').filter_map(corner).map(|i| i - 1).collect();
                let front = (p[c[1]] - p[c[0]]).cross(p[c[2]] - p[c[0]]);
                assert!(front.length() > 0.0, "{name}: a face without area");
                let shading: Vec3 = c.iter().map(|i| n[*i]).sum();
                assert!(front.dot(shading) > 0.0, "{name}: {line}");
                faces += c.len() - 2;
            }
            assert!(name != "knot.obj" || faces == 100_000, "{faces}");
        }
    }
}
