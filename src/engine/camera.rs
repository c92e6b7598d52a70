//! Perspective cameras: pinhole and thin lens.
//!
//! A picture is a rectangle at distance 1 before the lens; its position (0, 0) is the top left
//! corner and one unit is a pixel. A pixel is the mean radiance over its square and over the lens,
//! so a camera ray has the weight 1. Seen from the light, the same camera has an importance We,
//! normalised over the whole picture: ∫∫ We cosθ dω dA = 1 (*Physically Based Rendering*, 3rd ed.,
//! 16.1.1). A light path that reaches the film contributes We-weighted flux to one pixel; with N
//! paths in all, a pixel is (width · height / N) times the sum of its contributions.

use std::f32::consts::PI;

use glam::{UVec2, Vec2, Vec3A};

use super::geometry::Ray;
use super::sampling::warp::sample_unit_disk;
use super::scene::desc::CameraDesc;

/// A camera, ready to use.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    desc: CameraDesc,
    position: Vec3A,
    right: Vec3A,
    up: Vec3A,
    forward: Vec3A,
    /// Half the picture's size at distance 1.
    half: Vec2,
    /// Film size in pixels.
    size: Vec2,
    lens_radius: f32,
    focus_distance: f32,
}

/// How the middle of the lens sees the scene: what overlays are drawn with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// The middle of the lens.
    pub position: Vec3A,
    /// To the right edge of the picture at distance 1, over its squared length.
    pub right: Vec3A,
    /// To the upper edge, likewise.
    pub up: Vec3A,
    /// Unit view direction.
    pub forward: Vec3A,
    /// Pixels.
    pub size: Vec2,
}

impl Projection {
    /// Film position, on the picture or beside it, and depth along the view direction of the
    /// point `p`; the position means nothing unless the depth is above 0.
    #[inline]
    pub fn film(&self, p: Vec3A) -> (Vec2, f32) {
        let from = p - self.position;
        let depth = from.dot(self.forward);
        let slope = Vec2::new(from.dot(self.right), from.dot(self.up)) / depth;
        let film = Vec2::new(0.5 + 0.5 * slope.x, 0.5 - 0.5 * slope.y) * self.size;
        (film, depth)
    }
}

/// A point of the lens as seen from a point of the scene.
#[derive(Clone, Copy, Debug)]
pub struct CameraSample {
    /// Unit direction from the reference point to the lens.
    pub wi: Vec3A,
    /// The point of the lens: end of the shadow ray.
    pub target: Vec3A,
    /// Distance to it.
    pub distance: f32,
    /// Where on the film, in pixels.
    pub film: Vec2,
    /// Importance We in m⁻² sr⁻¹ (pinhole: sr⁻¹, for its one point).
    pub importance: f32,
    /// Density of `wi` in 1/sr at the reference point; importance / `pdf_dir` is the factor on
    /// f · cosθ · radiance there.
    pub pdf_dir: f32,
    /// Normal of the lens: the view direction.
    pub n: Vec3A,
}

impl Camera {
    /// Checks and prepares a camera.
    ///
    /// # Errors
    /// A sentence, if the picture has no pixels or the view makes no sense.
    pub fn new(desc: &CameraDesc) -> Result<Self, String> {
        if desc.width == 0 || desc.height == 0 {
            return Err(format!(
                "A picture of {} × {} pixels is empty.",
                desc.width, desc.height
            ));
        }
        let vectors = [desc.position, desc.target, desc.up];
        if !vectors.iter().all(|v| v.is_finite()) {
            return Err("The camera's position, target or up direction is not finite.".into());
        }
        if !(desc.vfov_deg > 0.0 && desc.vfov_deg < 180.0) {
            return Err(format!(
                "The camera's opening angle of {}° is not between 0 and 180.",
                desc.vfov_deg
            ));
        }
        let (lens_radius, focus_distance) = desc
            .lens
            .map_or((0.0, 1.0), |lens| (lens.radius, lens.focus_distance));
        let positive = |x: f32| x.is_finite() && x > 0.0;
        if desc.lens.is_some() && !(positive(lens_radius) && positive(focus_distance)) {
            return Err("A lens needs a radius and a focus distance above 0.".into());
        }
        let forward = (desc.target.as_dvec3() - desc.position.as_dvec3())
            .try_normalize()
            .ok_or("The camera's target is its own position.")?;
        let up = desc.up.as_dvec3().try_normalize();
        let right = up
            .and_then(|up| forward.cross(up).try_normalize())
            .ok_or("The camera's up direction is its view direction.")?;
        let tan = (0.5 * f64::from(desc.vfov_deg).to_radians()).tan();
        let aspect = f64::from(desc.width) / f64::from(desc.height);
        Ok(Self {
            desc: *desc,
            position: desc.position.into(),
            right: right.as_vec3a(),
            up: right.cross(forward).as_vec3a(),
            forward: forward.as_vec3a(),
            half: Vec2::new((tan * aspect) as f32, tan as f32),
            size: Vec2::new(desc.width as f32, desc.height as f32),
            lens_radius,
            focus_distance,
        })
    }

