//! Scenes with a closed form whose numbers anybody may drive to an extreme: the window's panel, and
//! scene ids such as `stress:room,albedo=0.99,scale=1e6` on the command line.

use std::fmt;

use glam::Vec3;

use super::oracles;
use super::scenes::{diffuse, ggx, glass, sky, sphere, square, view};
use crate::engine::film::Frame;
use crate::engine::math::Rgb;
use crate::engine::scene::desc::SceneDesc;

/// What the id of such a scene begins with.
pub const PREFIX: &str = "stress:";

/// A number that can be changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knob {
    /// Name in ids.
    pub name: &'static str,
    /// Label with unit.
    pub label: &'static str,
    /// Value where nothing is said.
    pub default: f64,
    /// Least and largest value.
    pub range: [f64; 2],
    /// Whether it spans decades.
    pub logarithmic: bool,
}

const fn knob(
    name: &'static str,
    label: &'static str,
    default: f64,
    range: [f64; 2],
    logarithmic: bool,
) -> Knob {
    Knob {
        name,
        label,
        default,
        range,
        logarithmic,
    }
}

const SCALE: Knob = knob("scale", "Scale (m)", 1.0, [1e-9, 1e9], true);
const OFFSET: Knob = knob("offset", "Offset (sizes)", 0.0, [0.0, 1e7], true);
const ALBEDO: Knob = knob("albedo", "Albedo", 0.5, [0.0, 0.999], false);
const IOR: Knob = knob("ior", "Index of refraction", 1.5, [1.0, 4.0], false);
const ROUGHNESS: Knob = knob("roughness", "Roughness α", 0.3, [1e-6, 1.0], true);
const LIGHT: Knob = knob("light", "Lamp's radius (heights)", 0.1, [1e-6, 0.9], true);

/// A scene whose radiance is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Experiment {
    /// The inside of a sphere that shines everywhere.
    Room,
    /// A diffuse ball under an even sky.
    Ball,
    /// A glass ball under an even sky.
    Glass,
    /// A rough metal plate under an even sky.
    Metal,
    /// A diffuse spot under a lamp of constant power.
    Lamp,
}

impl Experiment {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Room, Self::Ball, Self::Glass, Self::Metal, Self::Lamp];

    /// Name in ids.
    pub fn name(self) -> &'static str {
        match self {
            Self::Room => "room",
            Self::Ball => "ball",
            Self::Glass => "glass",
            Self::Metal => "metal",
            Self::Lamp => "lamp",
        }
    }

    /// What it is, and what is right.
    pub fn summary(self) -> &'static str {
        match self {
            Self::Room => "Inside of a diffuse sphere that emits 1 everywhere: 1/(1−ρ).",
            Self::Ball => "Diffuse ball under an even sky of 1: ρ.",
            Self::Glass => "Glass ball under an even sky of 1, which loses nothing: 1.",
            Self::Metal => {
                "Rough metal plate at 60° under an even sky of 1: the share that the microfacets \
                 reflect once, integrated apart."
            }
            Self::Lamp => "Diffuse spot under a round lamp whose power stays: ρ L r²/h² = 0.1 ρ.",
        }
    }

    /// The numbers it depends on.
    pub fn knobs(self) -> &'static [Knob] {
        match self {
            Self::Room | Self::Ball => &[SCALE, OFFSET, ALBEDO],
            Self::Glass => &[SCALE, OFFSET, IOR],
            Self::Metal => &[SCALE, OFFSET, ROUGHNESS],
            Self::Lamp => &[SCALE, OFFSET, ALBEDO, LIGHT],
        }
    }
}

/// An experiment with its numbers, one for each knob.
#[derive(Clone, Debug, PartialEq)]
pub struct Stress {
    /// Which.
    pub experiment: Experiment,
    /// In the order of [`Experiment::knobs`].
    pub values: Vec<f64>,
}

impl Stress {
    /// With the values that nothing is said about.
    pub fn new(experiment: Experiment) -> Self {
        Self {
            experiment,
            values: experiment.knobs().iter().map(|k| k.default).collect(),
        }
    }

