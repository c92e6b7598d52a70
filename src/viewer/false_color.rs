//! Luminance as colours that colour-blind people can tell apart.

use crate::picture::colors;

/// Stops that the scale covers.
pub const STOPS: f32 = 10.0;
/// Stops of them that lie below luminance 1.
pub const STOPS_BELOW: f32 = 9.0;
/// Smallest luminance whose logarithm is taken.
const DARKEST: f32 = 1e-30;

/// The bytes that show `rgb` after multiplication by 2^`exposure_ev`.
pub fn false_color(exposure_ev: f32, rgb: [f32; 3]) -> [u8; 3] {
    let [r, g, b] = rgb.map(|x| (x * exposure_ev.exp2()).max(0.0));
    let luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    scale((luminance.max(DARKEST).log2() + STOPS_BELOW) / STOPS)
}

/// The colour at `x` of the scale, 0 to 1.
pub fn scale(x: f32) -> [u8; 3] {
    colors::viridis(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brighter_is_lighter() {
        let lightness = |ev: f32| {
            let [r, g, b] = false_color(ev, [1.0; 3]).map(f32::from);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let steps: Vec<f32> = (-9..=1).map(|ev| lightness(ev as f32)).collect();
        assert!(steps.windows(2).all(|pair| pair[0] < pair[1]), "{steps:?}");
        assert_eq!(false_color(0.0, [0.0; 3]), scale(0.0));
    }
}
