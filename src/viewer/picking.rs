//! What lies under the cursor.

use glam::{Vec2, Vec3};

use super::gpu::picture_point;
use super::workspace::Workspace;
use crate::engine::geometry::SurfaceInteraction;

/// A point of a surface that the picture shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Hit {
    /// Where.
    pub point: Vec3,
    /// Geometric normal.
    pub normal: Vec3,
    /// Distance from the eye.
    pub distance: f32,
    /// Name of its material.
    pub material: String,
}

/// The surface at a position of the picture's area in physical pixels.
pub fn hit(workspace: &Workspace, at: Vec2) -> Option<Hit> {
    let scene = workspace.scene.as_ref()?;
    let si = surface(workspace, at)?;
    let material = scene.material_names.get(si.material as usize);
    Some(Hit {
        point: si.p.into(),
        normal: si.n_g.into(),
        distance: si.t,
        material: material.cloned().unwrap_or_default(),
    })
}

/// All that is known of the surface there.
pub fn surface(workspace: &Workspace, at: Vec2) -> Option<SurfaceInteraction> {
    let scene = workspace.scene.as_ref()?;
    let size = workspace.pixels();
    let (display, placement) = (&workspace.model.display, workspace.placement);
    let film = picture_point(display, placement, workspace.area, size, at)?;
    let camera = workspace.model.camera(size).ok()?;
    // The middle of the lens.
    let ray = camera.generate_ray(film, Vec2::splat(0.5));
    // Half-transparent surfaces count as surfaces.
    scene.intersect(&ray, || 0.0)
}
