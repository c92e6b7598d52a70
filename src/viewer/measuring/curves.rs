//! Errors of one view, a curve for each algorithm that has rendered it.

use super::Along;
use crate::engine::integrators::{Params, REGISTRY};
use crate::engine::measure::convergence::{Look, Prediction, Rate, fit, predict};
use crate::engine::session::Settings;
use crate::picture::colors;
use crate::plot;

/// Most curves; the oldest goes first.
const MOST: usize = 16;
/// Samples of a curve nearer to each other than this ratio of passes are thinned out.
const THIN: f64 = 1.03;

/// An error at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Completed passes.
    pub passes: u64,
    /// Seconds.
    pub seconds: f64,
    /// RMSE against the reference over its mean.
    pub measured: Option<f64>,
    /// Estimated RMSE over the mean, and its 95 % interval.
    pub estimated: Option<(f64, [f64; 2])>,
}

impl Sample {
    fn error(&self, measured: bool) -> Option<f64> {
        if measured {
            self.measured
        } else {
            self.estimated.map(|(error, _)| error)
        }
    }
}

/// The errors of one algorithm.
#[derive(Clone)]
pub struct Track {
    settings: Settings,
    /// Its name in the plot.
    pub label: String,
    /// Its colour.
    pub color: [u8; 3],
    /// In the order of the passes.
    pub samples: Vec<Sample>,
}

/// All curves of a view.
#[derive(Default)]
pub struct Curves {
    tracks: Vec<Track>,
    /// What could not be done.
    pub complaint: Option<String>,
    made: usize,
}

impl Curves {
    /// Forgets everything: the view is another one.
    pub fn clear(&mut self) {
        self.tracks.clear();
        self.made = 0;
    }

    /// The curves, the oldest first.
    pub fn tracks(&self) -> &[Track] {
        &self.tracks
    }

    /// Adds a sample of what `settings` render. A render that began again continues its curve
    /// where it goes beyond it.
    pub fn add(&mut self, settings: &Settings, sample: Sample) {
        let index = self.index(settings);
        let samples = &mut self.tracks[index].samples;
        if let Some(old) = samples.iter_mut().find(|s| s.passes == sample.passes) {
            old.measured = sample.measured.or(old.measured);
            old.estimated = sample.estimated.or(old.estimated);
            return;
        }
        match samples.last() {
            Some(last) if last.passes > sample.passes => return,
            _ => {}
        }
        // The newest sample always stays; the one before it only if it is far enough from its own
        // predecessor.
        if let [.., before, last] = samples[..]
            && (last.passes as f64) < before.passes as f64 * THIN
            && before.measured.is_some() == sample.measured.is_some()
        {
            samples.pop();
        }
        samples.push(sample);
    }

    fn index(&mut self, settings: &Settings) -> usize {
        if let Some(found) = self.tracks.iter().position(|t| same(&t.settings, settings)) {
            return found;
        }
        if self.tracks.len() == MOST {
            self.tracks.remove(0);
        }
        self.tracks.push(Track {
            settings: settings.clone(),
            label: label(settings),
            color: colors::curve(self.made),
            samples: Vec::new(),
        });
        self.made += 1;
        self.tracks.len() - 1
    }

    /// The curves as they are drawn.
    pub fn plotted(&self, along: Along, measured: bool) -> Vec<plot::Curve> {
        let curve = |track: &Track| {
            let x = |s: &Sample| match along {
                Along::Seconds => s.seconds,
                Along::Samples => s.passes as f64,
            };
            let band = |s: &Sample| s.estimated.filter(|_| !measured).map(|(_, i)| (x(s), i));
            let point = |s: &Sample| s.error(measured).map(|e| (x(s), e));
            plot::Curve {
                label: track.label.clone(),
                color: track.color,
                points: track.samples.iter().filter_map(point).collect(),
                band: track.samples.iter().filter_map(band).collect(),
            }
        };
        let curves = self.tracks.iter().map(curve);
        curves.filter(|c| !c.points.is_empty()).collect()
    }

