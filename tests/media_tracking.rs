//! Phase functions, distances and transmittance of media against what they claim to be.

#[path = "support/chi_square.rs"]
mod chi_square;

use std::sync::Arc;

use chi_square::{SphereGrid, assert_family, p_value, test_directions};
use glam::{Vec2, Vec3, Vec3A};
use lightscope::engine::geometry::Ray;
use lightscope::engine::math::Rgb;
use lightscope::engine::media::{Draws, Medium, Phase};
use lightscope::engine::sampling::{IndependentSampler, Sampler, Stream};
use lightscope::engine::scene::desc::media::{
    DensityData, GridDesc, MediumDesc, NamedMedium, PhaseDesc,
};

const G: [f32; 9] = [-0.999, -0.9, -0.3, 0.0, 1e-6, 0.3, 0.7, 0.9, 0.999];

fn phases() -> Vec<Phase> {
    let hg = G.map(|g| Phase::HenyeyGreenstein { g });
    [&[Phase::Isotropic, Phase::Rayleigh][..], &hg].concat()
}

fn numbers(stream: u64) -> impl FnMut() -> [f32; 4] {
    let mut index = 0;
    move || {
        let mut s = IndependentSampler::new(11, Stream::Test, (stream, index));
        index += 1;
        [0, 1, 2, 3].map(|_| s.next_1d())
    }
}

#[test]
fn phase_functions_draw_by_the_density_they_claim() {
    let mut p_values = Vec::new();
    for (i, phase) in phases().into_iter().enumerate() {
        for (j, wo) in [Vec3A::new(0.3, -0.5, 0.8), Vec3A::NEG_Z]
            .into_iter()
            .enumerate()
        {
            let wo = wo.normalize();
            let (axis, spread) = match phase {
                Phase::HenyeyGreenstein { g } => (wo * -g.signum(), f64::from(1.0 - g.abs())),
                _ => (-wo, 1.0),
            };
            let mut next = numbers((i * 2 + j) as u64);
            let p = test_directions(
                &SphereGrid::new(axis, spread),
                300_000,
                |wi| f64::from(phase.pdf(wo, wi)),
                || {
                    let [x, y, ..] = next();
                    Some(phase.sample(wo, Vec2::new(x, y)))
                },
            );
            p_values.push((format!("{phase:?} {wo}"), p));
        }
    }
    assert_family(&p_values);
}

/// The mean cosine of Henyey and Greenstein is g; that of the others 0.
#[test]
fn phase_functions_have_their_mean_cosine() {
    for (i, phase) in phases().into_iter().enumerate() {
        let (wo, n) = (Vec3A::new(-0.6, 0.64, 0.48), 200_000);
        let mut next = numbers(100 + i as u64);
        let sum: f64 = (0..n)
            .map(|_| {
                let [x, y, ..] = next();
                f64::from(-wo.dot(phase.sample(wo, Vec2::new(x, y))))
            })
            .sum();
        let exact = match phase {
            Phase::HenyeyGreenstein { g } => f64::from(g),
            _ => 0.0,
        };
        // The variance of a cosine is at most 1.
        let found = sum / f64::from(n);
        assert!(
            (found - exact).abs() < 4.5 / f64::from(n).sqrt(),
            "{phase:?}: {found}"
        );
    }
}

#[test]
fn phase_functions_take_the_ends_of_the_random_numbers() {
    let last = 1.0 - f32::EPSILON / 2.0;
    for phase in phases() {
        for x in [0.0, 1e-7, 0.5, last] {
            for y in [0.0, 0.25, last] {
                for wo in [Vec3A::X, Vec3A::NEG_Z, Vec3A::new(0.48, 0.6, -0.64)] {
                    let wi = phase.sample(wo, Vec2::new(x, y));
                    let pdf = phase.pdf(wo, wi);
                    assert!((wi.length() - 1.0).abs() < 1e-5, "{phase:?} {x} {y}: {wi}");
                    assert!(pdf > 0.0 && pdf.is_finite(), "{phase:?} {x} {y}: {pdf}");
                }
            }
        }
    }
}

fn medium(sigma_t: [f32; 3], albedo: [f32; 3], grid: Option<GridDesc>) -> Medium {
    let desc = NamedMedium {
        name: "test".to_owned(),
        medium: MediumDesc {
            sigma_t: sigma_t.into(),
            albedo: albedo.into(),
            emission: if sigma_t == [0.0; 3] {
                Rgb::BLACK
            } else {
                Rgb::splat(0.25)
            },
            phase: PhaseDesc::Isotropic,
            grid,
        },
    };
    Medium::new(&desc).unwrap_or_else(|e| panic!("{e}"))
}

/// Densities over the unit cube.
fn grid(size: [usize; 3], majorant_scale: f32, at: impl Fn(usize) -> f32) -> GridDesc {
    let values = (0..size.iter().product()).map(at).collect();
    GridDesc {
        density: Arc::new(DensityData {
            name: "test".to_owned(),
            size,
            values,
        }),
        min: Vec3::ZERO,
        max: Vec3::ONE,
        majorant_scale,
    }
}

