//! The transition monoid of a set of layers: what one byte must remember of a path segment.

use std::collections::HashMap;

use super::automaton::{Automaton, LETTERS};
use super::expression::{Expression, ExpressionError};
use crate::engine::event::Letter;

/// The four components: label and expression. Microfacet lobes count as specular, volumes as
/// diffuse; typed letters are literal.
pub const COMPONENTS: [(&str, &str); 4] = [
    ("direct", "L(D|V)?E"),
    ("specular", "L.*(S|G)E"),
    ("caustic", "L(S|G)+(D|V)E"),
    ("indirect", "L.*(D|V).*(D|V)E"),
];

/// What is remembered of a word of events: an element of the transition monoid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ClassId(u8);

impl ClassId {
    /// The empty word.
    pub const EMPTY: Self = Self(0);

    /// The byte, for photons and records that carry it.
    pub const fn to_byte(self) -> u8 {
        self.0
    }
}

/// Most elements: a class is one byte.
const MAX_ELEMENTS: usize = 255;
/// Most layers: a set of them is a `u32`.
const MAX_LAYERS: usize = 32;
/// Row length of the join table, so that two bytes are an index that needs no check.
const ROW: usize = 256;

/// The classes of paths for a set of layers.
#[derive(Clone, Debug)]
pub struct PathClasses {
    labels: Vec<String>,
    expressions: Vec<Expression>,
    len: usize,
    letters: [ClassId; LETTERS],
    join: Box<[u8]>,
    layers: [u32; ROW],
    from_eye: [u32; ROW],
    from_light: [u32; ROW],
}

impl PathClasses {
    /// The four components alone.
    pub fn components() -> Self {
        Self::with_components(&[]).expect("the components have few classes; a test builds them")
    }

    /// The four components, then `extra` expressions labelled `expr1`, `expr2` ….
    ///
    /// # Errors
    /// If there are more than 32 layers, or more than 255 classes are needed to tell them apart.
    pub fn with_components(extra: &[Expression]) -> Result<Self, ExpressionError> {
        let mut labels: Vec<String> = COMPONENTS.iter().map(|c| c.0.to_owned()).collect();
        let mut expressions = Vec::with_capacity(COMPONENTS.len() + extra.len());
        for (_, text) in COMPONENTS {
            expressions.push(text.parse()?);
        }
        labels.extend((1..=extra.len()).map(|i| format!("expr{i}")));
        expressions.extend_from_slice(extra);
        Self::new(labels, expressions)
    }

    /// One layer per expression.
    ///
    /// # Errors
    /// As [`Self::with_components`].
    pub fn new(labels: Vec<String>, expressions: Vec<Expression>) -> Result<Self, ExpressionError> {
        let refuse = |message: String| ExpressionError {
            text: expressions.last().map_or_else(String::new, |e| e.text().to_owned()),
            position: None,
            message,
        };
        if expressions.len() > MAX_LAYERS {
            let given = expressions.len();
            return Err(refuse(format!("there can be at most {MAX_LAYERS} layers, not {given}")));
        }
        let nodes: Vec<_> = expressions.iter().map(|e| &e.node).collect();
        let too_large = || {
            refuse(format!(
                "together with the other layers it needs more than {MAX_ELEMENTS} path classes; \
                 use a shorter expression, or fewer"
            ))
        };
        let automaton = Automaton::new(&nodes).map_err(|_| too_large())?;
        let monoid = Monoid::new(&automaton).ok_or_else(too_large)?;
        Ok(monoid.tabulate(&automaton, labels, expressions))
    }

    /// Number of classes.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Never true: the empty word has a class.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Labels of the layers.
    pub fn labels(&self) -> &[String] {
        &self.labels
    }

    /// Expressions of the layers.
    pub fn expressions(&self) -> &[Expression] {
        &self.expressions
    }

    /// Class of the word of one event.
    #[inline]
    pub fn of(&self, letter: Letter) -> ClassId {
        self.letters[letter as usize]
    }

    /// Class of a word whose part toward the light is `light_side`, the rest `eye_side`.
    #[inline]
    pub fn join(&self, light_side: ClassId, eye_side: ClassId) -> ClassId {
        ClassId(self.join[usize::from(light_side.0) * ROW + usize::from(eye_side.0)])
    }

    /// Class of `suffix` after one more event on the light side: a step of a camera walk.
    #[inline]
    pub fn prepend(&self, letter: Letter, suffix: ClassId) -> ClassId {
        self.join(self.of(letter), suffix)
    }

