//! From runs to curves with bands, slopes, and the winner at equal time.

use serde::Serialize;

use super::options::{ReportOptions, Subject};
use super::record::{LayerFigures, Point, Run};
use crate::cli::scene::parameter_text;
use crate::engine::integrators::{Entry, Params};
use crate::engine::measure::convergence::{
    Look, NoiseAndBias, Prediction, fit, noise_and_bias, predict, without_reference_noise,
};
use crate::engine::measure::{ReferenceNoise, unseen};

/// What happened on one scene.
#[derive(Serialize)]
pub struct SceneSummary {
    /// Its name.
    pub id: String,
    /// Pixels.
    pub size: [u32; 2],
    /// Where the reference lies; without one all errors are estimates.
    pub reference: Option<String>,
    /// What the reference's own noise gives, where its standard errors are known.
    pub reference_noise: Option<ReferenceNoise>,
    /// The measure of the curves and of the race, in words.
    pub measure: &'static str,
    /// Everybody who took part.
    pub integrators: Vec<Contestant>,
}

/// One algorithm on one scene.
#[derive(Serialize)]
pub struct Contestant {
    /// Its id.
    pub id: &'static str,
    /// Its name.
    pub label: &'static str,
    /// All parameters.
    pub parameters: String,
    /// Words that it cannot find here, and why.
    pub missing: Option<String>,
    /// What its estimated error cannot see.
    pub unseen: Option<&'static str>,
    /// All runs.
    pub runs: Vec<Run>,
    /// Their common passes.
    pub curve: Vec<CurvePoint>,
    /// Slope of the error against passes, the reference's noise taken off (the only figure that it
    /// is taken off from).
    pub slope: Option<f64>,
    /// At the end of the time, mean over the seeds.
    pub race: Race,
    /// Noise and bias at the end, in units of radiance, where there is a reference.
    pub parts: Option<NoiseAndBias>,
    /// Whether the error is more than its noise, the upper end of its interval, explains.
    pub bias_seen: bool,
    /// When the relative error reaches the target.
    pub prediction: Option<Prediction>,
    /// 1000 · relMSE · t_cpu: smaller is better.
    pub k: Option<f64>,
    /// Layer by layer, mean over the seeds.
    pub layers: Vec<LayerFigures>,
}

/// The runs at a pass that all of them have.
#[derive(Clone, Copy, Serialize)]
pub struct CurvePoint {
    /// Completed passes.
    pub pass: u64,
    /// Wall time in seconds, mean over the seeds.
    pub seconds: f64,
    /// Root mean square over the seeds of the relative error.
    pub error: f64,
    /// Smallest and largest over the seeds.
    pub band: [f64; 2],
}

/// How it stood when the time was up.
#[derive(Clone, Copy, Serialize)]
pub struct Race {
    /// Root mean square over the seeds of the relative error.
    pub error: Option<f64>,
    /// Smallest and largest over the seeds.
    pub band: Option<[f64; 2]>,
    /// Passes, mean over the seeds.
    pub passes: f64,
    /// It has the smallest error.
    pub winner: bool,
    /// Its band overlaps that of the winner: too close to call.
    pub close: bool,
}

impl SceneSummary {
    /// Of all runs on a scene; `runs` in the order of the contestants.
    pub fn new(options: &ReportOptions, subject: &Subject, runs: Vec<Vec<Run>>) -> Self {
        let (whole, picture) = (subject.whole(), subject.reference.as_ref());
        let se = picture.and_then(|p| p.standard_errors.iter().find(|s| s.label == "whole"));
        let noise = whole
            .zip(se)
            .and_then(|(r, se)| ReferenceNoise::new(&r.pixels, &se.pixels));
        let mean = whole.and_then(|r| mean(&r.pixels));
        let scale = Scale {
            mean,
            noise: noise.map_or(0.0, |n| n.rmse),
        };
        let pairs = options.contestants.iter().zip(runs);
        let mut integrators: Vec<Contestant> = pairs
            .map(|(c, runs)| contestant(options, subject, c, runs, scale))
            .collect();
        call_race(&mut integrators);
        Self {
            id: subject.id.clone(),
            size: subject.size.to_array(),
            reference: subject
                .reference_path
                .as_ref()
                .map(|p| p.display().to_string()),
            reference_noise: noise,
            measure: match mean {
                Some(_) => "RMSE against the reference / its mean",
                None => "estimated RMSE / mean of the picture (there is no reference)",
            },
            integrators,
        }
    }
}

/// What errors are divided by, and what the reference adds to them.
#[derive(Clone, Copy)]
struct Scale {
    mean: Option<f64>,
    noise: f64,
}

impl Scale {
    /// The relative error of a point.
    fn error(&self, p: &Point) -> Option<f64> {
        let (error, mean) = match self.mean {
            Some(mean) => (p.rmse?, mean),
            None => (p.estimate?, p.mean?),
        };
        (mean > 0.0).then(|| error / mean)
    }
}

fn mean(pixels: &[[f32; 3]]) -> Option<f64> {
    let means = crate::engine::measure::metrics::channel_means(pixels)?;
    let mean = means.iter().sum::<f64>() / 3.0;
    (mean > 0.0).then_some(mean)
}

