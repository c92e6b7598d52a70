//! Layered OpenEXR files: one part, channels `R G B` for the whole and `label.R` … for the
//! layers, texts in string attributes.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;

use exr::error::Error;
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image, LayerAttributes,
    ReadChannels, ReadLayers, SmallVec, Text, WritableImage,
};
use glam::UVec2;

use super::{Layer, Picture, WHOLE, labels};
use crate::engine::io::image;

/// The bytes of a file. The same pictures give the same bytes, lines being stored in order, but for
/// the order of the texts, which the library keeps in a hash map.
///
/// # Errors
/// If a layer has no name, or another number of pixels.
pub fn encode(
    size: UVec2,
    layers: &[(&str, &[[f32; 3]])],
    texts: &[(String, String)],
) -> Result<Vec<u8>, Error> {
    let mut channels = SmallVec::new();
    for (label, pixels) in layers {
        for (c, letter) in ["R", "G", "B"].into_iter().enumerate() {
            let samples = pixels.iter().map(|pixel| pixel[c]).collect();
            let name = Text::new_or_none(channel_name(label, letter))
                .ok_or_else(|| Error::NotSupported("name of a layer".into()))?;
            channels.push(AnyChannel::new(name, FlatSamples::F32(samples)));
        }
    }
    let mut attributes = LayerAttributes::default();
    for (name, text) in texts {
        // Strings are UTF-8 by the format's definition; `Text` knows Latin-1 only.
        let value = AttributeValue::Text(Text::from_slice_unchecked(text.as_bytes()));
        attributes
            .other
            .insert(Text::from_slice_unchecked(name.as_bytes()), value);
    }
    let size = (size.x as usize, size.y as usize);
    let channels = AnyChannels::sort(channels);
    let part = exr::image::Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, channels);
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(part).write().to_buffered(&mut bytes)?;
    Ok(bytes.into_inner())
}

fn channel_name(label: &str, letter: &str) -> String {
    if label == WHOLE {
        letter.to_owned()
    } else {
        format!("{label}.{letter}")
    }
}

/// Reads the first part of a file.
///
/// # Errors
/// If it cannot be read, or is no such file.
pub fn read(path: &Path) -> Result<Picture, Error> {
    decode(&std::fs::read(path)?)
}

/// Reads the first part of the bytes of a file.
///
/// # Errors
/// If they are no such file.
pub fn decode(bytes: &[u8]) -> Result<Picture, Error> {
    image::check_exr(bytes).map_err(|message| Error::Invalid(message.into()))?;
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))?;
    let part = image.layer_data;
    let attributes = part.attributes.other.iter().chain(&image.attributes.other);
    let texts: BTreeMap<String, String> = attributes
        .filter_map(|(name, value)| Some((utf8(name), text_of(value)?)))
        .collect();
    let mut layers: Vec<Layer> = Vec::new();
    for channel in &part.channel_data.list {
        let name = utf8(&channel.name);
        let (label, letter) = name.rsplit_once('.').unwrap_or((WHOLE, &name));
        let Some(c) = ["R", "G", "B"].iter().position(|known| *known == letter) else {
            continue;
        };
        let index = layers
            .iter()
            .position(|layer| layer.label == label)
            .unwrap_or_else(|| {
                let pixels = vec![[0.0; 3]; part.size.area()];
                let expression = texts.get(label).cloned();
                layers.push(Layer {
                    label: label.to_owned(),
                    expression,
                    pixels,
                });
                layers.len() - 1
            });
        for (pixel, value) in layers[index]
            .pixels
            .iter_mut()
            .zip(channel.sample_data.values_as_f32())
        {
            pixel[c] = value;
        }
    }
    layers.sort_by_key(|layer| place(&layer.label));
    Ok(Picture {
        size: UVec2::new(part.size.x() as u32, part.size.y() as u32),
        layers,
        standard_errors: Vec::new(),
        attributes: texts.into_iter().collect(),
    })
}

/// The text `name` of a file, if it is an OpenEXR file that has one.
#[cfg(feature = "viewer")]
pub fn read_text(path: &Path, name: &str) -> Option<String> {
    let meta = exr::meta::MetaData::read_from_file(path, false).ok()?;
    let header = meta.headers.first()?;
    let own = header.own_attributes.other.iter();
    let mut all = own.chain(&header.shared_attributes.other);
    all.find(|(key, _)| utf8(key) == name)
        .and_then(|(_, value)| text_of(value))
}

/// The whole first, then the components, then the rest in the order of their names.
fn place(label: &str) -> (usize, String) {
    let index = labels().position(|known| known == label);
    (index.unwrap_or(usize::MAX), label.to_owned())
}

fn utf8(text: &Text) -> String {
    String::from_utf8_lossy(text.bytes()).into_owned()
}

fn text_of(value: &AttributeValue) -> Option<String> {
    match value {
        AttributeValue::Text(text) => Some(utf8(text)),
        AttributeValue::F32(x) => Some(x.to_string()),
        AttributeValue::F64(x) => Some(x.to_string()),
        AttributeValue::I32(x) => Some(x.to_string()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_and_texts_come_back_as_they_were() {
        let size = UVec2::new(3, 2);
        let ramp = |start: f32| {
            (0..6)
                .map(|i| [start + i as f32, -0.0, 1e-30])
                .collect::<Vec<_>>()
        };
        let (whole, direct, expr) = (ramp(0.5), ramp(-2.0), ramp(1e9));
        let layers = [
            (WHOLE, &whole[..]),
            ("direct", &direct[..]),
            ("expr1", &expr[..]),
        ];
        let texts = [
            ("expr1".to_owned(), "LD.*E".to_owned()),
            ("a:b".to_owned(), "π ≠ 3".to_owned()),
        ];
        let bytes = encode(size, &layers, &texts).unwrap();
        let one = &texts[..1];
        let twice = [(); 2].map(|()| encode(size, &layers, one).unwrap());
        assert!(twice[0] == twice[1]);

        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.exr");
        std::fs::write(&path, bytes).unwrap();
        let picture = read(&path).unwrap();
        assert_eq!(picture.size, size);
        let labels: Vec<&str> = picture.layers.iter().map(|l| l.label.as_str()).collect();
        assert_eq!(labels, ["whole", "direct", "expr1"]);
        for (layer, (_, pixels)) in picture.layers.iter().zip(layers) {
            assert_eq!(layer.pixels, pixels);
        }
        assert_eq!(picture.layers[2].key(), "LD.*E");
        assert!(
            picture
                .attributes
                .contains(&("a:b".to_owned(), "π ≠ 3".to_owned()))
        );
    }
}
