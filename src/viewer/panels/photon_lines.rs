//! Lines over the picture: ways of photons, splitting planes, discs, gather rays, cache records.

use egui::{Color32, Painter, Pos2, Rect, Stroke, Ui};
use glam::{Vec2, Vec3A};

use crate::engine::camera::Projection;
use crate::engine::math::Frame as Basis;
use crate::engine::photon::{MapKind, SplitPlane};
use crate::viewer::gpu::{PixelRect, PointsLayer, place};
use crate::viewer::photons::Found;
use crate::viewer::workspace::Workspace;

/// Corners of a circle.
const CORNERS: usize = 32;
/// Most records that are drawn as circles.
const MAX_CIRCLES: usize = 4000;
/// Least depth that is drawn, a share of the scene's radius.
const NEAR: f32 = 1e-4;

const CAUSTIC: Color32 = Color32::from_rgb(255, 170, 60);
const GLOBAL: Color32 = Color32::from_rgb(90, 180, 255);
const VOLUME: Color32 = Color32::from_rgb(150, 220, 210);
const WAY: Color32 = Color32::from_rgb(250, 230, 120);
const RAY: Color32 = Color32::from_rgb(120, 220, 140);
const RECORD: Color32 = Color32::from_rgb(220, 130, 220);

/// From the scene to points of the window.
struct Pen {
    painter: Painter,
    projection: Projection,
    /// Left top corner of the picture and window points per pixel of it.
    corner: Pos2,
    scale: f32,
    near: f32,
}

/// Draws all that is chosen over the picture in `rect`.
pub fn show(ui: &Ui, workspace: &Workspace, rect: Rect) {
    let choice = workspace.photons.choice;
    let (Some(frame), Some(scene)) = (&workspace.frame, &workspace.scene) else {
        return;
    };
    let tiles = workspace.model.display.tiles();
    let (Some(view), [_]) = (&frame.photons, tiles.as_slice()) else {
        return;
    };
    let Ok(camera) = workspace.model.camera(workspace.pixels()) else {
        return;
    };
    let per_point = ui.ctx().pixels_per_point();
    let area = PixelRect {
        min: Vec2::ZERO,
        size: workspace.area.as_vec2(),
    };
    let (corner, scale) = place(area, workspace.pixels(), workspace.placement);
    let (center, radius) = scene.geometry.bounding_sphere();
    let pen = Pen {
        painter: ui.painter().with_clip_rect(rect),
        projection: camera.projection(),
        corner: rect.min + egui::vec2(corner.x, corner.y) / per_point,
        scale: scale / per_point,
        near: NEAR * radius,
    };
    if choice.planes > 0
        && let Some(map) = view.map(choice.map())
    {
        let (lo, hi) = (center - radius, center + radius);
        let (lo, hi) = bounds(map.photons().map(|p| p.p)).unwrap_or((lo, hi));
        for plane in map.planes(lo.to_array(), hi.to_array(), choice.planes - 1) {
            pen.plane(&plane);
        }
    }
    for way in &workspace.photons.ways {
        let line = Stroke::new(1.0, WAY.gamma_multiply(0.7));
        for pair in way.points.windows(2) {
            pen.line(pair[0], pair[1], line);
        }
        for photon in &way.stored {
            pen.dot(photon.p, 2.5, WAY);
        }
    }
    if choice.records
        && let Some(cache) = view.cache()
    {
        for record in cache.records().iter().take(MAX_CIRCLES) {
            let reach = cache.reach(record);
            pen.circle(record.p, record.n, reach, Stroke::new(1.0, RECORD));
        }
    }
    if choice.asks
        && let Some(found) = &workspace.photons.found
    {
        pen.found(found, radius);
    }
}

/// Most photons that are drawn while the camera moves.
const MOVING: u64 = 250_000;

/// The photons over the picture, if they are shown.
pub fn layer(workspace: &Workspace) -> Option<PointsLayer> {
    let choice = workspace.photons.choice;
    let frame = workspace.frame.as_ref()?;
    let single = workspace.model.display.tiles().len() == 1;
    if !single || frame.photons.is_none() || !choice.is_on() {
        return None;
    }
    let camera = workspace.model.camera(workspace.pixels()).ok()?;
    let area = PixelRect {
        min: Vec2::ZERO,
        size: workspace.area.as_vec2(),
    };
    let landed = workspace.photons.landed();
    let (count, side) = if workspace.navigating {
        (landed.min(MOVING), 1)
    } else {
        (landed, choice.side)
    };
    Some(PointsLayer {
        points: workspace.photons.points.clone(),
        count: usize::try_from(count).unwrap_or(usize::MAX),
        projection: camera.projection(),
        place: place(area, workspace.pixels(), workspace.placement),
        side,
        alone: choice.alone,
        depths: workspace.photons.depths.clone(),
    })
}

