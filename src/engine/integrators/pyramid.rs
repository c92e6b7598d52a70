//! The pyramid of strategies (Veach 1997, figure 10.3): for each strategy (s, t) of bidirectional
//! path tracing the picture it finds alone, and what its weight leaves of it.
//!
//! The weighted pictures of all strategies add up to the whole; where an unweighted one is noisy
//! and the weighted one is not, another strategy has taken over.

use glam::{UVec2, Vec2};
use rayon::prelude::*;

use super::bdpt::Bdpt;
use super::bidirectional::{Sink, Technique, Workspace};
use super::{Cancelled, Params, Pass, RenderStats};
use crate::engine::math::Rgb;
use crate::engine::path::ClassId;

/// The two pictures of one strategy, row by row from the top left.
#[derive(Clone, Debug)]
pub struct TechniqueImage {
    /// The strategy.
    pub technique: Technique,
    /// Radiance times weight.
    pub weighted: Vec<[f32; 3]>,
    /// Radiance, as if the strategy were the only one.
    pub unweighted: Vec<[f32; 3]>,
}

/// Rows of one chunk of work.
const CHUNK_ROWS: u32 = 4;

/// A contribution, before it is added to its pictures.
struct Entry {
    technique: Technique,
    pixel: UVec2,
    value: Rgb,
    weight: f32,
}

/// The contributions of one chunk, of paths with at most `most` vertices.
struct List {
    pixel: UVec2,
    most: usize,
    entries: Vec<Entry>,
}

impl List {
    fn push(&mut self, technique: Technique, pixel: UVec2, value: Rgb, weight: f32) {
        if technique.s + technique.t <= self.most && value.is_finite() {
            self.entries.push(Entry {
                technique,
                pixel,
                value,
                weight,
            });
        }
    }
}

impl Sink for List {
    fn add(&mut self, technique: Technique, _: ClassId, value: Rgb, weight: f32) {
        self.push(technique, self.pixel, value, weight);
    }

    fn splat(&mut self, film: Vec2, technique: Technique, _: ClassId, value: Rgb, weight: f32) {
        self.push(technique, film.as_uvec2(), value, weight);
    }
}

/// Sums in f64 of one strategy.
struct Sums {
    technique: Technique,
    weighted: Vec<[f64; 3]>,
    unweighted: Vec<[f64; 3]>,
}

/// The pyramid of all paths of 2 to `most` vertices, from the passes 0 to `passes` − 1 of `cx`'s job
/// under bidirectional path tracing with the parameters `params`: shorter paths first, then by s.
///
/// # Errors
/// [`Cancelled`] if the job was.
pub fn pyramid(
    cx: &Pass<'_>,
    params: &Params,
    passes: u64,
    most: usize,
) -> Result<Vec<TechniqueImage>, Cancelled> {
    let bdpt = Bdpt::new(params);
    let size = cx.camera.size();
    let pixels = size.x as usize * size.y as usize;
    let techniques = (2..=most).flat_map(|n| (0..n).map(move |s| Technique { s, t: n - s }));
    let black = vec![[0.0; 3]; pixels];
    let mut sums: Vec<Sums> = techniques
        .map(|technique| Sums {
            technique,
            weighted: black.clone(),
            unweighted: black.clone(),
        })
        .collect();
    for index in 0..passes {
        let cx = Pass { index, ..*cx };
        let chunks = (0..size.y.div_ceil(CHUNK_ROWS)).into_par_iter();
        let lists: Result<Vec<List>, Cancelled> = chunks
            .map(|chunk| {
                cx.cancel.check()?;
                let rows = chunk * CHUNK_ROWS..size.y.min((chunk + 1) * CHUNK_ROWS);
                Ok(fill(&bdpt, &cx, rows, most))
            })
            .collect();
        // In the order of the chunks: the same for any number of threads.
        for entry in lists?.into_iter().flat_map(|list| list.entries) {
            let Technique { s, t } = entry.technique;
            // Behind all shorter paths, of which those of n vertices have n strategies.
            let n = s + t;
            let place = &mut sums[(n - 2) * (n + 1) / 2 + s];
            let pixel = (entry.pixel.y * size.x + entry.pixel.x) as usize;
            for (c, v) in entry.value.to_array().into_iter().enumerate() {
                place.unweighted[pixel][c] += f64::from(v);
                place.weighted[pixel][c] += f64::from(v) * f64::from(entry.weight);
            }
        }
    }
    let mean = |sum: [f64; 3]| sum.map(|x| (x / passes.max(1) as f64) as f32);
    let image = |s: Sums| TechniqueImage {
        technique: s.technique,
        weighted: s.weighted.into_iter().map(mean).collect(),
        unweighted: s.unweighted.into_iter().map(mean).collect(),
    };
    Ok(sums.into_iter().map(image).collect())
}

/// All pictures on one sheet, a row for each length of paths, s growing to the right: weighted ones
/// on the left, unweighted ones on the right.
pub fn sheet(images: &[TechniqueImage], size: UVec2) -> (UVec2, Vec<[f32; 3]>) {
    let vertices = |i: &TechniqueImage| i.technique.s + i.technique.t;
    let most = images.iter().map(vertices).max().unwrap_or(2) as u32;
    let columns = most;
    let whole = UVec2::new(2 * columns, most - 1) * size;
    let mut pixels = vec![[0.0; 3]; whole.x as usize * whole.y as usize];
    for image in images {
        let row = vertices(image) as u32 - 2;
        for (half, source) in [(0, &image.weighted), (1, &image.unweighted)] {
            let left = (half * columns + image.technique.s as u32) * size.x;
            for (y, line) in (0..size.y).zip(source.chunks_exact(size.x as usize)) {
                let at = ((row * size.y + y) * whole.x + left) as usize;
                pixels[at..at + line.len()].copy_from_slice(line);
            }
        }
    }
    (whole, pixels)
}

