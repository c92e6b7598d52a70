//! What is shown of photon maps over the picture, and what a click on a surface finds there.

use std::sync::Arc;

use glam::{UVec2, Vec2, Vec3A};

pub use super::gpu::{Depths, Point, Points};
use super::picking;
use super::workspace::Workspace;
use crate::engine::film::Frame;
use crate::engine::geometry::SurfaceInteraction;
use crate::engine::integrators::photon::{GatherRay, PhotonQuery};
use crate::engine::integrators::{Cancel, Pass, PhotonView};
use crate::engine::math::Rgb;
use crate::engine::path::{ClassId, PathClasses};
use crate::engine::photon::{MapKind, Photon, PhotonMaps, PhotonPath};

/// Columns of the grid of depths that hide photons: one ray each, at every change of view.
const COLUMNS: u32 = 240;
/// Where no surface is: shaders need not know infinity.
const FAR: f32 = 1e30;
/// Letters of the longest word that names a class.
const LONGEST_NAME: usize = 4;
/// Colours of classes: those of Okabe and Ito (2008), which colour-blind people tell apart.
const PALETTE: [[u8; 3]; 8] = [
    [230, 159, 0],
    [86, 180, 233],
    [0, 158, 115],
    [240, 228, 66],
    [0, 114, 178],
    [213, 94, 0],
    [204, 121, 167],
    [255, 255, 255],
];

/// Which photons are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Drawn {
    /// None.
    #[default]
    None,
    /// Those of the caustic map.
    Caustic,
    /// Those of the global map.
    Global,
    /// Those of the volume map.
    Volume,
    /// Those of all maps.
    All,
}

impl Drawn {
    /// The maps whose photons are drawn.
    pub fn kinds(self) -> &'static [MapKind] {
        match self {
            Self::None => &[],
            Self::Caustic => &[MapKind::Caustic],
            Self::Global => &[MapKind::Global],
            Self::Volume => &[MapKind::Volume],
            Self::All => &[MapKind::Caustic, MapKind::Global, MapKind::Volume],
        }
    }
}

/// What the colour of a photon tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum ColorBy {
    /// Its power.
    #[default]
    Power,
    /// Where it came from: x, y and z as red, green and blue.
    Direction,
    /// The class of its path.
    Class,
}

/// What is shown, as the user chose it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Photons.
    pub drawn: Drawn,
    /// Their colour.
    pub color: ColorBy,
    /// The picture is left out.
    pub alone: bool,
    /// Photons behind surfaces are left out.
    pub hide: bool,
    /// Side of a photon in physical pixels.
    pub side: u32,
    /// Photons that have landed so far; all if absent.
    pub landed: Option<u64>,
    /// They land while one looks on.
    pub landing: bool,
    /// Photons whose ways are drawn.
    pub ways: u64,
    /// Levels of splitting planes.
    pub planes: u32,
    /// Records of the irradiance cache.
    pub records: bool,
    /// A click on the picture asks what is there.
    pub asks: bool,
}

impl Default for Choice {
    fn default() -> Self {
        Self {
            drawn: Drawn::None,
            color: ColorBy::Power,
            alone: false,
            hide: true,
            side: 2,
            landed: None,
            landing: false,
            ways: 0,
            planes: 0,
            records: false,
            asks: false,
        }
    }
}

impl Choice {
    /// Whether anything is drawn over the picture.
    pub fn is_on(&self) -> bool {
        self.drawn != Drawn::None || self.ways > 0 || self.planes > 0 || self.records || self.asks
    }

    /// The map that planes and ways are shown of.
    pub fn map(&self) -> MapKind {
        match self.drawn {
            Drawn::Caustic => MapKind::Caustic,
            Drawn::Volume => MapKind::Volume,
            _ => MapKind::Global,
        }
    }
}

/// What a map says of a point, with the place of each photon and its kernel weight over the largest.
pub type Queried = (MapKind, PhotonQuery, Vec<(Vec3A, f32)>);

/// What a click found.
#[derive(Clone, Debug)]
pub struct Found {
    /// Where.
    pub si: SurfaceInteraction,
    /// What each map says there.
    pub queries: Vec<Queried>,
    /// Gather rays.
    pub rays: Vec<GatherRay>,
    /// What they bring.
    pub gathered: Rgb,
}

/// What was made from a frame's photons and serves until they change.
#[derive(Default)]
pub struct Photons {
    /// The choice.
    pub choice: Choice,
    /// The points that are drawn.
    pub points: Points,
    made_of: Option<PointsKey>,
    /// Ways of photons.
    pub ways: Vec<PhotonPath>,
    ways_of: Option<(usize, MapKind, u64)>,
    /// The answer to the last click.
    pub found: Option<Found>,
    found_in: Option<(usize, u64)>,
    /// What hides photons.
    pub depths: Arc<Depths>,
    depths_of: Option<(crate::engine::camera::Projection, u64)>,
    /// Names of the classes that drawn photons have, with their colours.
    pub legend: Vec<(String, [u8; 3])>,
    scenes: (usize, u64),
}

