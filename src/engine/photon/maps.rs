//! The maps of a scene.

use super::emission::Emission;
use super::map::{MapCounts, MapSettings, PhotonMap};
use super::projection::ProjectionMap;
use super::trace::MapKind;
use crate::engine::path::PathClasses;
use crate::engine::scene::Scene;

/// The photon maps of a scene; a map that nothing reads, or that no photon can reach, is absent.
#[derive(Clone, Debug, Default)]
pub struct PhotonMaps {
    /// Prefixes (S|G)+.
    pub caustic: Option<PhotonMap>,
    /// All others.
    pub global: Option<PhotonMap>,
    /// In media.
    pub volume: Option<PhotonMap>,
}

/// Which maps are wanted, and how large.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapsSettings {
    /// Photons of the caustic map; 0: it is not built.
    pub caustic: usize,
    /// Photons of the global map; 0: it is not built.
    pub global: usize,
    /// Photons of the volume map; 0: it is not built.
    pub volume: usize,
    /// The rest, `photons` left aside.
    pub map: MapSettings,
}

impl PhotonMaps {
    /// Builds the maps. `check` is asked once a piece of work.
    ///
    /// # Errors
    /// What `check` returns.
    pub fn build<E: Send>(
        scene: &Scene,
        classes: &PathClasses,
        settings: &MapsSettings,
        check: &(impl Fn() -> Result<(), E> + Sync),
    ) -> Result<Self, E> {
        if scene.lights.is_empty() {
            return Ok(Self::default());
        }
        let build = |kind, emission: &Emission, photons| {
            let settings = MapSettings {
                photons,
                ..settings.map
            };
            PhotonMap::build(scene, classes, kind, emission, &settings, check)
        };
        let mut maps = Self::default();
        if settings.volume > 0 && scene.features.volume {
            let everywhere = &Emission::Everywhere;
            maps.volume = Some(build(MapKind::Volume, everywhere, settings.volume)?);
        }
        if !scene.features.diffuse {
            return Ok(maps);
        }
        if settings.caustic > 0
            && let Some(aimed) = Emission::aimed(scene, ProjectionMap::new(scene))
        {
            maps.caustic = Some(build(MapKind::Caustic, &aimed, settings.caustic)?);
        }
        if settings.global > 0 {
            maps.global = Some(build(
                MapKind::Global,
                &Emission::Everywhere,
                settings.global,
            )?);
        }
        Ok(maps)
    }

    /// The maps there are.
    pub fn iter(&self) -> impl Iterator<Item = &PhotonMap> {
        self.caustic.iter().chain(&self.global).chain(&self.volume)
    }

    /// Bytes of all.
    pub fn memory_bytes(&self) -> usize {
        self.iter().map(PhotonMap::memory_bytes).sum()
    }

    /// Rays and cut paths of all.
    pub fn counts(&self) -> impl Iterator<Item = &MapCounts> {
        self.iter().map(|m| &m.counts)
    }
}
