//! The badge "sum of parts − whole".

use std::ops::Range;

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
    /// Of the components of a frame.
    pub fn of_components(frame: &Frame) -> Self {
        let layers = layer_of_part(0)..layer_of_part(PARTS);
        Self::of(frame, layers).unwrap_or_default()
    }

    /// Of the typed expressions of a frame, as if they shared no path.
    pub fn of_expressions(frame: &Frame) -> Self {
        let layers = layer_of_part(PARTS)..frame.layers.len();
        Self::of(frame, layers).unwrap_or_default()
    }

    fn of(frame: &Frame, layers: Range<usize>) -> Option<Self> {
        let whole = &frame.layers.first()?.pixels;
        if !frame.plan.whole || layers.is_empty() {
            return None;
        }
        let parts = frame.layers.get(layers)?.iter();
        let parts: Vec<&[[f32; 3]]> = parts.map(|layer| layer.pixels.as_slice()).collect();
        let complete = parts.iter().all(|p| p.len() == whole.len());
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
        let mut plan = RenderPlan::nothing();
        plan.whole = true;
        let mut frame = Frame::empty(std::sync::Arc::new(plan));
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
        let balance = Balance::of_components(&frame([1.0, 0.25, 0.5, 0.125, 0.125]));
        let expected = Balance {
            mean: Some(0.0),
            rms: Some(0.0),
        };
        assert_eq!(balance, expected);
    }

    #[test]
    fn a_part_that_lacks_shows() {
        let balance = Balance::of_components(&frame([1.0, 0.25, 0.5, 0.0, 0.0]));
        assert_eq!(balance.mean, Some(-0.25));
        let black = Balance::of_components(&frame([0.0; 5]));
        assert_eq!(black, Balance::default());
        let none = Balance::of_expressions(&frame([1.0; 5]));
        assert_eq!(none, Balance::default());
    }
}
