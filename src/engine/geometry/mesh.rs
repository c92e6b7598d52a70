//! Triangle meshes: what a scene gives, what is dropped, and the data of a shaded point.
//!
//! This is the cold half: it is read once a hit. Traversal has its own copy of the vertices.

use std::ops::Range;

use glam::{DVec3, Vec2, Vec3, Vec3A};

use super::offset::inset;
use crate::engine::math::float::MACHINE_EPSILON;

/// A mesh as a scene gives it, in world space.
#[derive(Clone, Copy, Debug, Default)]
pub struct MeshInput<'a> {
    /// Vertex positions.
    pub positions: &'a [Vec3],
    /// A normal a vertex, of any length, or empty for flat facets.
    pub normals: &'a [Vec3],
    /// A pair of texture coordinates a vertex, or empty.
    pub uvs: &'a [[f32; 2]],
    /// Vertex indices, counter-clockwise seen from the front.
    pub triangles: &'a [[u32; 3]],
    /// Index into the scene's materials.
    pub material: u32,
}

/// How many primitives were left out, and why.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DropReport {
    /// Triangles with an index past the end of the vertices.
    pub bad_index: usize,
    /// Triangles with a NaN or infinite vertex.
    pub non_finite: usize,
    /// Triangles with a coordinate beyond [`MAX_COORDINATE`].
    pub out_of_range: usize,
    /// Triangles without area: collinear vertices or repeated indices.
    pub zero_area: usize,
    /// Spheres with a radius that is not positive, or not finite, or out of range.
    pub invalid_sphere: usize,
    /// Meshes whose normals or texture coordinates do not match their vertices in number; these
    /// are ignored, the triangles stay.
    pub ignored_attributes: usize,
}

impl DropReport {
    /// All primitives left out.
    pub fn total(&self) -> usize {
        self.bad_index + self.non_finite + self.out_of_range + self.zero_area + self.invalid_sphere
    }
}

/// The largest coordinate: products of two differences stay far from overflow.
pub const MAX_COORDINATE: f32 = 1e18;

/// No normals, or no texture coordinates.
const NONE: u32 = u32::MAX;

/// One input mesh.
#[derive(Clone, Debug)]
struct Part {
    material: u32,
    first_vertex: u32,
    first_normal: u32,
    first_uv: u32,
    prims: Range<u32>,
}

/// All triangles of a scene, in input order without the dropped ones.
#[derive(Clone, Debug, Default)]
pub struct TriangleMesh {
    parts: Vec<Part>,
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    uvs: Vec<[f32; 2]>,
    triangles: Vec<[u32; 3]>,
    part_of: Vec<u32>,
    /// Index in the input mesh; empty where nothing was dropped.
    source: Vec<u32>,
}

/// A point of a triangle.
#[derive(Clone, Copy, Debug)]
pub struct TrianglePoint {
    /// Position.
    pub p: Vec3A,
    /// Bound on the absolute error of `p`.
    pub p_error: Vec3A,
    /// Unit geometric normal.
    pub n_g: Vec3A,
    /// Unit shading normal, in the hemisphere of `n_g`.
    pub n_s: Vec3A,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Index into the scene's materials.
    pub material: u32,
}

