//! Path classes: the one byte that a path segment carries instead of its word.

use super::automaton::{Automaton, LETTERS};
use super::expression::{Expression, ExpressionError};
use super::monoid::Monoid;
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

    /// The class of a byte that [`Self::to_byte`] gave for the same layers.
    pub const fn from_byte(byte: u8) -> Self {
        Self(byte)
    }

    /// The byte, for photons and records that carry it.
    pub const fn to_byte(self) -> u8 {
        self.0
    }
}

/// Most classes of one set of layers: an id is one byte.
pub(super) const MAX_CLASSES: usize = 255;
/// Most layers: a set of them is a `u32`.
const MAX_LAYERS: usize = 32;
/// Length of the tables, so that no byte is out of bounds.
const ROW: usize = 256;

/// The classes of paths for a set of layers: a finite monoid as tables.
///
/// Words other than the empty one may share [`ClassId::EMPTY`] where the layers cannot tell them
/// from it, as in `L.*E` alone; beside the components none does.
///
/// The components need 6 classes. With one expression beside them, over all four letters and, for
/// comparison, over words of D and S only:
///
/// | expression | D G S V | D S |
/// |---|---|---|
/// | `LDS*E\|LS*E` | 9 | 7 |
/// | `LS+DE` | 9 | 6 |
/// | `L(S\|D)*E` | 11 | 6 |
/// | `LDDDE\|LSDSDE` | 14 | 13 |
/// | `L.*D.{3}E` | 55 | 33 |
#[derive(Clone, Debug)]
pub struct PathClasses {
    labels: Vec<String>,
    expressions: Vec<Expression>,
    len: usize,
    letters: [ClassId; LETTERS],
    join: Box<[[ClassId; ROW]; ROW]>,
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
        let refuse = |layer: usize, message: String| ExpressionError {
            text: expressions
                .get(layer)
                .map_or_else(String::new, |e| e.text().to_owned()),
            position: None,
            message,
        };
        if expressions.len() > MAX_LAYERS {
            let given = expressions.len();
            let message = format!("there can be at most {MAX_LAYERS} layers, not {given}");
            return Err(refuse(MAX_LAYERS, message));
        }
        let mut automata = Vec::with_capacity(expressions.len());
        for (layer, expression) in expressions.iter().enumerate() {
            let automaton = Automaton::new(&expression.node).map_err(|_| {
                refuse(
                    layer,
                    format!("it needs more than {MAX_CLASSES} path classes; {SHORTEN}"),
                )
            })?;
            automata.push(automaton);
        }
        match Monoid::new(&automata, &Letter::ALL) {
            Ok(monoid) => Ok(Self::tabulate(&monoid, labels, expressions)),
            Err(_) => {
                let message = format!(
                    "together with the layers before it, it needs more than {MAX_CLASSES} path \
                     classes; {SHORTEN}"
                );
                Err(refuse(first_too_many(&automata), message))
            }
        }
    }

    fn tabulate(monoid: &Monoid, labels: Vec<String>, expressions: Vec<Expression>) -> Self {
        let len = monoid.then.len();
        let mut classes = Self {
            labels,
            expressions,
            len,
            letters: monoid.then[0].map(ClassId),
            join: Box::new([[ClassId::EMPTY; ROW]; ROW]),
            layers: [0; ROW],
            from_eye: [0; ROW],
            from_light: [0; ROW],
        };
        classes.layers[..len].copy_from_slice(&monoid.layers);
        for light in 0..len {
            let row = &mut classes.join[light];
            row[0] = ClassId(light as u8);
            // Elements are numbered by the length of their shortest words: what an entry is made
            // from stands before it.
            for (eye, found) in monoid.shortest.iter().enumerate() {
                if let Some((shorter, letter)) = *found {
                    let before = usize::from(row[usize::from(shorter)].0);
                    row[eye] = ClassId(monoid.then[before][letter as usize]);
                }
            }
            for (eye, joined) in row[..len].iter().enumerate() {
                let word = classes.layers[usize::from(joined.0)];
                classes.from_eye[eye] |= word;
                classes.from_light[light] |= word;
            }
        }
        classes
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
        self.join[usize::from(light_side.0)][usize::from(eye_side.0)]
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

    /// A shortest word of each class that has one of at most `longest` events, in letters from
    /// the light on: a name for people.
    pub fn shortest_words(&self, longest: usize) -> Vec<(ClassId, String)> {
        let mut named = vec![(ClassId::EMPTY, String::new())];
        let mut first = 0;
        for _ in 0..longest {
            let last = named.len();
            for i in first..last {
                for letter in [Letter::D, Letter::S, Letter::G] {
                    let class = self.append(named[i].0, letter);
                    if named.iter().all(|(known, _)| *known != class) {
                        named.push((class, format!("{}{letter:?}", named[i].1)));
                    }
                }
            }
            first = last;
        }
        named
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
            for (&class, &letter) in frontier
                .iter()
                .flat_map(|c| letters.iter().map(move |l| (c, l)))
            {
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

/// What helps against too many classes.
const SHORTEN: &str = "use smaller counts, or fewer expressions";

/// The first layer with which the classes become too many. More layers never have fewer classes, so
/// it is the last one if none before it is.
fn first_too_many(automata: &[Automaton]) -> usize {
    let too_many = |layer: &usize| Monoid::new(&automata[..=*layer], &Letter::ALL).is_err();
    let last = automata.len().saturating_sub(1);
    (0..last).find(too_many).unwrap_or(last)
}
