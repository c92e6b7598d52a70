//! All lights of a scene and the choice of one.

use std::collections::HashMap;

use glam::{Vec2, Vec3A};

use super::environment::is_radiance;
use super::silhouette::Silhouette;
use super::{
    DirectionalLight, EnvironmentLight, Light, LightSample, PointLight, QuadLight, SphereLight,
    SpotLight, TriangleLight,
};
use crate::engine::geometry::Geometry;
use crate::engine::math::Rgb;
use crate::engine::math::distribution::Discrete;
use crate::engine::sampling::Sampler;
use crate::engine::scene::desc::LightDesc;

/// A primitive of the geometry that emits from its front side.
#[derive(Clone, Copy, Debug)]
pub struct Emitter {
    /// Index of the triangle or sphere.
    pub prim: u32,
    /// Emitted radiance, the same everywhere on it.
    pub radiance: Rgb,
}

/// The lights of a scene, chosen in proportion to their power.
///
/// Invariant: the probabilities of all lights sum to exactly 1, and none is 0: lights without
/// power are left out.
#[derive(Clone, Debug, Default)]
pub struct Lights {
    lights: Vec<Light>,
    /// `None` if there is no light.
    selection: Option<Discrete>,
    environments: Vec<u32>,
    by_primitive: HashMap<u32, u32>,
    skipped: usize,
}

impl Lights {
    /// Prepares the lights without surface in `descs` and the primitives of `geometry` in
    /// `emitters`; light from infinity enters `scene`. Two consecutive triangles of one quadrangle
    /// become one light.
    ///
    /// # Errors
    /// A sentence, where a light's values make no sense.
    pub fn build(
        descs: &[LightDesc],
        emitters: &[Emitter],
        geometry: &Geometry,
        scene: Silhouette,
    ) -> Result<Self, String> {
        let mut lights = Self::default();
        lights.add_emitters(emitters, geometry)?;
        for desc in descs {
            if let Some(light) = prepare(desc, scene)? {
                lights.add(light);
            }
        }
        let weights: Vec<f64> = lights.lights.iter().map(importance).collect();
        lights.selection = Discrete::new(&weights);
        if lights.selection.is_none() && !lights.lights.is_empty() {
            return Err("There are more than 16 million lights.".into());
        }
        Ok(lights)
    }

    fn add_emitters(&mut self, emitters: &[Emitter], geometry: &Geometry) -> Result<(), String> {
        let mut previous: Option<(u32, TriangleLight)> = None;
        for &Emitter { prim, radiance } in emitters {
            check("Emission", radiance)?;
            if let Some(sphere) = geometry.sphere(prim) {
                let light = SphereLight::new(sphere.center, sphere.radius, sphere.inward, radiance);
                self.add_surface(prim, light.map(Light::Sphere), radiance);
                previous = None;
                continue;
            }
            let triangle = geometry
                .triangle_vertices(prim)
                .and_then(|corners| TriangleLight::new(prim, corners, radiance));
            let quad = previous
                .zip(triangle)
                .and_then(|((id, first), second)| Some((id, QuadLight::new(&first, &second)?)));
            if let Some((id, quad)) = quad {
                self.lights[id as usize] = Light::Quad(Box::new(quad));
                self.by_primitive.insert(prim, id);
                previous = None;
            } else {
                let id = self.add_surface(prim, triangle.map(Light::Triangle), radiance);
                previous = id.zip(triangle);
            }
        }
        Ok(())
    }

    /// Adds the light of a primitive; counts it if it should shine and cannot.
    fn add_surface(&mut self, prim: u32, light: Option<Light>, radiance: Rgb) -> Option<u32> {
        let id = light.and_then(|light| self.add(light));
        match id {
            Some(id) => {
                self.by_primitive.insert(prim, id);
            }
            None if !radiance.is_black() => self.skipped += 1,
            None => {}
        }
        id
    }

    /// Adds a light that has power.
    fn add(&mut self, light: Light) -> Option<u32> {
        if importance(&light) <= 0.0 {
            return None;
        }
        let id = self.lights.len() as u32;
        if matches!(light, Light::Environment(_)) {
            self.environments.push(id);
        }
        self.lights.push(light);
        Some(id)
    }

    /// Chooses a light: its index and the probability of that.
    #[inline]
    pub fn sample(&self, u: f32) -> Option<(u32, f32)> {
        let choice = self.selection.as_ref()?.sample(u);
        Some((choice.index as u32, choice.pmf))
    }

    /// Whether there is more than one: only then [`Lights::sample`] looks at its number.
    #[inline]
    pub fn are_several(&self) -> bool {
        self.lights.len() > 1
    }

    /// Chooses a light by its power and draws a point of it for a shadow ray from `p`: the light's
    /// index, the probability of the choice, and the point. The next three numbers are kept for
    /// it; they are not drawn where a light without size is the only one.
    #[inline]
    pub fn sample_li(
        &self,
        p: Vec3A,
        sampler: &mut impl Sampler,
    ) -> Option<(u32, f32, LightSample)> {
        let (u, choice) = match self.lights[..] {
            [ref only] if only.is_delta() => (Vec2::ZERO, 0.0),
            _ => (sampler.next_2d(), sampler.next_1d()),
        };
        let (id, pmf) = self.sample(choice)?;
        Some((id, pmf, self.get(id).sample_li(p, u)?))
    }

