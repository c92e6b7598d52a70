//! Radiance files with texts, in comment lines of their head.

use std::io::BufRead;

use glam::UVec2;
use image::codecs::hdr::HdrEncoder;
use image::{ImageResult, Rgb};

/// The first line of a file.
const MAGIC: &[u8] = b"#?RADIANCE\n";

/// The bytes of a file. The format knows no NaN: such values are black.
///
/// # Errors
/// If `pixels` are not `size.x * size.y`.
pub fn encode(
    size: UVec2,
    pixels: &[[f32; 3]],
    texts: &[(String, String)],
) -> ImageResult<Vec<u8>> {
    let number = |x: f32| if x.is_nan() { 0.0 } else { x };
    let pixels: Vec<Rgb<f32>> = pixels.iter().map(|rgb| Rgb(rgb.map(number))).collect();
    let mut bytes = Vec::new();
    HdrEncoder::new(&mut bytes).encode(&pixels, size.x as usize, size.y as usize)?;
    if bytes.starts_with(MAGIC) {
        let line = |(name, text): &(String, String)| format!("# {name}={}\n", one_line(text));
        let lines: String = texts.iter().map(line).collect();
        bytes.splice(MAGIC.len()..MAGIC.len(), lines.into_bytes());
    }
    Ok(bytes)
}

fn one_line(text: &str) -> String {
    text.replace(['\n', '\r'], " ")
}

/// The texts of a file.
pub fn read_texts(file: impl BufRead) -> Vec<(String, String)> {
    // The head is text and ends at an empty line.
    let head = file
        .lines()
        .map_while(Result::ok)
        .take_while(|l| !l.is_empty());
    let text = |line: String| {
        let (name, text) = line.strip_prefix("# ")?.split_once('=')?;
        Some((name.to_owned(), text.to_owned()))
    };
    head.filter_map(text).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_and_texts_come_back() {
        let pixels = [[1.0, 0.5, 0.25], [f32::NAN, 2.0, 2.0]];
        let texts = [("a:b".to_owned(), "x=1 y=2".to_owned())];
        let bytes = encode(UVec2::new(2, 1), &pixels, &texts).expect("two pixels");
        let read = image::load_from_memory(&bytes)
            .expect("a picture")
            .to_rgb32f();
        assert_eq!(read.as_raw().as_slice(), [1.0, 0.5, 0.25, 0.0, 2.0, 2.0]);
        assert_eq!(read_texts(bytes.as_slice()), texts);
    }
}
