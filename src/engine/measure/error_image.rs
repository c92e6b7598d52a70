//! Where a picture is wrong: one number a pixel.

use glam::UVec2;

/// Which number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum ErrorKind {
    /// Mean of |x − r| over the channels, in units of radiance.
    #[default]
    Absolute,
    /// The same over the mean of |r| over the channels, plus a hundredth of the picture's mean so
    /// that black pixels do not count without bound.
    Relative,
    /// Mean of x − r over the channels: what is too bright and what is too dark.
    Signed,
}

impl ErrorKind {
    /// All of them, in the order of the window's list.
    pub const ALL: [Self; 3] = [Self::Absolute, Self::Relative, Self::Signed];

    /// Name in the window.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Absolute => "absolute",
            Self::Relative => "relative",
            Self::Signed => "signed",
        }
    }
}

/// Share of the pixels whose error lies within the scale of colours.
const WITHIN: f64 = 0.99;
/// Share of the picture's mean that is added to the reference of a relative error.
const FLOOR: f64 = 0.01;

/// An error a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorImage {
    /// Pixels.
    pub size: UVec2,
    /// Which error.
    pub kind: ErrorKind,
    /// Row by row; NaN where a picture is not finite.
    pub values: Vec<f32>,
    /// The error at the end of the scale: 99 of 100 pixels lie within. 1, 2 or 5 times a power
    /// of ten, so that it stays still while errors shrink a little.
    pub scale: f32,
}

impl ErrorImage {
    /// Of a picture against a reference; none if they differ in size.
    pub fn new(
        kind: ErrorKind,
        size: UVec2,
        image: &[[f32; 3]],
        reference: &[[f32; 3]],
    ) -> Option<Self> {
        if image.len() != reference.len() || image.len() != size.x as usize * size.y as usize {
            return None;
        }
        let floor = FLOOR * mean(reference);
        let value = |x: &[f32; 3], r: &[f32; 3]| {
            let each = |f: fn(f64, f64) -> f64| {
                (0..3)
                    .map(|c| f(f64::from(x[c]), f64::from(r[c])))
                    .sum::<f64>()
                    / 3.0
            };
            let value = match kind {
                ErrorKind::Absolute => each(|x, r| (x - r).abs()),
                ErrorKind::Relative => each(|x, r| (x - r).abs()) / (each(|_, r| r.abs()) + floor),
                ErrorKind::Signed => each(|x, r| x - r),
            };
            value as f32
        };
        let values: Vec<f32> = image
            .iter()
            .zip(reference)
            .map(|(x, r)| value(x, r))
            .collect();
        let scale = scale(&values);
        Some(Self {
            size,
            kind,
            values,
            scale,
        })
    }

    /// Place of a value on the scale: 0 to 1, of signed errors −1 to 1; none if it is not finite.
    pub fn place(&self, value: f32) -> Option<f32> {
        let lowest = if self.kind == ErrorKind::Signed {
            -1.0
        } else {
            0.0
        };
        value
            .is_finite()
            .then(|| (value / self.scale).clamp(lowest, 1.0))
    }
}

fn mean(pixels: &[[f32; 3]]) -> f64 {
    let finite = pixels.iter().flatten().filter(|x| x.is_finite());
    let (sum, n) = finite.fold((0.0, 0u64), |(s, n), x| (s + f64::from(*x), n + 1));
    sum / n.max(1) as f64
}

fn scale(values: &[f32]) -> f32 {
    let finite = values.iter().filter(|v| v.is_finite());
    let mut sizes: Vec<f32> = finite.map(|v| v.abs()).collect();
    if sizes.is_empty() {
        return 1.0;
    }
    let at = ((sizes.len() - 1) as f64 * WITHIN) as usize;
    let (_, size, _) = sizes.select_nth_unstable_by(at, f32::total_cmp);
    round_up(*size)
}

/// The next 1, 2 or 5 times a power of ten; 1 for 0.
fn round_up(x: f32) -> f32 {
    if x <= f32::MIN_POSITIVE {
        return 1.0;
    }
    let power = 10f32.powf(x.log10().floor());
    let step = [1.0, 2.0, 5.0].into_iter().find(|s| x <= s * power);
    step.unwrap_or(10.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_errors_of_one_pixel() {
        let (x, r) = ([[1.0, 2.0, 3.0]], [[2.0, 2.0, 2.0]]);
        let of = |kind| ErrorImage::new(kind, UVec2::ONE, &x, &r).unwrap();
        let two_thirds = 2.0 / 3.0;
        assert!((of(ErrorKind::Absolute).values[0] - two_thirds).abs() < 1e-6);
        assert!((of(ErrorKind::Relative).values[0] - two_thirds / 2.02).abs() < 1e-6);
        assert_eq!(of(ErrorKind::Signed).values[0], 0.0);
        assert!(ErrorImage::new(ErrorKind::Signed, UVec2::ONE, &x, &[]).is_none());
    }

    #[test]
    fn the_scale_ends_at_a_round_number() {
        for (x, up) in [
            (0.9, 1.0),
            (1.0, 1.0),
            (1.1, 2.0),
            (30.0, 50.0),
            (0.06, 0.1),
            (0.0, 1.0),
        ] {
            assert!((round_up(x) / up - 1.0).abs() < 1e-5, "{x}");
        }
        let (x, r) = ([[0.0; 3], [f32::NAN; 3]], [[0.3; 3], [0.3; 3]]);
        let image = ErrorImage::new(ErrorKind::Signed, UVec2::new(2, 1), &x, &r).unwrap();
        assert!((image.scale - 0.5).abs() < 1e-6);
        assert!((image.place(image.values[0]).unwrap() + 0.6).abs() < 1e-5);
        assert_eq!(
            (image.place(image.values[1]), image.place(9.0)),
            (None, Some(1.0))
        );
    }
}
