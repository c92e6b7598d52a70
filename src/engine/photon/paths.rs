//! The first pass once more, photon by photon: for those who want to see photons land.

use glam::Vec3A;

use super::emission::Emission;
use super::map::{MapSettings, PhotonMap, follow};
use super::record::Photon;
use super::trace::{Walks, Witness};
use crate::engine::geometry::{Ray, SurfaceInteraction};
use crate::engine::math::Rgb;
use crate::engine::path::{ClassId, PathClasses};
use crate::engine::scene::Scene;

/// The way of one photon.
#[derive(Clone, Debug, Default)]
pub struct PhotonPath {
    /// Where it left the light, met surfaces, and, where it left the scene, a point on its last
    /// ray.
    pub points: Vec<Vec3A>,
    /// What of it was stored, in full precision.
    pub stored: Vec<Photon>,
}

impl Witness for PhotonPath {
    fn stored(&mut self, photon: Photon, _si: &SurfaceInteraction, _u: f32) {
        self.stored.push(photon);
    }

    fn travelled(&mut self, ray: &Ray, si: Option<&SurfaceInteraction>, _: Rgb, _: ClassId) {
        if self.points.is_empty() {
            self.points.push(ray.o);
        }
        self.points.push(si.map_or(ray.at(1.0), |si| si.p));
    }
}

impl PhotonMap {
    /// The ways of the photons of numbers `range` that this map was made of; `settings` and
    /// `emission` are those it was built with.
    pub fn paths(
        &self,
        scene: &Scene,
        classes: &PathClasses,
        emission: &Emission,
        settings: &MapSettings,
        range: std::ops::Range<u64>,
    ) -> Vec<PhotonPath> {
        let one = |number| {
            let mut path = PhotonPath::default();
            self.follow(scene, classes, emission, settings, number, &mut path);
            path
        };
        range.map(one).collect()
    }

    /// Follows photon `number` of those that this map was made of, and tells `to` of its way.
    pub fn follow(
        &self,
        scene: &Scene,
        classes: &PathClasses,
        emission: &Emission,
        settings: &MapSettings,
        number: u64,
        to: &mut impl Witness,
    ) {
        let walks = Walks {
            scene,
            classes,
            kind: self.kind,
            roulette: settings.roulette,
            emission,
        };
        let share = (1.0 / self.counts.emitted.max(1) as f64) as f32;
        follow(&walks, settings, (false, number), share, to);
    }
}
