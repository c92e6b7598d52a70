//! All that makes the picture, and nothing else: what jobs, undo and saved states look at.

use glam::UVec2;

use super::display::Display;
use super::source::SceneSource;
use crate::engine::camera::Camera;
use crate::engine::integrators::REGISTRY;
use crate::engine::scene::desc::CameraDesc;
use crate::engine::session::Settings;

/// Pixels of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum PictureSize {
    /// As many as the window has.
    #[default]
    Window,
    /// A number of its own; the picture is shown as large as fits.
    Fixed(UVec2),
}

/// Smallest and largest side of a picture in pixels.
pub const SIDES: std::ops::RangeInclusive<u32> = 1..=16_384;
/// Most pixels of a picture: what 8192 × 8192 has.
pub const MAX_PIXELS: u64 = 1 << 26;

/// All that makes the picture.
#[derive(Clone, PartialEq)]
pub struct Model {
    /// The scene.
    pub source: SceneSource,
    /// The view; its width and height mean nothing here.
    pub view: CameraDesc,
    /// The view the scene opens with.
    pub home: CameraDesc,
    /// Pixels.
    pub size: PictureSize,
    /// Algorithm, parameters, layers, seed.
    pub settings: Settings,
    /// How it is shown.
    pub display: Display,
}

impl Model {
    /// A scene with the first integrator of the registry and defaults for the rest.
    pub fn new(source: SceneSource) -> Self {
        Self {
            source,
            view: CameraDesc::default(),
            home: CameraDesc::default(),
            size: PictureSize::Window,
            settings: Settings::new(&REGISTRY[0]),
            display: Display::default(),
        }
    }

    /// Pixels of the picture in an area of `window` pixels: at least one each way, and no more
    /// than `most`, what the graphics card holds.
    pub fn pixels(&self, window: UVec2, most: u64) -> UVec2 {
        let most = most.clamp(1, MAX_PIXELS);
        let wanted = match self.size {
            PictureSize::Window => window,
            PictureSize::Fixed(size) => size,
        };
        let size = wanted.clamp(UVec2::splat(*SIDES.start()), UVec2::splat(*SIDES.end()));
        let pixels = u64::from(size.x) * u64::from(size.y);
        if pixels <= most {
            return size;
        }
        let scale = (most as f64 / pixels as f64).sqrt();
        (size.as_dvec2() * scale).as_uvec2().max(UVec2::ONE)
    }

    /// The camera of a picture of `size` pixels.
    ///
    /// # Errors
    /// A sentence if the view makes no sense.
    pub fn camera(&self, size: UVec2) -> Result<Camera, String> {
        let size = size.max(UVec2::ONE);
        let (width, height) = (size.x, size.y);
        Camera::new(&CameraDesc {
            width,
            height,
            ..self.view
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_stay_within_memory_and_keep_their_shape() {
        let mut model = Model::new(SceneSource::Embedded("x".to_owned()));
        let many = u64::MAX;
        assert_eq!(
            model.pixels(UVec2::new(640, 480), many),
            UVec2::new(640, 480)
        );
        assert_eq!(
            model.pixels(UVec2::new(640, 480), 76_800),
            UVec2::new(320, 240)
        );
        assert_eq!(model.pixels(UVec2::ZERO, many), UVec2::ONE);
        model.size = PictureSize::Fixed(UVec2::new(16_384, 8_192));
        let size = model.pixels(UVec2::ONE, many);
        assert!(u64::from(size.x) * u64::from(size.y) <= MAX_PIXELS);
        assert!((f64::from(size.x) / f64::from(size.y) - 2.0).abs() < 1e-3);
    }
}
