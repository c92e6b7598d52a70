//! Unpolarised Fresnel reflection at a smooth dielectric interface, in forms that neither cancel
//! for an index near 1 nor at grazing angles.

use glam::Vec3A;

/// A dielectric interface seen from one of its sides.
#[derive(Clone, Copy, Debug)]
pub struct Interface {
    /// Index on the far side over the index on the near side.
    eta: f32,
    /// η² − 1, kept apart since `eta` loses it to rounding near 1.
    eta_sq_minus_1: f32,
}

impl Interface {
    /// The interface to an inside of index `ior`, seen from `outside` (index 1) or from within.
    #[inline]
    pub fn new(ior: f32, outside: bool) -> Self {
        let difference = (ior - 1.0) * (ior + 1.0);
        if outside {
            Self {
                eta: ior,
                eta_sq_minus_1: difference,
            }
        } else {
            Self {
                eta: 1.0 / ior,
                eta_sq_minus_1: -difference / (ior * ior),
            }
        }
    }

    /// Index on the far side over the index on the near side.
    #[inline]
    pub const fn eta(self) -> f32 {
        self.eta
    }

    /// Reflectance and transmittance for light at the near side's cosine `cos` in [0, 1]; they
    /// sum to 1.
    ///
    /// With q = η cosθt = √(η² − 1 + cos²) the amplitudes of Fresnel's equations are
    /// r⊥ = −(η² − 1)/(cos + q)² and r∥ = (η² − 1)((η² + 1)cos² − 1)/(η² cos + q)², and the
    /// transmittances 4 cos q/(cos + q)² and 4 η² cos q/(η² cos + q)²: products of what is exact
    /// when the index is near 1 or the cosine near 0.
    #[inline]
    pub fn fresnel(self, cos: f32) -> (f32, f32) {
        let (d, eta_sq) = (self.eta_sq_minus_1, self.eta * self.eta);
        if d == 0.0 {
            return (0.0, 1.0);
        }
        let q_sq = d + cos * cos;
        if q_sq <= 0.0 {
            return (1.0, 0.0); // total internal reflection
        }
        let q = q_sq.sqrt();
        let (s, p) = (1.0 / (cos + q), 1.0 / (eta_sq * cos + q));
        let r_s = d * s * s;
        let r_p = (d * p) * (((eta_sq + 1.0) * cos * cos - 1.0) * p);
        // The smaller one keeps its digits, the other makes the sum exact: next to the critical
        // angle q is rounded and would leave a gap.
        let r = 0.5 * (r_s * r_s + r_p * r_p);
        if r < 0.5 {
            (r, 1.0 - r)
        } else {
            let t = self.transmitted(cos, q);
            (1.0 - t, t)
        }
    }

    /// The transmittance where the far side's cosine `cos_t` is known as well: next to the
    /// critical angle the near side's alone does not determine it.
    #[inline]
    pub fn transmittance(self, cos: f32, cos_t: f32) -> f32 {
        self.transmitted(cos, self.eta * cos_t)
    }

    #[inline]
    fn transmitted(self, cos: f32, q: f32) -> f32 {
        let eta_sq = self.eta * self.eta;
        let (s, p) = (1.0 / (cos + q), 1.0 / (eta_sq * cos + q));
        2.0 * (cos * s * (q * s) + eta_sq * cos * p * (q * p))
    }

    /// The refracted direction of `wo` about the unit normal `n` on `wo`'s side; None under
    /// total internal reflection. With equal indices it is exactly −wo.
    #[inline]
    pub fn refract(self, wo: Vec3A, n: Vec3A) -> Option<Vec3A> {
        let d = self.eta_sq_minus_1;
        if d == 0.0 {
            return Some(-wo);
        }
        let cos = wo.dot(n);
        let q_sq = d + cos * cos;
        if q_sq <= 0.0 {
            return None;
        }
        // Snell: η wi = −wo + (cos − q) n, where cos − q = −(η² − 1)/(cos + q).
        Some((-wo - n * (d / (cos + q_sq.sqrt()))).normalize())
    }
}

