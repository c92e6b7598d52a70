//! How a finished frame is shown. Nothing here restarts the render.

use crate::engine::film::ToneMap;
use crate::engine::path::COMPONENTS;

/// Number of components.
pub const PARTS: usize = COMPONENTS.len();

/// Which layers are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Shown {
    /// The whole, which has sums of its own.
    #[default]
    Whole,
    /// The sum of the components that are on.
    Parts([bool; PARTS]),
    /// All four components side by side.
    Grid,
    /// The typed expression of this number alone.
    Expression(u8),
}

/// How a picture is brought to the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Display {
    /// Which layers.
    pub shown: Shown,
    /// Exposure in stops.
    pub exposure: f32,
    /// Stops beyond `exposure` for each component where it is shown alone.
    pub part_exposure: [f32; PARTS],
    /// From radiance to display values.
    pub tonemap: ToneMap,
    /// Luminance as a colour-blind-safe scale of colours.
    pub false_color: bool,
}

impl Default for Display {
    fn default() -> Self {
        Self {
            shown: Shown::Whole,
            exposure: 0.0,
            part_exposure: [0.0; PARTS],
            tonemap: ToneMap::default(),
            false_color: false,
        }
    }
}

/// Range of exposures in stops.
pub const EXPOSURES: std::ops::RangeInclusive<f32> = -16.0..=16.0;

/// A part of the picture area and what is shown in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile {
    /// Left, top, width and height as shares of the picture area.
    pub area: [f32; 4],
    /// Indices of the frame's layers whose sum is shown.
    pub layers: Vec<usize>,
    /// Exposure in stops.
    pub exposure: f32,
    /// What it shows, where several pictures stand side by side.
    pub label: Option<&'static str>,
}

/// Index of a typed expression among the layers of a frame: they follow the components.
pub const fn layer_of_expression(number: usize) -> usize {
    PARTS + 1 + number
}

/// Index of a component among the layers of a frame: the whole is the first.
pub const fn layer_of_part(part: usize) -> usize {
    part + 1
}

impl Shown {
    /// Which components are in what is shown.
    pub fn parts(self) -> [bool; PARTS] {
        match self {
            Self::Whole | Self::Grid | Self::Expression(_) => [true; PARTS],
            Self::Parts(on) => on,
        }
    }

    /// The component that is shown alone.
    pub fn solo(self) -> Option<usize> {
        let Self::Parts(on) = self else { return None };
        let first = on.iter().position(|on| *on)?;
        (on.iter().filter(|on| **on).count() == 1).then_some(first)
    }

    /// Switches one component on or off.
    #[must_use]
    pub fn toggled(self, part: usize) -> Self {
        let mut on = self.parts();
        on[part] = !on[part];
        if on == [true; PARTS] {
            Self::Whole
        } else {
            Self::Parts(on)
        }
    }

    /// One component alone; the whole if it was alone already.
    #[must_use]
    pub fn soloed(self, part: usize) -> Self {
        if self.solo() == Some(part) {
            return Self::Whole;
        }
        let mut on = [false; PARTS];
        on[part] = true;
        Self::Parts(on)
    }
}

impl Display {
    /// What is drawn where.
    pub fn tiles(&self) -> Vec<Tile> {
        let single = |layers: Vec<usize>, exposure: f32| {
            let area = [0.0, 0.0, 1.0, 1.0];
            vec![Tile {
                area,
                layers,
                exposure,
                label: None,
            }]
        };
        match self.shown {
            Shown::Whole => single(vec![0], self.exposure),
            Shown::Parts(on) => {
                let layers = (0..PARTS).filter(|&p| on[p]).map(layer_of_part).collect();
                let own = self.shown.solo().map_or(0.0, |p| self.part_exposure[p]);
                single(layers, self.exposure + own)
            }
            Shown::Expression(i) => {
                single(vec![layer_of_expression(usize::from(i))], self.exposure)
            }
            Shown::Grid => (0..PARTS).map(|part| self.quarter(part)).collect(),
        }
    }

    fn quarter(&self, part: usize) -> Tile {
        let (column, row) = (part % 2, part / 2);
        Tile {
            area: [column as f32 * 0.5, row as f32 * 0.5, 0.5, 0.5],
            layers: vec![layer_of_part(part)],
            exposure: self.exposure + self.part_exposure[part],
            label: Some(COMPONENTS[part].0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn switching_all_components_on_again_shows_the_whole() {
        let off = Shown::Whole.toggled(2);
        assert_eq!(off, Shown::Parts([true, true, false, true]));
        assert_eq!(off.toggled(2), Shown::Whole);
    }

    #[test]
    fn solo_twice_is_the_whole() {
        let solo = Shown::Grid.soloed(1);
        assert_eq!(solo.solo(), Some(1));
        assert_eq!(solo.soloed(1), Shown::Whole);
        assert_eq!(solo.soloed(0).solo(), Some(0));
    }

    #[test]
    fn the_grid_covers_the_area_once_with_every_component() {
        let display = Display {
            shown: Shown::Grid,
            exposure: 1.0,
            part_exposure: [0.0, 0.0, 3.0, 0.0],
            ..Display::default()
        };
        let tiles = display.tiles();
        let area: f32 = tiles.iter().map(|t| t.area[2] * t.area[3]).sum();
        assert_eq!((tiles.len(), area), (PARTS, 1.0));
        let layers: Vec<usize> = tiles.iter().flat_map(|t| t.layers.clone()).collect();
        assert_eq!(layers, [1, 2, 3, 4]);
        assert_eq!(tiles[2].exposure, 4.0);
        assert_eq!(tiles[2].label, Some("caustic"));
    }

    #[test]
    fn a_sum_of_parts_leaves_out_the_others() {
        let display = Display {
            shown: Shown::Parts([false, true, true, false]),
            ..Display::default()
        };
        assert_eq!(display.tiles()[0].layers, [2, 3]);
    }
}
