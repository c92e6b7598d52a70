//! Scales of colours that colour-blind people can read, sRGB-encoded.

/// Equal steps of viridis (van der Walt and Smith 2015). The shader has the same.
const VIRIDIS: [[f32; 3]; 9] = [
    [0.267, 0.005, 0.329],
    [0.279, 0.175, 0.483],
    [0.230, 0.322, 0.546],
    [0.173, 0.449, 0.558],
    [0.128, 0.567, 0.551],
    [0.158, 0.684, 0.502],
    [0.369, 0.789, 0.383],
    [0.678, 0.864, 0.190],
    [0.993, 0.906, 0.144],
];
/// From blue over white to red, after the scale RdBu of Brewer and Harrower (2002).
#[cfg(any(feature = "viewer", test))]
const BLUE_RED: [[f32; 3]; 9] = [
    [0.020, 0.188, 0.380],
    [0.129, 0.400, 0.674],
    [0.263, 0.576, 0.765],
    [0.573, 0.773, 0.871],
    [0.969, 0.969, 0.969],
    [0.957, 0.647, 0.510],
    [0.839, 0.376, 0.302],
    [0.698, 0.094, 0.169],
    [0.404, 0.000, 0.122],
];
/// What is shown for a value that is no number.
pub const NO_NUMBER: [u8; 3] = [255, 0, 255];

/// The colour at `x` of viridis, 0 to 1.
pub fn viridis(x: f32) -> [u8; 3] {
    at(&VIRIDIS, x)
}

/// The colour of a signed value, −1 (blue) to 1 (red); 0 is white.
#[cfg(any(feature = "viewer", test))]
pub fn blue_red(x: f32) -> [u8; 3] {
    at(&BLUE_RED, 0.5 + 0.5 * x)
}

fn at(steps: &[[f32; 3]; 9], x: f32) -> [u8; 3] {
    let at = x.clamp(0.0, 1.0) * (steps.len() - 1) as f32;
    let i = (at as usize).min(steps.len() - 2);
    let t = at - i as f32;
    let mix = |c: usize| steps[i][c] * (1.0 - t) + steps[i + 1][c] * t;
    [mix(0), mix(1), mix(2)].map(|v| (v * 255.0).round() as u8)
}

/// Colours of curves: those of Okabe and Ito (2008), which colour-blind people tell apart, and
/// two more.
const CURVES: [[u8; 3]; 9] = [
    [0, 114, 178],
    [230, 159, 0],
    [0, 158, 115],
    [204, 121, 167],
    [213, 94, 0],
    [86, 180, 233],
    [170, 150, 20],
    [120, 120, 120],
    [130, 70, 200],
];

/// The colour of the curve `index`.
pub fn curve(index: usize) -> [u8; 3] {
    CURVES[index % CURVES.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_run_from_end_to_end() {
        assert_eq!(viridis(0.0), [68, 1, 84]);
        assert_eq!(viridis(2.0), viridis(1.0));
        assert_eq!(blue_red(0.0), [247, 247, 247]);
        let ([r, _, b], [r2, _, b2]) = (blue_red(-0.9), blue_red(0.9));
        assert!(b > r && r2 > b2);
    }
}
