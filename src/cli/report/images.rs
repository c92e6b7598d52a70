//! Pictures of a report.

use crate::cli::error::CliError;
use crate::engine::film::tonemap::{NAN_COLOR, tonemap};
use crate::engine::film::{Frame, ToneMap};
use crate::engine::measure::error_image::{ErrorImage, ErrorKind};
use crate::picture::{colors, png_file};
use glam::UVec2;

/// Linear value that the mean of the lit pixels' logarithms is brought to.
const MIDDLE_GREY: f64 = 0.18;
/// Relative error at the bright end of the error images' scale.
pub const ERROR_SCALE: f32 = 0.5;

/// The exposure in stops that suits a picture (Reinhard et al. 2002, equation 2).
fn exposure(pixels: &[[f32; 3]]) -> f32 {
    let luminance = pixels
        .iter()
        .map(|p| f64::from(p[0] + 2.0 * p[1] + p[2]) / 4.0);
    let lit = luminance.filter(|l| l.is_finite() && *l > 0.0);
    let (sum, n) = lit.fold((0.0, 0u64), |(s, n), l| (s + l.ln(), n + 1));
    if n == 0 {
        return 0.0;
    }
    (MIDDLE_GREY / (sum / n as f64).exp()).log2() as f32
}

/// A PNG of `pixels`, exposed as suits `like`.
pub fn picture(
    size: UVec2,
    pixels: &[[f32; 3]],
    like: &[[f32; 3]],
    texts: &[(String, String)],
) -> Result<Vec<u8>, CliError> {
    let ev = exposure(like);
    let shown = |rgb: &[f32; 3]| match rgb.iter().any(|x| x.is_nan()) {
        true => NAN_COLOR,
        false => tonemap(ToneMap::Filmic, ev, *rgb),
    };
    encode(size, &pixels.iter().map(shown).collect::<Vec<_>>(), texts)
}

/// A PNG of the relative error of a frame; the same scale for all, so that they can be compared.
pub fn error(
    frame: &Frame,
    reference: &[[f32; 3]],
    texts: &[(String, String)],
) -> Result<Option<Vec<u8>>, CliError> {
    let pixels = &frame.layers[0].pixels;
    let Some(image) = ErrorImage::new(ErrorKind::Relative, frame.size, pixels, reference) else {
        return Ok(None);
    };
    let color = |v: &f32| match v.is_finite() {
        true => colors::viridis(v / ERROR_SCALE),
        false => colors::NO_NUMBER,
    };
    let pixels: Vec<[u8; 3]> = image.values.iter().map(color).collect();
    encode(frame.size, &pixels, texts).map(Some)
}

fn encode(
    size: UVec2,
    pixels: &[[u8; 3]],
    texts: &[(String, String)],
) -> Result<Vec<u8>, CliError> {
    png_file::encode(size, pixels, texts)
        .map_err(|error| CliError::failed(format!("a picture cannot be encoded: {error}")))
}
