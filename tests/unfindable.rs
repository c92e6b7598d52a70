//! What each integrator says it cannot find, against what it finds: of every word up to two events,
//! and some of three, exactly those are black that it names.

mod support;

use std::sync::Arc;

use lightscope::engine::event::Letter;
use lightscope::engine::integrators::{self, Cancel, Missing, Params, REGISTRY};
use lightscope::engine::path::{ClassId, PathClasses};
use lightscope::engine::scene::Scene;
use lightscope::engine::session::Renderer;
use support::agreement::mean;
use support::render::{job, render, scene_from_toml};

/// Diffuse, glossy, mirror and glass balls on a diffuse floor before a larger one.
fn balls(lights: &str, sphere: &str) -> Arc<Scene> {
    scene_from_toml(&format!(
        r#"
        camera = {{ position = [0, 0.6, 3.5], target = [0, -0.2, 0], vfov_deg = 50, width = 32, height = 24 }}
        lights = [{lights}]
        spheres = [
            {sphere}
            {{ center = [0, -7, 0], radius = 6, material = "white" }},
            {{ center = [0.8, -0.2, -3.2], radius = 1.5, material = "white" }},
            {{ center = [-1.1, -0.4, 0], radius = 0.6, material = "glass" }},
            {{ center = [0.9, -0.4, 0.5], radius = 0.6, material = "metal" }},
            {{ center = [0.5, -0.8, 1.1], radius = 0.2, material = "metal" }},
            {{ center = [0.1, -0.5, -0.6], radius = 0.5, material = "mirror" }},
            {{ center = [-0.25, -0.7, 0.8], radius = 0.3, material = "white" }},
        ]
        [materials]
        black = {{ type = "diffuse", reflectance = [0, 0, 0] }}
        white = {{ type = "diffuse", reflectance = [0.8, 0.8, 0.8] }}
        glass = {{ type = "dielectric", ior = 1.5 }}
        mirror = {{ type = "mirror", reflectance = [0.9, 0.9, 0.9] }}
        metal = {{ type = "ggx_conductor", specular_reflectance = [0.9, 0.9, 0.9], alpha = 0.4 }}
        "#
    ))
}

const POINT: &str = r#"{ type = "point", position = [0.5, 2, 1], intensity = [5, 5, 5] }"#;
const SUN: &str = r#"{ type = "directional", direction = [0.2, -2, -1], irradiance = [2, 2, 2] }"#;
const SPOT: &str = r#"{ type = "spot", position = [0, 3, 1], direction = [0, -1, -0.2], angle_deg = 60, falloff_deg = 10, intensity = [9, 9, 9] }"#;
const SKY: &str = r#"{ type = "constant", radiance = [0.3, 0.4, 0.5] }"#;
const LAMP: &str =
    r#"{ center = [-0.6, 1.0, -1.5], radius = 0.7, material = "black", emission = [9, 8, 7] },"#;

/// Words of up to two events, without `LE`, and those of three that the table tells apart.
const WORDS: [&str; 16] = [
    "LDE", "LGE", "LSE", "LDDE", "LDGE", "LDSE", "LGDE", "LGGE", "LGSE", "LSDE", "LSGE", "LSSE",
    "LSDSE", "LSGSE", "LSDDE", "LGDGE",
];

/// Whether a word such as `LDE` is among those that were named.
fn names(missing: Option<&Missing>, word: &str) -> bool {
    let Some(missing) = missing else { return false };
    let expression = missing.words.parse().expect("an expression");
    let classes = PathClasses::new(vec!["said".to_owned()], vec![expression]).expect("few");
    let letters = word.chars().filter_map(|c| match c {
        'D' => Some(Letter::D),
        'G' => Some(Letter::G),
        'S' => Some(Letter::S),
        _ => None,
    });
    let class = letters.fold(ClassId::EMPTY, |c, l| classes.append(c, l));
    classes.layers(class) != 0
}

/// Most passes: rare words may need many.
const PASSES: u64 = 2048;

/// Fails unless exactly those words are black that `id` names for the scene.
fn check(what: &str, scene: &Arc<Scene>, id: &str, set: &[(&str, &str)]) {
    let mut job = job(scene, id, set);
    job.settings.layers.components = false;
    job.settings.layers.expressions = WORDS.map(|w| w.parse().expect("well-formed")).to_vec();
    let said = (job.settings.integrator.missing)(&scene.features, &job.settings.params);
    let said = WORDS.map(|word| names(said.as_ref(), word));
    let mut renderer = Renderer::new(&job).expect("classes fit their table");
    loop {
        let rest = if id == "monte-carlo" { 4 } else { 32 };
        for _ in 0..rest {
            renderer
                .render_pass(&Cancel::never())
                .expect("nobody cancels");
        }
        let layers = renderer.frame().layers;
        let first = layers.len() - WORDS.len();
        let black = |i: usize| mean(&layers[first + i].pixels) == 0.0;
        let wrong = (0..WORDS.len()).find(|i| black(*i) != said[*i]);
        let Some(wrong) = wrong else { break };
        assert!(
            black(wrong) && renderer.passes() < PASSES,
            "{id} {set:?} under {what}: {} is black: {}, said: {}",
            WORDS[wrong],
            black(wrong),
            said[wrong]
        );
    }
}

