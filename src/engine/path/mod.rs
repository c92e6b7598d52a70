//! The algebra of light paths: words, expressions over them, and the small class that a path
//! segment carries.
//!
//! A path is a word over [`Letter`](crate::engine::event::Letter)s, read from the light to the
//! eye. The layers of a render, the four components and the expressions a user types, are one
//! finite automaton; its transition monoid is finite, so a segment of a path is known well enough
//! by one byte, its [`ClassId`], and [`PathClasses::join`] is a table lookup.

mod automaton;
mod class;
mod expression;
mod monoid;
mod parser;

pub use class::{COMPONENTS, ClassId, PathClasses};
pub use expression::{Expression, ExpressionError};
