//! Names of samples: a stream of random numbers and an index in it.

use std::fmt;

use glam::UVec2;

use crate::engine::photon::MapKind;
use crate::engine::sampling::Stream;

/// A sample of a render: with the render's settings and seed enough to compute it again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleId {
    /// The sample of a pixel in one pass, with the light path that is connected to it, if any.
    Camera {
        /// The pixel.
        pixel: UVec2,
        /// The pass.
        pass: u64,
    },
    /// A light path that is joined to the lens.
    LightPath {
        /// Its number within the pass.
        path: u64,
        /// The pass.
        pass: u64,
    },
    /// A light path whose vertices are merged.
    MergedPath {
        /// Its number within the pass.
        path: u64,
        /// The pass.
        pass: u64,
    },
    /// A photon of a map.
    Photon {
        /// The map.
        map: MapKind,
        /// Its number among those emitted.
        number: u64,
        /// The pass that reads the map; it matters where every pass has maps of its own.
        pass: u64,
    },
    /// A step of a Markov chain.
    ChainStep {
        /// The chain.
        chain: u64,
        /// Its step, from 1.
        step: u64,
    },
    /// An independent sample that chains may start from.
    Bootstrap {
        /// Its number.
        number: u64,
    },
}

/// Names of the maps, as they are typed.
const MAPS: [(&str, MapKind); 3] = [
    ("caustic", MapKind::Caustic),
    ("global", MapKind::Global),
    ("volume", MapKind::Volume),
];

impl SampleId {
    /// Names of all streams that samples have.
    pub const STREAMS: [&'static str; 5] = ["camera", "light", "photon", "chain", "bootstrap"];

    /// The sample of a stream called `stream` that `index` names: `X,Y,PASS` of the camera,
    /// `PATH,PASS` of light paths, `MAP,NUMBER,PASS` of photons, `CHAIN,STEP`, or a number.
    ///
    /// # Errors
    /// What is wrong, in one sentence.
    pub fn parse(stream: &str, index: &str) -> Result<Self, String> {
        let parts: Vec<&str> = index.split(',').map(str::trim).collect();
        let wrong =
            |right: &str| format!("\"{index}\" is no index of the stream {stream}; {right}");
        let numbers = |parts: &[&str]| -> Option<Vec<u64>> {
            parts.iter().map(|part| part.parse().ok()).collect()
        };
        let map = MAPS.iter().find(|(name, _)| parts.first() == Some(name));
        match (stream, map, parts.len()) {
            ("camera", ..) => match numbers(&parts).as_deref() {
                Some(&[x, y, pass]) if x.max(y) <= u64::from(u32::MAX) => Ok(Self::Camera {
                    pixel: UVec2::new(x as u32, y as u32),
                    pass,
                }),
                _ => Err(wrong("write X,Y,PASS, such as 12,34,0")),
            },
            ("light", Some((_, map)), 3) => match numbers(&parts[1..]).as_deref() {
                Some(&[number, pass]) => Ok(Self::Photon {
                    map: *map,
                    number,
                    pass,
                }),
                _ => Err(wrong("write MAP,NUMBER,PASS, such as caustic,12,0")),
            },
            ("light" | "photon", ..) => match numbers(&parts).as_deref() {
                Some(&[path, pass]) if stream == "light" => Ok(Self::LightPath { path, pass }),
                Some(&[path, pass]) => Ok(Self::MergedPath { path, pass }),
                _ if stream == "photon" => Err(wrong("write PATH,PASS, such as 12,0")),
                _ => Err(wrong(
                    "write PATH,PASS, such as 12,0, or for a photon of a map MAP,NUMBER,PASS with \
                     the map caustic, global or volume",
                )),
            },
            ("chain", ..) => match numbers(&parts).as_deref() {
                Some(&[chain, step]) => Ok(Self::ChainStep { chain, step }),
                _ => Err(wrong("write CHAIN,STEP, such as 3,1000")),
            },
            ("bootstrap", ..) => match numbers(&parts).as_deref() {
                Some(&[number]) => Ok(Self::Bootstrap { number }),
                _ => Err(wrong("write a number")),
            },
            _ => Err(format!(
                "there is no stream \"{stream}\"; there are {}",
                Self::STREAMS.join(", ")
            )),
        }
    }

    /// The stream its random numbers come from.
    pub fn stream(&self) -> Stream {
        match self {
            Self::Camera { .. } => Stream::Camera,
            Self::LightPath { .. } | Self::Photon { .. } => Stream::Light,
            Self::MergedPath { .. } => Stream::Photon,
            Self::ChainStep { .. } => Stream::Chain,
            Self::Bootstrap { .. } => Stream::Bootstrap,
        }
    }

    /// Name of its stream, as it is typed.
    pub fn stream_name(&self) -> &'static str {
        match self {
            Self::Camera { .. } => "camera",
            Self::LightPath { .. } | Self::Photon { .. } => "light",
            Self::MergedPath { .. } => "photon",
            Self::ChainStep { .. } => "chain",
            Self::Bootstrap { .. } => "bootstrap",
        }
    }

    /// The pass it belongs to; 0 where no number depends on one.
    pub fn pass(&self) -> u64 {
        match *self {
            Self::Camera { pass, .. }
            | Self::LightPath { pass, .. }
            | Self::MergedPath { pass, .. }
            | Self::Photon { pass, .. } => pass,
            Self::ChainStep { .. } | Self::Bootstrap { .. } => 0,
        }
    }
}

/// The index, as it is typed.
impl fmt::Display for SampleId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Camera { pixel, pass } => write!(f, "{},{},{pass}", pixel.x, pixel.y),
            Self::LightPath { path, pass } | Self::MergedPath { path, pass } => {
                write!(f, "{path},{pass}")
            }
            Self::Photon { map, number, pass } => {
                let name = MAPS.iter().find(|(_, kind)| *kind == map);
                write!(f, "{},{number},{pass}", name.map_or("global", |(n, _)| n))
            }
            Self::ChainStep { chain, step } => write!(f, "{chain},{step}"),
            Self::Bootstrap { number } => write!(f, "{number}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_printed_is_read_back() {
        let (path, pass) = (9, 3);
        let all = [
            SampleId::Camera {
                pixel: UVec2::new(5, 7),
                pass: u64::MAX,
            },
            SampleId::LightPath { path, pass },
            SampleId::MergedPath { path, pass },
            SampleId::Photon {
                map: MapKind::Caustic,
                number: 1,
                pass,
            },
            SampleId::ChainStep { chain: 4, step: 1 },
            SampleId::Bootstrap { number: 8 },
        ];
        for id in all {
            assert_eq!(SampleId::parse(id.stream_name(), &id.to_string()), Ok(id));
        }
    }

    #[test]
    fn what_is_no_index_is_refused_with_what_would_be() {
        for (stream, index, right) in [
            ("camera", "1,2", "X,Y,PASS"),
            ("camera", "1,2,-3", "X,Y,PASS"),
            ("camera", "4294967296,2,0", "X,Y,PASS"),
            ("light", "caustics,2,3", "MAP,NUMBER,PASS"),
            ("light", "", "PATH,PASS"),
            ("photon", "1,2,3", "PATH,PASS"),
            ("chain", "1", "CHAIN,STEP"),
            ("bootstrap", "x", "a number"),
            ("lights", "1", "camera, light, photon"),
        ] {
            let error = SampleId::parse(stream, index).unwrap_err();
            assert!(error.contains(right), "{stream} {index}: {error}");
        }
    }
}