fn check_all(what: &str, scene: &Arc<Scene>, mode_hits: bool) {
    for entry in REGISTRY {
        let photons = [("global-photons", "2000"), ("caustic-photons", "2000")];
        let sets: Vec<Vec<(&str, &str)>> = match entry.id {
            "path" if mode_hits => vec![vec![], vec![("mode", "hits")]],
            "pssmlt" => vec![vec![("over", "path")], vec![("over", "bdpt")]],
            "photon" => vec![
                [&[("fresh-maps", "on")], &photons[..]].concat(),
                [
                    &[("indirect", "gather"), ("gather-rays", "4")],
                    &photons[..],
                ]
                .concat(),
            ],
            "monte-carlo" => vec![vec![("depth", "2")]],
            "bdpt" => ["all", "1,2+2,2", "all-1,*-0,*", "*,1+1,3", "0,*"]
                .map(|on| vec![("strategies", on)])
                .to_vec(),
            "sppm" | "vcm" => vec![vec![("radius", "0.05")]],
            _ => vec![vec![]],
        };
        for set in sets {
            check(what, scene, entry.id, &set);
        }
    }
}

#[test]
fn lights_of_zero_size() {
    check_all("a point", &balls(POINT, ""), true);
    check_all("a sun", &balls(SUN, ""), false);
    check_all("a spot", &balls(SPOT, ""), false);
}

#[test]
fn lights_with_a_size() {
    check_all("a lamp", &balls("", LAMP), false);
    check_all("a sky", &balls(SKY, ""), true);
}

/// `LE` is no word of lights of zero size; of the others all but light tracing under a sky find it.
#[test]
fn light_seen_directly() {
    for (what, scene) in [("lamp", balls("", LAMP)), ("sky", balls(SKY, ""))] {
        for entry in REGISTRY {
            let mut job = job(&scene, entry.id, &[]);
            job.settings.layers.expressions = vec!["LE".parse().expect("well-formed")];
            let black = mean(&render(&job, 1).layers[5].pixels) == 0.0;
            let params = Params::defaults(entry.params);
            let said = names((entry.missing)(&scene.features, &params).as_ref(), "LE");
            assert_eq!(black, said, "{} sees the {what}", entry.id);
        }
    }
}

/// The words of the table, where everything it names is in the scene.
#[test]
fn the_table() {
    let zero = balls(POINT, "").features;
    let lamp = balls("", LAMP).features;
    let sky = balls(SKY, "").features;
    let hits: &[(&str, &str)] = &[("mode", "hits")];
    for (id, set, features, words) in [
        ("path", &[][..], zero, Some("LS.*E")),
        ("path", hits, zero, Some("L.*E")),
        ("path", hits, lamp, None),
        ("path", &[], lamp, None),
        ("whitted", &[], zero, Some("L.+(D|G|V).*E|LS+E")),
        ("whitted", &[], lamp, Some("L.+(D|G|V).*E")),
        ("monte-carlo", &[("depth", "3")], lamp, Some("L.{4,}E")),
        (
            "monte-carlo",
            &[("depth", "3")],
            zero,
            Some("L.{4,}E|LS.*E"),
        ),
        ("light", &[], lamp, Some("L.*SE")),
        ("light", &[], zero, Some("L.*SE")),
        ("light", &[], sky, Some("LE|L.*SE")),
        ("bdpt", &[], zero, Some("LS+((D|G|V)S+)*E")),
        ("bdpt", &[], sky, None),
        ("pssmlt", &[("over", "path")], zero, Some("LS.*E")),
        (
            "pssmlt",
            &[("over", "bdpt")],
            zero,
            Some("LS+((D|G|V)S+)*E"),
        ),
        ("pssmlt", &[], lamp, None),
        ("photon", &[], zero, Some("LS(S|G)*E")),
        ("photon", &[], lamp, None),
        ("photon", &[("caustic-map", "off")], lamp, Some("L(S|G)+DE")),
        (
            "photon",
            &[("global-map", "off")],
            zero,
            Some("LS(S|G)*E|L.*D.*DE"),
        ),
        ("sppm", &[], zero, Some("LS(S|G|V)*E")),
        ("sppm", &[], sky, None),
        ("vcm", &[], zero, Some("LS+((G|V)S+)*E")),
        ("vcm", &[], lamp, None),
    ] {
        let entry = integrators::find(id).expect("an integrator");
        let mut params = Params::defaults(entry.params);
        for (name, value) in set {
            params.set(entry.params, name, value).expect("a value");
        }
        let said = (entry.missing)(&features, &params).map(|m| m.words.into_owned());
        assert_eq!(said.as_deref(), words, "{id} {set:?}");
    }
}
