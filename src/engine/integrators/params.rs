//! Parameters of integrators: one description feeds `--set`, its help, the sliders and the tests.

use std::collections::BTreeMap;
use std::fmt;

use crate::engine::scene::features::SceneFeatures;

use super::bidirectional::{Heuristic, Strategies};

/// What a parameter may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParamKind {
    /// One of these words.
    Choice(&'static [&'static str]),
    /// `on` or `off`.
    Switch,
    /// An integer in this range, ends included.
    Integer(i64, i64),
    /// A number in this range, ends included.
    Number(f64, f64),
    /// Strategies of bidirectional path tracing, in the words of [`Strategies`].
    Strategies,
}

/// Description of a parameter.
#[derive(Clone, Copy, Debug)]
pub struct ParamSpec {
    /// Name, kebab-case.
    pub name: &'static str,
    /// Range.
    pub kind: ParamKind,
    /// Default, as it would be typed.
    pub default: &'static str,
    /// Unit, empty for pure numbers.
    pub unit: &'static str,
    /// Whether it makes a difference in a scene of these features: elsewhere the window hides it.
    pub matters: fn(&SceneFeatures) -> bool,
    /// One sentence.
    pub doc: &'static str,
}

/// A value that was checked against its [`ParamSpec`].
#[derive(Clone, Debug, PartialEq)]
pub enum ParamValue {
    /// A word of the choice.
    Choice(&'static str),
    /// A switch.
    Switch(bool),
    /// An integer.
    Integer(i64),
    /// A number.
    Number(f64),
    /// Strategies, as they were typed.
    Strategies(String),
}

impl fmt::Display for ParamValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Choice(word) => f.write_str(word),
            Self::Switch(on) => f.write_str(if *on { "on" } else { "off" }),
            Self::Integer(i) => write!(f, "{i}"),
            Self::Number(x) => write!(f, "{x}"),
            Self::Strategies(text) => f.write_str(text),
        }
    }
}

impl ParamSpec {
    /// Reads a value.
    ///
    /// # Errors
    /// A sentence with the values that would be right.
    pub fn parse(&self, text: &str) -> Result<ParamValue, String> {
        let value = match self.kind {
            ParamKind::Choice(words) => words
                .iter()
                .find(|w| **w == text)
                .map(|w| ParamValue::Choice(w)),
            ParamKind::Switch => match text {
                "on" => Some(ParamValue::Switch(true)),
                "off" => Some(ParamValue::Switch(false)),
                _ => None,
            },
            ParamKind::Integer(lo, hi) => {
                let in_range = |v: &i64| (lo..=hi).contains(v);
                text.parse().ok().filter(in_range).map(ParamValue::Integer)
            }
            ParamKind::Strategies => text
                .parse::<Strategies>()
                .is_ok()
                .then(|| ParamValue::Strategies(text.to_owned())),
            ParamKind::Number(lo, hi) => {
                let in_range = |v: &f64| (lo..=hi).contains(v);
                text.parse().ok().filter(in_range).map(ParamValue::Number)
            }
        };
        value.ok_or_else(|| {
            format!(
                "parameter {} cannot be \"{text}\"; it is {}",
                self.name,
                self.range()
            )
        })
    }

    /// The values allowed, in words.
    pub fn range(&self) -> String {
        let unit = if self.unit.is_empty() {
            String::new()
        } else {
            format!(" {}", self.unit)
        };
        match self.kind {
            ParamKind::Choice(words) => format!("one of {}", words.join(", ")),
            ParamKind::Switch => "on or off".to_owned(),
            ParamKind::Integer(lo, hi) => format!("an integer from {lo} to {hi}{unit}"),
            ParamKind::Strategies => {
                "all, all but some (all-0,2-*,1) or some (1,2+0,2), where s,t \
                 are numbers of vertices from the light (0 to 30) and from the lens (1 to 30), * \
                 any number"
                    .to_owned()
            }
            ParamKind::Number(lo, hi) => format!("a number from {lo} to {hi}{unit}"),
        }
    }
}

/// The values of all parameters of one integrator.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Params(BTreeMap<&'static str, ParamValue>);

impl Params {
    /// The defaults of `specs`.
    pub fn defaults(specs: &[ParamSpec]) -> Self {
        let value = |s: &ParamSpec| s.parse(s.default).unwrap_or(ParamValue::Switch(false));
        Self(specs.iter().map(|s| (s.name, value(s))).collect())
    }

    /// Sets `name` to what `text` says.
    ///
    /// # Errors
    /// A sentence that names the parameters or values there are.
    pub fn set(&mut self, specs: &[ParamSpec], name: &str, text: &str) -> Result<(), String> {
        let Some(spec) = specs.iter().find(|s| s.name == name) else {
            let names: Vec<&str> = specs.iter().map(|s| s.name).collect();
            return Err(format!(
                "there is no parameter \"{name}\"; there are {}",
                names.join(", ")
            ));
        };
        self.0.insert(spec.name, spec.parse(text)?);
        Ok(())
    }

    /// Value of the choice `name`; the empty word if there is none.
    pub fn choice(&self, name: &str) -> &'static str {
        match self.0.get(name) {
            Some(ParamValue::Choice(word)) => word,
            _ => "",
        }
    }

    /// Value of the switch `name`; off if there is none.
    pub fn switch(&self, name: &str) -> bool {
        matches!(self.0.get(name), Some(ParamValue::Switch(true)))
    }

    /// Value of the integer `name`; 0 if there is none.
    pub fn integer(&self, name: &str) -> i64 {
        match self.0.get(name) {
            Some(ParamValue::Integer(i)) => *i,
            _ => 0,
        }
    }

    /// Value of the number `name`; 0 if there is none.
    pub fn number(&self, name: &str) -> f64 {
        match self.0.get(name) {
            Some(ParamValue::Number(x)) => *x,
            _ => 0.0,
        }
    }

    /// Value of `name` as it would be typed; empty if there is none.
    pub fn text(&self, name: &str) -> String {
        self.0
            .get(name)
            .map(ToString::to_string)
            .unwrap_or_default()
    }

    /// Strategies `name`; all of them if there is no such parameter.
    pub fn strategies(&self, name: &str) -> Strategies {
        match self.0.get(name) {
            Some(ParamValue::Strategies(text)) => text.parse().ok(),
            _ => None,
        }
        .unwrap_or(Strategies::all(Heuristic::Power))
    }

    /// Names and values, sorted by name.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &ParamValue)> {
        self.0.iter().map(|(n, v)| (*n, v))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::integrators::REGISTRY;

    #[test]
    fn every_default_of_the_registry_is_in_its_range() {
        for entry in REGISTRY {
            for spec in entry.params {
                assert!(
                    spec.parse(spec.default).is_ok(),
                    "{} {}",
                    entry.id,
                    spec.name
                );
            }
        }
    }

    #[test]
    fn wrong_values_are_refused_with_the_range() {
        let spec = ParamSpec {
            name: "n",
            kind: ParamKind::Integer(1, 9),
            default: "3",
            unit: "",
            matters: |_| true,
            doc: "",
        };
        let mut p = Params::defaults(&[spec]);
        assert_eq!(p.integer("n"), 3);
        let error = p.set(&[spec], "n", "10").unwrap_err();
        assert_eq!(
            error,
            "parameter n cannot be \"10\"; it is an integer from 1 to 9"
        );
        assert!(
            p.set(&[spec], "m", "1")
                .unwrap_err()
                .contains("there are n")
        );
        assert_eq!(p.integer("n"), 3);
    }
}
