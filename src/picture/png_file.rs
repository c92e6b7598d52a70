//! PNG files with texts, which the `image` crate does not write.

use glam::UVec2;
use png::{BitDepth, ColorType, Encoder, EncodingError, SrgbRenderingIntent};

/// The bytes of a file of 8-bit sRGB pixels.
///
/// # Errors
/// If `pixels` are not `size.x * size.y`.
pub fn encode(
    size: UVec2,
    pixels: &[[u8; 3]],
    texts: &[(String, String)],
) -> Result<Vec<u8>, EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, size.x, size.y);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    for (name, text) in texts {
        encoder.add_itxt_chunk(name.clone(), text.clone())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels.as_flattened())?;
    writer.finish()?;
    Ok(bytes)
}

/// All texts of a file; none if it is no PNG.
pub fn read_texts(file: impl std::io::BufRead + std::io::Seek) -> Vec<(String, String)> {
    let Ok(reader) = png::Decoder::new(file).read_info() else {
        return Vec::new();
    };
    let texts = reader.info().utf8_text.iter();
    texts
        .filter_map(|t| Some((t.keyword.clone(), t.get_text().ok()?)))
        .collect()
}

/// The text `name` of a file, if it is a PNG that has one.
#[cfg(feature = "viewer")]
pub fn read_text(file: impl std::io::BufRead + std::io::Seek, name: &str) -> Option<String> {
    let texts = read_texts(file).into_iter();
    texts
        .filter(|(n, _)| n == name)
        .map(|(_, text)| text)
        .next()
}

#[cfg(all(test, feature = "viewer"))]
mod tests {
    use super::*;

    #[test]
    fn pixels_and_texts_come_back() {
        let pixels = [[1, 2, 3], [255, 0, 9]];
        let texts = [("lightscope:state".to_owned(), "{\"π\": 3}".to_owned())];
        let bytes = encode(UVec2::new(2, 1), &pixels, &texts).expect("two pixels");
        let read = image::load_from_memory(&bytes).expect("a PNG").to_rgb8();
        assert_eq!(read.as_raw().as_slice(), pixels.as_flattened());
        let text = |name| read_text(std::io::Cursor::new(&bytes), name);
        assert_eq!(text("lightscope:state").as_deref(), Some("{\"π\": 3}"));
        assert_eq!(text("other"), None);
        assert!(encode(UVec2::new(3, 1), &pixels, &texts).is_err());
    }
}