fn contestant(
    options: &ReportOptions,
    subject: &Subject,
    (entry, params): &(&'static Entry, Params),
    runs: Vec<Run>,
    scale: Scale,
) -> Contestant {
    let curve = curve(&runs, scale);
    let missing = (entry.missing)(&subject.scene.features, params);
    let noise = scale.mean.map_or(0.0, |mean| scale.noise / mean);
    let fitted = curve.iter().filter(|p| p.pass >= 2);
    let slope = fit(fitted.map(|p| (p.pass as f64, without_reference_noise(p.error, noise))));
    let looks: Vec<Look> = curve
        .iter()
        .map(|p| Look {
            passes: p.pass,
            seconds: p.seconds,
            error: p.error,
        })
        .collect();
    let last = || runs.iter().filter_map(|r| r.points.last());
    let average = |f: &dyn Fn(&Point) -> Option<f64>| average(last().map(f));
    let squares =
        |f: &dyn Fn(&Point) -> Option<f64>| average(&|p| f(p).map(|e| e * e)).map(f64::sqrt);
    let parts = squares(&|p| p.rmse)
        .zip(squares(&|p| p.estimate))
        .map(|(rmse, estimate)| noise_and_bias(rmse, estimate, scale.noise));
    let errors: Vec<f64> = last().filter_map(|p| scale.error(p)).collect();
    Contestant {
        id: entry.id,
        label: entry.label,
        parameters: parameter_text(params),
        missing: missing.map(|m| format!("{}: {}", m.words, m.why)),
        unseen: unseen(entry.id, params),
        slope: slope.map(|rate| rate.slope),
        race: Race {
            error: squares(&|p| scale.error(p)),
            band: (!errors.is_empty()).then(|| ends(&errors)),
            passes: average(&|p| Some(p.pass as f64)).unwrap_or(0.0),
            winner: false,
            close: false,
        },
        bias_seen: squares(&|p| p.rmse)
            .zip(squares(&|p| p.interval.map(|i| i[1])))
            .is_some_and(|(rmse, most)| without_reference_noise(rmse, scale.noise) > most),
        // A biased method may never get there; what stays of its error says so.
        prediction: predict(&looks, options.target),
        parts,
        k: average(&|p| p.relmse.map(|e| 1000.0 * e * p.t_cpu)),
        layers: layer_means(&runs),
        curve,
        runs,
    }
}

fn curve(runs: &[Run], scale: Scale) -> Vec<CurvePoint> {
    let Some(first) = runs.first() else {
        return Vec::new();
    };
    let at = |pass: u64| {
        let points: Option<Vec<&Point>> = runs
            .iter()
            .map(|r| r.points.iter().find(|p| p.pass == pass))
            .collect();
        let points = points?;
        let errors: Option<Vec<f64>> = points.iter().map(|p| scale.error(p)).collect();
        let errors = errors?;
        Some(CurvePoint {
            pass,
            seconds: average(points.iter().map(|p| Some(p.t_wall)))?,
            error: average(errors.iter().map(|e| Some(e * e)))?.sqrt(),
            band: ends(&errors),
        })
    };
    first.points.iter().filter_map(|p| at(p.pass)).collect()
}

fn ends(values: &[f64]) -> [f64; 2] {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    [low, values.iter().copied().fold(0.0, f64::max)]
}

/// The mean, if there are values and none is missing.
fn average(values: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let values: Option<Vec<f64>> = values.collect();
    let values = values.filter(|v| !v.is_empty())?;
    Some(values.iter().sum::<f64>() / values.len() as f64)
}

fn layer_means(runs: &[Run]) -> Vec<LayerFigures> {
    let Some(first) = runs.first() else {
        return Vec::new();
    };
    let mean = |i: usize| {
        let of = |f: &dyn Fn(&LayerFigures) -> f64| {
            average(runs.iter().map(|r| r.layers.get(i).map(f))).unwrap_or(f64::NAN)
        };
        LayerFigures {
            layer: first.layers[i].layer.clone(),
            rmse: of(&|l| l.rmse * l.rmse).sqrt(),
            bias: of(&|l| l.bias),
            relmse: of(&|l| l.relmse),
            reference_rmse: first.layers[i].reference_rmse,
        }
    };
    (0..first.layers.len()).map(mean).collect()
}

fn call_race(all: &mut [Contestant]) {
    let error = |c: &Contestant| c.race.error.filter(|e| e.is_finite());
    let best = (0..all.len())
        .filter(|i| error(&all[*i]).is_some())
        .min_by(|a, b| {
            error(&all[*a])
                .unwrap_or(f64::INFINITY)
                .total_cmp(&error(&all[*b]).unwrap_or(f64::INFINITY))
        });
    let Some(best) = best else { return };
    all[best].race.winner = true;
    let high = all[best].race.band.map_or(0.0, |b| b[1]);
    for (i, c) in all.iter_mut().enumerate() {
        c.race.close = i != best && c.race.band.is_some_and(|b| b[0] <= high);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(seed: u64, points: &[(u64, f64)]) -> Run {
        let point = |&(pass, estimate): &(u64, f64)| Point {
            pass,
            spp: pass,
            t_wall: pass as f64,
            t_cpu: pass as f64,
            rays: 0,
            estimate: Some(estimate),
            interval: None,
            mean: Some(2.0),
            rmse: None,
            relmse: None,
            nmse: None,
            rmse_without_worst: None,
            relmse_without_worst: None,
        };
        Run {
            seed,
            points: points.iter().map(point).collect(),
            layers: Vec::new(),
        }
    }

    #[test]
    fn curves_have_the_passes_that_all_seeds_have() {
        let scale = Scale {
            mean: None,
            noise: 0.0,
        };
        let runs = [
            run(0, &[(2, 0.6), (4, 0.4), (7, 0.2)]),
            run(1, &[(2, 0.8), (4, 0.4), (6, 0.2)]),
        ];
        let curve = curve(&runs, scale);
        let passes: Vec<u64> = curve.iter().map(|p| p.pass).collect();
        assert_eq!(passes, [2, 4]);
        assert!((curve[0].error - (0.125f64).sqrt()).abs() < 1e-12);
        assert_eq!((curve[0].band, curve[1].error), ([0.3, 0.4], 0.2));
    }
}
