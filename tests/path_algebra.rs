//! The path algebra against a matcher that knows nothing of automata.

use lightscope::engine::event::Letter;
use lightscope::engine::path::{COMPONENTS, ClassId, Expression, PathClasses};
use proptest::prelude::*;

/// All words over the four letters up to length 7.
fn words(longest: usize) -> Vec<Vec<Letter>> {
    let mut all = vec![Vec::new()];
    let mut last = all.clone();
    for _ in 0..longest {
        let longer =
            |w: &Vec<Letter>| Letter::ALL.map(|l| w.iter().copied().chain([l]).collect::<Vec<_>>());
        last = last.iter().flat_map(longer).collect();
        all.extend(last.iter().cloned());
    }
    all
}

/// What the naive matcher understands: written out by hand, apart from the parser under test.
#[derive(Debug)]
enum Naive {
    Any,
    One(&'static [Letter]),
    Seq(Vec<Naive>),
    Or(Vec<Naive>),
    Many(Box<Naive>, usize, usize),
}

use Letter::{D, G, S, V};
use Naive::{Any, Many, One, Or, Seq};

/// Lengths of the prefixes of `w` that match.
fn prefixes(n: &Naive, w: &[Letter]) -> Vec<usize> {
    let mut found = match n {
        Any => (!w.is_empty()).then_some(1).into_iter().collect(),
        One(letters) => w
            .first()
            .filter(|l| letters.contains(l))
            .map(|_| 1)
            .into_iter()
            .collect(),
        Seq(parts) => parts.iter().fold(vec![0], |ends, part| {
            let more = |e: &usize| {
                prefixes(part, &w[*e..])
                    .into_iter()
                    .map(|m| e + m)
                    .collect::<Vec<_>>()
            };
            ends.iter().flat_map(more).collect()
        }),
        Or(branches) => branches.iter().flat_map(|b| prefixes(b, w)).collect(),
        Many(inner, min, max) => {
            let (mut all, mut ends) = (Vec::new(), vec![0usize]);
            for count in 0..=*max.min(&(w.len() + min)) {
                if count >= *min {
                    all.extend(&ends);
                }
                let more = |e: &usize| {
                    prefixes(inner, &w[*e..])
                        .into_iter()
                        .map(|m| e + m)
                        .collect::<Vec<_>>()
                };
                ends = ends.iter().flat_map(more).collect();
                ends.sort_unstable();
                ends.dedup();
            }
            all
        }
    };
    found.sort_unstable();
    found.dedup();
    found
}

fn matches(n: &Naive, w: &[Letter]) -> bool {
    prefixes(n, w).contains(&w.len())
}

/// Whether `w` is the beginning of a word that matches. No expression is without words, so what
/// still has to come can always be completed.
fn begins(n: &Naive, w: &[Letter]) -> bool {
    w.is_empty()
        || match n {
            Any | One(_) => matches(n, w),
            Or(branches) => branches.iter().any(|b| begins(b, w)),
            Seq(parts) => {
                let mut ends = vec![0];
                parts.iter().any(|part| {
                    let begun = ends.iter().any(|&e| begins(part, &w[e..]));
                    ends = further(part, w, &ends);
                    begun
                })
            }
            Many(inner, _, max) => {
                let mut ends = vec![0];
                (0..*max.min(&w.len())).any(|_| {
                    let begun = ends.iter().any(|&e| begins(inner, &w[e..]));
                    ends = further(inner, w, &ends);
                    begun
                })
            }
        }
}

/// Where matches of `n` end that start at one of `starts`.
fn further(n: &Naive, w: &[Letter], starts: &[usize]) -> Vec<usize> {
    let from = |&s: &usize| prefixes(n, &w[s..]).into_iter().map(move |m| s + m);
    starts.iter().flat_map(from).collect()
}

/// The matcher of the words read from the eye to the light.
fn mirrored(n: &Naive) -> Naive {
    match n {
        Any => Any,
        One(letters) => One(letters),
        Seq(parts) => Seq(parts.iter().rev().map(mirrored).collect()),
        Or(branches) => Or(branches.iter().map(mirrored).collect()),
        Many(inner, min, max) => many(mirrored(inner), *min, *max),
    }
}

fn many(n: Naive, min: usize, max: usize) -> Naive {
    Many(Box::new(n), min, max)
}

const INF: usize = usize::MAX;
const SG: &[Letter] = &[S, G];
const DV: &[Letter] = &[D, V];

/// Expressions and what they mean.
fn cases() -> Vec<(&'static str, Naive)> {
    let star = |n| many(n, 0, INF);
    vec![
        ("LE", Seq(vec![])),
        ("L.*E", star(Any)),
        ("LD?E", many(One(&[D]), 0, 1)),
        (
            "LDS*E|LS*E",
            Or(vec![Seq(vec![One(&[D]), star(One(&[S]))]), star(One(&[S]))]),
        ),
        (
            "LDS*E|LGS*E|LS*E",
            Seq(vec![many(One(&[D, G]), 0, 1), star(One(&[S]))]),
        ),
        ("LS+DE", Seq(vec![many(One(&[S]), 1, INF), One(&[D])])),
        ("L(D|S)*E", star(One(&[D, S]))),
        (
            "LDDDE|LSDSDE",
            Or(vec![
                many(One(&[D]), 3, 3),
                many(Seq(vec![One(&[S]), One(&[D])]), 2, 2),
            ]),
        ),
        (
            "L.*D.{3}E",
            Seq(vec![star(Any), One(&[D]), many(Any, 3, 3)]),
        ),
        (
            "L(DS|G)+V?E",
            Seq(vec![
                many(Or(vec![Seq(vec![One(&[D]), One(&[S])]), One(&[G])]), 1, INF),
                many(One(&[V]), 0, 1),
            ]),
        ),
        (
            "L((D|G){2,4}S)*E",
            star(Seq(vec![many(One(&[D, G]), 2, 4), One(&[S])])),
        ),
        (
            "LD{2,}(|S)E",
            Seq(vec![many(One(&[D]), 2, INF), many(One(&[S]), 0, 1)]),
        ),
        (
            "L ( V | S V ) * E",
            star(Or(vec![One(&[V]), Seq(vec![One(&[S]), One(&[V])])])),
        ),
        ("L(D?S?)*E", star(One(&[D, S]))),
    ]
}

fn components() -> [Naive; 4] {
    let star = |n| many(n, 0, INF);
    [
        many(One(DV), 0, 1),
        Seq(vec![star(Any), One(SG)]),
        Seq(vec![many(One(SG), 1, INF), One(DV)]),
        Seq(vec![star(Any), One(DV), star(Any), One(DV)]),
    ]
}

fn expression(text: &str) -> Expression {
    text.parse().unwrap_or_else(|e| panic!("{e}"))
}

/// Classes of the expressions alone, without the components.
fn alone(texts: &[&str]) -> PathClasses {
    let labels = texts.iter().map(|t| (*t).to_owned()).collect();
    PathClasses::new(labels, texts.iter().map(|t| expression(t)).collect()).expect("few classes")
}

fn class_of(classes: &PathClasses, word: &[Letter]) -> ClassId {
    word.iter()
        .fold(ClassId::EMPTY, |c, l| classes.append(c, *l))
}

#[test]
fn every_word_up_to_length_seven_falls_into_the_right_layers() {
    let words = words(7);
    for (text, naive) in cases() {
        let classes = PathClasses::with_components(&[expression(text)]).expect(text);
        let mut oracles: Vec<Naive> = components().into_iter().collect();
        oracles.push(naive);
        for word in &words {
            let expected = (0..5)
                .filter(|i| matches(&oracles[*i], word))
                .fold(0, |m, i| m | 1 << i);
            let found = classes.layers(class_of(&classes, word));
            assert_eq!(found, expected, "{text} on {word:?}");
        }
    }
}

#[test]
fn components_are_a_partition() {
    let classes = PathClasses::components();
    for word in words(7) {
        assert_eq!(
            classes.layers(class_of(&classes, &word)).count_ones(),
            1,
            "{word:?}"
        );
    }
}

#[test]
fn join_is_associative_and_agrees_with_walking_either_way() {
    for (text, _) in cases() {
        let classes = PathClasses::with_components(&[expression(text)]).expect(text);
        let mut all = vec![ClassId::EMPTY];
        for done in 0.. {
            let Some(&class) = all.get(done) else { break };
            for longer in Letter::ALL.map(|letter| classes.append(class, letter)) {
                if !all.contains(&longer) {
                    all.push(longer);
                }
            }
        }
        assert_eq!(all.len(), classes.len(), "{text}: every class has a word");
        for &a in &all {
            for &b in &all {
                for &c in &all {
                    let left = classes.join(classes.join(a, b), c);
                    assert_eq!(left, classes.join(a, classes.join(b, c)));
                }
            }
        }
        for word in words(5) {
            let from_eye = word
                .iter()
                .rev()
                .fold(ClassId::EMPTY, |c, l| classes.prepend(*l, c));
            assert_eq!(from_eye, class_of(&classes, &word));
        }
    }
}

#[test]
fn reachable_layers_are_those_some_longer_word_has() {
    let words = words(7);
    for (text, naive) in cases() {
        let classes = PathClasses::with_components(&[expression(text)]).expect(text);
        let mut forward: Vec<Naive> = components().into_iter().collect();
        forward.push(naive);
        let backward: Vec<Naive> = forward.iter().map(mirrored).collect();
        let mask = |oracles: &[Naive], word: &[Letter]| {
            (0..5)
                .filter(|i| begins(&oracles[*i], word))
                .fold(0, |m, i| m | 1 << i)
        };
        for word in &words {
            let class = class_of(&classes, word);
            let turned: Vec<Letter> = word.iter().rev().copied().collect();
            let from_light = classes.reachable_from_light(class);
            assert_eq!(
                from_light,
                mask(&forward, word),
                "{text}: {word:?} and more events"
            );
            let from_eye = classes.reachable_from_eye(class);
            assert_eq!(
                from_eye,
                mask(&backward, &turned),
                "{text}: more events and {word:?}"
            );
        }
    }
}

#[test]
fn only_the_empty_word_has_the_empty_class_beside_the_components() {
    for (text, _) in cases() {
        let classes = PathClasses::with_components(&[expression(text)]).expect(text);
        for word in words(7) {
            assert_eq!(
                class_of(&classes, &word) == ClassId::EMPTY,
                word.is_empty(),
                "{text} {word:?}"
            );
        }
    }
}

#[test]
fn possible_layers_follow_letters_and_depth() {
    let classes = PathClasses::components();
    let bits = |names: &[&str]| {
        names.iter().fold(0, |m, n| {
            m | 1 << COMPONENTS.iter().position(|c| c.0 == *n).unwrap()
        })
    };
    assert_eq!(classes.possible(&[D], None), bits(&["direct", "indirect"]));
    assert_eq!(classes.possible(&[S], None), bits(&["direct", "specular"]));
    assert_eq!(classes.possible(&[D, G], None), 0b1111);
    assert_eq!(
        classes.possible(&[D, S], Some(1)),
        bits(&["direct", "specular"])
    );
    assert_eq!(classes.possible(&[D, S], Some(0)), bits(&["direct"]));
    assert_eq!(classes.possible(&[], None), bits(&["direct"]));
}

#[test]
fn class_counts() {
    assert_eq!(PathClasses::components().len(), 6);
    let counts = [
        ("LDS*E|LS*E", 9),
        ("LS+DE", 9),
        ("L(S|D)*E", 11),
        ("LDDDE|LSDSDE", 14),
        ("L.*D.{3}E", 55),
    ];
    for (text, expected) in counts {
        let classes = PathClasses::with_components(&[expression(text)]).expect(text);
        assert_eq!(classes.len(), expected, "{text} with the components");
    }
}

#[test]
fn too_large_expressions_are_refused() {
    for text in ["L.*D.{200}E", "LD{255}E", "L(.{255}){2}SE", "L.*D.{7}E"] {
        let error = PathClasses::with_components(&[expression(text)]).expect_err(text);
        assert!(error.to_string().contains("path classes"), "{error}");
    }
    // The one that makes them too many is named, not the last one.
    let together = ["LD{100}E", "LS{100}E", "LG{100}E", "LE"].map(expression);
    let error = PathClasses::with_components(&together).expect_err("too many together");
    assert_eq!(error.text, "LG{100}E", "{error}");
    assert!(error.to_string().contains("together"), "{error}");
    let many: Vec<Expression> = (0..29).map(|_| expression("LDE")).collect();
    assert!(PathClasses::with_components(&many).is_err());
}

#[test]
fn the_largest_that_is_read_is_done_with_quickly() {
    let nothing = "L((((D{0}){255}){255}){255}){255}E";
    assert!(nothing.parse::<Expression>().is_err());
    for text in [
        "L((.?){255}){2}E",
        "LD{250}(.|D?){100}E",
        "L(.{0,2}S){120}E",
        "L(D?){255}S*E",
    ] {
        let start = std::time::Instant::now();
        assert!(
            PathClasses::with_components(&[expression(text)]).is_err(),
            "{text}"
        );
        // A generous bound on tens of milliseconds; without one on the size these take minutes.
        assert!(start.elapsed().as_secs() < 10, "{text}");
    }
    let stacked = format!("L{}D{}E", "(".repeat(60), "*)".repeat(60));
    assert_eq!(alone(&[&stacked]).len(), alone(&["LD*E"]).len());
}

/// Expressions made at random, with what they mean.
fn any_expression() -> impl Strategy<Value = (String, Naive)> {
    const LETTERS: [(&str, &[Letter]); 4] = [("D", &[D]), ("G", &[G]), ("S", &[S]), ("V", &[V])];
    let leaf = prop_oneof![
        (0..4usize).prop_map(|i| (LETTERS[i].0.to_owned(), One(LETTERS[i].1))),
        Just(()).prop_map(|()| (".".to_owned(), Any)),
    ];
    leaf.prop_recursive(4, 12, 3, |inner| {
        let two = (inner.clone(), inner.clone());
        prop_oneof![
            two.clone()
                .prop_map(|((a, x), (b, y))| (format!("{a}{b}"), Seq(vec![x, y]))),
            two.prop_map(|((a, x), (b, y))| (format!("({a}|{b})"), Or(vec![x, y]))),
            (inner, 0..6usize).prop_map(|((a, x), kind)| {
                let kinds = [
                    ("*", 0, INF),
                    ("+", 1, INF),
                    ("?", 0, 1),
                    ("{2}", 2, 2),
                    ("{1,3}", 1, 3),
                    ("{2,}", 2, INF),
                ];
                let (sign, min, max) = kinds[kind];
                (format!("({a}){sign}"), many(x, min, max))
            }),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn random_expressions_agree_with_the_naive_matcher((body, naive) in any_expression()) {
        // Some are refused, as they need too many classes; the fixed cases are not.
        let text = format!("L{body}E");
        let Ok(classes) = PathClasses::new(vec![text.clone()], vec![expression(&text)]) else {
            return Ok(());
        };
        let turned = mirrored(&naive);
        for word in words(4) {
            let class = class_of(&classes, &word);
            let back: Vec<Letter> = word.iter().rev().copied().collect();
            prop_assert_eq!(classes.layers(class) == 1, matches(&naive, &word), "{} {:?}", text, word);
            prop_assert_eq!(classes.reachable_from_light(class) == 1, begins(&naive, &word), "{} {:?}", text, word);
            prop_assert_eq!(classes.reachable_from_eye(class) == 1, begins(&turned, &back), "{} {:?}", text, word);
        }
    }
}
