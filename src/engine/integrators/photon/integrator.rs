//! Photon mapping as an integrator: it keeps what a change does not touch.

use std::sync::Arc;

use super::params::{Indirect, PhotonSettings};
use super::view::PhotonView;
use super::walk::Estimator;
use crate::engine::film::Film;
use crate::engine::integrators::stats::ERRORS;
use crate::engine::integrators::tiled::{SamplerKind, Tiled};
use crate::engine::integrators::{
    BadSample, Cancelled, Fact, Integrator, Params, Pass, Recording, RenderStats, ReplayError,
    SampleId,
};
use crate::engine::photon::irradiance_cache::IrradianceCache;
use crate::engine::photon::{MapKind, MapsSettings, PhotonMap, PhotonMaps};
use crate::engine::scene::desc::CameraDesc;

/// All that maps depend on beside the scene. A map is built anew when its key changes, and then
/// only: a move of the camera and most settings change none.
#[derive(Clone, Debug, PartialEq)]
struct MapsKey {
    settings: MapsSettings,
    /// The expressions behind the classes that photons carry.
    layers: Vec<String>,
}

impl MapsKey {
    /// Whether maps of this key hold all that `wanted` asks for.
    fn serves(&self, wanted: &Self) -> bool {
        let (mut have, want) = (self.clone(), &wanted.settings);
        for (count, wanted) in [
            (&mut have.settings.caustic, want.caustic),
            (&mut have.settings.global, want.global),
            (&mut have.settings.volume, want.volume),
        ] {
            if wanted == 0 {
                *count = 0;
            }
        }
        have == *wanted
    }
}

/// All that the records of the irradiance cache depend on.
#[derive(Clone, Debug, PartialEq)]
struct CacheKey {
    maps: MapsKey,
    camera: CameraDesc,
    estimate: PhotonSettings,
}

/// The integrator.
pub struct PhotonMapper {
    settings: PhotonSettings,
    tiled: Tiled<Estimator>,
    maps: Option<(MapsKey, Arc<PhotonMaps>)>,
    cache: Option<(CacheKey, Arc<IrradianceCache>)>,
}

impl PhotonMapper {
    /// Without maps: they are built in the first pass.
    pub fn new(settings: PhotonSettings) -> Self {
        Self {
            settings,
            tiled: Tiled::new(Estimator::default(), SamplerKind::Sobol),
            maps: None,
            cache: None,
        }
    }

    /// The records of interpolated gathers, where there are some.
    fn cache(&self) -> Option<&IrradianceCache> {
        self.cache.as_ref().map(|(_, cache)| cache.as_ref())
    }

    fn key(&self, cx: &Pass<'_>) -> MapsKey {
        maps_key(&self.settings, cx, map_index(&self.settings, cx))
    }

    /// Builds the maps this pass needs, where they are not there yet.
    fn prepare(&mut self, cx: &Pass<'_>, stats: &mut RenderStats) -> Result<(), Cancelled> {
        let key = self.key(cx);
        if self
            .maps
            .as_ref()
            .is_none_or(|(have, _)| !have.serves(&key))
        {
            self.maps = None;
            self.cache = None;
            self.tiled.estimator_mut().forget();
            let maps = build_maps(&key, cx, stats)?;
            self.maps = Some((key.clone(), Arc::new(maps)));
        }
        let maps = self.maps.as_ref().map(|(_, maps)| Arc::clone(maps));
        *self.tiled.estimator_mut() =
            Estimator::new(&self.settings, cx, maps.unwrap_or_default(), 1.0);
        self.prepare_cache(cx, key, stats)
    }

    fn prepare_cache(
        &mut self,
        cx: &Pass<'_>,
        maps: MapsKey,
        stats: &mut RenderStats,
    ) -> Result<(), Cancelled> {
        // Records do not tell numbers of events apart: with a limit they cannot serve.
        if self.settings.indirect != Indirect::Cache
            || cx.plan.max_depth.is_some()
            || cx.plan.features.media
        {
            self.cache = None;
            return Ok(());
        }
        let estimate = PhotonSettings {
            caustic_map: true,
            global_map: true,
            ..self.settings
        };
        let camera = *cx.camera.desc();
        let key = CacheKey {
            maps,
            camera,
            estimate,
        };
        let estimator = self.tiled.estimator_mut();
        match &self.cache {
            Some((have, cache)) if *have == key => estimator.cache = Some(Arc::clone(cache)),
            _ => {
                estimator.fill_cache(cx, stats)?;
                self.cache = estimator.cache.clone().map(|cache| (key, cache));
            }
        }
        Ok(())
    }
}

/// Which of several independent maps a pass reads.
fn map_index(settings: &PhotonSettings, cx: &Pass<'_>) -> u64 {
    if settings.fresh_maps { cx.index } else { 0 }
}

fn maps_key(settings: &PhotonSettings, cx: &Pass<'_>, index: u64) -> MapsKey {
    let features = &cx.plan.features;
    // What is seen in a mirror reads both maps, whatever is blackened; without mirrors there are
    // no caustics, and nobody reads the global map if its component is black.
    let mirrors = features.specular || features.glossy;
    let (caustic, global) = (mirrors, settings.global_map || mirrors);
    let count = |read: bool, photons: usize| if read { photons } else { 0 };
    let expressions = cx.plan.classes.expressions().iter();
    MapsKey {
        settings: MapsSettings {
            caustic: count(caustic, settings.caustic_photons),
            global: count(global, settings.global_photons),
            volume: count(
                settings.volume_map && features.volume,
                settings.volume_photons,
            ),
            map: settings.map(cx.seed, index),
        },
        layers: expressions.map(|e| e.text().to_owned()).collect(),
    }
}

