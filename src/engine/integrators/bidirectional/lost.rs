//! Which words no strategy finds while some are switched off.

use super::strategies::Strategies;
use crate::engine::scene::features::SceneFeatures;

/// Most events of words that are looked at one by one.
const EVENTS: usize = 4;
/// Strategies of longer paths have no switches of their own.
const VERTICES: usize = 60;

/// An expression for the words of up to four events, and of all lengths from one on that are off as a
/// whole, that none of `strategies` finds; `None` if they find all of them.
pub fn lost_words(strategies: &Strategies, features: &SceneFeatures) -> Option<String> {
    let ends = |events: usize| connected_ends(strategies, features, events);
    let kept = (0..VERTICES).rposition(|events| !ends(events).is_empty());
    let all_from = kept.map_or(0, |events| events + 1);
    let mut words: Vec<String> = (0..all_from.min(EVENTS + 1))
        .flat_map(|events| coverings(&ends(events), features.specular, events))
        .collect();
    match all_from {
        0 => words.push("L.*E".to_owned()),
        VERTICES => {}
        from => words.push(format!("L.{{{from},}}E")),
    }
    (!words.is_empty()).then(|| words.join("|"))
}

/// The events at the ends that each strategy connects that can find words of `events` events: bit i
/// is the i-th event from the light.
fn connected_ends(strategies: &Strategies, features: &SceneFeatures, events: usize) -> Vec<u64> {
    let can_find = |s: usize| match s {
        0 => !features.zero_size_lights,
        1 => events > 0 || !features.environment,
        _ => !features.shining_media,
    };
    let ends = |s: usize| match s {
        0 => 0,
        _ => (1 << s >> 2) | if s <= events { 1 << (s - 1) } else { 0 },
    };
    (0..=events + 1)
        .filter(|s| strategies.is_on(*s, events + 2 - s) && can_find(*s))
        .map(ends)
        .collect()
}

/// Words in which an S stops every strategy at an end: the least sets of events that cover `ends`.
fn coverings(ends: &[u64], specular: bool, events: usize) -> Vec<String> {
    let stops = |mirrors: u64| ends.iter().all(|ends| ends & mirrors != 0);
    let is_least = |mirrors: u64| {
        let mut each = (0..events)
            .map(|i| 1_u64 << i)
            .filter(|bit| mirrors & bit != 0);
        stops(mirrors) && each.all(|bit| !stops(mirrors & !bit))
    };
    let word = |mirrors: u64| {
        let letter = |i| {
            if mirrors & (1_u64 << i) != 0 {
                'S'
            } else {
                '.'
            }
        };
        format!("L{}E", (0..events).map(letter).collect::<String>())
    };
    (0..1_u64 << events)
        .filter(|mirrors| (*mirrors == 0 || specular) && is_least(*mirrors))
        .map(word)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lost(words: &str, features: SceneFeatures) -> Option<String> {
        lost_words(&words.parse().expect("strategies"), &features)
    }

    #[test]
    fn what_the_others_leave() {
        let mirrors = SceneFeatures {
            specular: true,
            hittable_lights: true,
            ..SceneFeatures::default()
        };
        let zero = SceneFeatures {
            specular: true,
            zero_size_lights: true,
            ..SceneFeatures::default()
        };
        let is = |words, features, expected: &str| {
            assert_eq!(
                lost(words, features).unwrap_or_default(),
                expected,
                "{words}"
            );
        };
        is("all", mirrors, "");
        is("all-1,2", mirrors, "");
        is("all-1,2", SceneFeatures::default(), "");
        // A shadow ray and nothing else: one event, and no mirror there.
        is("1,2", mirrors, "LE|LSE|L.{2,}E");
        // Chance hits find all.
        is("0,*", mirrors, "");
        is("0,*", zero, "L.*E");
        // The lens joined to light paths: the last event is no S.
        is("*,1", mirrors, "LSE|L.SE|L..SE|L...SE");
        is("1,*", mirrors, "LSE|LS.E|LS..E|LS...E");
        // In the middle of two events, nowhere else.
        is("2,2", mirrors, "LE|L.E|LS.E|L.SE|L.{3,}E");
    }
}
