//! Images in: PNG, JPEG, Radiance HDR and OpenEXR, decoded to linear values.

use std::io::Cursor;
use std::path::Path;

use ::image::{ImageFormat, ImageReader, Limits};

use super::error::InputError;
use super::source::{Disk, FileSource, reason};
use crate::engine::scene::desc::ImageData;

/// How 8-bit values are meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Encoding {
    /// IEC 61966-2-1.
    Srgb,
    /// Values are proportional to light.
    Linear,
}

/// Largest side in pixels.
const MAX_SIDE: u32 = 16384;
/// Most memory a decoder may take, in bytes.
const MAX_MEMORY: u64 = 4 << 30;

/// Reads an image from the disk.
///
/// # Errors
/// A sentence if it cannot be read, or holds values that are no radiance.
pub fn read(path: &Path, encoding: Encoding) -> Result<ImageData, InputError> {
    read_from(&Disk, &path.to_string_lossy(), encoding)
}

/// Reads an image from `files`. Float formats are linear whatever `encoding` says.
///
/// # Errors
/// As [`read`].
pub fn read_from(
    files: &dyn FileSource,
    path: &str,
    encoding: Encoding,
) -> Result<ImageData, InputError> {
    let fail = |message: String| InputError::in_file(path, message);
    let bytes = files
        .read(path)
        .map_err(|e| fail(format!("the image cannot be read: {}", reason(&e))))?;
    let exr = bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]);
    let image = if exr {
        decode_exr(&bytes)
    } else {
        decode(&bytes, encoding)
    };
    let mut image = image.map_err(|e| fail(format!("the image cannot be decoded: {e}")))?;
    image.name = path.to_owned();
    if let Some(bad) = image
        .pixels
        .iter()
        .position(|p| p.iter().any(|v| !v.is_finite()))
    {
        let (x, y) = (bad % image.width, bad / image.width);
        let message = format!("pixel ({x}, {y}) is NaN or infinite; radiance is a finite number");
        return Err(fail(message));
    }
    Ok(image)
}

/// Most pixels a byte of a file stands for: 1032 bytes, which a byte of deflate says at most, of
/// eight pixels each. A file that claims more was cut, or was made to exhaust memory.
const PIXELS_A_BYTE: u64 = 1032 * 8;

/// Refuses a size that a file of `bytes` bytes cannot hold, before memory is taken for it.
fn check_claim(width: u64, height: u64, bytes: usize) -> Result<(), String> {
    let side = u64::from(MAX_SIDE);
    if width > side || height > side {
        return Err(format!(
            "it claims {width} × {height} pixels, and a side may have at most {side}"
        ));
    }
    if width * height > PIXELS_A_BYTE * bytes as u64 {
        return Err(format!(
            "it claims {width} × {height} pixels, more than its {bytes} bytes can hold"
        ));
    }
    Ok(())
}

/// Refuses an OpenEXR file whose parts claim more pixels than it can hold.
///
/// # Errors
/// What is wrong, without the file's name.
pub fn check_exr(bytes: &[u8]) -> Result<(), String> {
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false)
        .map_err(|e| e.to_string())?;
    let mut headers = meta.headers.iter();
    headers.try_for_each(|header| {
        let (width, height) = (header.layer_size.width(), header.layer_size.height());
        check_claim(width as u64, height as u64, bytes.len())
    })
}

fn decode(bytes: &[u8], encoding: Encoding) -> Result<ImageData, String> {
    let format = ::image::guess_format(bytes)
        .map_err(|_| "it is neither PNG, JPEG, Radiance HDR nor OpenEXR".to_owned())?;
    // Sizes stand in the head of a file; what follows is decoded only if it can hold so much.
    let head = ImageReader::with_format(Cursor::new(bytes), format);
    let (width, height) = head.into_dimensions().map_err(|e| e.to_string())?;
    check_claim(width.into(), height.into(), bytes.len())?;
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_MEMORY);
    reader.limits(limits);
    let image = reader.decode().map_err(|e| e.to_string())?;
    // A 16-bit file is as much a display encoding as an 8-bit one; Radiance is linear.
    let linear = format == ImageFormat::Hdr || encoding == Encoding::Linear;
    let rgb = image.into_rgb32f();
    let (width, height) = (rgb.width() as usize, rgb.height() as usize);
    let decode = |v: f32| if linear { v } else { srgb_to_linear(v) };
    let pixels = rgb.pixels().map(|p| p.0.map(decode)).collect();
    Ok(ImageData {
        name: String::new(),
        width,
        height,
        pixels,
    })
}

/// Decodes an sRGB value in [0, 1].
pub fn srgb_to_linear(v: f32) -> f32 {
    if v <= 0.040_45 {
        v / 12.92
    } else {
        ((v + 0.055) / 1.055).powf(2.4)
    }
}

fn decode_exr(bytes: &[u8]) -> Result<ImageData, String> {
    use exr::prelude::{ReadChannels, ReadLayers, read};
    check_exr(bytes)?;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| (size.width(), vec![[0.0_f32; 3]; size.area()]),
            |(width, pixels): &mut (usize, Vec<[f32; 3]>), at, (r, g, b): (f32, f32, f32)| {
                pixels[at.y() * *width + at.x()] = [r, g, b];
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(|e| e.to_string())?;
    let (width, pixels) = image.layer_data.channel_data.pixels;
    let height = pixels.len().checked_div(width).unwrap_or(0);
    if pixels.is_empty() {
        return Err("it has no pixels".to_owned());
    }
    Ok(ImageData {
        name: String::new(),
        width,
        height,
        pixels,
    })
}