#[derive(Clone, PartialEq)]
struct PointsKey {
    maps: usize,
    drawn: Drawn,
    color: ColorBy,
}

/// Tells one set of maps from another while it lives.
fn address(maps: &Arc<PhotonMaps>) -> usize {
    Arc::as_ptr(maps) as usize
}

impl Photons {
    /// Photons on the points' list.
    pub fn count(&self) -> u64 {
        self.points.list.len() as u64
    }

    /// Those of them that are drawn.
    pub fn landed(&self) -> u64 {
        let all = self.count();
        self.choice.landed.map_or(all, |n| n.min(all))
    }

    /// Lets time pass: photons land one by one, then faster and faster. True while they do.
    pub fn tick(&mut self, seconds: f32) -> bool {
        if !self.choice.landing {
            return false;
        }
        let landed = self.landed();
        let next = landed + 1 + (landed as f64 * f64::from(seconds.clamp(0.0, 0.1))) as u64;
        if next >= self.count() {
            self.choice.landed = None;
            self.choice.landing = false;
        } else {
            self.choice.landed = Some(next);
        }
        self.choice.landing
    }

    /// Makes the points anew if the photons, or what is wanted of them, changed.
    fn refresh_points(&mut self, view: &PhotonView, classes: &PathClasses) {
        let key = PointsKey {
            maps: address(view.maps()),
            drawn: self.choice.drawn,
            color: self.choice.color,
        };
        if self.made_of.as_ref() == Some(&key) {
            return;
        }
        // With the mean power of their map, beside which they are bright or faint.
        let mut photons: Vec<(Photon, f32)> = Vec::new();
        for map in key.drawn.kinds().iter().filter_map(|kind| view.map(*kind)) {
            let mean = map.counts.power.iter().sum::<f64>() / (3 * map.len().max(1)) as f64;
            photons.extend(map.photons().map(|photon| (photon, mean as f32)));
        }
        self.legend.clear();
        let palette = Palette::new(classes, &photons);
        let points = mixed(photons.len()).map(|i| Point {
            p: photons[i].0.p.to_array(),
            color: palette.color(key.color, &photons[i]),
        });
        self.points.list = Arc::new(points.collect());
        self.points.number += 1;
        if key.color == ColorBy::Class {
            self.legend = palette.legend;
        }
        self.made_of = Some(key);
    }
}

