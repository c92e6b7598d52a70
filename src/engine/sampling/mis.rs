//! Weights of multiple importance sampling (Veach 1997, *Robust Monte Carlo Methods for Light
//! Transport Simulation*, section 9.2).

/// Weight of a strategy of density `own` beside one of density `other`, in the same measure.
/// Densities may be infinite or 0; the result is in [0, 1], and the weights of a pair sum to 1.
#[inline]
pub fn balance(own: f32, other: f32) -> f32 {
    if own == 0.0 {
        return 0.0;
    }
    // A ratio, so that neither a huge nor a tiny pair of densities overflows or vanishes.
    1.0 / (1.0 + other / own)
}

/// The power heuristic with exponent 2 (Veach 1997, equation 9.13).
#[inline]
pub fn power(own: f32, other: f32) -> f32 {
    if own == 0.0 {
        return 0.0;
    }
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_sum_to_one_over_the_whole_range() {
        for e in (-38..=38).step_by(4) {
            for f in (-38..=38).step_by(4) {
                let (a, b) = (10f32.powi(e), 10f32.powi(f));
                for w in [balance, power] {
                    let sum = w(a, b) + w(b, a);
                    assert!((sum - 1.0).abs() < 1e-6, "{a} {b} {sum}");
                }
            }
        }
        assert_eq!(power(1.0, 0.0), 1.0);
        assert_eq!(power(0.0, 1.0), 0.0);
        assert_eq!(balance(1.0, f32::INFINITY), 0.0);
    }
}
