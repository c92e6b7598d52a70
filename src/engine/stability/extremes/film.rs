//! Sums and their ends.

use glam::{UVec2, Vec3};

use super::super::case::{Case, Fit, Run, Variant};
use super::super::estimate::Sampling;
use super::super::fits;
use super::super::scenes::{diffuse, sphere, view};
use crate::engine::film::pass_buffer::PassBuffer;
use crate::engine::film::{Film, SampleRadiance};
use crate::engine::math::Rgb;
use crate::engine::path::{ClassId, PathClasses};
use crate::engine::scene::desc::SceneDesc;

/// Many samples.
pub const ACCUMULATE: Case = Case {
    id: "accumulate",
    label: "Sums of many samples",
    summary: "2²⁵ samples of one pixel, and small ones after one of 10⁶.",
    parameter: "samples",
    oracle: "the mean, to 10⁻⁶",
    stiff: false,
    fit: fits::engine,
    run: accumulate,
};

/// Roulette from the first event on, and none.
pub const ROULETTE: Case = Case {
    id: "roulette",
    label: "Russian roulette in bright rooms",
    summary: "The shining sphere of high albedo with roulette from the first event on, from the \
              fourth, and from the thousandth.",
    parameter: "1/(1−ρ)",
    oracle: "E/(1−ρ)",
    stiff: true,
    fit: roulette_fit,
    run: roulette,
};

/// The mean that a film says after `n` samples, of which the first is `first` and all others
/// `rest`.
fn film_mean(n: u64, first: f32, rest: f32) -> f64 {
    let size = UVec2::ONE;
    let mut film = Film::new(size, 0);
    let classes = PathClasses::components();
    let mut pass = PassBuffer::new(size, 0);
    let mut put = |film: &mut Film, value: f32, times: u64| {
        let mut sample = SampleRadiance::new(&classes, 0);
        sample.add(ClassId::EMPTY, Rgb::splat(value));
        for tile in pass.tiles_mut() {
            tile.begin();
            tile.put(0, 0, &sample);
        }
        for _ in 0..times {
            film.commit(&pass);
        }
    };
    put(&mut film, first, 1);
    put(&mut film, rest, n - 1);
    let mut layers = Vec::new();
    film.resolve(&["whole".to_owned()], &mut layers);
    layers
        .first()
        .map_or(f64::NAN, |l| f64::from(l.pixels[0][0]))
}

fn accumulate(run: &mut Run) {
    let n = 1_u64 << run.pick(23, 25);
    let found = film_mean(n, 1.1, 1.1);
    run.value(n as f64, "of one kind", found, f64::from(1.1_f32), 1e-6);
    let n = 1_u64 << 20;
    let exact = (1e6 + (n - 1) as f64 * f64::from(1e-4_f32)) / n as f64;
    run.value(
        n as f64,
        "after one of 10⁶",
        film_mean(n, 1e6, 1e-4),
        exact,
        1e-6,
    );
}

fn roulette_fit(id: &str) -> Fit {
    const fn from(name: &'static str, set: &'static [(&'static str, &'static str)]) -> Variant {
        Variant {
            name,
            set,
            bias: 0.0,
        }
    }
    const PATH: &[Variant] = &[
        from("roulette=0", &[("roulette", "0"), ("mode", "hits")]),
        from("roulette=4", &[("roulette", "4"), ("mode", "hits")]),
        from("roulette=1000", &[("roulette", "1000"), ("mode", "hits")]),
    ];
    const OTHERS: &[Variant] = &[
        from("roulette=0", &[("roulette", "0")]),
        from("roulette=30", &[("roulette", "30")]),
    ];
    match id {
        "path" => Fit::Asked(PATH),
        "light" | "bdpt" => Fit::Asked(OTHERS),
        "sppm" | "vcm" | "pssmlt" => Fit::LeftOut("they walk as bdpt does, which is asked"),
        _ => Fit::LeftOut("integrating-sphere and photon-power ask it as far as it follows"),
    }
}

fn roulette(run: &mut Run) {
    let albedos: &[f32] = match run.id() {
        "path" => run.pick(&[0.9, 0.995], &[0.9, 0.995, 0.9995]),
        "light" => run.pick(&[0.9, 0.99], &[0.9, 0.995]),
        _ => run.pick(&[0.9], &[0.9, 0.98]),
    };
    for &rho in albedos {
        let mut wall = sphere(0, Vec3::ZERO, 1.0, true);
        wall.emission = Some(Rgb::WHITE);
        let desc = SceneDesc {
            camera: view(
                Vec3::new(0.3, -0.2, 0.4),
                Vec3::new(1.0, 0.5, -1.0),
                90.0,
                4,
            ),
            materials: vec![diffuse("wall", rho)],
            spheres: vec![wall],
            ..SceneDesc::default()
        };
        let exact = 1.0 / (1.0 - f64::from(rho));
        let how = Sampling::new(4, run.pick(512, 4096), run.pick(0.1, 0.03));
        let job = run.job(&desc);
        run.picture(exact, "", &job, exact, &how);
    }
}
