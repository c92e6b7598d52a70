//! An orthonormal basis around a normal.

use glam::Vec3A;

/// A right-handed orthonormal basis; `n` is the local z axis.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Local x axis in world space.
    pub s: Vec3A,
    /// Local y axis in world space.
    pub t: Vec3A,
    /// Local z axis in world space, a unit vector.
    pub n: Vec3A,
}

impl Frame {
    /// A basis around the unit vector `n`, continuous but for n.z = −0
    /// (Duff et al. 2017, *Building an Orthonormal Basis, Revisited*).
    #[inline]
    pub fn from_normal(n: Vec3A) -> Self {
        let sign = 1.0_f32.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        Self {
            s: Vec3A::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
            t: Vec3A::new(b, sign + n.y * n.y * a, -n.y),
            n,
        }
    }

    /// A world direction in local coordinates.
    #[inline]
    pub fn to_local(&self, w: Vec3A) -> Vec3A {
        Vec3A::new(w.dot(self.s), w.dot(self.t), w.dot(self.n))
    }

    /// A local direction in world coordinates.
    #[inline]
    pub fn to_world(&self, v: Vec3A) -> Vec3A {
        self.s * v.x + self.t * v.y + self.n * v.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn basis_is_orthonormal_and_right_handed_everywhere() {
        for i in 0..1000 {
            let z = -1.0 + 2.0 * i as f32 / 999.0;
            let phi = i as f32 * 2.4;
            let r = (1.0 - z * z).max(0.0).sqrt();
            let n = Vec3A::new(r * phi.cos(), r * phi.sin(), z).normalize();
            let f = Frame::from_normal(n);
            assert!(f.s.dot(f.t).abs() < 2e-6 && f.s.dot(n).abs() < 2e-6);
            assert!((f.s.length() - 1.0).abs() < 2e-6 && (f.t.length() - 1.0).abs() < 2e-6);
            assert!((f.s.cross(f.t) - n).length() < 4e-6);
            let w = Vec3A::new(0.3, -0.5, 0.8);
            assert!((f.to_world(f.to_local(w)) - w).length() < 2e-6);
        }
    }
}
