//! Unit vectors in two bytes: the octahedral map (Cigolle et al. 2014, *A Survey of Efficient
//! Representations for Independent Unit Vectors*) with eight bits a coordinate.

use glam::{Vec2, Vec3A};

/// Largest code of a coordinate; even, so that the axes are exact.
const MAX: f32 = 254.0;

/// Packs the unit vector `d` by the nearest code on its own side of the plane of normal `n`: a
/// grazing photon must not be taken for one that arrived from behind its surface.
pub fn pack(d: Vec3A, n: Vec3A) -> u16 {
    let q = (square(d) * 0.5 + Vec2::splat(0.5)) * MAX;
    let front = d.dot(n) >= 0.0;
    let mut best = (0, f32::NEG_INFINITY);
    for (dx, dy) in (-1..=1).flat_map(|y| (-1..=1).map(move |x| (x, y))) {
        let code = wrap(q.round() + Vec2::new(dx as f32, dy as f32));
        let code = (code.x as u16) << 8 | code.y as u16;
        let found = unpack(code);
        let side = found.dot(n);
        // One on the wrong side, or in the plane, only where there is no other.
        let penalty = if side != 0.0 && (side > 0.0) == front {
            0.0
        } else {
            4.0
        };
        let closeness = found.dot(d) - penalty;
        if closeness > best.1 {
            best = (code, closeness);
        }
    }
    best.0
}

/// The code of a place beyond the border of the square, where the octahedron is folded: it goes on
/// at the mirrored place of the same side.
fn wrap(code: Vec2) -> Vec2 {
    let beyond = |x: f32| !(0.0..=MAX).contains(&x);
    let back = |x: f32| if x < 0.0 { -x } else { 2.0 * MAX - x };
    match (beyond(code.x), beyond(code.y)) {
        (true, false) => Vec2::new(back(code.x), MAX - code.y),
        (false, true) => Vec2::new(MAX - code.x, back(code.y)),
        (true, true) => Vec2::new(MAX - back(code.x), MAX - back(code.y)),
        (false, false) => code,
    }
}

/// The unit vector of a code.
#[inline]
pub fn unpack(code: u16) -> Vec3A {
    let p = Vec2::new(f32::from(code >> 8), f32::from(code & 255)) * (2.0 / MAX) - Vec2::ONE;
    let z = 1.0 - p.x.abs() - p.y.abs();
    let fold = (-z).max(0.0);
    let x = p.x - fold.copysign(p.x);
    let y = p.y - fold.copysign(p.y);
    Vec3A::new(x, y, z).normalize()
}

/// The octahedron unfolded to [−1, 1]².
#[inline]
fn square(d: Vec3A) -> Vec2 {
    let d = d / (d.x.abs() + d.y.abs() + d.z.abs());
    if d.z >= 0.0 {
        Vec2::new(d.x, d.y)
    } else {
        let flip = |a: f32, b: f32| (1.0 - b.abs()).copysign(a);
        Vec2::new(flip(d.x, d.y), flip(d.y, d.x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::sampling::warp::sample_sphere;
    use crate::engine::sampling::{IndependentSampler, Sampler, Stream};

    #[test]
    fn directions_come_back_within_two_degrees_and_on_their_side() {
        let mut sampler = IndependentSampler::new(1, Stream::Test, (0, 0));
        let mut worst: f32 = 0.0;
        for _ in 0..200_000 {
            let (d, n) = (
                sample_sphere(sampler.next_2d()),
                sample_sphere(sampler.next_2d()),
            );
            // Half of them grazing: turned almost into the plane.
            let grazing = (d - n * (d.dot(n) * (1.0 - 1e-5))).normalize();
            for d in [d, grazing] {
                let found = unpack(pack(d, n));
                worst = worst.max(found.angle_between(d));
                assert!((found.length() - 1.0).abs() < 1e-6);
                // In the plane there is no side.
                let side = d.dot(n);
                assert!(
                    side == 0.0 || (found.dot(n) > 0.0) == (side > 0.0),
                    "{d} {n} {found}"
                );
            }
        }
        assert!(worst.to_degrees() < 2.0, "{}", worst.to_degrees());
    }

    #[test]
    fn axes_are_exact() {
        for d in [
            Vec3A::X,
            Vec3A::NEG_X,
            Vec3A::Y,
            Vec3A::NEG_Y,
            Vec3A::Z,
            Vec3A::NEG_Z,
        ] {
            assert_eq!(unpack(pack(d, d)), d);
        }
    }
}
