//! The transition monoid of a set of layers: how a word moves each state of their common automaton.
//! Two words with the same element are in the same layers, whatever stands before and after them
//! (Pin 1986, *Varieties of Formal Languages*, chapter 1), so the element is all that a path segment
//! has to carry.

use std::collections::HashMap;

use super::automaton::{Automaton, LETTERS, Row};
use super::class::MAX_CLASSES;
use crate::engine::event::Letter;

/// The elements, numbered in the order of their shortest words; 0 is the empty word's.
#[derive(Debug)]
pub(super) struct Monoid {
    /// The element of each element's word with one more letter on the eye side.
    pub(super) then: Vec<Row<u8>>,
    /// How each element was found: the element of its shortest word without the letter next to the
    /// eye, and that letter. The empty word has none.
    pub(super) shortest: Vec<Option<(u8, Letter)>>,
    /// The layers that each element's words belong to.
    pub(super) layers: Vec<u32>,
}

/// The monoid has more than [`MAX_CLASSES`] elements.
#[derive(Debug)]
pub(super) struct TooManyElements;

impl Monoid {
    /// Enumerates the elements that words over `alphabet` have. At most 32 automata.
    pub(super) fn new(
        automata: &[Automaton],
        alphabet: &[Letter],
    ) -> Result<Self, TooManyElements> {
        let product = Product::new(automata, alphabet)?;
        // Breadth first over words. An element is the list of the states that it leads to.
        let identity: Vec<u8> = (0..product.next.len()).map(|state| state as u8).collect();
        let mut elements = Numbered::new(identity);
        let mut monoid = Self {
            then: Vec::new(),
            shortest: vec![None],
            layers: Vec::new(),
        };
        while let Some(element) = elements.list.get(monoid.then.len()).cloned() {
            let current = monoid.then.len() as u8;
            let mut row = [0; LETTERS];
            for &letter in alphabet {
                let moved = element
                    .iter()
                    .map(|&s| product.next[s as usize][letter as usize]);
                row[letter as usize] = elements.number(moved.collect())?;
                if monoid.shortest.len() < elements.list.len() {
                    monoid.shortest.push(Some((current, letter)));
                }
            }
            monoid.then.push(row);
            monoid.layers.push(product.layers[element[0] as usize]);
        }
        Ok(monoid)
    }
}

/// The automaton of all layers at once, of its reachable states only. As each factor is minimal, it
/// is minimal too, and each state is where some element leads from the start: it has no more states
/// than the monoid has elements.
struct Product {
    next: Vec<Row<u8>>,
    layers: Vec<u32>,
}

impl Product {
    fn new(automata: &[Automaton], alphabet: &[Letter]) -> Result<Self, TooManyElements> {
        let mut states = Numbered::new(vec![0; automata.len()]);
        let mut product = Self {
            next: Vec::new(),
            layers: Vec::new(),
        };
        while let Some(state) = states.list.get(product.next.len()).cloned() {
            let factors = || automata.iter().zip(&state);
            let mut row = [0; LETTERS];
            for letter in alphabet.iter().map(|&letter| letter as usize) {
                let moved = factors().map(|(factor, &s)| factor.next[s as usize][letter]);
                row[letter] = states.number(moved.collect())?;
            }
            let accepting = factors().map(|(factor, &s)| factor.accepting[s as usize]);
            let bits = accepting
                .enumerate()
                .map(|(layer, accepts)| u32::from(accepts) << layer);
            product.layers.push(bits.fold(0, |mask, bit| mask | bit));
            product.next.push(row);
        }
        Ok(product)
    }
}

/// Lists of states, numbered in the order in which they are first seen.
struct Numbered {
    list: Vec<Vec<u8>>,
    numbers: HashMap<Vec<u8>, u8>,
}

impl Numbered {
    fn new(first: Vec<u8>) -> Self {
        Self {
            list: vec![first.clone()],
            numbers: HashMap::from([(first, 0)]),
        }
    }

    fn number(&mut self, item: Vec<u8>) -> Result<u8, TooManyElements> {
        if let Some(&number) = self.numbers.get(&item) {
            return Ok(number);
        }
        if self.list.len() == MAX_CLASSES {
            return Err(TooManyElements);
        }
        let number = self.list.len() as u8;
        self.list.push(item.clone());
        self.numbers.insert(item, number);
        Ok(number)
    }
}

#[cfg(test)]
mod tests {
    use super::super::class::COMPONENTS;
    use super::super::expression::Expression;
    use super::*;

    fn count(texts: &[&str], alphabet: &[Letter]) -> usize {
        let automaton = |text: &&str| {
            let expression: Expression = text.parse().expect("well-formed");
            Automaton::new(&expression.node).expect("small")
        };
        let automata: Vec<Automaton> = texts.iter().map(automaton).collect();
        Monoid::new(&automata, alphabet).expect("small").then.len()
    }

    #[test]
    fn counts_of_the_documentation() {
        let components = COMPONENTS.map(|component| component.1);
        let two = [Letter::D, Letter::S];
        let expected = [
            ("LDS*E|LS*E", 9, 7),
            ("LS+DE", 9, 6),
            ("L(S|D)*E", 11, 6),
            ("LDDDE|LSDSDE", 14, 13),
            ("L.*D.{3}E", 55, 33),
        ];
        assert_eq!(
            (count(&components, &Letter::ALL), count(&components, &two)),
            (6, 6)
        );
        for (text, all, of_two) in expected {
            let texts = [&components[..], &[text]].concat();
            assert_eq!(count(&texts, &Letter::ALL), all, "{text}");
            assert_eq!(count(&texts, &two), of_two, "{text} over D and S");
        }
    }

    #[test]
    fn equal_languages_have_one_automaton() {
        // The number of elements depends on the language, not on how it is written.
        for (a, b) in [
            ("L.*E", "L(D|G|S|V|..)*E"),
            ("LD{2,}E", "LDD+E"),
            ("L(D*)*S?E", "LD*(S|D?)E"),
            ("LDE|LDSE|LDSSE", "LDS{0,2}E"),
        ] {
            assert_eq!(
                count(&[a], &Letter::ALL),
                count(&[b], &Letter::ALL),
                "{a} {b}"
            );
            // In every state of the product both accept or neither does.
            let both = count(&[a, b], &Letter::ALL);
            assert_eq!(both, count(&[a], &Letter::ALL), "{a} {b}");
        }
    }
}
