//! Which media are where.

use glam::Vec3A;

use super::glow::Glow;
use super::medium::Medium;
use crate::engine::geometry::{Bounds3, Geometry, Ray, SurfaceInteraction};
use crate::engine::scene::desc::media::{MediaDesc, SurfaceDesc};

/// Most closed surfaces that a point can be within; what is entered beyond them does not count.
const CAPACITY: usize = 12;
/// No region, in the table by primitive.
const NONE: u16 = u16::MAX;
/// Most surfaces that a ray crosses to find out where it starts.
const MAX_CROSSINGS: u32 = 10_000;

/// The closed surfaces that a ray is within. An entry a crossing: a mesh that overlaps itself is
/// entered twice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inside {
    regions: [u16; CAPACITY],
    len: u8,
}

impl Inside {
    fn enter(&mut self, region: u16) {
        if let Some(free) = self.regions.get_mut(usize::from(self.len)) {
            *free = region;
            self.len += 1;
        }
    }

    fn leave(&mut self, region: u16) {
        let len = usize::from(self.len);
        if let Some(i) = self.regions[..len].iter().rposition(|r| *r == region) {
            self.regions.copy_within(i + 1..len, i);
            self.len -= 1;
        }
    }

    fn entries(&self) -> &[u16] {
        &self.regions[..usize::from(self.len)]
    }
}

/// A closed surface and what fills it.
#[derive(Clone, Debug)]
pub struct Region {
    medium: Option<u16>,
    priority: i32,
    bounds: Bounds3,
    /// The normal points to the inside.
    inward: bool,
}

/// All media of a scene.
#[derive(Clone, Debug, Default)]
pub struct Media {
    media: Vec<Medium>,
    regions: Vec<Region>,
    /// The region that each primitive bounds; empty without regions.
    by_prim: Vec<u16>,
    everywhere: Option<u16>,
    /// Where a medium everywhere ends if light comes from infinity.
    ball: Option<(Vec3A, f32)>,
    /// How those that emit are found.
    pub glow: Glow,
}

impl Media {
    /// Prepares the media of `desc` between the surfaces of `geometry`.
    ///
    /// # Errors
    /// A sentence, where something makes no sense.
    pub fn build(
        desc: &MediaDesc,
        geometry: &Geometry,
        inward: impl Fn(usize) -> bool,
        light_at_infinity: bool,
    ) -> Result<Self, String> {
        let media: Vec<Medium> = desc
            .media
            .iter()
            .map(Medium::new)
            .collect::<Result<_, _>>()?;
        let known = |i: Option<usize>| match i {
            Some(i) if i >= media.len() => Err(format!("there is no medium number {i}")),
            _ => Ok(i.map(|i| i as u16)),
        };
        let everywhere = known(desc.everywhere)?;
        if let Some(i) = desc.everywhere {
            let m = &media[i];
            let endless = |c: usize| m.emission[c] > 0.0 && m.sigma_t[c] == 0.0;
            if (0..3).any(endless) && !light_at_infinity {
                return Err(format!(
                    "medium \"{}\": it is everywhere and emits without extinction, which would be \
                     endlessly bright",
                    desc.media[i].name
                ));
            }
        }
        if desc.interiors.len() >= usize::from(NONE) || media.len() >= usize::from(NONE) {
            return Err("there are at most 65534 media and surfaces filled with them".to_owned());
        }
        let mut by_prim = Vec::new();
        if !desc.interiors.is_empty() {
            by_prim = vec![NONE; geometry.primitive_count()];
        }
        let mut regions = Vec::with_capacity(desc.interiors.len());
        for (number, interior) in desc.interiors.iter().enumerate() {
            let prims: Vec<u32> = match &interior.surface {
                SurfaceDesc::Meshes(meshes) => meshes
                    .clone()
                    .flat_map(|m| geometry.mesh_triangles(m))
                    .collect(),
                SurfaceDesc::Sphere(i) => geometry.sphere_prim(*i).into_iter().collect(),
            };
            let mut bounds = Bounds3::EMPTY;
            for prim in prims {
                by_prim[prim as usize] = number as u16;
                bounds = bounds.union(&bounds_of(geometry, prim));
            }
            regions.push(Region {
                medium: known(interior.medium)?,
                priority: interior.priority,
                bounds,
                inward: match interior.surface {
                    SurfaceDesc::Sphere(i) => inward(i),
                    SurfaceDesc::Meshes(_) => false,
                },
            });
        }
        let ball = (everywhere.is_some() && light_at_infinity).then(|| geometry.bounding_sphere());
        let placed = regions
            .iter()
            .filter_map(|r| Some((&media[usize::from(r.medium?)], r.bounds)));
        let glow = Glow::new(placed);
        Ok(Self {
            glow,
            media,
            regions,
            by_prim,
            everywhere,
            ball,
        })
    }