    /// Reads an id, its prefix included.
    ///
    /// # Errors
    /// A sentence that says what is wrong and what would be right.
    pub fn parse(id: &str) -> Result<Self, String> {
        let mut words = id.strip_prefix(PREFIX).unwrap_or(id).split(',');
        let name = words.next().unwrap_or_default();
        let names = || Experiment::ALL.map(Experiment::name).join(", ");
        let experiment = Experiment::ALL.into_iter().find(|e| e.name() == name);
        let experiment =
            experiment.ok_or_else(|| format!("there is no experiment '{name}': {}", names()))?;
        let mut stress = Self::new(experiment);
        for word in words {
            let knobs = experiment.knobs();
            let known = || knobs.iter().map(|k| k.name).collect::<Vec<_>>().join(", ");
            let (name, value) = word.split_once('=').unwrap_or((word, ""));
            let at = knobs.iter().position(|k| k.name == name);
            let at = at.ok_or_else(|| format!("there is no number '{name}': {}", known()))?;
            let [least, most] = knobs[at].range;
            let value = value.parse().ok().filter(|v| (least..=most).contains(v));
            stress.values[at] =
                value.ok_or_else(|| format!("{name} is a number from {least} to {most}"))?;
        }
        Ok(stress)
    }

    fn value(&self, knob: Knob) -> f64 {
        let at = self.experiment.knobs().iter().position(|k| *k == knob);
        at.map_or(knob.default, |at| self.values[at])
    }

    /// The mean radiance that is right for every pixel.
    pub fn exact(&self) -> f64 {
        let rho = f64::from(self.value(ALBEDO) as f32);
        match self.experiment {
            Experiment::Room => 1.0 / (1.0 - rho),
            Experiment::Ball => rho,
            Experiment::Glass => 1.0,
            Experiment::Metal => oracles::ggx_albedo(self.value(ROUGHNESS), 0.5),
            Experiment::Lamp => 0.1 * rho,
        }
    }

    /// The scene.
    pub fn scene(&self) -> SceneDesc {
        let [scale, offset] = [SCALE, OFFSET].map(|knob| self.value(knob) as f32);
        let center = Vec3::splat(scale * offset);
        let at = |x: f32, y: f32, z: f32| center + scale * Vec3::new(x, y, z);
        let wall = || diffuse("wall", self.value(ALBEDO) as f32);
        let seen = |position, vfov| view(position, center, vfov, 64);
        let mut desc = SceneDesc {
            name: format!("Stress: {}", self.experiment.name()),
            description: self.experiment.summary().to_owned(),
            ..SceneDesc::default()
        };
        match self.experiment {
            Experiment::Room => {
                let mut room = sphere(0, center, scale, true);
                room.emission = Some(Rgb::WHITE);
                desc.camera = seen(at(0.3, -0.2, 0.4), 60.0);
                (desc.materials, desc.spheres) = (vec![wall()], vec![room]);
            }
            Experiment::Ball | Experiment::Glass => {
                // The ball fills the view, also a wide one.
                desc.camera = seen(at(0.0, 0.0, 3.0), 14.0);
                desc.materials = vec![match self.experiment {
                    Experiment::Ball => wall(),
                    _ => glass("glass", self.value(IOR) as f32),
                }];
                desc.spheres = vec![sphere(0, center, scale, false)];
                desc.lights = vec![sky(1.0)];
            }
            Experiment::Metal => {
                desc.camera = seen(at(0.0, 2.0 * 3.0_f32.sqrt(), 2.0), 0.01);
                desc.materials = vec![ggx("metal", self.value(ROUGHNESS) as f32)];
                let [u, v] = [Vec3::X, Vec3::Y].map(|d| scale * d);
                desc.meshes = vec![square(0, center, u, v)];
                desc.lights = vec![sky(1.0)];
            }
            Experiment::Lamp => {
                let radius = self.value(LIGHT) as f32;
                let mut lamp = sphere(1, at(0.0, 1.0, 0.0), scale * radius, false);
                lamp.emission = Some(Rgb::splat(0.1 / (radius * radius)));
                desc.camera = seen(at(2.0, 2.0, 0.8), 1e-3);
                desc.materials = vec![wall(), diffuse("lamp", 0.0)];
                let [u, v] = [Vec3::Z, Vec3::X].map(|d| 0.05 * scale * d);
                desc.meshes = vec![square(0, center, u, v)];
                desc.spheres = vec![lamp];
            }
        }
        desc
    }
}

