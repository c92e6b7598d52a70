//! Integer hashes that turn (seed, stream, index, dimension) into random bits.

/// A bijective finaliser of 64 bits (Steele, Lea, Flood 2014, *Fast Splittable Pseudorandom
/// Number Generators*, variant 13 of Stafford's search).
#[inline]
pub const fn mix64(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Combines two words so that each changes about half of the bits of the result.
#[inline]
pub const fn combine(a: u64, b: u64) -> u64 {
    mix64(a.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ mix64(b ^ 0xd1b5_4a32_d192_ed03))
}

/// The upper 24 bits as a number in [0, 1): every value is a multiple of 2⁻²⁴.
#[inline]
pub const fn unit_f32(bits: u64) -> f32 {
    (bits >> 40) as f32 * (1.0 / (1u32 << 24) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_f32_stays_below_one() {
        assert_eq!(unit_f32(0), 0.0);
        assert!(unit_f32(u64::MAX) < 1.0);
    }

    #[test]
    fn combine_distinguishes_order_and_neighbours() {
        let mut seen = std::collections::HashSet::new();
        for a in 0..300u64 {
            for b in 0..300u64 {
                assert!(seen.insert(combine(a, b)));
            }
        }
    }
}