    /// All media.
    pub fn as_slice(&self) -> &[Medium] {
        &self.media
    }

    /// Whether nothing lies between the surfaces.
    pub fn is_empty(&self) -> bool {
        self.everywhere.is_none() && self.regions.is_empty()
    }

    /// The media that are anywhere.
    pub fn placed(&self) -> impl Iterator<Item = &Medium> {
        let inside = self.regions.iter().filter_map(|r| r.medium);
        inside
            .chain(self.everywhere)
            .map(|m| &self.media[usize::from(m)])
    }

    /// What fills the place where `inside` is true, and the part of the ray, up to `t_max`, on
    /// which it does so.
    #[inline]
    pub fn along(&self, inside: &Inside, ray: &Ray, t_max: f32) -> Option<(&Medium, (f32, f32))> {
        if let Some(region) = self.top(inside) {
            let medium = self.regions[usize::from(region)].medium?;
            return Some((&self.media[usize::from(medium)], (0.0, t_max)));
        }
        let medium = &self.media[usize::from(self.everywhere?)];
        let Some((center, radius)) = self.ball else {
            return Some((medium, (0.0, t_max)));
        };
        let (begin, end) = chord(ray, center, radius)?;
        let span = (begin.max(0.0), end.min(t_max));
        (span.0 < span.1).then_some((medium, span))
    }

    /// The region whose medium counts: of the highest priority, then the last declared.
    #[inline]
    fn top(&self, inside: &Inside) -> Option<u16> {
        let entries = inside.entries().iter().copied();
        entries.max_by_key(|&r| (self.regions[usize::from(r)].priority, r))
    }

    /// Crosses the surface at `si` in the direction `d`.
    #[inline]
    pub fn cross(&self, inside: &mut Inside, si: &SurfaceInteraction, d: Vec3A) {
        let Some(&number) = self.by_prim.get(si.prim as usize) else {
            return;
        };
        let Some(region) = self.regions.get(usize::from(number)) else {
            return;
        };
        if (d.dot(si.n_g) < 0.0) != region.inward {
            inside.enter(number);
        } else {
            inside.leave(number);
        }
    }

    /// What a ray is within that leaves `si` in the direction `d`, where `inside` is true on the
    /// side of `si.wo`.
    #[inline]
    pub fn beyond(&self, inside: &Inside, si: &SurfaceInteraction, d: Vec3A) -> Inside {
        let mut beyond = *inside;
        if (si.wo.dot(si.n_g) > 0.0) != (d.dot(si.n_g) > 0.0) {
            self.cross(&mut beyond, si, d);
        }
        beyond
    }

    /// What the point `p`, on no surface, is within: of each region a ray from there leaves more
    /// often than it enters.
    pub fn inside(&self, geometry: &Geometry, p: Vec3A) -> Inside {
        let mut inside = Inside::default();
        let holds = |b: &Bounds3| b.min.cmple(p).all() && p.cmple(b.max).all();
        if !self.regions.iter().any(|r| holds(&r.bounds)) {
            return inside;
        }
        // No axis and no symmetry of usual scenes: it seldom runs along a face.
        let mut ray = Ray::new(p, Vec3A::new(0.393_7, 0.821_4, 0.412_8).normalize());
        let mut leaves = vec![0_i32; self.regions.len()];
        for _ in 0..MAX_CROSSINGS {
            let Some(hit) = geometry.intersect(&ray) else {
                break;
            };
            let si = geometry.interaction(&ray, &hit);
            if let Some(count) = leaves.get_mut(usize::from(self.by_prim[si.prim as usize])) {
                let inward = self.regions[usize::from(self.by_prim[si.prim as usize])].inward;
                *count += if (ray.d.dot(si.n_g) > 0.0) != inward {
                    1
                } else {
                    -1
                };
            }
            ray = si.spawn_ray(ray.d);
        }
        for (region, count) in leaves.into_iter().enumerate() {
            (0..count).for_each(|_| inside.enter(region as u16));
        }
        inside
    }
}

fn bounds_of(geometry: &Geometry, prim: u32) -> Bounds3 {
    match geometry.sphere(prim) {
        Some(sphere) => sphere.bounds(),
        None => geometry
            .triangle_vertices(prim)
            .into_iter()
            .flatten()
            .fold(Bounds3::EMPTY, |b, p| b.including(p)),
    }
}

/// Where the ray, to both sides, is within a ball.
fn chord(ray: &Ray, center: Vec3A, radius: f32) -> Option<(f32, f32)> {
    let o = ray.o.as_dvec3() - center.as_dvec3();
    let d = ray.d.as_dvec3();
    let b = o.dot(d);
    let perpendicular = o - d * b;
    let half = f64::from(radius).powi(2) - perpendicular.length_squared();
    (half > 0.0).then(|| ((-b - half.sqrt()) as f32, (-b + half.sqrt()) as f32))
}
