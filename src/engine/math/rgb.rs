//! Three independent numbers: radiance in W·sr⁻¹·m⁻², reflectance, throughput.

use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, Index, Mul, MulAssign, Neg, Sub};

use glam::Vec3A;

/// A value per channel. No colour space is attached and none is ever converted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rgb(Vec3A);

impl Rgb {
    /// All channels 0.
    pub const BLACK: Self = Self(Vec3A::ZERO);
    /// All channels 1.
    pub const WHITE: Self = Self(Vec3A::ONE);

    /// One value per channel.
    #[inline]
    pub const fn new(r: f32, g: f32, b: f32) -> Self {
        Self(Vec3A::new(r, g, b))
    }

    /// The same value in every channel.
    #[inline]
    pub const fn splat(v: f32) -> Self {
        Self(Vec3A::splat(v))
    }

    /// The channels in the order red, green, blue.
    #[inline]
    pub fn to_array(self) -> [f32; 3] {
        self.0.to_array()
    }

    /// True if every channel is exactly 0.
    #[inline]
    pub fn is_black(self) -> bool {
        self.0 == Vec3A::ZERO
    }

    /// True if no channel is NaN or infinite.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.0.is_finite()
    }

    /// The largest channel.
    #[inline]
    pub fn max_component(self) -> f32 {
        self.0.max_element()
    }

    /// The arithmetic mean of the channels: the scalar used where an importance is needed,
    /// since the channels carry no colour space that could define a luminance.
    #[inline]
    pub fn mean(self) -> f32 {
        (self.0.x + self.0.y + self.0.z) * (1.0 / 3.0)
    }

    /// Rec. 709 luminance, for display only.
    #[inline]
    pub fn luminance(self) -> f32 {
        self.0.dot(Vec3A::new(0.2126, 0.7152, 0.0722))
    }

    /// Channel-wise function.
    #[inline]
    pub fn map(self, f: impl Fn(f32) -> f32) -> Self {
        Self::new(f(self.0.x), f(self.0.y), f(self.0.z))
    }
}

impl From<[f32; 3]> for Rgb {
    fn from(c: [f32; 3]) -> Self {
        Self(Vec3A::from_array(c))
    }
}

impl From<Rgb> for [f32; 3] {
    fn from(c: Rgb) -> Self {
        c.to_array()
    }
}

impl Index<usize> for Rgb {
    type Output = f32;
    #[inline]
    fn index(&self, channel: usize) -> &f32 {
        &self.0[channel]
    }
}

impl Add for Rgb {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        Self(self.0 + o.0)
    }
}

impl AddAssign for Rgb {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        self.0 += o.0;
    }
}

impl Sub for Rgb {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        Self(self.0 - o.0)
    }
}

impl Neg for Rgb {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Mul for Rgb {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        Self(self.0 * o.0)
    }
}

impl Mul<f32> for Rgb {
    type Output = Self;
    #[inline]
    fn mul(self, k: f32) -> Self {
        Self(self.0 * k)
    }
}

impl Mul<Rgb> for f32 {
    type Output = Rgb;
    #[inline]
    fn mul(self, c: Rgb) -> Rgb {
        c * self
    }
}

impl MulAssign for Rgb {
    #[inline]
    fn mul_assign(&mut self, o: Self) {
        self.0 *= o.0;
    }
}

impl MulAssign<f32> for Rgb {
    #[inline]
    fn mul_assign(&mut self, k: f32) {
        self.0 *= k;
    }
}

impl Div for Rgb {
    type Output = Self;
    #[inline]
    fn div(self, o: Self) -> Self {
        Self(self.0 / o.0)
    }
}

impl Div<f32> for Rgb {
    type Output = Self;
    #[inline]
    fn div(self, k: f32) -> Self {
        Self(self.0 / k)
    }
}

impl Sum for Rgb {
    fn sum<I: Iterator<Item = Self>>(iter: I) -> Self {
        iter.fold(Self::BLACK, |a, b| a + b)
    }
}
