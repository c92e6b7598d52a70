//! A minimal deterministic automaton over the four letters for several expressions at once.

use std::collections::HashMap;

use super::expression::Node;

/// Letters of the alphabet.
pub(super) const LETTERS: usize = 4;
/// Most event positions of all expressions together, repetitions unrolled.
const MAX_POSITIONS: usize = 2000;
/// Most states before minimisation.
const MAX_STATES: usize = 4000;

/// State 0 is the start. Every state has a successor for every letter.
#[derive(Clone, Debug)]
pub(super) struct Automaton {
    /// Successors.
    pub next: Vec<[u16; LETTERS]>,
    /// Bit i: the word read so far is in expression i.
    pub accepts: Vec<u32>,
}

/// The expressions are too large to be tabulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TooLarge;

/// Positions of letters that may come first and last, and whether the empty word belongs
/// (Glushkov 1961).
struct Ends {
    empty: bool,
    first: Vec<usize>,
    last: Vec<usize>,
}

#[derive(Default)]
struct Positions {
    /// Letters allowed at each position, as a mask.
    letters: Vec<u8>,
    follow: Vec<Vec<usize>>,
}

impl Positions {
    fn add(&mut self, node: &Node) -> Result<Ends, TooLarge> {
        match node {
            Node::Empty => Ok(Ends { empty: true, first: vec![], last: vec![] }),
            Node::Letters(mask) => {
                if self.letters.len() >= MAX_POSITIONS {
                    return Err(TooLarge);
                }
                let p = self.letters.len();
                self.letters.push(*mask);
                self.follow.push(Vec::new());
                Ok(Ends { empty: false, first: vec![p], last: vec![p] })
            }
            Node::Sequence(parts) => {
                let mut ends = Ends { empty: true, first: vec![], last: vec![] };
                for part in parts {
                    let next = self.add(part)?;
                    ends = self.concatenate(ends, next);
                }
                Ok(ends)
            }
            Node::Union(branches) => {
                let mut ends = Ends { empty: false, first: vec![], last: vec![] };
                for branch in branches {
                    let next = self.add(branch)?;
                    ends.empty |= next.empty;
                    ends.first.extend(next.first);
                    ends.last.extend(next.last);
                }
                Ok(ends)
            }
            Node::Repeat { node, min, max } => self.repeat(node, *min, *max),
        }
    }

    /// Unrolls: x{m,n} is m copies and n − m optional ones; x{m,} ends in a starred copy.
    fn repeat(&mut self, node: &Node, min: u32, max: Option<u32>) -> Result<Ends, TooLarge> {
        let mut ends = Ends { empty: true, first: vec![], last: vec![] };
        if !has_letters(node) {
            // Nested repetitions of nothing would be unrolled without end.
            return Ok(ends);
        }
        for _ in 0..min {
            let next = self.add(node)?;
            ends = self.concatenate(ends, next);
        }
        for _ in min..max.unwrap_or(min) {
            let mut next = self.add(node)?;
            next.empty = true;
            ends = self.concatenate(ends, next);
        }
        if max.is_none() {
            let mut starred = self.add(node)?;
            self.link(&starred.last, &starred.first);
            starred.empty = true;
            ends = self.concatenate(ends, starred);
        }
        Ok(ends)
    }

    fn concatenate(&mut self, mut a: Ends, b: Ends) -> Ends {
        self.link(&a.last, &b.first);
        if a.empty {
            a.first.extend(&b.first);
        }
        let mut last = b.last;
        if b.empty {
            last.extend(a.last);
        }
        Ends { empty: a.empty && b.empty, first: a.first, last }
    }

    fn link(&mut self, from: &[usize], to: &[usize]) {
        for &p in from {
            self.follow[p].extend(to);
            self.follow[p].sort_unstable();
            self.follow[p].dedup();
        }
    }
}

fn has_letters(node: &Node) -> bool {
    match node {
        Node::Empty => false,
        Node::Letters(_) => true,
        Node::Sequence(nodes) | Node::Union(nodes) => nodes.iter().any(has_letters),
        Node::Repeat { node, .. } => has_letters(node),
    }
}

impl Automaton {
    /// The minimal automaton of `nodes`.
    pub fn new(nodes: &[&Node]) -> Result<Self, TooLarge> {
        let mut positions = Positions::default();
        let mut start = Vec::new();
        let mut start_mask = 0u32;
        let mut final_mask: HashMap<usize, u32> = HashMap::new();
        for (layer, node) in nodes.iter().enumerate() {
            let ends = positions.add(node)?;
            start.extend(&ends.first);
            start_mask |= u32::from(ends.empty) << layer;
            for p in ends.last {
                *final_mask.entry(p).or_default() |= 1 << layer;
            }
        }
        let automaton = subsets(&positions, start, start_mask, &final_mask)?;
        Ok(automaton.minimised())
    }

    /// Moore's partition refinement.
    fn minimised(&self) -> Self {
        let mut block = number(self.accepts.iter());
        loop {
            let signatures: Vec<_> = (0..self.next.len())
                .map(|s| (block[s], self.next[s].map(|n| block[usize::from(n)])))
                .collect();
            let refined = number(signatures.iter());
            if refined.iter().max() == block.iter().max() {
                break;
            }
            block = refined;
        }
        // Blocks are numbered in the order they appear, so the start stays 0.
        let count = block.iter().max().map_or(0, |m| usize::from(*m) + 1);
        let mut minimal = Self { next: vec![[0; LETTERS]; count], accepts: vec![0; count] };
        for (s, b) in block.iter().enumerate() {
            minimal.next[usize::from(*b)] = self.next[s].map(|n| block[usize::from(n)]);
            minimal.accepts[usize::from(*b)] = self.accepts[s];
        }
        minimal
    }
}

/// Numbers equal items alike, in the order they appear.
fn number<T: std::hash::Hash + Eq>(items: impl Iterator<Item = T>) -> Vec<u16> {
    let mut seen = HashMap::new();
    items
        .map(|item| {
            let new = seen.len() as u16;
            *seen.entry(item).or_insert(new)
        })
        .collect()
}

/// Subset construction. A state is the set of positions that may be read next, and which
/// expressions the word read so far belongs to.
fn subsets(
    positions: &Positions,
    mut start: Vec<usize>,
    start_mask: u32,
    final_mask: &HashMap<usize, u32>,
) -> Result<Automaton, TooLarge> {
    start.sort_unstable();
    start.dedup();
    let mut index = HashMap::from([((start.clone(), start_mask), 0u16)]);
    let mut states = vec![(start, start_mask)];
    let mut automaton = Automaton { next: Vec::new(), accepts: Vec::new() };
    let mut done = 0;
    while done < states.len() {
        let (candidates, mask) = states[done].clone();
        automaton.accepts.push(mask);
        let mut successors = [0; LETTERS];
        for (letter, successor) in successors.iter_mut().enumerate() {
            let (mut next, mut accepted) = (Vec::new(), 0);
            for &p in candidates.iter().filter(|p| positions.letters[**p] & (1 << letter) != 0) {
                next.extend(&positions.follow[p]);
                accepted |= final_mask.get(&p).copied().unwrap_or(0);
            }
            next.sort_unstable();
            next.dedup();
            let key = (next, accepted);
            *successor = match index.get(&key) {
                Some(&known) => known,
                None => {
                    if states.len() >= MAX_STATES {
                        return Err(TooLarge);
                    }
                    let new = states.len() as u16;
                    index.insert(key.clone(), new);
                    states.push(key);
                    new
                }
            };
        }
        automaton.next.push(successors);
        done += 1;
    }
    Ok(automaton)
}