/// Cosine-weighted mean transmittance 2∫ T(c) c dc from outside into an index `ior`, to double
/// precision. The mean internal reflectance is Fdr = 1 − mean/ior² (both sides exchange equal
/// flux in equilibrium).
///
/// Substituting c = √|η²−1| sinh t (cosh t for η < 1) makes the integrand smooth, also next to
/// index 1 where it would have a kink: dc = q dt and q is the other hyperbolic function.
pub fn mean_transmittance(ior: f64) -> f64 {
    // Gauss–Legendre with five nodes a panel.
    const NODES: [(f64, f64); 5] = [
        (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
        (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (0.906_179_845_938_664, 0.236_926_885_056_189_1),
    ];
    const PANELS: u32 = 256;
    let d = (ior - 1.0) * (ior + 1.0);
    if d == 0.0 {
        return 1.0;
    }
    let (scale, eta_sq) = (d.abs().sqrt(), ior * ior);
    let t_max = ((1.0 + ior) / scale).ln();
    let width = t_max / f64::from(PANELS);
    let integrand = |t: f64| {
        let (sinh, cosh) = (scale * t.sinh(), scale * t.cosh());
        let (c, q) = if d > 0.0 { (sinh, cosh) } else { (cosh, sinh) };
        let transmittance =
            2.0 * c * q * (1.0 / (c + q).powi(2) + eta_sq / (eta_sq * c + q).powi(2));
        2.0 * c * transmittance * q
    };
    let panel = |i: u32| -> f64 {
        let middle = (f64::from(i) + 0.5) * width;
        let sum = NODES.map(|(x, w)| w * integrand(middle + 0.5 * width * x));
        sum.iter().sum::<f64>() * 0.5 * width
    };
    (0..PANELS).map(panel).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The textbook form in double precision.
    fn textbook(eta: f64, c: f64) -> f64 {
        let sin2_t = (1.0 - c * c) / (eta * eta);
        if sin2_t >= 1.0 {
            return 1.0;
        }
        let ct = (1.0 - sin2_t).sqrt();
        let s = (c - eta * ct) / (c + eta * ct);
        let p = (eta * c - ct) / (eta * c + ct);
        0.5 * (s * s + p * p)
    }

    #[test]
    fn agrees_with_the_textbook_form() {
        for ior in [0.5_f32, 0.9, 1.1, 1.33, 1.5, 1.9, 10.0, 1e3] {
            for outside in [true, false] {
                let interface = Interface::new(ior, outside);
                let eta = if outside {
                    f64::from(ior)
                } else {
                    1.0 / f64::from(ior)
                };
                for i in 0..=1000 {
                    let c = i as f32 / 1000.0;
                    let (r, t) = interface.fresnel(c);
                    let exact = textbook(eta, f64::from(c));
                    // √ magnifies the rounding of η² − 1 + cos² next to the critical angle.
                    let q_sq = (eta * eta - 1.0 + f64::from(c).powi(2)).abs();
                    if q_sq > 0.0 && q_sq < 1e-4 {
                        continue;
                    }
                    assert!((f64::from(r) - exact).abs() < 1e-4, "{ior} {c} {r} {exact}");
                    assert!((r + t - 1.0).abs() < 1e-7, "{ior} {c}: {r} + {t}");
                }
            }
        }
    }

    #[test]
    fn index_next_to_one_keeps_its_digits() {
        for ior in [1.0_f32 + 1e-6, 1.0 - 1e-6] {
            let eta = f64::from(ior);
            for c in [1.0_f32, 0.7, 0.1] {
                // r⊥ and r∥ in double precision by the same algebra hold twelve digits.
                let (d, c64) = ((eta - 1.0) * (eta + 1.0), f64::from(c));
                let q = (d + c64 * c64).sqrt();
                let s = d / (c64 + q).powi(2);
                let p = d * ((eta * eta + 1.0) * c64 * c64 - 1.0) / (eta * eta * c64 + q).powi(2);
                let exact = 0.5 * (s * s + p * p);
                let (r, t) = Interface::new(ior, true).fresnel(c);
                assert!((f64::from(r) / exact - 1.0).abs() < 1e-5, "{r} {exact}");
                assert!((t - 1.0).abs() < 1e-6);
                let back = Interface::new(ior, false).fresnel(q as f32 / ior).0;
                assert!(
                    (f64::from(back) / exact - 1.0).abs() < 1e-4,
                    "{back} {exact}"
                );
            }
        }
        let one = Interface::new(1.0, true);
        assert_eq!(one.fresnel(0.0), (0.0, 1.0));
        let wo = Vec3A::new(0.6, 0.0, 0.8);
        assert_eq!(one.refract(wo, Vec3A::Z), Some(-wo));
    }

    #[test]
    fn refraction_obeys_snell_and_is_reversible() {
        for ior in [0.7_f32, 1.000_001, 1.5, 1e3] {
            // At c = 0 the way back is critical, and may round to total reflection.
            for i in 1..=100 {
                let c = i as f32 / 100.0;
                let wo = Vec3A::new((1.0 - c * c).sqrt(), 0.0, c);
                let Some(wi) = Interface::new(ior, true).refract(wo, Vec3A::Z) else {
                    continue;
                };
                assert!((wo.x + ior * wi.x).abs() < 1e-6 * ior.max(1.0) && wi.z <= 0.0);
                // From within a large index the way back hangs on 1 − cos², below f32's digits.
                if ior < 100.0 {
                    let back = Interface::new(ior, false)
                        .refract(wi, Vec3A::NEG_Z)
                        .unwrap();
                    // A rounding of wi.x is magnified by η, near the critical angle by 1/cos too.
                    let tolerance = 1e-6 * ior.max(1.0) / c;
                    assert!((back - wo).length() < tolerance, "{ior} {c}");
                }
            }
        }
    }

    #[test]
    fn mean_internal_reflectance_is_exact() {
        let fdr = |ior: f64| 1.0 - mean_transmittance(ior) / (ior * ior);
        assert!((fdr(1.5) - 0.59635).abs() < 5e-6, "{}", fdr(1.5));
        assert!((fdr(1.9) - 0.76384).abs() < 5e-6, "{}", fdr(1.9));
        // Equilibrium: the mean seen from within an index η is that seen from outside 1/η.
        for ior in [1.000_001, 1.1, 1.5, 3.0, 100.0] {
            let from_within = mean_transmittance(1.0 / ior);
            let from_outside = mean_transmittance(ior) / (ior * ior);
            assert!((from_within / from_outside - 1.0).abs() < 1e-12, "{ior}");
        }
        assert_eq!(mean_transmittance(1.0), 1.0);
    }
}
