//! From radiance to the bytes of a display.
//!
//! A curve maps exposed radiance to linear display values in [0, 1]; the sRGB encoding is applied
//! once, afterwards. Curves act on numbers per channel, Rec. 709 primaries assumed: this is for
//! looking at pictures, nothing is measured on its result.

/// How radiance is brought into the range of a display.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum ToneMap {
    /// Values above 1 are cut.
    #[default]
    Linear,
    /// x / (1 + x) per channel (Reinhard et al. 2002, *Photographic Tone Reproduction for Digital
    /// Images*, equation 3).
    Reinhard,
    /// A rational fit of the ACES reference curve (Narkowicz 2015, *ACES Filmic Tone Mapping
    /// Curve*).
    Filmic,
    /// AgX (Sobotka 2022) with the polynomial contrast curve of Wrensch 2023, *Minimal AgX
    /// Implementation*: bright colours lose saturation instead of changing hue.
    Agx,
}

/// What a caller shows for a pixel that is not a number.
pub const NAN_COLOR: [u8; 3] = [255, 0, 255];

/// Inputs above this are shown as white by every curve; it keeps their squares finite.
const BRIGHTEST: f32 = 1e9;

impl ToneMap {
    /// All of them, in the order of the window's list.
    pub const ALL: [Self; 4] = [Self::Linear, Self::Reinhard, Self::Filmic, Self::Agx];

    /// Id on the command line.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Reinhard => "reinhard",
            Self::Filmic => "filmic",
            Self::Agx => "agx",
        }
    }

    /// Name in the window.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Linear => "Linear",
            Self::Reinhard => "Reinhard",
            Self::Filmic => "Filmic",
            Self::Agx => "AgX",
        }
    }

    /// The tone map of that id.
    pub fn find(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|map| map.id() == id)
    }
}

/// The bytes that show `rgb` after multiplication by 2^`exposure_ev`. What is below 0 or NaN
/// becomes 0 and +∞ white; callers mark NaN by [`NAN_COLOR`].
pub fn tonemap(map: ToneMap, exposure_ev: f32, rgb: [f32; 3]) -> [u8; 3] {
    let scale = exposure_ev.exp2();
    curve(map, rgb.map(|x| x * scale)).map(|x| (srgb_encode(x) * 255.0).round() as u8)
}

/// Linear display values in [0, 1] of exposed radiance.
pub fn curve(map: ToneMap, rgb: [f32; 3]) -> [f32; 3] {
    // A comparison with NaN fails.
    let rgb = rgb.map(|x| if x > 0.0 { x.min(BRIGHTEST) } else { 0.0 });
    let shown = match map {
        ToneMap::Linear => rgb,
        ToneMap::Reinhard => rgb.map(|x| x / (1.0 + x)),
        ToneMap::Filmic => rgb.map(narkowicz),
        ToneMap::Agx => agx(rgb),
    };
    shown.map(|x| x.clamp(0.0, 1.0))
}

/// The sRGB transfer function (IEC 61966-2-1) of a linear value in [0, 1].
pub fn srgb_encode(linear: f32) -> f32 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

fn narkowicz(x: f32) -> f32 {
    x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)
}

/// Mixes the channels before the curve (rows of Wrensch's matrix, which he writes in columns).
const AGX_INSET: [[f32; 3]; 3] = [
    [0.842_479_05, 0.078_433_6, 0.079_223_745],
    [0.042_328_242, 0.878_468_64, 0.079_166_13],
    [0.042_375_654, 0.078_433_6, 0.879_143],
];
/// Undoes [`AGX_INSET`] after the curve.
const AGX_OUTSET: [[f32; 3]; 3] = [
    [1.196_879, -0.098_020_88, -0.099_029_74],
    [-0.052_896_85, 1.151_903_1, -0.098_961_18],
    [-0.052_971_635, -0.098_043_45, 1.151_073_7],
];
/// Range of the logarithmic encoding in stops.
const AGX_STOPS: [f32; 2] = [-12.473_93, 4.026_069];