fn rough(i: usize) -> f32 {
    let x = (i * 7919 % 101) as f32 / 100.0;
    if i.is_multiple_of(5) {
        0.0
    } else {
        2.0 * x * x
    }
}

/// A ray that is slanted, and where it crosses the unit cube.
const CHORD: (f32, f32) = (0.35, 1.1);

fn slanted() -> Ray {
    let d = Vec3A::new(0.6, 0.64, 0.48);
    Ray::new(Vec3A::new(0.02, 0.05, 0.1), d)
}

/// ∫ density along the chord, in f64.
fn thickness(grid: &GridDesc) -> f64 {
    let m = medium([1.0; 3], [0.0; 3], Some(grid.clone()));
    let n = 20_000;
    let step = f64::from(CHORD.1 - CHORD.0) / f64::from(n);
    let at = |i: i32| {
        let t = f64::from(CHORD.0) + (f64::from(i) + 0.5) * step;
        f64::from(m.density(slanted().at(t as f32)))
    };
    (0..n).map(at).sum::<f64>() * step
}

/// Mean and its standard error of `n` estimates.
fn mean(n: u32, mut estimate: impl FnMut() -> f64) -> (f64, f64) {
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..n {
        let x = estimate();
        sum += x;
        squares += x * x;
    }
    let n = f64::from(n);
    let mean = sum / n;
    (mean, ((squares / n - mean * mean).max(0.0) / n).sqrt())
}

fn near(what: &str, (found, error): (f64, f64), exact: f64) {
    assert!(
        (found - exact).abs() <= 4.5 * error + 2e-6 * exact.abs(),
        "{what}: {found}, not {exact}, error {error}"
    );
}

fn draws(next: &mut impl FnMut() -> [f32; 4]) -> Draws {
    let [a, b, c, d] = next();
    Draws::new([a, b], [c, d])
}

const SIGMAS: [[f32; 3]; 4] = [
    [1.0, 1.0, 1.0],
    [3.0, 1.0, 0.2],
    [0.0, 2.0, 5.0],
    [0.3, 0.0, 0.0],
];

#[test]
fn ratio_tracking_is_transmittance() {
    for (s, sigma) in SIGMAS.into_iter().enumerate() {
        for (k, scale) in [1.0, 8.0].into_iter().enumerate() {
            let g = grid([5, 4, 7], scale, rough);
            let m = medium(sigma, [0.8; 3], Some(g.clone()));
            let tau = thickness(&g);
            for c in 0..3 {
                let mut next = numbers((200 + s * 20 + k * 10 + c) as u64);
                let found = mean(40_000, || {
                    let mut d = draws(&mut next);
                    let t = m.transmittance(&slanted(), CHORD, &mut d);
                    assert_eq!(d.exceeded, 0);
                    f64::from(t[c])
                });
                near("transmittance", found, (-f64::from(sigma[c]) * tau).exp());
            }
        }
    }
}

/// What is tracked through, scattered and emitted, with uneven throughputs: each channel gets its
/// own, whichever of them was tracked.
#[test]
fn tracking_scatters_and_emits_each_channel_by_its_own_extinction() {
    let beta = Rgb::new(0.2, 1.0, 3.0);
    let albedo = [0.9, 0.5, 0.1];
    for (s, sigma) in SIGMAS.into_iter().enumerate() {
        for (k, g) in [None, Some(grid([5, 4, 7], 1.0, rough))]
            .into_iter()
            .enumerate()
        {
            let tau = g.as_ref().map_or(f64::from(CHORD.1 - CHORD.0), thickness);
            let m = medium(sigma, albedo, g);
            for c in 0..3 {
                let tracked = |what: u64, value: fn(&lightscope::engine::media::Tracked) -> Rgb| {
                    let stream = 400 + (s * 20 + k * 10 + c) as u64 + 1000 * what;
                    let mut next = numbers(stream);
                    mean(60_000, || {
                        let mut d = draws(&mut next);
                        let tracked = m.track(&slanted(), CHORD, beta, &mut d);
                        let sum = (beta * tracked.weight).to_array().iter().sum::<f32>();
                        assert!(sum <= 4.2 * 1.000_01, "throughput grows to {sum}");
                        f64::from(value(&tracked)[c])
                    })
                };
                let (sigma, albedo) = (f64::from(sigma[c]), f64::from(albedo[c]));
                let through = (-sigma * tau).exp();
                let weight = |t: &lightscope::engine::media::Tracked| t.weight;
                let name = |what: &str| format!("{what} {sigma} {k}");
                near(
                    &name("through"),
                    tracked(0, |t| if t.t.is_none() { t.weight } else { Rgb::BLACK }),
                    through,
                );
                near(
                    &name("scattered"),
                    tracked(1, |t| if t.t.is_some() { t.weight } else { Rgb::BLACK }),
                    albedo * (1.0 - through),
                );
                let emitted = if sigma == 0.0 {
                    tau
                } else {
                    (1.0 - through) / sigma
                };
                near(&name("emitted"), tracked(2, |t| t.emitted), 0.25 * emitted);
                near(
                    &name("both"),
                    tracked(3, weight),
                    through + albedo * (1.0 - through),
                );
            }
        }
    }
}