impl TriangleMesh {
    /// Takes over the meshes; counts in `report` what it leaves out.
    pub fn new(meshes: &[MeshInput<'_>], report: &mut DropReport) -> Self {
        let mut all = Self::default();
        let mut source = Vec::new();
        for mesh in meshes {
            all.push(mesh, &mut source, report);
        }
        if report.total() > 0 {
            all.source = source;
        }
        all
    }

    fn push(&mut self, mesh: &MeshInput<'_>, source: &mut Vec<u32>, report: &mut DropReport) {
        let vertices = mesh.positions.len();
        let usable = |length: usize| length == vertices && length > 0;
        for length in [mesh.normals.len(), mesh.uvs.len()] {
            report.ignored_attributes += usize::from(length > 0 && length != vertices);
        }
        let first_vertex = self.positions.len() as u32;
        let first_prim = self.triangles.len() as u32;
        let (mut first_normal, mut first_uv) = (NONE, NONE);
        self.positions.extend_from_slice(mesh.positions);
        if usable(mesh.normals.len()) {
            first_normal = self.normals.len() as u32;
            self.normals.extend_from_slice(mesh.normals);
        }
        if usable(mesh.uvs.len()) {
            first_uv = self.uvs.len() as u32;
            self.uvs.extend_from_slice(mesh.uvs);
        }
        for (i, triangle) in mesh.triangles.iter().enumerate() {
            if accept(mesh.positions, triangle, report) {
                self.triangles.push(triangle.map(|v| first_vertex + v));
                self.part_of.push(self.parts.len() as u32);
                source.push(i as u32);
            }
        }
        self.parts.push(Part {
            material: mesh.material,
            first_vertex,
            first_normal,
            first_uv,
            prims: first_prim..self.triangles.len() as u32,
        });
    }

    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// The primitives of an input mesh.
    pub fn prims(&self, mesh: usize) -> Range<u32> {
        self.parts.get(mesh).map_or(0..0, |part| part.prims.clone())
    }

    /// Input mesh of a triangle and its index there.
    pub fn source(&self, prim: u32) -> Option<(usize, usize)> {
        let mesh = *self.part_of.get(prim as usize)? as usize;
        let index = match self.source.get(prim as usize) {
            Some(&index) => index,
            None => prim - self.parts[mesh].prims.start,
        };
        Some((mesh, index as usize))
    }

    /// The corners of a triangle.
    pub fn vertices(&self, prim: u32) -> Option<[Vec3A; 3]> {
        let triangle = self.triangles.get(prim as usize)?;
        Some(triangle.map(|v| self.positions[v as usize].into()))
    }

    /// Material of a triangle.
    pub fn material(&self, prim: u32) -> Option<u32> {
        let part = *self.part_of.get(prim as usize)?;
        self.parts.get(part as usize).map(|part| part.material)
    }

    /// Area of a triangle; 0 past the end.
    pub fn area(&self, prim: u32) -> f32 {
        self.vertices(prim)
            .map_or(0.0, |v| (0.5 * scaled_normal(v).length()) as f32)
    }

    /// The point of triangle `prim` with the barycentric weights `u`, `v` of its second and third
    /// vertex.
    ///
    /// Computed in f64 and rounded once, which bounds the error of the position by half a unit in
    /// the last place (less than the γ₇ Σ|bᵢpᵢ| of *Physically Based Rendering*, 4th ed., 6.8.5).
    pub fn point(&self, prim: u32, u: f32, v: f32) -> TrianglePoint {
        let triangle = self.triangles[prim as usize];
        let part = &self.parts[self.part_of[prim as usize] as usize];
        // Not by `map` over the corners, which is not inlined.
        let at = |i: u32| self.positions[i as usize].as_dvec3();
        let corners = [at(triangle[0]), at(triangle[1]), at(triangle[2])];
        let (e1, e2) = (corners[1] - corners[0], corners[2] - corners[0]);
        let cross = e1.cross(e2);
        let largest = corners[0].abs().max(corners[1].abs()).max(corners[2].abs());
        let largest = largest.as_vec3a();
        let (b1, b2) = (f64::from(u), f64::from(v));
        let within = largest * MACHINE_EPSILON;
        let p = corners[0] + b1 * e1 + b2 * e2;
        let p = inset(p, [1.0 - b1 - b2, b1, b2], [e1, e2, cross], within).as_vec3a();
        let p_error = p.abs() * MACHINE_EPSILON + largest * (16.0 * MACHINE_EPSILON.powi(2));
        let n_g = cross.normalize().as_vec3a();
        let of_part = |i: u32| (i - part.first_vertex) as usize;
        let [a, b, c] = triangle;
        let local = [of_part(a), of_part(b), of_part(c)];
        let b = [1.0 - u - v, u, v];
        TrianglePoint {
            p,
            p_error,
            n_g,
            n_s: self.shading_normal(part, local, b, n_g),
            uv: self.uv(part, local, b),
            material: part.material,
        }
    }

    /// Interpolated, turned into the hemisphere of `n_g`; `n_g` where it has no direction.
    fn shading_normal(&self, part: &Part, local: [usize; 3], b: [f32; 3], n_g: Vec3A) -> Vec3A {
        if part.first_normal == NONE {
            return n_g;
        }
        let mut sum = DVec3::ZERO;
        for (i, weight) in local.into_iter().zip(b) {
            let n = self.normals[part.first_normal as usize + i];
            sum += f64::from(weight) * n.as_dvec3();
        }
        let n_s = match sum.try_normalize() {
            Some(n) => n.as_vec3a(),
            None => return n_g,
        };
        let side = n_s.dot(n_g);
        if side > 0.0 {
            n_s
        } else if side < 0.0 {
            -n_s
        } else {
            n_g
        }
    }

    /// Interpolated texture coordinates; the barycentric weights where the mesh has none.
    fn uv(&self, part: &Part, local: [usize; 3], b: [f32; 3]) -> Vec2 {
        if part.first_uv == NONE {
            return Vec2::new(b[1], b[2]);
        }
        let mut uv = Vec2::ZERO;
        for (i, weight) in local.into_iter().zip(b) {
            uv += weight * Vec2::from(self.uvs[part.first_uv as usize + i]);
        }
        if uv.is_finite() { uv } else { Vec2::ZERO }
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.positions)
            + size_of_val(&*self.normals)
            + size_of_val(&*self.uvs)
            + size_of_val(&*self.triangles)
            + size_of_val(&*self.part_of)
            + size_of_val(&*self.source)
    }
}

/// Twice the area along the normal.
fn scaled_normal(v: [Vec3A; 3]) -> DVec3 {
    let [a, b, c] = v.map(|p| p.as_dvec3());
    (b - a).cross(c - a)
}

/// Whether a triangle can be hit; counts it where not.
fn accept(positions: &[Vec3], triangle: &[u32; 3], report: &mut DropReport) -> bool {
    let mut corners = [Vec3A::ZERO; 3];
    for (corner, &index) in corners.iter_mut().zip(triangle) {
        match positions.get(index as usize) {
            Some(&p) => *corner = p.into(),
            None => {
                report.bad_index += 1;
                return false;
            }
        }
    }
    if !corners.iter().all(|p| p.is_finite()) {
        report.non_finite += 1;
        return false;
    }
    if corners
        .iter()
        .any(|p| p.abs().max_element() > MAX_COORDINATE)
    {
        report.out_of_range += 1;
        return false;
    }
    if scaled_normal(corners) == DVec3::ZERO {
        report.zero_area += 1;
        return false;
    }
    true
}
