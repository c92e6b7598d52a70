//! All surfaces of a scene, prepared for rays.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::OnceLock;

use glam::{Vec2, Vec3A};

use super::accel;
use super::bounds::Bounds3;
use super::closed::{self, Departure, RayFault, Shell};
use super::interaction::SurfaceInteraction;
use super::mesh::{DropReport, MAX_COORDINATE, MeshInput, TriangleMesh};
use super::ray::{Hit, Ray};
use super::sphere::{Sphere, SphereInput};
use super::traverse::Tree;
use crate::engine::math::hash::combine;

/// Triangles and spheres.
///
/// Primitives are numbered: the triangles in input order, mesh after mesh, then the spheres.
/// Dropped ones leave no gap; [`Geometry::mesh_triangles`] and [`Geometry::sphere_prim`] map input
/// to primitives.
///
/// Invariant: answers depend on the input alone, not on the shape of the hierarchy.
#[derive(Clone, Debug)]
pub struct Geometry {
    mesh: TriangleMesh,
    tree: Tree,
    sphere_materials: Vec<u32>,
    sphere_prims: Vec<Option<u32>>,
    /// By triangle; empty where no two lie in one place.
    hidden: Vec<bool>,
    /// By primitive; empty while no surface emits.
    lights: Vec<Option<u32>>,
    bounds: Bounds3,
    /// Nothing asks for texture coordinates.
    untextured: bool,
    /// By triangle; made when it is asked for first.
    shells: OnceLock<Vec<Shell>>,
}

impl Geometry {
    /// Prepares the surfaces; counts what cannot be hit and is left out.
    pub fn build(meshes: &[MeshInput<'_>], spheres: &[SphereInput]) -> (Self, DropReport) {
        let mut report = DropReport::default();
        let mesh = TriangleMesh::new(meshes, &mut report);
        let mut kept = Vec::new();
        let mut sphere_materials = Vec::new();
        let mut sphere_prims = Vec::new();
        for input in spheres {
            if is_valid(input) {
                sphere_prims.push(Some((mesh.len() + kept.len()) as u32));
                sphere_materials.push(input.material);
                kept.push(Sphere {
                    center: input.center.into(),
                    radius: input.radius,
                    inward: input.inward,
                });
            } else {
                sphere_prims.push(None);
                report.invalid_sphere += 1;
            }
        }
        let hidden = repeated(&mesh);
        let tree = accel::build(&mesh, kept, &hidden);
        let bounds = tree
            .spheres
            .iter()
            .fold(tree.triangle_bounds, |all, s| all.union(&s.bounds()));
        let geometry = Self {
            mesh,
            tree,
            sphere_materials,
            sphere_prims,
            hidden,
            lights: Vec::new(),
            bounds,
            untextured: false,
            shells: OnceLock::new(),
        };
        (geometry, report)
    }

    /// The closest hit in (0, `ray.t_max`); the lowest primitive where several are equally far.
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.tree.intersect(ray)
    }

