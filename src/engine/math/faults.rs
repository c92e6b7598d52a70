//! Radiance that cannot be right.

use std::ops::{AddAssign, Sub};

use super::Rgb;

/// What can be wrong with the radiance of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A channel is not a number. The sample is left out.
    Nan,
    /// A channel is infinite. The sample is left out.
    Infinite,
    /// A channel is below zero: no light is. The sample counts.
    Negative,
}

impl Fault {
    /// What is wrong with `value`, the worst first.
    #[inline]
    pub fn of(value: Rgb) -> Option<Self> {
        // One comparison tells the sound ones: it fails for NaN as well.
        let channels = value.to_array();
        if channels.iter().all(|x| (0.0..f32::INFINITY).contains(x)) {
            return None;
        }
        Some(Self::worst(channels))
    }

    #[cold]
    fn worst(channels: [f32; 3]) -> Self {
        if channels.iter().any(|x| x.is_nan()) {
            Self::Nan
        } else if channels.iter().any(|x| x.is_infinite()) {
            Self::Infinite
        } else {
            Self::Negative
        }
    }

    /// In a few words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nan => "not a number",
            Self::Infinite => "infinite",
            Self::Negative => "negative",
        }
    }
}

/// How often which fault was found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FaultCounts {
    /// Samples that were NaN.
    pub nan: u64,
    /// Samples that were infinite.
    pub infinite: u64,
    /// Samples that were negative.
    pub negative: u64,
}

impl FaultCounts {
    /// Looks at the radiance of a sample and counts it if it is faulty.
    #[inline]
    pub fn look_at(&mut self, value: Rgb) -> Option<Fault> {
        let fault = Fault::of(value)?;
        match fault {
            Fault::Nan => self.nan += 1,
            Fault::Infinite => self.infinite += 1,
            Fault::Negative => self.negative += 1,
        }
        Some(fault)
    }

    /// Samples that were left out because they were no numbers.
    pub fn non_finite(&self) -> u64 {
        self.nan + self.infinite
    }

    /// The worst that was found.
    pub fn worst(&self) -> Option<Fault> {
        let found = [
            (self.nan, Fault::Nan),
            (self.infinite, Fault::Infinite),
            (self.negative, Fault::Negative),
        ];
        found.iter().find(|(n, _)| *n > 0).map(|(_, fault)| *fault)
    }
}

impl AddAssign for FaultCounts {
    fn add_assign(&mut self, o: Self) {
        self.nan += o.nan;
        self.infinite += o.infinite;
        self.negative += o.negative;
    }
}

/// What was found since `o`.
impl Sub for FaultCounts {
    type Output = Self;

    fn sub(self, o: Self) -> Self {
        Self {
            nan: self.nan - o.nan,
            infinite: self.infinite - o.infinite,
            negative: self.negative - o.negative,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_channel_names_the_fault() {
        let of = |r, g, b| Fault::of(Rgb::new(r, g, b));
        assert_eq!(of(0.0, 1.0, f32::MAX), None);
        assert_eq!(of(-0.0, 0.0, 0.0), None);
        assert_eq!(of(-1e-30, 0.0, 1.0), Some(Fault::Negative));
        assert_eq!(of(-1.0, f32::INFINITY, 0.0), Some(Fault::Infinite));
        assert_eq!(of(0.0, f32::NEG_INFINITY, 0.0), Some(Fault::Infinite));
        assert_eq!(of(f32::INFINITY, -1.0, f32::NAN), Some(Fault::Nan));
    }
}
