//! A sample that is followed again is the sample of the render, bit for bit.

mod support;

use std::sync::Arc;

use glam::UVec2;
use lightscope::engine::camera::Camera;
use lightscope::engine::film::Film;
use lightscope::engine::film::tiles::Tiles;
use lightscope::engine::integrators::replay::Step;
use lightscope::engine::integrators::{
    self, Cancel, Integrator, Params, Pass, Recording, ReplayError, SampleId,
};
use lightscope::engine::io::embedded;
use lightscope::engine::photon::MapKind;
use lightscope::engine::plan::{LayerSettings, RenderPlan};
use lightscope::engine::scene::Scene;
use support::render::{load, reference_dir};

const SIZE: UVec2 = UVec2::new(13, 10);

/// A scene, a view and an algorithm, ready for any pass.
struct Setup {
    scene: Arc<Scene>,
    camera: Camera,
    plan: RenderPlan,
    cancel: Cancel,
    integrator: Box<dyn Integrator>,
}

impl Setup {
    fn new(scene: Arc<Scene>, id: &str, set: &[(&str, &str)]) -> Self {
        let entry = integrators::find(id).expect("an integrator of the registry");
        let mut params = Params::defaults(entry.params);
        for (name, value) in set {
            params
                .set(entry.params, name, value)
                .expect("a parameter of the integrator");
        }
        let camera = Camera::new(&scene.camera).expect("a view").with_size(SIZE);
        let layers = LayerSettings {
            components: true,
            ..LayerSettings::default()
        };
        let plan = RenderPlan::new(&scene, camera.has_lens(), &layers).expect("classes");
        Self {
            scene,
            camera,
            plan,
            cancel: Cancel::never(),
            integrator: (entry.build)(&params),
        }
    }

    /// Whole picture of pass `index` alone.
    fn picture(&mut self, index: u64) -> Vec<[f32; 3]> {
        let mut film = Film::new(SIZE, self.plan.planned);
        let (integrator, pass) = self.pass(index);
        integrator.render_pass(&pass, &mut film).expect("a pass");
        let mut layers = Vec::new();
        film.resolve(&self.plan.labels, &mut layers);
        layers.swap_remove(0).pixels
    }

    fn replay(&mut self, sample: SampleId) -> Result<Recording, ReplayError> {
        let mut recording = Recording::default();
        let (integrator, pass) = self.pass(sample.pass());
        integrator.replay(&pass, &sample, &mut recording)?;
        Ok(recording)
    }

    fn pass(&mut self, index: u64) -> (&mut Box<dyn Integrator>, Pass<'_>) {
        let pass = Pass {
            scene: &self.scene,
            camera: &self.camera,
            plan: &self.plan,
            seed: 11,
            index,
            cancel: &self.cancel,
        };
        (&mut self.integrator, pass)
    }
}

fn embedded_scene(id: &str) -> Arc<Scene> {
    let desc = embedded::read(id).unwrap_or_else(|e| panic!("{e}"));
    Arc::new(Scene::build(&desc).unwrap_or_else(|e| panic!("{e}")))
}

fn scenes() -> Vec<(&'static str, Arc<Scene>)> {
    let reference = |name: &'static str| {
        let scene = load(&reference_dir(name).join("scene.json"));
        (name, scene)
    };
    vec![
        reference("cornell-glossy"),
        reference("cornell-glass"),
        ("fog-spot", embedded_scene("fog-spot")),
        ("sky-sun", embedded_scene("sky-sun")),
    ]
}

fn bits(pixel: [f32; 3]) -> [u32; 3] {
    pixel.map(f32::to_bits)
}

/// The pixels in the order in which a pass takes their samples.
fn pixels() -> impl Iterator<Item = UVec2> {
    let tiles = Tiles::new(SIZE);
    (0..tiles.len()).flat_map(move |tile| tiles.pixels(tile).map(|(_, pixel)| pixel))
}

fn place(pixel: UVec2) -> usize {
    (pixel.y * SIZE.x + pixel.x) as usize
}

/// Adds up splats as a film does.
struct Sums(Vec<[f64; 3]>);

impl Sums {
    fn new() -> Self {
        Self(vec![[0.0; 3]; (SIZE.x * SIZE.y) as usize])
    }

    fn add_splats(&mut self, recording: &Recording) -> usize {
        let mut count = 0;
        for (film, radiance) in recording.splats() {
            let sum = &mut self.0[place(film.as_uvec2())];
            (0..3).for_each(|c| sum[c] += f64::from(radiance[c]));
            count += 1;
        }
        count
    }
}

