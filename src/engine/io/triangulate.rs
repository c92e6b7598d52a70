//! Polygons into triangles by ear clipping: concave faces come out right.

use glam::{Vec2, Vec3};

/// Most corners that are looked at for one polygon: enough for any with some hundreds of corners, and
/// for convex ones of ten thousand. Clipping takes the cube of the number at worst.
const MOST_LOOKS: usize = 100_000_000;

/// Splits the polygon through `points` into triangles of indices into it. What is left of a polygon
/// that is not simple, has no area or far too many corners is split as a fan: its degenerate
/// triangles are dropped later, with a count.
pub fn triangulate(points: &[Vec3]) -> Vec<[usize; 3]> {
    let n = points.len();
    if n < 3 {
        return Vec::new();
    }
    if n == 3 {
        return vec![[0, 1, 2]];
    }
    let flat = project(points);
    let mut left: Vec<usize> = (0..n).collect();
    let mut triangles = Vec::with_capacity(n - 2);
    let mut looks = 0;
    while left.len() > 3 && looks < MOST_LOOKS {
        let ear = (0..left.len()).find(|&i| {
            looks += left.len();
            looks >= MOST_LOOKS || is_ear(&flat, &left, i)
        });
        let Some(ear) = ear.filter(|_| looks < MOST_LOOKS) else {
            break;
        };
        let m = left.len();
        triangles.push([left[(ear + m - 1) % m], left[ear], left[(ear + 1) % m]]);
        left.remove(ear);
    }
    triangles.extend((1..left.len() - 1).map(|i| [left[0], left[i], left[i + 1]]));
    triangles
}

/// Drops the axis along which the polygon's normal (Newell's) is largest, keeping it
/// counter-clockwise.
fn project(points: &[Vec3]) -> Vec<Vec2> {
    let origin = points[0];
    let normal: Vec3 = (0..points.len())
        .map(|i| (points[i] - origin).cross(points[(i + 1) % points.len()] - origin))
        .sum();
    let a = normal.abs();
    points
        .iter()
        .map(|p| {
            let p = *p - origin;
            let flip = |v: Vec2, keep: bool| if keep { v } else { Vec2::new(v.y, v.x) };
            if a.z >= a.x && a.z >= a.y {
                flip(Vec2::new(p.x, p.y), normal.z >= 0.0)
            } else if a.x >= a.y {
                flip(Vec2::new(p.y, p.z), normal.x >= 0.0)
            } else {
                flip(Vec2::new(p.z, p.x), normal.y >= 0.0)
            }
        })
        .collect()
}

/// Twice the signed area of a triangle.
fn orient(a: Vec2, b: Vec2, c: Vec2) -> f32 {
    (b - a).perp_dot(c - a)
}

/// Whether the corner at place `i` is convex and no other corner lies within its triangle.
fn is_ear(flat: &[Vec2], left: &[usize], i: usize) -> bool {
    let m = left.len();
    let corners = [left[(i + m - 1) % m], left[i], left[(i + 1) % m]];
    let [a, b, c] = corners.map(|k| flat[k]);
    if orient(a, b, c) <= 0.0 {
        return false;
    }
    let inside =
        |p: Vec2| orient(a, b, p) >= 0.0 && orient(b, c, p) >= 0.0 && orient(c, a, p) >= 0.0;
    left.iter().all(|&k| {
        let p = flat[k];
        corners.contains(&k) || p == a || p == b || p == c || !inside(p)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(points: &[Vec3], triangles: &[[usize; 3]]) -> f32 {
        let one = |t: &[usize; 3]| {
            let [a, b, c] = t.map(|i| points[i]);
            (b - a).cross(c - a).length() / 2.0
        };
        triangles.iter().map(one).sum()
    }

    #[test]
    fn concave_polygons_keep_their_area_in_any_plane_and_order() {
        // An arrow whose fan from vertex 0 would cover ground outside of it; area 1.5.
        let arrow = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (1.0, 0.5)];
        let comb = [
            (0., 0.),
            (4., 0.),
            (4., 3.),
            (3., 3.),
            (3., 1.),
            (1., 1.),
            (1., 3.),
            (0., 3.),
        ];
        for (shape, expected) in [(&arrow[..], 1.5), (&comb[..], 8.0)] {
            for turn in 0..shape.len() {
                for axis in 0..6 {
                    let mut flat: Vec<(f32, f32)> = shape.to_vec();
                    flat.rotate_left(turn);
                    if axis >= 3 {
                        flat.reverse();
                    }
                    let place = |&(x, y): &(f32, f32)| match axis % 3 {
                        0 => Vec3::new(x, y, 5.0),
                        1 => Vec3::new(-2.0, x, y),
                        _ => Vec3::new(x, x + y, y),
                    };
                    let points: Vec<Vec3> = flat.iter().map(place).collect();
                    let found = triangulate(&points);
                    assert_eq!(found.len(), shape.len() - 2);
                    // The third plane is a shear: areas grow by the length of its normal.
                    let factor = if axis % 3 == 2 { 3.0_f32.sqrt() } else { 1.0 };
                    assert!((area(&points, &found) - expected * factor).abs() < 1e-4);
                    // Every triangle faces the way the polygon does.
                    let newell = |p: &[Vec3]| -> Vec3 {
                        (0..p.len()).map(|i| p[i].cross(p[(i + 1) % p.len()])).sum()
                    };
                    for t in &found {
                        assert!(newell(&t.map(|i| points[i])).dot(newell(&points)) > 0.0);
                    }
                }
            }
        }
    }

    #[test]
    fn degenerate_polygons_end() {
        assert_eq!(triangulate(&[Vec3::ZERO; 6]).len(), 4);
        assert_eq!(
            triangulate(&[Vec3::ZERO, Vec3::X, Vec3::NAN, Vec3::Y]).len(),
            2
        );
        assert!(triangulate(&[Vec3::ZERO, Vec3::X]).is_empty());
    }
}