    /// Probability with which [`Lights::sample`] chooses a light; 0 beyond the last.
    #[inline]
    pub fn pmf(&self, id: u32) -> f32 {
        self.selection
            .as_ref()
            .map_or(0.0, |selection| selection.pmf(id as usize))
    }

    /// The light of this index.
    ///
    /// # Panics
    /// Beyond the last: ids come from [`Lights::sample`], surfaces and [`Lights::environments`].
    #[inline]
    pub fn get(&self, id: u32) -> &Light {
        &self.lights[id as usize]
    }

    /// All lights, by index.
    pub fn as_slice(&self) -> &[Light] {
        &self.lights
    }

    /// The light that a primitive belongs to: what [`Geometry::set_lights`] asks for.
    pub fn of_primitive(&self, prim: u32) -> Option<u32> {
        self.by_primitive.get(&prim).copied()
    }

    /// Indices of the lights that a ray sees when it leaves the scene.
    #[inline]
    pub fn environments(&self) -> &[u32] {
        &self.environments
    }

    /// What a ray in the direction `d` sees when it leaves the scene: all environments together.
    pub fn escaped(&self, d: Vec3A) -> Rgb {
        let environments = self.environments.iter().map(|&id| self.get(id));
        environments.map(|light| light.escaped(d)).sum()
    }

    /// Emitted flux in W of all lights.
    pub fn power(&self) -> Rgb {
        self.lights.iter().map(Light::power).sum()
    }

    /// Number of primitives that should emit but whose area or power is out of the range of
    /// `f32`.
    pub fn skipped(&self) -> usize {
        self.skipped
    }

    /// Number of lights.
    pub fn len(&self) -> usize {
        self.lights.len()
    }

    /// Whether nothing emits.
    pub fn is_empty(&self) -> bool {
        self.lights.is_empty()
    }
}

/// What the choice is proportional to: power in W, mean of the channels; at most the largest
/// `f32` where that overflows.
fn importance(light: &Light) -> f64 {
    let sum: f64 = light.power().to_array().iter().map(|c| f64::from(*c)).sum();
    // Black light on an area beyond f32 is 0 · ∞.
    if sum.is_nan() {
        return 0.0;
    }
    (sum / 3.0).min(f64::from(f32::MAX))
}

/// Refuses a colour that no light can have.
fn check(what: &str, c: Rgb) -> Result<(), String> {
    if is_radiance(c) {
        return Ok(());
    }
    let c = c.to_array();
    Err(format!(
        "{what} {c:?} is not possible: it must be finite and not negative."
    ))
}

fn check_position(what: &str, p: glam::Vec3) -> Result<Vec3A, String> {
    if p.is_finite() {
        return Ok(p.into());
    }
    Err(format!("The position {p} of a {what} light is not finite."))
}

fn no_direction(what: &str) -> String {
    format!("The direction of a {what} light has no length, or is not finite.")
}

/// A light without surface; `None` for a black environment.
fn prepare(desc: &LightDesc, scene: Silhouette) -> Result<Option<Light>, String> {
    match desc {
        LightDesc::Point {
            position,
            intensity,
        } => {
            check("Intensity", *intensity)?;
            Ok(Some(Light::Point(PointLight {
                position: check_position("point", *position)?,
                intensity: *intensity,
            })))
        }
        LightDesc::Spot {
            position,
            direction,
            intensity,
            angle_deg,
            falloff_deg,
        } => {
            check("Intensity", *intensity)?;
            let angles = *angle_deg > 0.0 && *angle_deg <= 180.0;
            if !(angles && *falloff_deg >= 0.0 && falloff_deg <= angle_deg) {
                return Err(format!(
                    "A spot light's angle of {angle_deg}° with a falloff of {falloff_deg}° is not \
                     possible: 0 ≤ falloff ≤ angle ≤ 180 and angle > 0."
                ));
            }
            let position = check_position("spot", *position)?;
            SpotLight::new(
                position,
                (*direction).into(),
                *intensity,
                *angle_deg,
                *falloff_deg,
            )
            .map(|spot| Some(Light::Spot(spot)))
            .ok_or_else(|| no_direction("spot"))
        }
        LightDesc::Directional {
            direction,
            irradiance,
        } => {
            check("Irradiance", *irradiance)?;
            DirectionalLight::new((*direction).into(), *irradiance, scene)
                .map(|light| Some(Light::Directional(light)))
                .ok_or_else(|| no_direction("directional"))
        }
        LightDesc::Constant { radiance } => {
            check("Radiance", *radiance)?;
            let light = EnvironmentLight::constant(*radiance, scene);
            Ok(Some(Light::Environment(Box::new(light))))
        }
        LightDesc::Environment {
            image,
            scale,
            rotation,
        } => {
            let light = EnvironmentLight::image(image.clone(), *scale, *rotation, scene)?;
            Ok(light.map(|light| Light::Environment(Box::new(light))))
        }
    }
}
