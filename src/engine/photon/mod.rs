//! Photon maps (Jensen 1996, *Global Illumination using Photon Maps*; 2001, *Realistic Image
//! Synthesis Using Photon Mapping*).
//!
//! Light leaves the lights as photons, is scattered by one event at a time and stored wherever a
//! diffuse event exists, with the class of the events before. Two maps share the prefixes: the
//! caustic map holds (S|G)+, the global map all others.
//!
//! Invariant: a map depends on the scene, the layers and its settings, never on the camera or on
//! threads: photons are traced in fixed chunks that are joined in their order.

pub mod direction;
pub mod emission;
pub mod estimate;
pub mod irradiance_cache;
pub mod kdtree;
pub mod kernel;
pub mod map;
pub mod maps;
pub mod nearest;
pub mod paths;
pub mod projection;
pub mod record;
pub mod rgbe;
pub mod trace;
mod trace_media;
pub mod volume;

pub use estimate::{Contribution, Disc, Weighed};
pub use kdtree::{KdTree, SplitPlane, SplitRule};
pub use kernel::Kernel;
pub use map::{LEVELS, MapCounts, MapSettings, Numbers, Packing, PhotonMap};
pub use maps::{MapsSettings, PhotonMaps};
pub use nearest::Nearest;
pub use paths::PhotonPath;
pub use projection::ProjectionMap;
pub use record::{Photon, Record};
pub use trace::{MapKind, Roulette};