    /// The same view, vertical opening included, with another number of pixels (at least one
    /// each way: an empty picture has no rays, but still a view).
    #[must_use]
    pub fn with_size(&self, size: UVec2) -> Self {
        let size = size.max(UVec2::ONE);
        let aspect = f64::from(size.x) / f64::from(size.y);
        Self {
            desc: CameraDesc {
                width: size.x,
                height: size.y,
                ..self.desc
            },
            half: Vec2::new((f64::from(self.half.y) * aspect) as f32, self.half.y),
            size: size.as_vec2(),
            ..*self
        }
    }

    /// What it was made from.
    pub fn desc(&self) -> &CameraDesc {
        &self.desc
    }

    /// Width and height in pixels.
    pub fn size(&self) -> UVec2 {
        UVec2::new(self.desc.width, self.desc.height)
    }

    /// How the middle of the lens sees the scene.
    pub fn projection(&self) -> Projection {
        Projection {
            position: self.position,
            right: self.right / self.half.x,
            up: self.up / self.half.y,
            forward: self.forward,
            size: self.size,
        }
    }

    /// Unit view direction, the normal of the lens.
    pub fn forward(&self) -> Vec3A {
        self.forward
    }

    /// Whether rays start on a lens and not in one point.
    pub fn has_lens(&self) -> bool {
        self.lens_radius > 0.0
    }

    /// The ray that the film position `film` sees through the point `u_lens` of the lens; its
    /// weight is 1.
    #[inline]
    pub fn generate_ray(&self, film: Vec2, u_lens: Vec2) -> Ray {
        let x = (2.0 * film.x / self.size.x - 1.0) * self.half.x;
        let y = (1.0 - 2.0 * film.y / self.size.y) * self.half.y;
        let lens = self.lens_point(u_lens);
        // Through the point in focus, all in the camera's own coordinates: far from the origin
        // the position has few digits left.
        let shift = lens / self.focus_distance;
        let d = self.forward + self.right * (x - shift.x) + self.up * (y - shift.y);
        Ray::new(self.world_from_lens(lens), d.normalize())
    }

    #[inline]
    fn lens_point(&self, u: Vec2) -> Vec2 {
        if !self.has_lens() {
            Vec2::ZERO
        } else {
            sample_unit_disk(u) * self.lens_radius
        }
    }

    #[inline]
    fn world_from_lens(&self, lens: Vec2) -> Vec3A {
        self.position + self.right * lens.x + self.up * lens.y
    }

    /// Area of the picture at distance 1 from the lens.
    #[inline]
    fn film_area(&self) -> f32 {
        4.0 * self.half.x * self.half.y
    }

    /// Area of the lens; 1 for a pinhole, which counts as a delta.
    #[inline]
    fn lens_area(&self) -> f32 {
        if !self.has_lens() {
            1.0
        } else {
            PI * self.lens_radius * self.lens_radius
        }
    }

    /// The film position that sees along the unit direction `d` from the point `lens` of the
    /// lens, in the camera's plane; `None` if it is off the film.
    #[inline]
    fn project(&self, lens: Vec2, d: Vec3A) -> Option<Vec2> {
        let z = d.dot(self.forward);
        if z <= 0.0 {
            return None;
        }
        let slope = Vec2::new(d.dot(self.right), d.dot(self.up)) / z;
        let at_one = (slope + lens / self.focus_distance) / self.half;
        let film = Vec2::new(0.5 + 0.5 * at_one.x, 0.5 - 0.5 * at_one.y) * self.size;
        let inside = film.cmpge(Vec2::ZERO).all() && film.cmplt(self.size).all();
        inside.then_some(film)
    }

