//! The path algebra against a matcher that knows nothing of automata.

use lightscope::engine::event::Letter;
use lightscope::engine::path::{COMPONENTS, ClassId, Expression, PathClasses};

/// All words over the four letters up to length 7.
fn words(longest: usize) -> Vec<Vec<Letter>> {
    let mut all = vec![Vec::new()];
    let mut last = all.clone();
    for _ in 0..longest {
        let longer = |w: &Vec<Letter>| {
            Letter::ALL.map(|l| w.iter().copied().chain([l]).collect::<Vec<_>>())
        };
        last = last.iter().flat_map(longer).collect();
        all.extend(last.iter().cloned());
    }
    all
}

/// What the naive matcher understands: written out by hand, apart from the parser under test.
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
        One(letters) => w.first().filter(|l| letters.contains(l)).map(|_| 1).into_iter().collect(),
        Seq(parts) => parts.iter().fold(vec![0], |ends, part| {
            let more = |e: &usize| prefixes(part, &w[*e..]).into_iter().map(|m| e + m).collect::<Vec<_>>();
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
                    prefixes(inner, &w[*e..]).into_iter().map(|m| e + m).collect::<Vec<_>>()
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
        ("LDS*E|LS*E", Or(vec![Seq(vec![One(&[D]), star(One(&[S]))]), star(One(&[S]))])),
        ("LDS*E|LGS*E|LS*E", Seq(vec![many(One(&[D, G]), 0, 1), star(One(&[S]))])),
        ("LS+DE", Seq(vec![many(One(&[S]), 1, INF), One(&[D])])),
        ("L(D|S)*E", star(One(&[D, S]))),
        ("LDDDE|LSDSDE", Or(vec![many(One(&[D]), 3, 3), many(Seq(vec![One(&[S]), One(&[D])]), 2, 2)])),
        ("L.*D.{3}E", Seq(vec![star(Any), One(&[D]), many(Any, 3, 3)])),
        ("L(DS|G)+V?E", Seq(vec![many(Or(vec![Seq(vec![One(&[D]), One(&[S])]), One(&[G])]), 1, INF), many(One(&[V]), 0, 1)])),
        ("L((D|G){2,4}S)*E", star(Seq(vec![many(One(&[D, G]), 2, 4), One(&[S])]))),
        ("LD{2,}(|S)E", Seq(vec![many(One(&[D]), 2, INF), many(One(&[S]), 0, 1)])),
        ("L ( V | S V ) * E", star(Or(vec![One(&[V]), Seq(vec![One(&[S]), One(&[V])])]))),
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
    word.iter().fold(ClassId::EMPTY, |c, l| classes.append(c, *l))
}

#[test]
fn every_word_up_to_length_seven_falls_into_the_right_layers() {
    let words = words(7);
    for (text, naive) in cases() {
        let classes = PathClasses::with_components(&[expression(text)]).expect(text);
        let mut oracles: Vec<Naive> = components().into_iter().collect();
        oracles.push(naive);
        for word in &words {
            let expected = (0..5).filter(|i| matches(&oracles[*i], word)).fold(0, |m, i| m | 1 << i);
            let found = classes.layers(class_of(&classes, word));
            assert_eq!(found, expected, "{text} on {word:?}");
        }
    }
}

#[test]
fn components_are_a_partition() {
    let classes = PathClasses::components();
    for word in words(7) {
        assert_eq!(classes.layers(class_of(&classes, &word)).count_ones(), 1, "{word:?}");
    }
}

#[test]
fn join_is_associative_and_agrees_with_walking_either_way() {
    for (text, _) in cases() {
        let classes = alone(&[text]);
        let mut all: Vec<ClassId> = words(6).iter().map(|w| class_of(&classes, w)).collect();
        all.sort();
        all.dedup();
        for &a in &all {
            for &b in &all {
                for &c in all.iter().take(40) {
                    let left = classes.join(classes.join(a, b), c);
                    assert_eq!(left, classes.join(a, classes.join(b, c)));
                }
            }
        }
        for word in words(5) {
            let from_eye = word.iter().rev().fold(ClassId::EMPTY, |c, l| classes.prepend(*l, c));
            assert_eq!(from_eye, class_of(&classes, &word));
        }
    }
}

#[test]
fn reachable_layers_are_those_some_longer_word_has() {
    for text in ["LDS*E|LS*E", "LS+DE", "L(DS|G)+V?E", "LDDDE|LSDSDE"] {
        let classes = PathClasses::with_components(&[expression(text)]).expect(text);
        let extensions = words(4);
        for part in words(3) {
            let class = class_of(&classes, &part);
            let (mut before, mut after) = (0, 0);
            for more in &extensions {
                let more = class_of(&classes, more);
                before |= classes.layers(classes.join(more, class));
                after |= classes.layers(classes.join(class, more));
            }
            assert_eq!(classes.reachable_from_eye(class), before, "{text} {part:?}");
            assert_eq!(classes.reachable_from_light(class), after, "{text} {part:?}");
        }
    }
}

#[test]
fn possible_layers_follow_letters_and_depth() {
    let classes = PathClasses::components();
    let bits = |names: &[&str]| {
        names.iter().fold(0, |m, n| m | 1 << COMPONENTS.iter().position(|c| c.0 == *n).unwrap())
    };
    assert_eq!(classes.possible(&[D], None), bits(&["direct", "indirect"]));
    assert_eq!(classes.possible(&[S], None), bits(&["direct", "specular"]));
    assert_eq!(classes.possible(&[D, G], None), 0b1111);
    assert_eq!(classes.possible(&[D, S], Some(1)), bits(&["direct", "specular"]));
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
    for text in ["L.*D.{200}E", "L(.{255}){255}E", "L.*D.{7}E"] {
        let error = PathClasses::with_components(&[expression(text)]).expect_err(text);
        assert!(error.to_string().contains("path classes"), "{error}");
    }
    let many: Vec<Expression> = (0..29).map(|_| expression("LDE")).collect();
    assert!(PathClasses::with_components(&many).is_err());
}

#[test]
fn nested_repetitions_of_nothing_end() {
    let text = format!("L{}{}E", "(".repeat(60), "){255}".repeat(60));
    assert_eq!(alone(&[&text]).len(), 2);
}
