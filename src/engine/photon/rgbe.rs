//! Three non-negative numbers in four bytes: mantissas of eight bits and a common exponent
//! (Ward 1991, *Real Pixels*), rounded at random so that the mean is exact.

/// Exponent byte of the exponent 0.
const BIAS: i32 = 128;
/// Bits of a mantissa.
const BITS: i32 = 8;

/// Packs `c` (no channel negative, NaN or above 2¹¹⁹ · 255). Every channel is rounded up where
/// its remainder exceeds 1 − `u`, so for `u` uniform in [0, 1) the mean of [`unpack`] is `c`.
#[inline]
pub fn pack(c: [f32; 3], u: f32) -> [u8; 4] {
    let max = c[0].max(c[1]).max(c[2]);
    if max <= 0.0 {
        return [0; 4];
    }
    let mut exponent = exponent_of(max);
    // A mantissa that could round up to 256 takes the next exponent, whatever `u` is: a choice
    // that looked at `u` would bias the other channels.
    if f64::from(max) * power_of_two(BITS - exponent) > 255.0 {
        exponent += 1;
    }
    let exponent = exponent.clamp(1 - BIAS, 255 - BIAS);
    let scale = power_of_two(BITS - exponent);
    let mantissa = |x: f32| (f64::from(x) * scale + f64::from(u)) as u8;
    [
        mantissa(c[0]),
        mantissa(c[1]),
        mantissa(c[2]),
        (exponent + BIAS) as u8,
    ]
}

/// The numbers of a packed colour.
#[inline]
pub fn unpack([r, g, b, e]: [u8; 4]) -> [f32; 3] {
    let scale = power_of_two(i32::from(e) - BIAS - BITS);
    [r, g, b].map(|m| (f64::from(m) * scale) as f32)
}

/// The exponent e with x in [2^(e−1), 2^e).
#[inline]
fn exponent_of(x: f32) -> i32 {
    let bits = f64::from(x).to_bits();
    ((bits >> 52) & 0x7ff) as i32 - 1022
}

/// 2^e for |e| < 1000.
#[inline]
fn power_of_two(e: i32) -> f64 {
    f64::from_bits(((1023 + e) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::math::hash::{combine, unit_f32};

    fn colour(i: u64) -> [f32; 3] {
        let scale = 10f32.powf(30.0 * unit_f32(combine(i, 9)) - 15.0);
        [0, 1, 2].map(|c| scale * unit_f32(combine(i, c)))
    }

    #[test]
    fn the_error_is_within_one_step_of_the_largest_channel() {
        for i in 0..20_000 {
            let c = colour(i);
            let max = c.iter().copied().fold(0.0, f32::max);
            let found = unpack(pack(c, unit_f32(combine(i, 77))));
            for k in 0..3 {
                assert!((found[k] - c[k]).abs() <= max / 127.0, "{c:?} {found:?}");
            }
        }
        assert_eq!(pack([0.0; 3], 0.999), [0; 4]);
        assert_eq!(unpack([0; 4]), [0.0; 3]);
    }

    #[test]
    fn the_mean_over_the_roundings_is_exact() {
        let steps = 4096;
        for i in 0..400 {
            let c = colour(i);
            let mut sum = [0.0f64; 3];
            for k in 0..steps {
                let found = unpack(pack(c, (k as f32 + 0.5) / steps as f32));
                (0..3).for_each(|c| sum[c] += f64::from(found[c]));
            }
            for k in 0..3 {
                let (mean, exact) = (sum[k] / f64::from(steps), f64::from(c[k]));
                let max = f64::from(c.iter().copied().fold(0.0, f32::max));
                // The grid of `u` resolves the mean to a step of 1/4096 of a mantissa's.
                assert!(
                    (mean - exact).abs() <= max / 128.0 / f64::from(steps),
                    "{c:?}"
                );
            }
        }
    }

    #[test]
    fn ends_of_the_range_are_finite() {
        for c in [[f32::MIN_POSITIVE; 3], [1e-45, 0.0, 0.0], [1e38, 1.0, 0.0]] {
            let found = unpack(pack(c, 0.0));
            assert!(found.iter().all(|x| x.is_finite() && *x >= 0.0));
        }
        assert_eq!(unpack(pack([1.0, 0.5, 0.25], 0.0)), [1.0, 0.5, 0.25]);
    }
}