    /// Whether anything lies in (0, `ray.t_max`).
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.tree.occluded(ray)
    }

    /// Everything about the point where `ray` met the geometry in `hit`.
    pub fn interaction(&self, ray: &Ray, hit: &Hit) -> SurfaceInteraction {
        let light = self.light(hit.prim);
        if let Some(index) = self.sphere_index(hit.prim) {
            let sphere = &self.tree.spheres[index];
            let point = sphere.point(ray, hit.t);
            return SurfaceInteraction {
                p: point.p,
                p_error: point.p_error,
                n_g: point.n,
                n_s: point.n,
                uv: if self.untextured {
                    Vec2::ZERO
                } else {
                    sphere.uv(point.n)
                },
                wo: -ray.d,
                t: hit.t,
                material: self.sphere_materials[index],
                light,
                prim: hit.prim,
            };
        }
        let point = self.mesh.point(hit.prim, hit.u, hit.v);
        SurfaceInteraction {
            p: point.p,
            p_error: point.p_error,
            n_g: point.n_g,
            n_s: point.n_s,
            uv: point.uv,
            wo: -ray.d,
            t: hit.t,
            material: point.material,
            light,
            prim: hit.prim,
        }
    }

    /// Sets which light each primitive belongs to.
    pub fn set_lights(&mut self, light_of: impl Fn(u32) -> Option<u32>) {
        self.lights = (0..self.primitive_count() as u32).map(light_of).collect();
        if self.lights.iter().all(Option::is_none) {
            self.lights = Vec::new();
        }
    }

    /// Leaves out the texture coordinates of spheres, which cost more than the point: no material
    /// looks them up.
    pub fn without_textures(&mut self) {
        self.untextured = true;
    }

    /// The light a primitive belongs to.
    #[inline]
    pub fn light(&self, prim: u32) -> Option<u32> {
        self.lights.get(prim as usize).copied().flatten()
    }

    /// The box around everything; empty without primitives.
    pub fn bounds(&self) -> Bounds3 {
        self.bounds
    }

    /// Centre and radius of a sphere around everything; a point without primitives.
    pub fn bounding_sphere(&self) -> (Vec3A, f32) {
        (self.bounds.center(), self.bounds.radius())
    }

    /// Number of triangles and spheres.
    pub fn primitive_count(&self) -> usize {
        self.triangle_count() + self.sphere_count()
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.mesh.len()
    }

    /// Number of spheres.
    pub fn sphere_count(&self) -> usize {
        self.tree.spheres.len()
    }

    /// Bytes of the tree that rays walk, of all that are held.
    pub fn tree_bytes(&self) -> usize {
        self.tree.memory_bytes()
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        self.mesh.memory_bytes()
            + self.tree.memory_bytes()
            + size_of_val(&*self.sphere_materials)
            + size_of_val(&*self.sphere_prims)
            + size_of_val(&*self.lights)
    }

    /// The corners of a triangle; `None` for a sphere.
    pub fn triangle_vertices(&self, prim: u32) -> Option<[Vec3A; 3]> {
        self.mesh.vertices(prim)
    }

    /// A sphere; `None` for a triangle.
    pub fn sphere(&self, prim: u32) -> Option<&Sphere> {
        self.tree.spheres.get(self.sphere_index(prim)?)
    }

    /// Surface area of a primitive.
    pub fn primitive_area(&self, prim: u32) -> f32 {
        match self.sphere(prim) {
            Some(sphere) => sphere.area(),
            None => self.mesh.area(prim),
        }
    }

    /// Index of a primitive's material; `None` past the end.
    pub fn material(&self, prim: u32) -> Option<u32> {
        match self.sphere_index(prim) {
            Some(index) => self.sphere_materials.get(index).copied(),
            None => self.mesh.material(prim),
        }
    }

    /// The primitives of an input mesh, without its dropped triangles.
    pub fn mesh_triangles(&self, mesh: usize) -> Range<u32> {
        self.mesh.prims(mesh)
    }

    /// The input mesh of a triangle and its index there.
    pub fn triangle_source(&self, prim: u32) -> Option<(usize, usize)> {
        self.mesh.source(prim)
    }

    /// Whether a ray that left at `left` may not meet what it left again, but did at `si`. A flat
    /// triangle is never met again, nor tested where rays know it ([`Ray::clear_of`]); a sphere is,
    /// from within to within.
    #[cold]
    pub fn self_hit(&self, left: Departure, si: &SurfaceInteraction) -> Option<RayFault> {
        let chord = self.sphere(left.prim).is_some_and(|sphere| {
            let arrives_in_front = si.n_g.dot(si.wo) > 0.0;
            left.front == sphere.inward && arrives_in_front == sphere.inward
        });
        (!chord).then_some(RayFault::SelfHit)
    }

    /// Whether a ray that left at `left` and met nothing had to meet something: it went into what
    /// a closed surface encloses. Scenes of very many triangles are not
    /// looked at (`closed::MOST_TRIANGLES`).
    #[cold]
    pub fn missed_edge(&self, left: Departure) -> Option<RayFault> {
        let enclosed = match self.sphere(left.prim) {
            Some(sphere) => left.front == sphere.inward,
            None if left.prim as usize >= self.mesh.len() => false,
            None => {
                let shells = self.shells.get_or_init(|| closed::shells(&self.mesh));
                let shell = shells.get(left.prim as usize).copied();
                match shell.unwrap_or(Shell::Open) {
                    Shell::Open => false,
                    Shell::Behind => !left.front,
                    Shell::InFront => left.front,
                }
            }
        };
        enclosed.then_some(RayFault::MissedEdge)
    }

    /// Whether a triangle lies exactly on another of a lower number, so that no ray meets it.
    pub fn is_hidden(&self, prim: u32) -> bool {
        self.hidden.get(prim as usize).copied().unwrap_or(false)
    }

    /// The primitive of an input sphere; `None` where it was dropped.
    pub fn sphere_prim(&self, sphere: usize) -> Option<u32> {
        self.sphere_prims.get(sphere).copied().flatten()
    }

    #[inline]
    fn sphere_index(&self, prim: u32) -> Option<usize> {
        prim.checked_sub(self.tree.first_sphere)
            .map(|index| index as usize)
    }
}

fn is_valid(sphere: &SphereInput) -> bool {
    let reach = sphere.center.abs().max_element() + sphere.radius;
    sphere.center.is_finite() && sphere.radius > 0.0 && reach <= MAX_COORDINATE
}

/// Marks triangles whose corners are, in whatever order, those of a lower primitive. They are not
/// in the tree: rounding would decide which of the two is hit, and a hundred thousand of them in one
/// place would cost a test each.
fn repeated(mesh: &TriangleMesh) -> Vec<bool> {
    let bits = |prim: u32| {
        let mut corners = mesh
            .vertices(prim)
            .map(|corners| corners.map(|p| p.to_array().map(|x| (x + 0.0).to_bits())));
        if let Some(corners) = &mut corners {
            corners.sort_unstable();
        }
        corners
    };
    let hash = |prim: u32| {
        let words = bits(prim).unwrap_or_default();
        words
            .into_iter()
            .flatten()
            .fold(0, |h, word| combine(h, u64::from(word)))
    };
    let count = mesh.len() as u32;
    let mut hashes: Vec<u64> = (0..count).map(hash).collect();
    hashes.sort_unstable();
    let twice: Vec<u64> = hashes
        .windows(2)
        .filter(|pair| pair[0] == pair[1])
        .map(|pair| pair[0])
        .collect();
    if twice.is_empty() {
        return Vec::new();
    }
    let mut seen = HashMap::new();
    (0..count)
        .map(|prim| {
            twice.binary_search(&hash(prim)).is_ok()
                && *seen.entry(bits(prim)).or_insert(prim) != prim
        })
        .collect()
}
