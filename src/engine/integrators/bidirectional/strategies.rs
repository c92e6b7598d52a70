//! Which strategies are on, and how they share a path.

use std::str::FromStr;

/// How the weights of strategies depend on their densities (Veach 1997, section 9.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heuristic {
    /// In proportion to them.
    Balance,
    /// In proportion to their squares.
    Power,
}

impl Heuristic {
    #[inline]
    pub(super) fn share(self, density: f64) -> f64 {
        match self {
            Self::Balance => density,
            Self::Power => density * density,
        }
    }
}

/// Strategies (s, t) have bits of their own up to here; longer subpaths share the last.
const ROW: usize = 32;

/// The strategies (s, t) that are on: s vertices from the light, t from the lens.
///
/// In words: `all` or the first ones, then others added and taken away from left to right:
/// `all-0,2-*,1` (all but these; `*` is any number), `1,2+0,2` (these alone), `1,*-1,3`.
#[derive(Clone, Debug, PartialEq)]
pub struct Strategies {
    /// How those that are on share a path.
    pub heuristic: Heuristic,
    /// Number of light paths times the area of merging, m²; 0 if vertices are not merged.
    pub merging: f64,
    /// Bit t of row s.
    on: [u32; ROW],
    all: bool,
}

impl Strategies {
    /// Every strategy.
    pub fn all(heuristic: Heuristic) -> Self {
        Self {
            heuristic,
            merging: 0.0,
            on: [u32::MAX; ROW],
            all: true,
        }
    }

    /// Those that join a light path to the lens, t = 1.
    pub fn lens_alone() -> Self {
        let mut strategies = Self::all(Heuristic::Balance);
        strategies.set((None, None), false);
        strategies.set((None, Some(1)), true);
        strategies
    }

    /// Those of path tracing: hits and shadow rays, s ≤ 1, but for light joined to the lens.
    pub fn eye_alone(heuristic: Heuristic) -> Self {
        let mut strategies = Self::all(heuristic);
        strategies.set((None, None), false);
        strategies.set((Some(0), None), true);
        strategies.set((Some(1), None), true);
        strategies.set((Some(1), Some(1)), false);
        strategies
    }

    /// Whether any of them needs a walk from a light.
    pub fn walk_from_lights(&self) -> bool {
        self.on[1] & (1 << 1) != 0 || self.on[2..].iter().any(|row| *row != 0)
    }

    /// The strategies of the same words with the heuristic `heuristic`.
    #[must_use]
    pub fn with(self, heuristic: Heuristic) -> Self {
        Self { heuristic, ..self }
    }

    /// Whether none is switched off.
    pub fn are_all_on(&self) -> bool {
        self.all
    }

    /// Whether (s, t) is on.
    #[inline]
    pub fn is_on(&self, s: usize, t: usize) -> bool {
        self.all || self.on[s.min(ROW - 1)] & (1 << t.min(ROW - 1)) != 0
    }

    /// `words`, those of these strategies, with (s, t) switched: its own last term is taken out if
    /// that does it, otherwise one is added.
    pub fn toggled_words(&self, words: &str, s: usize, t: usize) -> String {
        let on = !self.is_on(s, t);
        let own = format!("{}{s},{t}", if on { '-' } else { '+' });
        if let Some(shorter) = words.strip_suffix(&own) {
            let undone = shorter.parse::<Self>();
            if undone.is_ok_and(|strategies| strategies.is_on(s, t) == on) {
                return shorter.to_owned();
            }
        }
        format!("{words}{}{s},{t}", if on { '+' } else { '-' })
    }

    fn set(&mut self, (s, t): (Option<usize>, Option<usize>), on: bool) {
        let columns = t.map_or(u32::MAX, |t| 1 << t);
        for row in s.map_or(0..ROW, |s| s..s + 1) {
            if on {
                self.on[row] |= columns;
            } else {
                self.on[row] &= !columns;
            }
        }
        self.all = self.on == [u32::MAX; ROW];
    }
}

impl FromStr for Strategies {
    type Err = ();

    fn from_str(text: &str) -> Result<Self, ()> {
        let mut strategies = Self::all(Heuristic::Power);
        let (mut rest, mut on) = match text.strip_prefix("all") {
            Some("") => return Ok(strategies),
            Some(rest) => {
                let sign = rest.chars().next().ok_or(())?;
                (rest.strip_prefix(['+', '-']).ok_or(())?, sign == '+')
            }
            None => {
                strategies.set((None, None), false);
                (text, true)
            }
        };
        while let Some(at) = rest.find(['+', '-']) {
            strategies.set(parse_pair(&rest[..at])?, on);
            on = rest[at..].starts_with('+');
            rest = &rest[at + 1..];
        }
        strategies.set(parse_pair(rest)?, on);
        Ok(strategies)
    }
}

/// `s,t`, each a number below 31 or `*`.
fn parse_pair(text: &str) -> Result<(Option<usize>, Option<usize>), ()> {
    let (s, t) = text.split_once(',').ok_or(())?;
    let number = |text: &str, least: usize| match text {
        "*" => Ok(None),
        _ => text
            .parse()
            .ok()
            .filter(|n| (least..ROW - 1).contains(n))
            .map(Some)
            .ok_or(()),
    };
    Ok((number(s, 0)?, number(t, 1)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_switch_strategies() {
        let on = |text: &str, s, t| Strategies::from_str(text).unwrap().is_on(s, t);
        assert!(on("all", 0, 2) && on("all", 100, 100));
        assert!(!on("all-0,2-*,1", 0, 2) && !on("all-0,2-*,1", 7, 1) && on("all-0,2-*,1", 0, 3));
        assert!(on("1,2+0,*", 1, 2) && on("1,2+0,*", 0, 60) && !on("1,2+0,*", 1, 3));
        assert!(on("1,*-1,3", 1, 2) && !on("1,*-1,3", 1, 3) && !on("1,*-1,3", 2, 2));
        assert!(on("all-1,*+1,3", 1, 3) && !on("all-1,*+1,3", 1, 2));
        assert_eq!("all".parse(), Ok(Strategies::all(Heuristic::Power)));
        for wrong in [
            "", "al", "all-", "all+", "1", "1,0", "1,2-1", "-1,2", "99,1", "1,2,3", "1,2++1,3",
        ] {
            assert!(Strategies::from_str(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_strategy_switched_twice_is_as_before() {
        for words in ["all", "all-*,1", "1,*", "1,2+0,2", "all-1,2"] {
            for (s, t) in [(0, 2), (1, 2), (1, 1), (3, 4)] {
                let of = |words: &str| Strategies::from_str(words).unwrap();
                let once = of(words).toggled_words(words, s, t);
                for (i, j) in (0..8).flat_map(|i| (1..8).map(move |j| (i, j))) {
                    let switched = (i, j) == (s, t);
                    let same = of(&once).is_on(i, j) == of(words).is_on(i, j);
                    assert_eq!(same, !switched, "{words} {once}");
                }
                let twice = of(&once).toggled_words(&once, s, t);
                assert_eq!(of(&twice), of(words), "{words} {twice}");
                assert!(twice.len() <= words.len(), "{words} {twice}");
            }
        }
    }
}
