//! The photon as it is stored: Jensen's twenty bytes, and a variant of full precision for tests
//! (Jensen 2001, *Realistic Image Synthesis Using Photon Mapping*, section 6.1).

use bytemuck::{Pod, Zeroable};
use glam::Vec3A;

use super::{direction, rgbe};
use crate::engine::math::Rgb;
use crate::engine::path::ClassId;

/// Largest number of events that a photon counts; longer prefixes count as this.
pub const MAX_EVENTS: u32 = 63;

/// A photon at the surface it landed on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Photon {
    /// Where.
    pub p: Vec3A,
    /// Flux that it carries, W.
    pub power: Rgb,
    /// Unit direction toward where it came from.
    pub wi: Vec3A,
    /// Class of the events before this landing, light side complete.
    pub class: ClassId,
    /// Their number, at most [`MAX_EVENTS`]; 0 if and only if it comes straight from a light.
    pub events: u32,
}

/// A stored photon.
pub trait Record: Copy + Send + Sync + 'static {
    /// Packs a photon that landed where the geometric normal is `n_g`. Powers are counted in
    /// `unit` W; `u` uniform in [0, 1) decides roundings.
    fn pack(photon: &Photon, n_g: Vec3A, unit: f32, u: f32) -> Self;
    /// Position.
    fn position(&self) -> &[f32; 3];
    /// Power in units.
    fn power(&self) -> Rgb;
    /// Unit direction toward where it came from.
    fn direction(&self) -> Vec3A;
    /// Class of the events before.
    fn class(&self) -> ClassId;
    /// Number of the events before.
    fn events(&self) -> u32;
    /// Axis by which the tree splits here.
    fn axis(&self) -> usize;
    /// Sets it.
    fn set_axis(&mut self, axis: usize);

    /// Everything, the power in W for `unit` W a unit.
    fn photon(&self, unit: f32) -> Photon {
        Photon {
            p: Vec3A::from_array(*self.position()),
            power: self.power() * unit,
            wi: self.direction(),
            class: self.class(),
            events: self.events(),
        }
    }
}

/// Class, axis and number of events: 8, 2 and 6 bits.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(transparent)]
struct Flags(u16);

impl Flags {
    #[inline]
    fn new(class: ClassId, events: u32) -> Self {
        Self(u16::from(class.to_byte()) << 8 | events.min(MAX_EVENTS) as u16)
    }

    #[inline]
    fn class(self) -> ClassId {
        ClassId::from_byte((self.0 >> 8) as u8)
    }

    #[inline]
    fn events(self) -> u32 {
        u32::from(self.0) & MAX_EVENTS
    }

    #[inline]
    fn axis(self) -> usize {
        usize::from(self.0 >> 6 & 3)
    }

    #[inline]
    fn set_axis(&mut self, axis: usize) {
        self.0 = self.0 & !(3 << 6) | (axis as u16 & 3) << 6;
    }
}

/// Twenty bytes: position, power by shared exponent, direction in two bytes, flags.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct PackedPhoton {
    p: [f32; 3],
    power: [u8; 4],
    direction: u16,
    flags: Flags,
}

impl Record for PackedPhoton {
    #[inline]
    fn pack(photon: &Photon, n_g: Vec3A, unit: f32, u: f32) -> Self {
        Self {
            p: photon.p.to_array(),
            power: rgbe::pack((photon.power / unit).to_array(), u),
            direction: direction::pack(photon.wi, n_g),
            flags: Flags::new(photon.class, photon.events),
        }
    }

    #[inline]
    fn position(&self) -> &[f32; 3] {
        &self.p
    }

    #[inline]
    fn power(&self) -> Rgb {
        rgbe::unpack(self.power).into()
    }

    #[inline]
    fn direction(&self) -> Vec3A {
        direction::unpack(self.direction)
    }

    #[inline]
    fn class(&self) -> ClassId {
        self.flags.class()
    }

    #[inline]
    fn events(&self) -> u32 {
        self.flags.events()
    }

    #[inline]
    fn axis(&self) -> usize {
        self.flags.axis()
    }

    #[inline]
    fn set_axis(&mut self, axis: usize) {
        self.flags.set_axis(axis);
    }
}

/// The same without loss.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct FullPhoton {
    p: [f32; 3],
    power: [f32; 3],
    direction: [f32; 3],
    flags: Flags,
    unused: u16,
}

impl Record for FullPhoton {
    #[inline]
    fn pack(photon: &Photon, _n_g: Vec3A, unit: f32, _u: f32) -> Self {
        Self {
            p: photon.p.to_array(),
            power: (photon.power / unit).to_array(),
            direction: photon.wi.to_array(),
            flags: Flags::new(photon.class, photon.events),
            unused: 0,
        }
    }

    #[inline]
    fn position(&self) -> &[f32; 3] {
        &self.p
    }

    #[inline]
    fn power(&self) -> Rgb {
        self.power.into()
    }

    #[inline]
    fn direction(&self) -> Vec3A {
        self.direction.into()
    }

    #[inline]
    fn class(&self) -> ClassId {
        self.flags.class()
    }

    #[inline]
    fn events(&self) -> u32 {
        self.flags.events()
    }

    #[inline]
    fn axis(&self) -> usize {
        self.flags.axis()
    }

    #[inline]
    fn set_axis(&mut self, axis: usize) {
        self.flags.set_axis(axis);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_photon_has_twenty_bytes() {
        assert_eq!(size_of::<PackedPhoton>(), 20);
        assert_eq!(size_of::<FullPhoton>(), 40);
    }

    #[test]
    fn flags_do_not_disturb_each_other() {
        for byte in [0, 1, 137, 255] {
            for events in [0, 1, 62, 63, 64, 1000] {
                for axis in 0..3 {
                    let mut flags = Flags::new(ClassId::from_byte(byte), events);
                    flags.set_axis(2 - axis);
                    flags.set_axis(axis);
                    assert_eq!(flags.class().to_byte(), byte);
                    assert_eq!(flags.events(), events.min(MAX_EVENTS));
                    assert_eq!(flags.axis(), axis);
                }
            }
        }
    }

    #[test]
    fn the_full_variant_loses_nothing() {
        let photon = Photon {
            p: Vec3A::new(1.0, -2.0, 3.5),
            power: Rgb::new(0.3, 1e-9, 7.0),
            wi: Vec3A::new(0.6, 0.0, 0.8),
            class: ClassId::from_byte(5),
            events: 9,
        };
        let full = FullPhoton::pack(&photon, Vec3A::Z, 2.0, 0.5);
        assert_eq!(full.photon(2.0), photon);
        let packed = PackedPhoton::pack(&photon, Vec3A::Z, 2.0, 0.5).photon(2.0);
        assert_eq!(
            (packed.p, packed.class, packed.events),
            (photon.p, photon.class, 9)
        );
        assert!((packed.wi - photon.wi).length() < 0.02);
        assert!((packed.power - photon.power).max_component().abs() < 7.0 / 127.0);
    }
}