/// The box of the points; None without any.
fn bounds(points: impl Iterator<Item = Vec3A>) -> Option<(Vec3A, Vec3A)> {
    points.fold(None, |range, p| {
        let (lo, hi) = range.unwrap_or((p, p));
        Some((lo.min(p), hi.max(p)))
    })
}

impl Pen {
    /// Where a point before the near plane is.
    fn at(&self, p: Vec3A) -> Option<Pos2> {
        let (film, depth) = self.projection.film(p);
        (depth >= self.near).then(|| self.corner + egui::vec2(film.x, film.y) * self.scale)
    }

    /// What of a line lies before the near plane.
    fn line(&self, a: Vec3A, b: Vec3A, stroke: Stroke) {
        let depth = |p: Vec3A| (p - self.projection.position).dot(self.projection.forward);
        let (da, db) = (depth(a), depth(b));
        if da.max(db) <= self.near {
            return;
        }
        // Cut a little beyond, so that rounding leaves both ends before it.
        let cut = |from: Vec3A, to: Vec3A, d: f32, e: f32| {
            if d > self.near {
                from
            } else {
                from + (to - from) * ((1.001 * self.near - d) / (e - d))
            }
        };
        let (p, q) = (cut(a, b, da, db), cut(b, a, db, da));
        if let (Some(p), Some(q)) = (self.at(p), self.at(q)) {
            self.painter.line_segment([p, q], stroke);
        }
    }

    fn dot(&self, p: Vec3A, radius: f32, color: Color32) {
        if let Some(at) = self.at(p) {
            self.painter.circle_filled(at, radius, color);
        }
    }

    fn circle(&self, center: Vec3A, n: Vec3A, radius: f32, stroke: Stroke) {
        let basis = Basis::from_normal(n);
        let corner = |i: usize| {
            let angle = std::f32::consts::TAU * i as f32 / CORNERS as f32;
            let local = Vec3A::new(angle.cos(), angle.sin(), 0.0) * radius;
            center + basis.to_world(local)
        };
        for i in 0..CORNERS {
            self.line(corner(i), corner(i + 1), stroke);
        }
    }

    /// The rectangle that a plane cuts from its box.
    fn plane(&self, plane: &SplitPlane) {
        let [u, v] = [(plane.axis + 1) % 3, (plane.axis + 2) % 3];
        let corner = |high_u: bool, high_v: bool| {
            let mut p = [0.0; 3];
            p[plane.axis] = plane.at;
            p[u] = if high_u { plane.hi[u] } else { plane.lo[u] };
            p[v] = if high_v { plane.hi[v] } else { plane.lo[v] };
            Vec3A::from_array(p)
        };
        let corners = [
            corner(false, false),
            corner(true, false),
            corner(true, true),
            corner(false, true),
        ];
        // Red, green and blue for x, y and z.
        let color = [
            Color32::from_rgb(235, 90, 80),
            Color32::from_rgb(90, 205, 90),
            Color32::from_rgb(95, 130, 255),
        ][plane.axis];
        for i in 0..4 {
            let (a, b) = (corners[i], corners[(i + 1) % 4]);
            self.line(a, b, Stroke::new(1.0, color));
        }
    }

    /// Gather rays, then the photons of each estimate, as bright as they weigh, and their disc.
    fn found(&self, found: &Found, scene_radius: f32) {
        let (p, n) = (found.si.p, found.si.n_g);
        for ray in &found.rays {
            let line = Stroke::new(0.7, RAY.gamma_multiply(0.45));
            let end = ray.end.unwrap_or(p + ray.d * scene_radius);
            self.line(p, end, line);
            if ray.end.is_some() {
                self.dot(end, 1.6, RAY);
            }
        }
        for (kind, query, photons) in &found.queries {
            let color = color_of(*kind);
            for (at, weight) in photons {
                self.dot(*at, 2.5, color.gamma_multiply(0.25 + 0.75 * weight));
            }
            if !photons.is_empty() {
                self.circle(p, n, query.radius, Stroke::new(1.5, color));
            }
        }
        self.dot(p, 3.0, Color32::WHITE);
    }
}

/// The colour of a map.
pub fn color_of(kind: MapKind) -> Color32 {
    match kind {
        MapKind::Caustic => CAUSTIC,
        MapKind::Global => GLOBAL,
        MapKind::Volume => VOLUME,
    }
}