fn build_maps(
    key: &MapsKey,
    cx: &Pass<'_>,
    stats: &mut RenderStats,
) -> Result<PhotonMaps, Cancelled> {
    let check = || cx.cancel.check();
    let maps = PhotonMaps::build(cx.scene, &cx.plan.classes, &key.settings, &check)?;
    for map in maps.iter() {
        let counts = &map.counts;
        stats.faults += counts.faults;
        stats.self_hits += counts.strayed[0];
        stats.missed_edges += counts.strayed[1];
        if let Some((number, what)) = counts.first_bad {
            let (map, pass) = (map.kind, cx.index);
            stats.keep(BadSample {
                id: SampleId::Photon { map, number, pass },
                what: ERRORS[what],
            });
        }
        stats.rays += counts.rays - counts.levels.iter().sum::<u64>();
        stats.add_light_rays(&counts.levels);
        stats.add_games(counts.roulette[0], counts.roulette[1]);
        stats.cut_paths += counts.cut;
    }
    Ok(maps)
}

impl Estimator {
    /// Reads `maps`; `scale` shrinks the area of every estimate (1: as the settings say).
    pub(super) fn new(
        settings: &PhotonSettings,
        cx: &Pass<'_>,
        maps: Arc<PhotonMaps>,
        scale: f32,
    ) -> Self {
        let radius = cx.scene.geometry.bounding_sphere().1 * scale.sqrt();
        Self {
            settings: Some(PhotonSettings {
                // Gather rays know of no media.
                indirect: if cx.plan.features.media {
                    Indirect::Direct
                } else {
                    settings.indirect
                },
                ..*settings
            }),
            volume_radius: settings.volume_radius * radius,
            maps,
            cache: None,
            radii: [
                settings.caustic_radius * radius,
                settings.global_radius * radius,
            ],
            nearest: ((settings.nearest as f32 * scale).round() as usize).max(2),
            numbers: (cx.seed, map_index(settings, cx)),
        }
    }

    /// Lets go of maps, so that they are freed before others are built.
    fn forget(&mut self) {
        self.maps = Arc::default();
        self.cache = None;
    }
}

/// Fresh maps of number `index` for the settings.
pub(super) fn fresh_maps(
    settings: &PhotonSettings,
    cx: &Pass<'_>,
    index: u64,
    stats: &mut RenderStats,
) -> Result<PhotonMaps, Cancelled> {
    build_maps(&maps_key(settings, cx, index), cx, stats)
}

impl Integrator for PhotonMapper {
    fn render_pass(&mut self, cx: &Pass<'_>, film: &mut Film) -> Result<RenderStats, Cancelled> {
        let mut stats = RenderStats::default();
        self.prepare(cx, &mut stats)?;
        stats += self.tiled.render_pass(cx, film)?;
        Ok(stats)
    }

    fn replay(
        &mut self,
        cx: &Pass<'_>,
        sample: &SampleId,
        to: &mut Recording,
    ) -> Result<(), ReplayError> {
        self.prepare(cx, &mut RenderStats::default())?;
        let SampleId::Photon { map, number, .. } = *sample else {
            return self.tiled.replay(cx, sample, to);
        };
        let view = PhotonView::new(self.tiled.estimator());
        view.follow(cx.scene, &cx.plan.classes, map, number, to)
            .map_err(ReplayError::Cannot)
    }

    fn update(&mut self, params: &Params) -> bool {
        self.settings = PhotonSettings::new(params);
        true
    }

    fn needs_preview(&self, cx: &Pass<'_>) -> bool {
        let built = self
            .maps
            .as_ref()
            .is_some_and(|(have, _)| have.serves(&self.key(cx)));
        !built || self.settings.indirect != Indirect::Direct
    }

    fn memory_bytes(&self) -> usize {
        let maps = self
            .maps
            .as_ref()
            .map_or(0, |(_, maps)| maps.memory_bytes());
        let cache = self.cache().map_or(0, IrradianceCache::memory_bytes);
        self.tiled.buffer_bytes() + maps + cache
    }

    fn facts(&self) -> Vec<Fact> {
        let mut facts = Vec::new();
        if let Some((_, maps)) = &self.maps {
            let mut named = vec![("caustic map", &maps.caustic), ("global map", &maps.global)];
            if maps.volume.is_some() {
                named.push(("volume map", &maps.volume));
                if self.settings.indirect != Indirect::Direct {
                    facts.push(Fact {
                        label: "indirect light",
                        value: "from the global map directly: gather rays know no media".to_owned(),
                    });
                }
            }
            facts.extend(named.into_iter().map(|(label, map)| {
                Fact {
                    label,
                    value: map
                        .as_ref()
                        .map_or("not built: nothing reads it".to_owned(), describe),
                }
            }));
        }
        if let Some(cache) = self.cache() {
            let (records, bytes) = (cache.records().len(), cache.memory_bytes());
            facts.push(Fact {
                label: "irradiance cache",
                value: format!("{records} records, {bytes} bytes"),
            });
        }
        facts
    }

    fn photons(&self) -> Option<PhotonView> {
        self.maps
            .is_some()
            .then(|| PhotonView::new(self.tiled.estimator()))
    }
}

fn describe(map: &PhotonMap) -> String {
    let counts = &map.counts;
    let [r, g, b] = counts.power;
    let aim = match map.kind {
        MapKind::Caustic => " toward mirrors, glass and gloss",
        MapKind::Global | MapKind::Volume => "",
    };
    format!(
        "{} photons of {} emitted{aim}, power {r:.4} {g:.4} {b:.4} W, {} bytes",
        counts.stored,
        counts.emitted,
        map.memory_bytes()
    )
}