#[test]
fn samples_of_pixels_are_those_of_the_render() {
    let few = [
        ("caustic-photons", "3000"),
        ("global-photons", "3000"),
        ("volume-photons", "3000"),
    ];
    let algorithms: [(&str, &[(&str, &str)]); 9] = [
        ("path", &[]),
        ("path", &[("mode", "kajiya"), ("sampler", "independent")]),
        ("path", &[("mode", "hits")]),
        ("whitted", &[]),
        ("monte-carlo", &[("rays", "3")]),
        ("photon", &few),
        (
            "photon",
            &[few[0], few[1], ("indirect", "gather"), ("gather-rays", "9")],
        ),
        ("photon", &[few[0], few[1], few[2], ("fresh-maps", "on")]),
        ("sppm", &[]),
    ];
    for (name, scene) in scenes() {
        for (id, set) in algorithms {
            let entry = integrators::find(id).expect("an integrator");
            if entry.refusal(&scene.features).is_some() {
                continue;
            }
            for index in [0, 3] {
                let mut setup = Setup::new(Arc::clone(&scene), id, set);
                let picture = setup.picture(index);
                let mut lit = 0;
                for pixel in pixels() {
                    let sample = SampleId::Camera { pixel, pass: index };
                    let recording = setup.replay(sample).expect("a replay");
                    let radiance = recording.radiance().to_array();
                    let expected = picture[place(pixel)];
                    assert_eq!(
                        bits(radiance),
                        bits(expected),
                        "{name} {id} {set:?} {sample}: {radiance:?} is not {expected:?}"
                    );
                    lit += usize::from(expected != [0.0; 3]);
                    let first = recording.steps.first();
                    assert!(matches!(first, Some(Step::Lens { .. })), "{first:?}");
                }
                assert!(id == "path" || lit > 0, "{name} {id} shows nothing");
            }
        }
    }
}

#[test]
fn samples_of_bidirectional_walks_are_those_of_the_render() {
    for (name, scene) in scenes() {
        for (id, set) in [
            ("bdpt", &[][..]),
            (
                "bdpt",
                &[("picture", "all-1,2"), ("sampler", "independent")],
            ),
            ("vcm", &[]),
        ] {
            for index in [0, 3] {
                let mut setup = Setup::new(Arc::clone(&scene), id, set);
                let picture = setup.picture(index);
                let (mut own, mut splats) = (Sums::new(), Sums::new());
                let mut count = 0;
                for pixel in pixels() {
                    let sample = SampleId::Camera { pixel, pass: index };
                    let recording = setup.replay(sample).expect("a replay");
                    own.0[place(pixel)] = recording.radiance().to_array().map(f64::from);
                    count += splats.add_splats(&recording);
                }
                assert!(count > 0, "{name} {id}: no light path reached the lens");
                for (i, expected) in picture.iter().enumerate() {
                    let sum = [0, 1, 2].map(|c| (own.0[i][c] + splats.0[i][c]) as f32);
                    assert_eq!(bits(sum), bits(*expected), "{name} {id} {set:?}, pixel {i}");
                }
            }
        }
    }
}

#[test]
fn light_paths_are_those_of_the_render() {
    for (name, scene) in scenes() {
        for index in [0, 3] {
            let mut setup = Setup::new(Arc::clone(&scene), "light", &[]);
            let picture = setup.picture(index);
            let mut splats = Sums::new();
            let mut count = 0;
            for path in 0..u64::from(SIZE.x * SIZE.y) {
                let sample = SampleId::LightPath { path, pass: index };
                let recording = setup.replay(sample).expect("a replay");
                count += splats.add_splats(&recording);
            }
            assert!(count > 0, "{name}: nothing reached the lens");
            for (i, expected) in picture.iter().enumerate() {
                let sum = splats.0[i].map(|x| x as f32);
                assert_eq!(bits(sum), bits(*expected), "{name}, pixel {i}");
            }
        }
    }
}

