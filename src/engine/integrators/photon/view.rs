//! What photon mapping knows, for display: photons, queries, gather rays, cache records.

use std::sync::Arc;

use super::gather::GatherRay;
use super::walk::Estimator;
use crate::engine::geometry::SurfaceInteraction;
use crate::engine::integrators::{Pass, RenderStats};
use crate::engine::math::Rgb;
use crate::engine::path::PathClasses;
use crate::engine::photon::emission::Emission;
use crate::engine::photon::irradiance_cache::IrradianceCache;
use crate::engine::photon::trace::Witness;
use crate::engine::photon::{
    Disc, MapKind, Nearest, PhotonMap, PhotonMaps, PhotonPath, ProjectionMap, Weighed,
};
use crate::engine::sampling::{IndependentSampler, Stream};
use crate::engine::scene::Scene;

/// A snapshot; it shares its photons with the render.
#[derive(Clone)]
pub struct PhotonView(Estimator);

/// The photons of an estimate.
#[derive(Clone, Debug)]
pub struct PhotonQuery {
    /// Where and on which side.
    pub disc: Disc,
    /// Radius of the disc that holds them.
    pub radius: f32,
    /// They, by place in the map's tree, with their weights; [`PhotonMap::photon`] tells the rest.
    pub photons: Vec<Weighed>,
    /// The radiance estimated from them, toward where the surface was seen from.
    pub radiance: Rgb,
}

impl PhotonView {
    pub(super) fn new(estimator: &Estimator) -> Self {
        Self(estimator.clone())
    }

    /// The photons.
    pub fn maps(&self) -> &Arc<PhotonMaps> {
        &self.0.maps
    }

    /// A map, if it was built.
    pub fn map(&self, kind: MapKind) -> Option<&PhotonMap> {
        match kind {
            MapKind::Caustic => self.0.maps.caustic.as_ref(),
            MapKind::Global => self.0.maps.global.as_ref(),
            MapKind::Volume => self.0.maps.volume.as_ref(),
        }
    }

    /// The records of interpolated gathers, if there are any.
    pub fn cache(&self) -> Option<&IrradianceCache> {
        self.0.cache.as_deref()
    }

    /// The ways of the photons of numbers `range` of a map, from their light on; `classes` are
    /// those of the render's plan.
    pub fn paths(
        &self,
        scene: &Scene,
        classes: &PathClasses,
        kind: MapKind,
        range: std::ops::Range<u64>,
    ) -> Vec<PhotonPath> {
        let (Some(map), Some(settings)) = (self.map(kind), self.0.settings) else {
            return Vec::new();
        };
        let (seed, index) = self.0.numbers;
        let range = range.start..range.end.min(map.counts.emitted);
        emission(scene, kind).map_or_else(Vec::new, |emission| {
            map.paths(scene, classes, &emission, &settings.map(seed, index), range)
        })
    }

    /// Follows photon `number` of a map once more and tells `to` of its way.
    ///
    /// # Errors
    /// One sentence, if there is no such photon.
    pub fn follow(
        &self,
        scene: &Scene,
        classes: &PathClasses,
        kind: MapKind,
        number: u64,
        to: &mut impl Witness,
    ) -> Result<(), String> {
        let map = self.map(kind).zip(self.0.settings);
        let Some(((map, settings), emission)) = map.zip(emission(scene, kind)) else {
            return Err("that photon map was not built: nothing in this scene reads it".to_owned());
        };
        let emitted = map.counts.emitted;
        if number >= emitted {
            return Err(format!(
                "photon {number} was not emitted: those of this map are 0 to {}",
                emitted.saturating_sub(1)
            ));
        }
        let (seed, index) = self.0.numbers;
        let numbers = settings.map(seed, index);
        map.follow(scene, classes, &emission, &numbers, number, to);
        Ok(())
    }

    /// The estimate of a map at `si` as a render makes it where the eye looks.
    pub fn query(
        &self,
        scene: &Scene,
        si: &SurfaceInteraction,
        kind: MapKind,
    ) -> Option<PhotonQuery> {
        let (map, settings) = (self.map(kind)?, self.0.settings?);
        let max_radius = match kind {
            MapKind::Caustic => self.0.radii[0],
            MapKind::Global => self.0.radii[1],
            MapKind::Volume => return None, // it tells nothing of surfaces
        };
        let disc = Disc::new(si, max_radius, true);
        let (radius, photons) = map.inspect(&disc, self.0.nearest, settings.kernel);
        let (bsdf, mut radiance) = (scene.bsdf(si), Rgb::BLACK);
        let mut nearest = Nearest::new(self.0.nearest);
        map.estimate(si, &bsdf, &disc, settings.kernel, &mut nearest, |c| {
            radiance += c.radiance
        });
        Some(PhotonQuery {
            disc,
            radius,
            photons,
            radiance,
        })
    }

    /// The rays of a gather at `si` and the radiance that they bring.
    pub fn gather(&self, cx: &Pass<'_>, si: &SurfaceInteraction) -> (Vec<GatherRay>, Rgb) {
        let (mut rays, mut stats) = (Vec::new(), RenderStats::default());
        let mut scratch = self.0.scratch();
        let bsdf = cx.scene.bsdf(si);
        let numbers = IndependentSampler::new(cx.seed, Stream::Gather, (0, 0));
        let all = u32::MAX;
        self.0.gather(
            cx,
            si,
            &bsdf,
            all,
            numbers,
            &mut scratch,
            &mut stats,
            &mut rays,
        );
        (
            rays,
            scratch.sums.iter().map(|(_, radiance)| *radiance).sum(),
        )
    }
}

/// How the photons of a map were emitted.
fn emission(scene: &Scene, kind: MapKind) -> Option<Emission> {
    match kind {
        MapKind::Caustic => Emission::aimed(scene, ProjectionMap::new(scene)),
        MapKind::Global | MapKind::Volume => Some(Emission::Everywhere),
    }
}

impl std::fmt::Debug for PhotonView {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let count = |map: &Option<PhotonMap>| map.as_ref().map(PhotonMap::len);
        f.debug_struct("PhotonView")
            .field("caustic", &count(&self.0.maps.caustic))
            .field("global", &count(&self.0.maps.global))
            .field("volume", &count(&self.0.maps.volume))
            .finish()
    }
}