    /// Importance of the direction at the cosine `cos` to the view direction.
    #[inline]
    fn importance(&self, cos: f32) -> f32 {
        let cos2 = cos * cos;
        1.0 / (self.film_area() * self.lens_area() * cos2 * cos2)
    }

    /// Position on the lens of a point near it.
    #[inline]
    fn lens_from_world(&self, p: Vec3A) -> Vec2 {
        if !self.has_lens() {
            return Vec2::ZERO;
        }
        let from = p - self.position;
        Vec2::new(from.dot(self.right), from.dot(self.up))
    }

    /// Importance We of a ray that leaves the lens, and its film position; `None` off the film.
    #[inline]
    pub fn we(&self, ray: &Ray) -> Option<(f32, Vec2)> {
        let film = self.project(self.lens_from_world(ray.o), ray.d)?;
        Some((self.importance(ray.d.dot(self.forward)), film))
    }

    /// Densities `(pdf_pos, pdf_dir)` with which [`Camera::generate_ray`] draws a ray from a
    /// uniform film position: 1/m² on the lens (1 for a pinhole) and 1/sr; 0 off the film.
    #[inline]
    pub fn pdf_we(&self, ray: &Ray) -> (f32, f32) {
        let pdf_pos = 1.0 / self.lens_area();
        match self.project(self.lens_from_world(ray.o), ray.d) {
            Some(_) => self.pdf_of_generated(ray),
            None => (pdf_pos, 0.0),
        }
    }

    /// The same of a ray that [`Camera::generate_ray`] drew: it is on the film. To project it back
    /// would lose those at the border that rounding carries beyond it, in a narrow view a share
    /// that shows.
    #[inline]
    pub fn pdf_of_generated(&self, ray: &Ray) -> (f32, f32) {
        (1.0 / self.lens_area(), self.pdf_dir(ray.d))
    }

    /// Density in 1/sr of the unit direction `d` of a ray that is on the film.
    #[inline]
    pub fn pdf_dir(&self, d: Vec3A) -> f32 {
        let cos = d.dot(self.forward);
        1.0 / (self.film_area() * cos * cos * cos)
    }

