//! Exposure from the picture.

use crate::engine::film::Frame;

/// Linear value that the picture's average is brought to (Reinhard et al. 2002, equation 2).
const MIDDLE_GREY: f64 = 0.18;
/// Pixels that are looked at, at most.
const SAMPLES: usize = 1 << 17;

/// The exposure in stops that brings the geometric mean of the luminance of all lit pixels of the
/// sum of `layers` to a middle grey; `None` where nothing is lit.
pub fn auto_exposure(frame: &Frame, layers: &[usize]) -> Option<f32> {
    let layers: Vec<&[[f32; 3]]> = layers
        .iter()
        .filter_map(|&layer| frame.layers.get(layer))
        .map(|layer| layer.pixels.as_slice())
        .collect();
    let count = layers.iter().map(|pixels| pixels.len()).min()?;
    let step = count.div_ceil(SAMPLES).max(1);
    let (mut sum, mut lit) = (0.0, 0u64);
    for i in (0..count).step_by(step) {
        let luminance: f64 = layers.iter().map(|pixels| luminance(pixels[i])).sum();
        if luminance > 0.0 && luminance.is_finite() {
            sum += luminance.ln();
            lit += 1;
        }
    }
    if lit == 0 {
        return None;
    }
    let mean = (sum / lit as f64).exp();
    Some((MIDDLE_GREY / mean).log2() as f32)
}

/// Relative luminance of Rec. 709 primaries.
fn luminance([r, g, b]: [f32; 3]) -> f64 {
    0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::film::FrameLayer;
    use crate::engine::plan::RenderPlan;

    fn frame(pixels: &[[f32; 3]]) -> Frame {
        let mut frame = Frame::empty(std::sync::Arc::new(RenderPlan::nothing()));
        let layer = |pixels: &[[f32; 3]]| FrameLayer {
            label: String::new(),
            pixels: pixels.to_vec(),
        };
        frame.layers = vec![layer(pixels), layer(pixels)];
        frame
    }

    #[test]
    fn the_mean_becomes_middle_grey() {
        let lit = frame(&[[0.36; 3], [0.0; 3], [f32::NAN; 3], [1.44; 3]]);
        // √(0.36 · 1.44) = 0.72 is two stops above 0.18; two layers are another stop.
        let near = |layers: &[usize], ev: f32| {
            let found = auto_exposure(&lit, layers);
            assert!(found.is_some_and(|f| (f - ev).abs() < 1e-4), "{found:?}");
        };
        near(&[0], -2.0);
        near(&[0, 1], -3.0);
    }

    #[test]
    fn darkness_has_no_exposure() {
        assert_eq!(auto_exposure(&frame(&[[0.0; 3]]), &[0]), None);
        assert_eq!(auto_exposure(&frame(&[]), &[0]), None);
        assert_eq!(auto_exposure(&frame(&[[1.0; 3]]), &[]), None);
    }
}