/// The numbers below `n`, each once, in an order that shares no pattern with the tree's: steps of
/// the golden ratio.
fn mixed(n: usize) -> impl Iterator<Item = usize> {
    let gcd = |mut a: usize, mut b: usize| {
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    let mut step = ((n as f64 * 0.618_033_988_75) as usize).max(1);
    while gcd(step, n) > 1 {
        step += 1;
    }
    (0..n).map(move |i| (i as u64 * step as u64 % n as u64) as usize)
}

/// Colours of photons.
struct Palette {
    /// Colour by class number.
    classes: Vec<(ClassId, [u8; 3])>,
    legend: Vec<(String, [u8; 3])>,
}

impl Palette {
    fn new(classes: &PathClasses, photons: &[(Photon, f32)]) -> Self {
        let (mut found, mut legend) = (Vec::new(), Vec::new());
        for (class, word) in classes.shortest_words(LONGEST_NAME) {
            if !photons.iter().any(|(p, _)| p.class == class) {
                continue;
            }
            let color = PALETTE[found.len() % PALETTE.len()];
            found.push((class, color));
            legend.push((format!("L{word}…"), color));
        }
        Self {
            classes: found,
            legend,
        }
    }

    fn color(&self, by: ColorBy, (photon, mean): &(Photon, f32)) -> [u8; 4] {
        let [r, g, b] = match by {
            ColorBy::Power => {
                // Hue by the power, brightness by its share of the mean: the mean shows at 71 %.
                let most = photon.power.max_component().max(f32::MIN_POSITIVE);
                let bright = (most / (most + mean)).sqrt();
                photon
                    .power
                    .to_array()
                    .map(|x| ((x / most).max(0.0).powf(1.0 / 2.2) * bright * 255.0) as u8)
            }
            ColorBy::Direction => photon.wi.to_array().map(|x| (127.5 + 127.5 * x) as u8),
            ColorBy::Class => {
                let own = self
                    .classes
                    .iter()
                    .find(|(class, _)| *class == photon.class);
                own.map_or([128; 3], |(_, color)| *color)
            }
        };
        [r, g, b, 255]
    }
}

/// Makes what is shown fit for the frame and the view.
pub fn refresh(workspace: &mut Workspace) {
    let (Some(frame), Some(scene)) = (workspace.frame.clone(), workspace.scene.clone()) else {
        return;
    };
    let Some(view) = &frame.photons else { return };
    let photons = &mut workspace.photons;
    photons.refresh_points(view, &frame.plan.classes);

    let choice = photons.choice;
    let wanted = (address(view.maps()), choice.map(), choice.ways);
    if photons.ways_of != Some(wanted) {
        let range = 0..choice.ways;
        photons.ways = view.paths(&scene, &frame.plan.classes, choice.map(), range);
        photons.ways_of = Some(wanted);
    }

    let now = (address(view.maps()), frame.epoch);
    if let Some(found) = &photons.found
        && photons.found_in != Some(now)
    {
        let si = found.si;
        workspace.photons.found = answer(workspace, &frame, si);
        workspace.photons.found_in = Some(now);
    }
    refresh_depths(workspace);
}

/// What the photons say at a position of the picture's area, in physical pixels.
pub fn ask(workspace: &mut Workspace, at: Vec2) {
    let Some(frame) = workspace.frame.clone() else {
        return;
    };
    let si = picking::surface(workspace, at);
    workspace.photons.found = si.and_then(|si| answer(workspace, &frame, si));
    let now = frame
        .photons
        .as_ref()
        .map(|v| (address(v.maps()), frame.epoch));
    workspace.photons.found_in = now;
}

fn answer(workspace: &Workspace, frame: &Frame, si: SurfaceInteraction) -> Option<Found> {
    let (view, scene) = (frame.photons.as_ref()?, workspace.scene.as_ref()?);
    let camera = workspace.model.camera(workspace.pixels()).ok()?;
    let cancel = Cancel::never();
    let pass = Pass {
        scene,
        camera: &camera,
        plan: &frame.plan,
        seed: workspace.model.settings.seed,
        index: 0,
        cancel: &cancel,
    };
    let place = |kind: MapKind| {
        let query = view.query(scene, &si, kind)?;
        let map = view.map(kind)?;
        let most = query.photons.iter().map(|w| w.density).fold(0.0, f32::max);
        let weighed = query.photons.iter().map(|w| {
            let share = if most > 0.0 { w.density / most } else { 0.0 };
            (map.photon(w.index).p, share)
        });
        let weighed = weighed.collect();
        Some((kind, query, weighed))
    };
    let kinds = [MapKind::Caustic, MapKind::Global];
    let (rays, gathered) = view.gather(&pass, &si);
    Some(Found {
        si,
        queries: kinds.into_iter().filter_map(place).collect(),
        rays,
        gathered,
    })
}

/// One ray a cell; none where nothing hides.
fn refresh_depths(workspace: &mut Workspace) {
    let Some(scene) = workspace.scene.clone() else {
        return;
    };
    let choice = workspace.photons.choice;
    if !choice.hide || choice.drawn == Drawn::None {
        if !workspace.photons.depths.depths.is_empty() {
            workspace.photons.depths = Arc::default();
        }
        workspace.photons.depths_of = None;
        return;
    }
    let full = workspace.pixels();
    let rows = (COLUMNS * full.y / full.x.max(1)).clamp(1, 4 * COLUMNS);
    let Ok(camera) = workspace.model.camera(UVec2::new(COLUMNS, rows)) else {
        return;
    };
    let address = Arc::as_ptr(&scene) as usize;
    let photons = &mut workspace.photons;
    if photons.scenes.0 != address {
        photons.scenes = (address, photons.scenes.1 + 1);
    }
    // The grid's own pixels are not quite square: it must cover the picture.
    let aim = full.as_vec2() / camera.size().as_vec2();
    let Ok(view) = workspace.model.camera(full) else {
        return;
    };
    let key = (view.projection(), workspace.photons.scenes.1);
    if workspace.photons.depths_of == Some(key) {
        return;
    }
    let depth = |x: u32, y: u32| {
        let film = (Vec2::new(x as f32, y as f32) + 0.5) * aim;
        let ray = view.generate_ray(film, Vec2::splat(0.5));
        let si = scene.intersect(&ray, || 0.0);
        si.map_or(FAR, |si| si.t * ray.d.dot(view.forward()))
    };
    let depths = (0..rows).flat_map(|y| (0..COLUMNS).map(move |x| (x, y)));
    workspace.photons.depths = Arc::new(Depths {
        size: [COLUMNS, rows],
        depths: depths.map(|(x, y)| depth(x, y)).collect(),
    });
    workspace.photons.depths_of = Some(key);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_photon_is_drawn_once_in_mixed_order() {
        for n in [0, 1, 2, 3, 10, 1000, 4096] {
            let mut order: Vec<usize> = mixed(n).collect();
            let in_order = order.windows(2).filter(|w| w[1] == w[0] + 1).count();
            assert!(n < 10 || in_order < n / 4, "{n}");
            order.sort_unstable();
            assert!(order.into_iter().eq(0..n), "{n}");
        }
    }

    #[test]
    fn photons_land_one_by_one_until_all_are_there() {
        let mut photons = Photons::default();
        let point = Point {
            p: [0.0; 3],
            color: [0; 4],
        };
        photons.points.list = Arc::new(vec![point; 500]);
        photons.choice.landed = Some(0);
        photons.choice.landing = true;
        let mut last = 0;
        for _ in 0..5 {
            assert!(photons.tick(1.0 / 60.0));
            assert_eq!(photons.landed(), last + 1);
            last = photons.landed();
        }
        while photons.tick(1.0 / 60.0) {
            assert!(photons.landed() > last);
            last = photons.landed();
        }
        assert_eq!((photons.landed(), photons.choice.landed), (500, None));
    }
}
