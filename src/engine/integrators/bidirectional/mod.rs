//! What algorithms with walks from both ends share: the two walks, their connections, and the
//! weights between the strategies (Veach 1997, *Robust Monte Carlo Methods for Light Transport
//! Simulation*, chapter 10).
//!
//! A path of n vertices v₀ … vₙ₋₁ begins on a light and ends on the lens. The strategy (s, t),
//! s + t = n, samples the first s vertices by a walk from the light, the other t by a walk from the
//! lens, and connects the two ends. s = 0: the walk from the lens meets the light by itself. s = 1:
//! a shadow ray. t = 1: a light path is joined to the lens and ends on a pixel of its own choice.
//! No strategy has t = 0: no walk meets a pinhole, nor is it looked for on a lens.
//!
//! Densities are in area measure, 1/m². Where a light lies at infinity, v₀ is a direction, counted
//! in 1/sr, and the density of v₁ is that of parallel rays, 1/m² across them. Vertices in a medium
//! have densities in 1/m², too, of directions alone: the density of distances is no part of them.

mod connect;
mod ends;
mod estimator;
mod flight;
mod lost;
mod merge;
mod strategies;
mod subpath;
mod vertex;
mod visibility;
mod weight;

#[cfg(test)]
mod tests;

pub use connect::{Connector, Sink, Technique};
pub use ends::LightEnd;
pub use estimator::{Bidirectional, Workspace, lens_dimension};
pub use lost::lost_words;
pub use merge::{PhotonGrid, PhotonList};
pub use strategies::{Heuristic, Strategies};
pub use subpath::{Escape, FIRST_LIGHT_VERTEX, LightStart, Subpath, Walker, vertex_dimensions};
pub use vertex::Vertex;
pub use weight::{Density, Join, Meeting, weight};
