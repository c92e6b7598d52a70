//! The badge "sum of parts − whole".

use super::display::{PARTS, layer_of_part};
use crate::engine::film::Frame;

/// Pixels that are looked at, at most: the window must not wait for this.
const SAMPLES: usize = 1 << 17;

/// How far the four components, which have sums of their own, are from the whole.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Balance {
    /// Mean of (sum of parts − whole) / mean of the whole; absent where the whole is black.
    pub mean: Option<f64>,
    /// Root of the mean of (sum of parts − whole)² / mean of the whole.
    pub rms: Option<f64>,
}

impl Balance {
    /// Measures a frame.
    pub fn update(&mut self, frame: &Frame) {
        *self = Self::of(frame).unwrap_or_default();
    }

    fn of(frame: &Frame) -> Option<Self> {
        let whole = &frame.layers.first()?.pixels;
        let parts: Vec<&[[f32; 3]]> = (0..PARTS)
            .filter_map(|part| frame.layers.get(layer_of_part(part)))
            .map(|layer| layer.pixels.as_slice())
            .collect();
        let complete = parts.len() == PARTS && parts.iter().all(|p| p.len() == whole.len());
        if !complete || whole.is_empty() {
            return None;
        }
        let step = whole.len().div_ceil(SAMPLES);
        let (mut brightness, mut sum, mut squares) = (0.0, 0.0, 0.0);
        let mut count = 0u64;
        for i in (0..whole.len()).step_by(step) {
            for c in 0..3 {
                let w = f64::from(whole[i][c]);
                let all: f64 = parts.iter().map(|p| f64::from(p[i][c])).sum();
                if w.is_finite() && all.is_finite() {
                    brightness += w;
                    sum += all - w;
                    squares += (all - w) * (all - w);
                    count += 1;
                }
            }
        }
        let (n, mean) = (count as f64, brightness / count as f64);
        (mean > 0.0).then(|| Self {
            mean: Some(sum / n / mean),
            rms: Some((squares / n).sqrt() / mean),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::film::FrameLayer;
    use crate::engine::plan::RenderPlan;

    fn frame(values: [f32; 5]) -> Frame {
        let mut frame = Frame::empty(std::sync::Arc::new(RenderPlan::nothing()));
        frame.layers = values
            .map(|value| FrameLayer {
                label: String::new(),
                pixels: vec![[value; 3]; 4],
            })
            .to_vec();
        frame
    }

    #[test]
    fn parts_that_add_up_differ_by_nothing() {
        let balance = Balance::of(&frame([1.0, 0.25, 0.5, 0.125, 0.125]));
        let expected = Balance {
            mean: Some(0.0),
            rms: Some(0.0),
        };
        assert_eq!(balance, Some(expected));
    }

    #[test]
    fn a_part_that_lacks_shows() {
        let balance = Balance::of(&frame([1.0, 0.25, 0.5, 0.0, 0.0])).expect("a balance");
        assert_eq!(balance.mean, Some(-0.25));
        assert_eq!(Balance::of(&frame([0.0; 5])), None);
    }
}