    /// Samples the lens as seen from `p`; `None` if `p` is not in the picture.
    #[inline]
    pub fn sample_wi(&self, p: Vec3A, u: Vec2) -> Option<CameraSample> {
        let lens = self.lens_point(u);
        let target = self.world_from_lens(lens);
        let to = target - p;
        let distance = to.length();
        let wi = to / distance;
        let film = self.project(lens, -wi)?;
        let cos = -wi.dot(self.forward);
        Some(CameraSample {
            wi,
            target,
            distance,
            film,
            importance: self.importance(cos),
            pdf_dir: distance / (cos * self.lens_area()) * distance,
            n: self.forward,
        })
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::engine::sampling::{IndependentSampler, Sampler, Stream};
    use crate::engine::scene::desc::LensDesc;

    fn desc(lens: Option<LensDesc>) -> CameraDesc {
        CameraDesc {
            position: Vec3::new(1.0, 2.0, 3.0),
            target: Vec3::new(1.0, 2.0, -4.0),
            up: Vec3::Y,
            vfov_deg: 60.0,
            width: 40,
            height: 20,
            lens,
        }
    }

    fn cameras() -> [Camera; 2] {
        let lens = LensDesc {
            radius: 0.3,
            focus_distance: 2.0,
        };
        [None, Some(lens)].map(|lens| Camera::new(&desc(lens)).unwrap())
    }

    fn sampler(index: u64) -> IndependentSampler {
        IndependentSampler::new(3, Stream::Test, (0, index))
    }

    #[test]
    fn top_left_is_up_and_left_and_the_opening_is_vertical() {
        let camera = cameras()[0];
        let centre = camera.generate_ray(Vec2::new(20.0, 10.0), Vec2::ZERO);
        assert!((centre.d - Vec3A::NEG_Z).length() < 1e-6);
        let top = camera.generate_ray(Vec2::new(20.0, 0.0), Vec2::ZERO);
        assert!((top.d.angle_between(centre.d).to_degrees() - 30.0).abs() < 1e-3);
        let corner = camera.generate_ray(Vec2::ZERO, Vec2::ZERO).d;
        assert!(corner.x < 0.0 && corner.y > 0.0);
        assert!(
            (corner.x / corner.y + 2.0).abs() < 1e-5,
            "pixels are square"
        );
    }

    #[test]
    fn rays_find_their_film_position_again() {
        for camera in cameras() {
            for i in 0..1000 {
                let mut s = sampler(i);
                let film = s.next_2d() * camera.size;
                let ray = camera.generate_ray(film, s.next_2d());
                let (importance, found) = camera.we(&ray).unwrap();
                assert!((found - film).length() < 1e-3, "{film} {found}");
                let (pdf_pos, pdf_dir) = camera.pdf_we(&ray);
                // The weight of a camera ray: We cosθ / (pdf_pos · pdf_dir) = 1.
                let cos = ray.d.dot(camera.forward());
                let weight = importance * cos / (pdf_pos * pdf_dir);
                assert!((weight - 1.0).abs() < 1e-5, "{weight}");
            }
        }
    }

    #[test]
    fn points_are_projected_to_where_rays_see_them() {
        for camera in cameras() {
            for i in 0..100 {
                let film = sampler(i).next_2d() * camera.size;
                let ray = camera.generate_ray(film, Vec2::splat(0.5));
                let (found, depth) = camera.projection().film(ray.at(7.0));
                assert!((found - film).length() < 1e-3, "{film} {found}");
                assert!((depth - 7.0 * ray.d.dot(camera.forward())).abs() < 1e-4);
                let behind = camera.projection().film(ray.at(-1.0)).1;
                assert!(behind < 0.0);
            }
        }
    }

    #[test]
    fn a_lens_is_sharp_in_its_plane_of_focus() {
        let camera = cameras()[1];
        let film = Vec2::new(3.0, 17.0);
        let at = |u: Vec2| {
            let ray = camera.generate_ray(film, u);
            ray.at(2.0 / ray.d.dot(camera.forward()))
        };
        for i in 0..100 {
            let u = sampler(i).next_2d();
            assert!(at(u).distance(at(Vec2::splat(0.5))) < 1e-5);
        }
    }

    #[test]
    fn a_shining_wall_has_its_radiance_seen_from_either_end() {
        // Light sampled on a wall z = −1, 4 m away, larger than the picture, radiance 1: all
        // contributions together are the mean over the film, which is 1.
        for camera in cameras() {
            let (half, n) = (Vec2::new(8.0, 5.0), 400_000);
            let area = 4.0 * half.x * half.y;
            let (mut sum, mut squares) = (0.0, 0.0);
            for i in 0..n {
                let mut s = sampler(i);
                let xy = (2.0 * s.next_2d() - Vec2::ONE) * half;
                let p = Vec3A::new(1.0 + xy.x, 2.0 + xy.y, -1.0);
                let Some(sample) = camera.sample_wi(p, s.next_2d()) else {
                    continue;
                };
                assert!((p + sample.wi * sample.distance).distance(sample.target) < 1e-5);
                let x = sample.importance / sample.pdf_dir * sample.wi.z * area;
                sum += f64::from(x);
                squares += f64::from(x).powi(2);
            }
            let mean = sum / n as f64;
            let error = ((squares / n as f64 - mean * mean) / n as f64).sqrt();
            assert!(
                error < 0.005 && (mean - 1.0).abs() < 5.0 * error,
                "{mean} ± {error}"
            );
        }
    }

    #[test]
    fn views_without_meaning_are_refused() {
        let good = desc(None);
        let lens = |radius, focus_distance| {
            Some(LensDesc {
                radius,
                focus_distance,
            })
        };
        let bad = [
            CameraDesc { width: 0, ..good },
            CameraDesc {
                vfov_deg: 180.0,
                ..good
            },
            CameraDesc {
                vfov_deg: f32::NAN,
                ..good
            },
            CameraDesc {
                target: good.position,
                ..good
            },
            CameraDesc {
                up: Vec3::Z,
                ..good
            },
            CameraDesc {
                up: Vec3::NAN,
                ..good
            },
            desc(lens(0.0, 1.0)),
            desc(lens(1.0, f32::INFINITY)),
        ];
        for desc in bad {
            assert!(Camera::new(&desc).is_err(), "{desc:?}");
        }
        let wide = cameras()[0].with_size(UVec2::new(1, 16_384));
        assert_eq!(wide.size(), UVec2::new(1, 16_384));
        assert_eq!(wide.desc().vfov_deg, 60.0);
    }
}