/// A grid of one value draws the distances of the homogeneous medium.
#[test]
fn a_constant_grid_is_homogeneous() {
    let mut p_values = Vec::new();
    for (i, sigma) in [0.5_f32, 3.0, 40.0].into_iter().enumerate() {
        let g = grid([9, 20, 3], 1.0, |_| 2.0);
        let m = medium([sigma; 3], [0.7; 3], Some(g));
        let sigma = 2.0 * f64::from(sigma);
        let length = f64::from(CHORD.1 - CHORD.0);
        let bins = 32;
        let edge = |b: u32| length * f64::from(b) / f64::from(bins);
        let mut probabilities: Vec<f64> = (0..bins)
            .map(|b| (-sigma * edge(b)).exp() - (-sigma * edge(b + 1)).exp())
            .collect();
        probabilities.push((-sigma * length).exp());
        let mut counts = vec![0; probabilities.len()];
        let mut next = numbers(9000 + i as u64);
        for _ in 0..200_000 {
            let t = m
                .track(&slanted(), CHORD, Rgb::WHITE, &mut draws(&mut next))
                .t;
            let bin = t.map_or(bins as usize, |t| {
                let x = f64::from(t - CHORD.0) / length * f64::from(bins);
                (x as usize).min(bins as usize - 1)
            });
            counts[bin] += 1;
        }
        p_values.push((format!("σ = {sigma}"), p_value(&probabilities, &counts)));
    }
    assert_family(&p_values);
}

/// A bound ten thousand times too high makes more steps and the same mean; one too low is found
/// out.
#[test]
fn majorants_too_high_cost_time_and_too_low_are_counted() {
    let sigma = [2.0, 1.0, 0.5];
    let g = grid([5, 4, 7], 1e4, rough);
    let m = medium(sigma, [0.5; 3], Some(g.clone()));
    let tau = thickness(&g);
    let mut next = numbers(77);
    let found = mean(400, || {
        let mut d = draws(&mut next);
        let tracked = m.track(&slanted(), CHORD, Rgb::WHITE, &mut d);
        assert_eq!(d.exceeded, 0);
        f64::from(if tracked.t.is_none() {
            tracked.weight[0]
        } else {
            0.0
        })
    });
    near("through", found, (-2.0 * tau).exp());

    let low = medium(sigma, [0.5; 3], Some(grid([5, 4, 7], 0.3, rough)));
    let exceeded: u64 = (0..1000)
        .map(|_| {
            let mut d = draws(&mut next);
            low.track(&slanted(), CHORD, Rgb::WHITE, &mut d);
            low.transmittance(&slanted(), CHORD, &mut d);
            d.exceeded
        })
        .sum();
    assert!(exceeded > 100, "{exceeded}");
}

/// Optical thicknesses over the whole range: finite, in order, never negative.
#[test]
fn extreme_extinctions_are_finite() {
    let length = (0.0, 1.0);
    for sigma in [0.0_f32, 1e-30, 1e-9, 1.0, 1e4, 1e9, 1e30] {
        for other in [0.0, 1e-9, 1e9] {
            let sigmas = [sigma, other, sigma];
            let grid = grid([2, 2, 2], 1.0, |_| 1.0);
            // A grid is stepped through; steps are few although one channel's bound is 10³⁰.
            for grid in [None, Some(grid)] {
                let m = medium(sigmas, [0.5, 1.0, 0.0], grid);
                for beta in [
                    Rgb::WHITE,
                    Rgb::new(1e-30, 1.0, 1e30),
                    Rgb::new(0.0, 0.0, 1.0),
                ] {
                    let mut next = numbers(5);
                    for _ in 0..50 {
                        let mut d = draws(&mut next);
                        let tracked = m.track(&slanted(), length, beta, &mut d);
                        let t = m.transmittance(&slanted(), length, &mut d);
                        for v in [tracked.weight, tracked.emitted, t] {
                            let fine = v.to_array().into_iter().all(|x| x.is_finite() && x >= 0.0);
                            assert!(fine, "{sigmas:?} {beta:?}: {tracked:?} {t:?}");
                        }
                        assert!(tracked.t.is_none_or(|t| (0.0..1.0).contains(&t)));
                    }
                }
            }
        }
    }
    // exp(−σ d) to the last digits.
    for exponent in -9..=4 {
        let sigma = 10_f32.powi(exponent);
        let m = medium([sigma; 3], [0.0; 3], None);
        let t = m.transmittance(&slanted(), length, &mut Draws::new([0.5; 2], [0.5; 2]));
        let exact = (-f64::from(sigma)).exp();
        // Below 1e-38 numbers lie 2⁻¹⁴⁹ apart.
        let apart = f64::from(f32::from_bits(1));
        assert!(
            (f64::from(t[0]) - exact).abs() <= 1e-6 * exact + apart,
            "{sigma}"
        );
    }
}
