//! From a syntax tree to its minimal deterministic automaton: the positions that may follow each
//! other (Glushkov 1961, *The Abstract Theory of Automata*), the subset construction over them
//! (Rabin and Scott 1959, *Finite Automata and Their Decision Problems*), and the partition
//! refinement of Moore 1956, *Gedanken-experiments on Sequential Machines*.

use std::collections::HashMap;

use super::class::MAX_CLASSES;
use super::expression::{MAX_EVENTS, Node};
use crate::engine::event::Letter;

/// Most states before the automaton is minimised.
const MAX_SUBSETS: usize = 4096;

/// Letters of the alphabet.
pub(super) const LETTERS: usize = Letter::ALL.len();
/// Something for each letter.
pub(super) type Row<T> = [T; LETTERS];

/// A minimal and complete automaton; it starts in state 0.
#[derive(Debug)]
pub(super) struct Automaton {
    pub(super) next: Vec<Row<u8>>,
    pub(super) accepting: Vec<bool>,
}

/// The automaton has more states than there may be classes.
#[derive(Debug)]
pub(super) struct TooManyStates;

impl Automaton {
    pub(super) fn new(node: &Node) -> Result<Self, TooManyStates> {
        let (next, accepting) = Positions::new(node).determinise()?;
        minimise(&next, &accepting)
    }
}

/// A set of positions, that is, of places where an event is named in the written-out expression.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
struct Set([u64; MAX_EVENTS / 64]);

impl Set {
    fn insert(&mut self, position: usize) {
        self.0[position / 64] |= 1 << (position % 64);
    }

    fn unite(&mut self, other: &Self) {
        for (a, b) in self.0.iter_mut().zip(other.0) {
            *a |= b;
        }
    }

    fn meet(&self, other: &Self) -> Self {
        let mut both = *self;
        for (a, b) in both.0.iter_mut().zip(other.0) {
            *a &= b;
        }
        both
    }

    fn is_empty(&self) -> bool {
        self.0.iter().all(|&word| word == 0)
    }

    fn iter(&self) -> impl Iterator<Item = usize> + '_ {
        (0..MAX_EVENTS / 64).flat_map(|index| {
            let mut word = self.0[index];
            std::iter::from_fn(move || {
                let bit = (word != 0).then(|| word.trailing_zeros() as usize)?;
                word &= word - 1;
                Some(64 * index + bit)
            })
        })
    }
}

/// What a part of the tree shows to its neighbours.
#[derive(Clone, Copy, Default)]
struct Fragment {
    /// Whether the empty word matches.
    nullable: bool,
    /// Positions that a match may start with.
    first: Set,
    /// Positions that a match may end with.
    last: Set,
}

/// Glushkov's automaton.
#[derive(Default)]
struct Positions {
    /// Which positions match each letter.
    of_letter: Row<Set>,
    /// Which positions may come after each.
    follow: Vec<Set>,
    root: Fragment,
}

impl Positions {
    fn new(root: &Node) -> Self {
        let mut positions = Self::default();
        positions.root = positions.add(root);
        positions
    }

    fn add(&mut self, node: &Node) -> Fragment {
        let empty = Fragment {
            nullable: true,
            ..Fragment::default()
        };
        match node {
            Node::Empty => empty,
            Node::Letters(mask) => self.position(*mask),
            Node::Sequence(nodes) => nodes.iter().fold(empty, |before, node| {
                let after = self.add(node);
                self.chain(&before, &after)
            }),
            Node::Union(nodes) => nodes.iter().fold(Fragment::default(), |mut union, node| {
                let part = self.add(node);
                union.nullable |= part.nullable;
                union.first.unite(&part.first);
                union.last.unite(&part.last);
                union
            }),
            Node::Repeat { node, min, max } => {
                // `a{2,}` is `a a+`, `a*` is `(a+)?`, `a{2,4}` is `a a a? a?`.
                let copies = max.unwrap_or((*min).max(1));
                (0..copies).fold(empty, |before, copy| {
                    let mut part = self.add(node);
                    part.nullable |= copy >= *min;
                    if max.is_none() && copy + 1 == copies {
                        self.link(&part.last, &part.first);
                    }
                    self.chain(&before, &part)
                })
            }
        }
    }

    fn position(&mut self, letters: u8) -> Fragment {
        let mut place = Set::default();
        // The parser lets no expression through that names more than MAX_EVENTS events.
        place.insert(self.follow.len());
        self.follow.push(Set::default());
        for (letter, positions) in self.of_letter.iter_mut().enumerate() {
            if letters & (1 << letter) != 0 {
                positions.unite(&place);
            }
        }
        Fragment {
            nullable: false,
            first: place,
            last: place,
        }
    }

    fn link(&mut self, from: &Set, to: &Set) {
        for position in from.iter() {
            self.follow[position].unite(to);
        }
    }

    fn chain(&mut self, before: &Fragment, after: &Fragment) -> Fragment {
        self.link(&before.last, &after.first);
        let mut chain = Fragment {
            nullable: before.nullable && after.nullable,
            first: before.first,
            last: after.last,
        };
        if before.nullable {
            chain.first.unite(&after.first);
        }
        if after.nullable {
            chain.last.unite(&before.last);
        }
        chain
    }

    /// The subset construction. A state is the set of positions that may come next, and whether
    /// the word so far matches.
    fn determinise(&self) -> Result<(Vec<Row<usize>>, Vec<bool>), TooManyStates> {
        let start = (self.root.first, self.root.nullable);
        let mut ids = HashMap::from([(start, 0)]);
        let mut states = vec![start];
        let mut next = Vec::new();
        while let Some(&(expected, _)) = states.get(next.len()) {
            let mut row = [0; LETTERS];
            for (target, of_letter) in row.iter_mut().zip(&self.of_letter) {
                let read = expected.meet(of_letter);
                let mut after = Set::default();
                read.iter()
                    .for_each(|position| after.unite(&self.follow[position]));
                let state = (after, !read.meet(&self.root.last).is_empty());
                *target = *ids.entry(state).or_insert(states.len());
                if *target == states.len() {
                    states.push(state);
                }
            }
            if states.len() > MAX_SUBSETS {
                return Err(TooManyStates);
            }
            next.push(row);
        }
        Ok((
            next,
            states.iter().map(|&(_, accepting)| accepting).collect(),
        ))
    }
}

/// Moore's algorithm: split the states by what they accept now, after one letter, after two, …
fn minimise(next: &[Row<usize>], accepting: &[bool]) -> Result<Automaton, TooManyStates> {
    let mut block: Vec<usize> = accepting
        .iter()
        .map(|&accepts| usize::from(accepts))
        .collect();
    let mut count = 0;
    loop {
        let mut ids = HashMap::new();
        let refined: Vec<usize> = (0..next.len())
            .map(|state| {
                let fresh = ids.len();
                *ids.entry((block[state], next[state].map(|to| block[to])))
                    .or_insert(fresh)
            })
            .collect();
        // State 0 is seen first, so its block is block 0: the start stays at 0.
        block = refined;
        if ids.len() > MAX_CLASSES {
            return Err(TooManyStates);
        }
        if ids.len() == count {
            break;
        }
        count = ids.len();
    }
    let mut minimal = Automaton {
        next: vec![[0; LETTERS]; count],
        accepting: vec![false; count],
    };
    for (state, &id) in block.iter().enumerate() {
        // At most MAX_CLASSES = 255 blocks.
        minimal.next[id] = next[state].map(|to| block[to] as u8);
        minimal.accepting[id] = accepting[state];
    }
    Ok(minimal)
}