#[test]
fn photons_are_those_of_the_maps() {
    for (name, scene, kinds) in [
        (
            "jensen-box",
            embedded_scene("jensen-box"),
            &[MapKind::Caustic, MapKind::Global][..],
        ),
        ("fog-spot", embedded_scene("fog-spot"), &[MapKind::Volume]),
    ] {
        let set = [
            ("caustic-photons", "2000"),
            ("global-photons", "2000"),
            ("volume-photons", "2000"),
        ];
        let mut setup = Setup::new(scene, "photon", &set);
        setup.picture(0);
        for &map in kinds {
            let view = setup.integrator.photons().expect("maps were built");
            let counts = view.map(map).expect("this map was built").counts;
            let (mut stored, mut power) = (0, [0.0_f64; 3]);
            for number in 0..counts.emitted {
                let pass = 0;
                let sample = SampleId::Photon { map, number, pass };
                for step in setup.replay(sample).expect("a replay").steps {
                    if let Step::Stored { power: one, .. } = step {
                        stored += 1;
                        (0..3).for_each(|c| power[c] += f64::from(one[c]));
                    }
                }
            }
            assert_eq!(stored, counts.stored, "{name} {map:?}");
            for c in 0..3 {
                // Summed in another order.
                let error = (power[c] - counts.power[c]).abs() / counts.power[c];
                assert!(error < 1e-9, "{name} {map:?}: {power:?} {:?}", counts.power);
            }
            let (pass, number) = (0, counts.emitted);
            let beyond = setup.replay(SampleId::Photon { map, number, pass });
            assert!(matches!(beyond, Err(ReplayError::Cannot(why)) if why.contains("0 to")));
        }
    }
}

/// What is printed is what a walk does: throughput and weights give each contribution again.
#[test]
fn steps_explain_what_they_add_up_to() {
    let scene = load(&reference_dir("cornell-glossy").join("scene.json"));
    let mut setup = Setup::new(scene, "path", &[]);
    let (mut vertices, mut games) = (0, 0);
    for pixel in pixels() {
        let recording = setup
            .replay(SampleId::Camera { pixel, pass: 0 })
            .expect("a replay");
        let mut throughput = [1.0; 3];
        for step in &recording.steps {
            match step {
                Step::Vertex(v) => {
                    assert_eq!(v.throughput.to_array(), throughput, "{pixel}");
                    assert!(v.material.is_some() && v.t > 0.0);
                    vertices += 1;
                }
                Step::Scattered {
                    pdf_dir, weight, ..
                } => {
                    let weight = weight.expect("path tracing tells it");
                    assert!(*pdf_dir > 0.0);
                    (0..3).for_each(|c| throughput[c] *= weight[c]);
                }
                Step::Roulette {
                    survived: true,
                    throughput: after,
                    ..
                } => {
                    games += 1;
                    throughput = after.to_array();
                }
                Step::Found {
                    weight,
                    pdf_light,
                    pdf_walk,
                    ..
                } => {
                    let (Some(light), Some(walk)) = (pdf_light, pdf_walk) else {
                        assert_eq!(*weight, 1.0);
                        continue;
                    };
                    let (light, walk) = (light * light, walk * walk);
                    // The power heuristic, of the one or of the other.
                    let own = [light / (light + walk), walk / (light + walk)];
                    assert!(own.iter().any(|w| (w - weight).abs() < 1e-4), "{step:?}");
                }
                _ => {}
            }
        }
    }
    assert!(vertices > 200 && games > 100, "{vertices} {games}");
}

#[test]
fn what_cannot_be_replayed_is_refused_in_a_sentence() {
    let scene = load(&reference_dir("cornell-diffuse").join("scene.json"));
    let (path, pass) = (0, 0);
    for (id, sample, said) in [
        (
            "pssmlt",
            SampleId::ChainStep { chain: 0, step: 1 },
            "all steps before it",
        ),
        (
            "path",
            SampleId::LightPath { path, pass },
            "the stream camera",
        ),
        (
            "bdpt",
            SampleId::LightPath { path, pass },
            "the stream camera",
        ),
        (
            "light",
            SampleId::MergedPath { path, pass },
            "the stream light",
        ),
        ("light", SampleId::LightPath { path: 130, pass }, "0 to 129"),
        (
            "vcm",
            SampleId::MergedPath {
                path: u64::MAX,
                pass,
            },
            "has the light paths 0 to",
        ),
    ] {
        let mut setup = Setup::new(Arc::clone(&scene), id, &[]);
        match setup.replay(sample) {
            Err(ReplayError::Cannot(why)) => assert!(why.contains(said), "{id}: {why}"),
            other => panic!("{id}: {other:?}"),
        }
    }
    // The light paths that vcm and sppm merge can be.
    for id in ["vcm", "sppm"] {
        let mut setup = Setup::new(Arc::clone(&scene), id, &[]);
        let merged = setup.replay(SampleId::MergedPath { path, pass });
        let steps = merged.expect("a replay").steps;
        assert!(matches!(steps[0], Step::Emission { .. }), "{id}");
    }
}