impl fmt::Display for Stress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{PREFIX}{}", self.experiment.name())?;
        for (knob, value) in self.experiment.knobs().iter().zip(&self.values) {
            if *value != knob.default {
                write!(f, ",{}={value}", knob.name)?;
            }
        }
        Ok(())
    }
}

/// A picture beside its closed form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Mean radiance of the picture.
    pub mean: f64,
    /// Its standard error.
    pub error: f64,
    /// Whether it is right to a thousandth and three standard errors; `None` while the standard
    /// error is above half a percent.
    pub holds: Option<bool>,
}

/// Measures the whole of `frame` against `exact`; `None` before there is something to measure.
pub fn measure(frame: &Frame, exact: f64) -> Option<Measured> {
    let whole = frame.layers.first()?;
    let mean_of = |pixels: &[[f32; 3]]| {
        let sum: f64 = pixels.iter().flatten().map(|x| f64::from(*x)).sum();
        sum / (3 * pixels.len()) as f64
    };
    let mean = mean_of(&whole.pixels);
    // Pixels are independent, or else err together: then halves of the picture differ in the mean.
    let alone = frame.relative_error? * mean / (whole.pixels.len() as f64).sqrt();
    let error = alone.max(mean_of(&frame.differences).abs());
    let holds = (error <= 0.005 * exact.abs())
        .then(|| (mean - exact).abs() <= 3.0 * error + 0.001 * exact.abs());
    let measured = mean.is_finite() && error.is_finite();
    measured.then_some(Measured { mean, error, holds })
}

#[cfg(test)]
mod tests {
    use super::super::estimate::frame;
    use super::super::scenes::job_of;
    use super::*;
    use crate::engine::integrators::path;

    #[test]
    fn ids_say_all() {
        for experiment in Experiment::ALL {
            let mut stress = Stress::new(experiment);
            assert_eq!(Stress::parse(&stress.to_string()), Ok(stress.clone()));
            for (knob, value) in experiment.knobs().iter().zip(&mut stress.values) {
                *value = 0.5 * (knob.range[0] + knob.range[1]);
            }
            assert_eq!(Stress::parse(&stress.to_string()), Ok(stress));
        }
        for wrong in [
            "stress:",
            "stress:rom",
            "stress:room,",
            "stress:room,ior=2",
            "stress:room,scale=x",
            "stress:room,albedo=1",
            "stress:room,scale=NaN",
        ] {
            assert!(Stress::parse(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn each_is_what_it_says_and_nothing_else() {
        let ids = [
            "stress:room,albedo=0.9,scale=1e6",
            "stress:ball,scale=0.000001,albedo=0.8",
            "stress:glass,ior=2.4,offset=100",
            "stress:metal,roughness=0.05",
            "stress:lamp,light=0.001,scale=1000",
        ];
        for id in ids {
            let stress = Stress::parse(id).expect("an id");
            let job = job_of(&path::ENTRY, &[], &stress.scene());
            let frame = frame(&job, 0, 64).expect("a picture");
            let holds = |exact: f64| measure(&frame, exact).expect("two halves").holds;
            let exact = stress.exact();
            let found = measure(&frame, exact);
            assert_eq!(holds(exact), Some(true), "{id}: {found:?} for {exact}");
            assert_eq!(holds(1.02 * exact), Some(false), "{id}: {found:?}");
            assert_eq!(frame.stats.errors().iter().sum::<u64>(), 0, "{id}");
        }
    }
}