    /// The fitted power law of a track, against passes.
    pub fn rate(&self, track: &Track, measured: bool) -> Option<Rate> {
        let looks = looks(track, measured);
        let later = looks.iter().filter(|l| l.passes >= 2);
        fit(later.map(|l| (l.passes as f64, l.error)))
    }

    /// When what `settings` render reaches `target`.
    pub fn prediction(
        &self,
        settings: &Settings,
        measured: bool,
        target: f64,
    ) -> Option<Prediction> {
        let track = self.tracks.iter().find(|t| same(&t.settings, settings))?;
        predict(&looks(track, measured), target)
    }
}

fn looks(track: &Track, measured: bool) -> Vec<Look> {
    let look = |s: &Sample| {
        Some(Look {
            passes: s.passes,
            seconds: s.seconds,
            error: s.error(measured)?,
        })
    };
    track.samples.iter().filter_map(look).collect()
}

/// Layers change nothing about the whole.
fn same(a: &Settings, b: &Settings) -> bool {
    a.integrator.id == b.integrator.id && a.params == b.params && a.seed == b.seed
}

/// The id, and what differs from the defaults.
fn label(settings: &Settings) -> String {
    let defaults = Params::defaults(settings.integrator.params);
    let differs = |name: &'static str| settings.params.text(name) != defaults.text(name);
    let others = settings.params.iter().filter(|(name, _)| differs(name));
    let mut text = settings.integrator.id.to_owned();
    for (name, value) in others {
        text += &format!(" {name}={value}");
    }
    if settings.seed != 0 {
        text += &format!(" seed={}", settings.seed);
    }
    text
}

/// Names of all integrators, for lists.
pub fn integrators() -> impl Iterator<Item = (usize, &'static str)> {
    REGISTRY.iter().map(|e| e.label).enumerate()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(passes: u64) -> Sample {
        let error = 1.0 / (passes as f64).sqrt();
        Sample {
            passes,
            seconds: passes as f64 * 0.1,
            measured: None,
            estimated: Some((error, [0.9 * error, 1.1 * error])),
        }
    }

    #[test]
    fn curves_pile_up_and_go_on_where_they_were() {
        let mut curves = Curves::default();
        let (path, mut other) = (Settings::new(&REGISTRY[0]), Settings::new(&REGISTRY[0]));
        other.seed = 3;
        (1..=20).for_each(|n| curves.add(&path, sample(n)));
        (1..=5).for_each(|n| curves.add(&other, sample(n)));
        // Back to the first: it starts over and adds nothing until it goes beyond.
        (1..=21).for_each(|n| curves.add(&path, sample(n)));
        let passes = |t: &Track| t.samples.iter().map(|s| s.passes).collect::<Vec<_>>();
        assert_eq!(passes(&curves.tracks[0]), (1..=21).collect::<Vec<_>>());
        assert_eq!(curves.tracks[1].label, "path seed=3");
        let rate = curves.rate(&curves.tracks[0], false).expect("a slope");
        assert!((rate.slope + 0.5).abs() < 1e-9);
        let p = curves.prediction(&path, false, 0.1).expect("a prediction");
        assert!((p.passes - 100.0).abs() < 1e-6 && (p.seconds - 10.0).abs() < 1e-6);
        assert_eq!(curves.rate(&curves.tracks[0], true), None);
    }

    #[test]
    fn long_curves_are_thinned_out() {
        let mut curves = Curves::default();
        let path = Settings::new(&REGISTRY[0]);
        (1..=10_000).for_each(|n| curves.add(&path, sample(n)));
        let samples = &curves.tracks[0].samples;
        assert!(samples.len() < 400, "{}", samples.len());
        assert_eq!(samples.last().map(|s| s.passes), Some(10_000));
    }
}
