//! Floating-point neighbours and error bounds (Pharr, Jakob, Humphreys, *Physically Based
//! Rendering*, 4th ed., section 6.8; Higham, *Accuracy and Stability*, section 3.1).

/// Half the distance between 1 and the next larger `f32`: the largest relative rounding error of
/// one operation.
pub const MACHINE_EPSILON: f32 = f32::EPSILON * 0.5;

/// The largest `f32` below 1: every uniform random number is at most this.
pub const ONE_MINUS_EPSILON: f32 = 1.0 - MACHINE_EPSILON;

/// Bound on the relative error that `n` roundings compound to: n·ε / (1 − n·ε).
#[inline]
pub const fn gamma(n: u32) -> f32 {
    let ne = n as f32 * MACHINE_EPSILON;
    ne / (1.0 - ne)
}

/// 1 − x² without the cancellation that squaring first would bring near 1; never negative.
#[inline]
pub fn one_minus_sqr(x: f32) -> f32 {
    ((1.0 - x) * (1.0 + x)).max(0.0)
}

/// The square root of `x`, 0 for negative `x` (rounding below an exact 0).
#[inline]
pub fn safe_sqrt(x: f32) -> f32 {
    x.max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gamma_bounds_the_error_of_repeated_products() {
        let x = 1.000_123_4_f32;
        let (mut single, mut exact) = (1.0_f32, 1.0_f64);
        for n in 1..=32 {
            single *= x;
            exact *= f64::from(x);
            assert!((f64::from(single) - exact).abs() / exact <= f64::from(gamma(n)));
        }
    }

    #[test]
    fn one_minus_epsilon_is_the_neighbour_of_one() {
        assert_eq!(ONE_MINUS_EPSILON.next_up(), 1.0);
    }
}