fn agx(rgb: [f32; 3]) -> [f32; 3] {
    let [lo, hi] = AGX_STOPS;
    let encoded = multiply(&AGX_INSET, rgb).map(|x| (x.log2().clamp(lo, hi) - lo) / (hi - lo));
    // The curve's result is encoded for a display of exponent 2.2: it is made linear here, so
    // that every map is encoded by the same function.
    multiply(&AGX_OUTSET, encoded.map(agx_contrast)).map(|x| x.max(0.0).powf(2.2))
}

/// Degree 6 in Horner's form.
fn agx_contrast(x: f32) -> f32 {
    const COEFFICIENTS: [f32; 7] = [15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.002_32];
    COEFFICIENTS.into_iter().fold(0.0, |sum, c| sum * x + c)
}

fn multiply(rows: &[[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    rows.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(map: ToneMap, x: f32) -> f32 {
        let rgb = curve(map, [x; 3]);
        let spread = rgb.iter().fold(0.0f32, |m, c| m.max((c - rgb[0]).abs()));
        assert!(spread < 2e-3, "{map:?} tints grey {x}: {rgb:?}");
        rgb[0]
    }

    #[test]
    fn every_curve_is_monotone_from_black_to_white() {
        for map in ToneMap::ALL {
            assert_eq!(tonemap(map, 0.0, [0.0; 3]), [0; 3], "{map:?}");
            let mut last = 0.0;
            for e in -400..=400 {
                let shown = grey(map, (e as f32 / 20.0).exp2());
                assert!(shown >= last, "{map:?} falls at 2^{}", e as f32 / 20.0);
                last = shown;
            }
            assert!(last > 0.99, "{map:?} ends at {last}");
        }
    }

    #[test]
    fn middle_grey_is_where_the_sources_put_it() {
        let near = |map, expected: f32| {
            let shown = grey(map, 0.18);
            assert!(
                (shown - expected).abs() < 2e-3,
                "{map:?}: {shown}, not {expected}"
            );
        };
        near(ToneMap::Linear, 0.18);
        near(ToneMap::Reinhard, 0.18 / 1.18);
        // 0.18·0.4818 / (0.18·1.0274 + 0.14)
        near(ToneMap::Filmic, 0.266_9);
        // log2 0.18 = −2.4739: 10 of 16.5 stops, where the polynomial gives 0.4967; ^2.2.
        near(ToneMap::Agx, 0.214_6);
    }

    #[test]
    fn srgb_is_applied_once() {
        // Published code values: linear 0.5 is 188, 0.18 is 118, 0.0031308 · 12.92 is 10.
        assert_eq!(
            tonemap(ToneMap::Linear, 0.0, [0.5, 0.18, 0.003_130_8]),
            [188, 118, 10]
        );
        assert_eq!(
            tonemap(ToneMap::Linear, -1.0, [1.0, 2.0, 4.0]),
            [188, 255, 255]
        );
    }

    #[test]
    fn values_that_are_no_radiance_are_defined() {
        for map in ToneMap::ALL {
            assert_eq!(tonemap(map, 0.0, [f32::NAN; 3]), [0; 3], "{map:?}");
            assert_eq!(tonemap(map, 0.0, [-1.0; 3]), [0; 3], "{map:?}");
            assert_eq!(tonemap(map, 0.0, [f32::INFINITY; 3]), [255; 3], "{map:?}");
            assert_eq!(tonemap(map, 20.0, [f32::MAX; 3]), [255; 3], "{map:?}");
        }
    }

    #[test]
    fn ids_lead_back_to_their_maps() {
        for map in ToneMap::ALL {
            assert_eq!(ToneMap::find(map.id()), Some(map));
        }
        assert_eq!(ToneMap::find("gamma"), None);
    }
}
