//! Weights of paths that are nothing but densities: connections and mergings together.

use crate::engine::integrators::bidirectional::{
    Density, Heuristic, Join, Meeting, Strategies, weight,
};
use crate::engine::sampling::{IndependentSampler, Sampler, Stream};

/// Random densities of a path, from either end, and what is possible at its vertices.
struct Numbers {
    from_light: Vec<f32>,
    from_eye: Vec<f32>,
    connectible: Vec<bool>,
    mergeable: Vec<bool>,
    shadow_ratio: f32,
    merging: f64,
}

impl Numbers {
    fn new(n: usize, index: u64) -> Self {
        let mut s = IndependentSampler::new(9, Stream::Test, (n as u64, index));
        let mut density = || (8.0 * s.next_1d() - 4.0).exp();
        let from_light = (0..n).map(|_| density()).collect();
        let from_eye = (0..n).map(|_| density()).collect();
        let (shadow_ratio, merging) = (density(), f64::from(density()));
        let connectible: Vec<bool> = (0..n)
            .map(|i| i == 0 || i + 1 == n || s.next_1d() < 0.7)
            .collect();
        let inner = |i: usize| i > 0 && i + 1 < n;
        let mergeable = (0..n)
            .map(|i| inner(i) && connectible[i] && s.next_1d() < 0.6)
            .collect();
        Self {
            from_light,
            from_eye,
            connectible,
            mergeable,
            shadow_ratio,
            merging,
        }
    }

    /// The densities of all strategies: connections by s, then mergings by their vertex.
    fn densities(&self) -> (Vec<f64>, Vec<f64>) {
        let n = self.from_light.len();
        let product = |of: &[f32]| of.iter().map(|p| f64::from(*p)).product::<f64>();
        let connections = (0..n).map(|s| {
            if s > 0 && !(self.connectible[s - 1] && self.connectible[s]) {
                return 0.0;
            }
            let shadow = if s == 1 && n > 2 {
                self.shadow_ratio
            } else {
                1.0
            };
            product(&self.from_light[..s]) * product(&self.from_eye[s..]) * f64::from(shadow)
        });
        let mergings = (0..n).map(|i| {
            let both = product(&self.from_light[..=i]) * product(&self.from_eye[i..]);
            if self.mergeable[i] {
                both * self.merging
            } else {
                0.0
            }
        });
        (connections.collect(), mergings.collect())
    }

    /// The weight of the strategy that meets so after `s` vertices from the light.
    fn weight(&self, s: usize, meeting: Meeting, strategies: &Strategies) -> f32 {
        let n = self.from_light.len();
        let part = |range: std::ops::Range<usize>, own: &[f32], other: &[f32]| -> Vec<Density> {
            range
                .map(|i| Density {
                    own: own[i],
                    other: other[i],
                    connectible: self.connectible[i],
                    mergeable: self.mergeable[i],
                })
                .collect()
        };
        let light = part(0..s, &self.from_light, &self.from_eye);
        let mut eye = part(s..n, &self.from_eye, &self.from_light);
        eye.reverse();
        let last = |path: &[Density]| {
            let at = |k: usize| path.len().checked_sub(k).map_or(0.0, |i| path[i].other);
            [at(1), at(2)]
        };
        let diffuse = |i: Option<usize>| i.is_some_and(|i| i < n && self.mergeable[i]);
        let join = Join {
            light_other: last(&light),
            eye_other: last(&eye),
            light: &light,
            eye: &eye,
            diffuse: [diffuse(s.checked_sub(1)), diffuse(Some(s))],
            meeting,
            shadow_ratio: self.shadow_ratio,
            zero_size: false,
            infinite: false,
        };
        weight(&join, strategies)
    }
}

#[test]
fn weights_of_connections_and_mergings_sum_to_one() {
    let mut merged = 0;
    for heuristic in [Heuristic::Balance, Heuristic::Power] {
        for (n, index) in (2..9).flat_map(|n| (0..500).map(move |i| (n, i))) {
            let numbers = Numbers::new(n, index);
            let mut strategies = Strategies::all(heuristic);
            strategies.merging = numbers.merging;
            let share = |p: f64| match heuristic {
                Heuristic::Balance => p,
                Heuristic::Power => p * p,
            };
            let (connections, mergings) = numbers.densities();
            let all = || connections.iter().chain(&mergings);
            let total: f64 = all().map(|p| share(*p)).sum();
            let mut sum = 0.0;
            for s in (0..n).filter(|s| connections[*s] > 0.0) {
                let w = f64::from(numbers.weight(s, Meeting::Connection, &strategies));
                assert!(
                    (w - share(connections[s]) / total).abs() < 1e-5,
                    "connection {s} of {n}"
                );
                sum += w;
            }
            for i in (0..n).filter(|i| mergings[*i] > 0.0) {
                let w = f64::from(numbers.weight(i + 1, Meeting::Merging, &strategies));
                assert!(
                    (w - share(mergings[i]) / total).abs() < 1e-5,
                    "merging {i} of {n}"
                );
                sum += w;
                merged += 1;
            }
            assert!((sum - 1.0).abs() < 1e-4, "{sum}");
        }
    }
    assert!(merged > 1000);
}

/// Light tracing never asks for the lens density: one strategy needs no weight.
#[test]
fn a_strategy_alone_has_weight_one() {
    let lens = Density {
        own: 1.0,
        other: 0.0,
        connectible: true,
        mergeable: false,
    };
    let light = [lens; 3];
    let join = Join {
        light: &light,
        eye: &[lens],
        light_other: [0.3, 2.0],
        eye_other: [0.0; 2],
        shadow_ratio: 5.0,
        diffuse: [false; 2],
        meeting: Meeting::Connection,
        zero_size: false,
        infinite: false,
    };
    assert_eq!(weight(&join, &Strategies::lens_alone()), 1.0);
    assert!(weight(&join, &Strategies::all(Heuristic::Power)) < 1.0);
}