    /// Class of `prefix` after one more event on the eye side: a step of a light walk.
    #[inline]
    pub fn append(&self, prefix: ClassId, letter: Letter) -> ClassId {
        self.join(prefix, self.of(letter))
    }

    /// The layers that a complete word of this class belongs to, as a bit mask.
    #[inline]
    pub fn layers(&self, word: ClassId) -> u32 {
        self.layers[usize::from(word.0)]
    }

    /// The layers that some word ending in `suffix` belongs to, `suffix` itself included.
    #[inline]
    pub fn reachable_from_eye(&self, suffix: ClassId) -> u32 {
        self.from_eye[usize::from(suffix.0)]
    }

    /// The layers that some word beginning with `prefix` belongs to, `prefix` itself included.
    #[inline]
    pub fn reachable_from_light(&self, prefix: ClassId) -> u32 {
        self.from_light[usize::from(prefix.0)]
    }

    /// The layers that hold some word of these letters with at most `max_events` events.
    pub fn possible(&self, letters: &[Letter], max_events: Option<u32>) -> u32 {
        let mut known = vec![false; self.len];
        known[0] = true;
        let mut frontier = vec![ClassId::EMPTY];
        let mut mask = self.layers(ClassId::EMPTY);
        // After `len` rounds nothing new can appear.
        let rounds = max_events.map_or(self.len, |m| self.len.min(m as usize));
        for _ in 0..rounds {
            let mut next = Vec::new();
            for (&class, &letter) in frontier.iter().flat_map(|c| letters.iter().map(move |l| (c, l))) {
                let longer = self.append(class, letter);
                if !std::mem::replace(&mut known[usize::from(longer.0)], true) {
                    mask |= self.layers(longer);
                    next.push(longer);
                }
            }
            frontier = next;
        }
        mask
    }
}

/// The functions from states to states that words of events induce.
struct Monoid {
    elements: Vec<Vec<u16>>,
    index: HashMap<Vec<u16>, u8>,
}

impl Monoid {
    /// Enumerates breadth first; `None` if there are too many.
    fn new(automaton: &Automaton) -> Option<Self> {
        let identity: Vec<u16> = (0..automaton.next.len() as u16).collect();
        let mut monoid =
            Self { index: HashMap::from([(identity.clone(), 0)]), elements: vec![identity] };
        let mut done = 0;
        while done < monoid.elements.len() {
            for letter in 0..LETTERS {
                let step = |s: &u16| automaton.next[usize::from(*s)][letter];
                let longer: Vec<u16> = monoid.elements[done].iter().map(step).collect();
                if !monoid.index.contains_key(&longer) {
                    if monoid.elements.len() >= MAX_ELEMENTS {
                        return None;
                    }
                    monoid.index.insert(longer.clone(), monoid.elements.len() as u8);
                    monoid.elements.push(longer);
                }
            }
            done += 1;
        }
        Some(monoid)
    }

    /// The element that reads a word of `first`, then one of `second`.
    fn compose(&self, first: usize, second: usize) -> u8 {
        let second = &self.elements[second];
        let both: Vec<u16> =
            self.elements[first].iter().map(|s| second[usize::from(*s)]).collect();
        self.index[&both]
    }

    fn tabulate(
        &self,
        automaton: &Automaton,
        labels: Vec<String>,
        expressions: Vec<Expression>,
    ) -> PathClasses {
        let len = self.elements.len();
        let mut join = vec![0; ROW * ROW].into_boxed_slice();
        let mut layers = [0; ROW];
        for a in 0..len {
            layers[a] = automaton.accepts[usize::from(self.elements[a][0])];
            for b in 0..len {
                join[a * ROW + b] = self.compose(a, b);
            }
        }
        let (mut from_eye, mut from_light) = ([0; ROW], [0; ROW]);
        for a in 0..len {
            for b in 0..len {
                let word = layers[usize::from(join[a * ROW + b])];
                from_eye[b] |= word;
                from_light[a] |= word;
            }
        }
        let identity = &self.elements[0];
        let letters = std::array::from_fn(|letter| {
            let step = |s: &u16| automaton.next[usize::from(*s)][letter];
            let function: Vec<u16> = identity.iter().map(step).collect();
            ClassId(self.index[&function])
        });
        PathClasses { labels, expressions, len, letters, join, layers, from_eye, from_light }
    }
}