/// One sample of every pixel of the rows `rows`.
fn fill(bdpt: &Bdpt, cx: &Pass<'_>, rows: std::ops::Range<u32>, most: usize) -> List {
    let mut list = List {
        pixel: UVec2::ZERO,
        most,
        entries: Vec::new(),
    };
    let (mut work, shift) = (Workspace::default(), Bdpt::light_shift(cx));
    for y in rows {
        for x in 0..cx.camera.size().x {
            list.pixel = UVec2::new(x, y);
            let mut stats = RenderStats::default();
            let sample = (list.pixel, &shift);
            bdpt.sample_pixel(cx, sample, &mut work, &mut list, &mut stats);
        }
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::camera::Camera;
    use crate::engine::film::Film;
    use crate::engine::integrators::{Cancel, Integrator, bdpt};
    use crate::engine::io::scene_file;
    use crate::engine::plan::{LayerSettings, RenderPlan};
    use crate::engine::scene::Scene;

    #[test]
    fn weighted_pictures_add_up_and_unweighted_ones_agree() {
        let text = r#"
            camera = { position = [0, 0, 3.5], target = [0, 0, 0], vfov_deg = 50, width = 12, height = 8 }
            spheres = [
                { center = [0, 0, 0], radius = 4, material = "white", inward = true },
                { center = [0, 2, 0], radius = 0.8, material = "white", emission = [3, 2, 1] },
                { center = [0, -1, 0], radius = 0.8, material = "white" },
            ]
            materials.white = { type = "diffuse", reflectance = [0.5, 0.5, 0.5] }
        "#;
        let desc = scene_file::from_toml(text, "test.toml").unwrap();
        let scene = Scene::build(&desc).unwrap();
        let camera = Camera::new(&scene.camera).unwrap();
        let settings = LayerSettings {
            max_depth: Some(2),
            ..LayerSettings::default()
        };
        let plan = RenderPlan::new(&scene, false, &settings).unwrap();
        let cancel = Cancel::never();
        let mut pass = Pass {
            scene: &scene,
            camera: &camera,
            plan: &plan,
            seed: 3,
            index: 0,
            cancel: &cancel,
        };
        let params = Params::defaults(bdpt::ENTRY.params);
        let passes = 512;
        let images = pyramid(&pass, &params, passes, 4).unwrap();
        assert_eq!(images.len(), 2 + 3 + 4);

        // The weighted pictures are the whole, from the same random numbers.
        let mut integrator = (bdpt::ENTRY.build)(&params);
        let mut film = Film::new(camera.size(), plan.planned);
        for index in 0..passes {
            pass.index = index;
            Integrator::render_pass(integrator.as_mut(), &pass, &mut film).unwrap();
        }
        let mut layers = Vec::new();
        film.resolve(&plan.labels, &mut layers);
        for (i, whole) in layers[0].pixels.iter().enumerate() {
            for (c, whole) in whole.iter().enumerate() {
                let sum: f32 = images.iter().map(|t| t.weighted[i][c]).sum();
                assert!((sum - whole).abs() < 1e-4 * whole, "{sum} {whole}");
            }
        }

        // The integrator shows each of them alone.
        for image in &images {
            let mut params = params.clone();
            let words = format!("{},{}", image.technique.s, image.technique.t);
            params.set(bdpt::ENTRY.params, "picture", &words).unwrap();
            let mut integrator = (bdpt::ENTRY.build)(&params);
            let mut film = Film::new(camera.size(), plan.planned);
            for index in 0..passes {
                pass.index = index;
                Integrator::render_pass(integrator.as_mut(), &pass, &mut film).unwrap();
            }
            film.resolve(&plan.labels, &mut layers);
            for (a, b) in layers[0].pixels.iter().zip(&image.weighted) {
                for c in 0..3 {
                    let near = (a[c] - b[c]).abs() <= 1e-4 * b[c];
                    assert!(near, "{words}: {} {}", a[c], b[c]);
                }
            }
        }

        // On the sheet each has its place: s = 1 of three vertices, unweighted.
        let (whole, pixels) = sheet(&images, camera.size());
        assert_eq!(whole, camera.size() * UVec2::new(8, 3));
        let at = UVec2::new(5, 1) * camera.size() + UVec2::new(3, 2);
        let of = images
            .iter()
            .find(|i| i.technique == Technique { s: 1, t: 2 });
        let there = of.unwrap().unweighted[2 * camera.size().x as usize + 3];
        assert_eq!(pixels[(at.y * whole.x + at.x) as usize], there);

        // Each strategy alone finds all paths of its length in this scene.
        let mean = |pixels: &[[f32; 3]]| -> f32 {
            pixels.iter().flatten().sum::<f32>() / (3 * pixels.len()) as f32
        };
        for n in 2..=4 {
            let of_length = || images.iter().filter(|t| t.technique.s + t.technique.t == n);
            let expected: f32 = of_length().map(|t| mean(&t.weighted)).sum();
            for t in of_length() {
                let found = mean(&t.unweighted);
                assert!(
                    (found / expected - 1.0).abs() < 0.05,
                    "{:?}: {found} against {expected}",
                    t.technique
                );
            }
        }
    }
}
