//! Colours over a surface, prepared for lookup.

use std::sync::Arc;

use glam::Vec2;

use super::desc::{ColorDesc, ImageData};
use crate::engine::math::Rgb;

/// A colour as a function of texture coordinates.
#[derive(Clone, Debug)]
pub enum Texture {
    /// The same everywhere.
    Constant(Rgb),
    /// A bilinearly filtered image, repeated in both directions; v = 0 is its bottom edge.
    Image {
        /// Invariant: has at least one pixel, `width * height` of them.
        image: Arc<ImageData>,
        /// Factor on the values.
        scale: Rgb,
    },
    /// A checkerboard.
    Checker {
        /// The colour of squares whose indices sum to an even, an odd number.
        colors: [Rgb; 2],
        /// Squares per unit of u and v.
        scale: f32,
    },
}

impl Texture {
    /// Prepares a colour.
    ///
    /// # Errors
    /// A sentence that says what is wrong with it.
    pub fn build(desc: &ColorDesc) -> Result<Self, String> {
        Ok(match desc {
            ColorDesc::Constant(c) => Self::Constant(*c),
            ColorDesc::Texture { image, scale } => {
                let pixels = image.width.checked_mul(image.height);
                if image.pixels.is_empty() || pixels != Some(image.pixels.len()) {
                    return Err(format!(
                        "the image {} holds {} pixels, not {} x {}",
                        image.name,
                        image.pixels.len(),
                        image.width,
                        image.height
                    ));
                }
                Self::Image {
                    image: Arc::clone(image),
                    scale: *scale,
                }
            }
            ColorDesc::Checker { colors, scale } => {
                if !scale.is_finite() {
                    return Err(format!("the scale {scale} of a checker is not finite"));
                }
                Self::Checker {
                    colors: *colors,
                    scale: *scale,
                }
            }
        })
    }

    /// The colour at texture coordinates `uv`.
    #[inline]
    pub fn eval(&self, uv: Vec2) -> Rgb {
        match self {
            Self::Constant(c) => *c,
            Self::Image { image, scale } => bilinear(image, uv) * *scale,
            Self::Checker { colors, scale } => {
                let cell = (uv * *scale).floor();
                let odd = (cell.x as i64).wrapping_add(cell.y as i64) & 1;
                colors[odd as usize]
            }
        }
    }

    /// The value if it is the same everywhere.
    #[inline]
    pub const fn constant(&self) -> Option<Rgb> {
        match self {
            Self::Constant(c) => Some(*c),
            _ => None,
        }
    }

    /// The mean over one period of the texture.
    pub fn mean(&self) -> Rgb {
        match self {
            Self::Constant(c) => *c,
            Self::Image { image, scale } => {
                let sum = image.pixels.iter().fold([0.0_f64; 3], |s, p| {
                    std::array::from_fn(|c| s[c] + f64::from(p[c]))
                });
                let n = image.pixels.len() as f64;
                Rgb::from(sum.map(|s| (s / n) as f32)) * *scale
            }
            Self::Checker { colors, .. } => 0.5 * (colors[0] + colors[1]),
        }
    }
}

/// Bilinear interpolation between pixel centres, wrapped around the edges.
fn bilinear(image: &ImageData, uv: Vec2) -> Rgb {
    if !uv.is_finite() {
        return Rgb::BLACK;
    }
    let (width, height) = (image.width, image.height);
    // Wrapping the coordinate first keeps the digits of the fraction.
    let wrapped = uv - uv.floor();
    let x = wrapped.x * width as f32 - 0.5;
    let y = (1.0 - wrapped.y) * height as f32 - 0.5;
    let (x0, y0) = (x.floor(), y.floor());
    let (fx, fy) = (x - x0, y - y0);
    let pixel = |dx: i64, dy: i64| {
        let column = (x0 as i64 + dx).rem_euclid(width as i64) as usize;
        let row = (y0 as i64 + dy).rem_euclid(height as i64) as usize;
        Rgb::from(image.pixels[row * width + column])
    };
    let top = pixel(0, 0) * (1.0 - fx) + pixel(1, 0) * fx;
    let bottom = pixel(0, 1) * (1.0 - fx) + pixel(1, 1) * fx;
    top * (1.0 - fy) + bottom * fy
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image() -> Texture {
        // Two columns, two rows; the top row is red and green, the bottom blue and black.
        let image = ImageData {
            name: "test".into(),
            width: 2,
            height: 2,
            pixels: vec![[1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [0., 0., 0.]],
        };
        Texture::build(&ColorDesc::Texture {
            image: Arc::new(image),
            scale: Rgb::WHITE,
        })
        .unwrap()
    }

    #[test]
    fn pixel_centres_hold_the_pixels_and_v_points_up() {
        let t = image();
        for period in [-3.0, 0.0, 5.0] {
            let at = |u: f32, v: f32| t.eval(Vec2::new(u + period, v - period));
            assert_eq!(at(0.25, 0.75), Rgb::new(1., 0., 0.));
            assert_eq!(at(0.75, 0.75), Rgb::new(0., 1., 0.));
            assert_eq!(at(0.25, 0.25), Rgb::new(0., 0., 1.));
            // The corner of the image mixes all four by wrapping.
            assert_eq!(at(0.0, 0.0), Rgb::splat(0.25));
        }
        assert_eq!(t.mean(), Rgb::splat(0.25));
    }

    #[test]
    fn strange_coordinates_are_answered() {
        let t = image();
        for x in [
            f32::NAN,
            f32::INFINITY,
            -1e30,
            1e30,
            f32::MIN_POSITIVE,
            -1e-9,
        ] {
            assert!(t.eval(Vec2::new(x, 0.3)).is_finite());
            assert!(t.eval(Vec2::new(0.3, x)).is_finite());
        }
    }

    #[test]
    fn checker_alternates() {
        let t = Texture::Checker {
            colors: [Rgb::BLACK, Rgb::WHITE],
            scale: 2.0,
        };
        assert_eq!(t.eval(Vec2::new(0.1, 0.1)), Rgb::BLACK);
        assert_eq!(t.eval(Vec2::new(0.6, 0.1)), Rgb::WHITE);
        assert_eq!(t.eval(Vec2::new(-0.1, 0.1)), Rgb::WHITE);
        assert_eq!(t.eval(Vec2::new(-0.1, -0.1)), Rgb::BLACK);
        assert_eq!(t.mean(), Rgb::splat(0.5));
    }

    #[test]
    fn broken_images_are_refused() {
        let image = ImageData {
            name: "empty.png".into(),
            width: 0,
            height: 3,
            pixels: vec![],
        };
        let desc = ColorDesc::Texture {
            image: Arc::new(image),
            scale: Rgb::WHITE,
        };
        assert!(Texture::build(&desc).unwrap_err().contains("empty.png"));
    }
}
