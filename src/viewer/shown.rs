//! What exists while there is a window: the window, the input it gets, and what draws in it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use egui_wgpu::winit::Painter;
use winit::dpi::LogicalSize;
use winit::event_loop::{ActiveEventLoop, EventLoopProxy, OwnedDisplayHandle};
use winit::window::Window;

use super::ViewError;
use super::app::Wake;
use super::gpu::painter;

/// Red, green, blue and opacity where no picture is yet.
const BACKGROUND: [f32; 4] = [0.1, 0.1, 0.1, 1.0];
/// For the test of lost devices: the number of the repaint after which the device is destroyed.
const LOSE_DEVICE: &str = "LIGHTSCOPE_TEST_LOSE_DEVICE";

/// A window and what draws in it.
pub struct Shown {
    /// The window.
    pub window: Arc<Window>,
    /// What the system tells it.
    pub input: egui_winit::State,
    /// Absent only while it is being replaced: a window has one surface at a time.
    painter: Option<Painter>,
    display: OwnedDisplayHandle,
    proxy: EventLoopProxy<Wake>,
    /// Set before the device is given up on purpose.
    closing: Arc<AtomicBool>,
    lose_in: Option<u32>,
}

impl Shown {
    /// Opens a window of `size` points.
    ///
    /// # Errors
    /// If there is no window or nothing that draws in it.
    pub fn open(
        context: &egui::Context,
        event_loop: &ActiveEventLoop,
        proxy: &EventLoopProxy<Wake>,
        [width, height]: [f32; 2],
    ) -> Result<Self, ViewError> {
        let attributes = Window::default_attributes()
            .with_title("lightscope")
            // Tools for people who do not see it want to know a window before it is shown.
            .with_visible(false)
            .with_inner_size(LogicalSize::new(width, height))
            .with_min_inner_size(LogicalSize::new(320.0, 240.0));
        let window = event_loop
            .create_window(attributes)
            .map_err(|error| ViewError::Failed(format!("no window can be opened: {error}")))?;
        let mut input = egui_winit::State::new(
            context.clone(),
            egui::ViewportId::ROOT,
            event_loop,
            Some(window.scale_factor() as f32),
            window.theme(),
            None,
        );
        input.init_accesskit(event_loop, &window, proxy.clone());
        window.set_visible(true);
        let lose_in = std::env::var(LOSE_DEVICE).ok();
        let mut shown = Self {
            window: Arc::new(window),
            input,
            painter: None,
            display: event_loop.owned_display_handle(),
            proxy: proxy.clone(),
            closing: Arc::default(),
            lose_in: lose_in.and_then(|text| text.parse().ok()),
        };
        shown.create_painter(context)?;
        Ok(shown)
    }

    fn create_painter(&mut self, context: &egui::Context) -> Result<(), ViewError> {
        self.closing = Arc::default();
        let (proxy, closing) = (self.proxy.clone(), Arc::clone(&self.closing));
        // An event loop that is gone no longer waits.
        let lost = move || {
            if !closing.load(Ordering::Relaxed) {
                let _ = proxy.send_event(Wake::DeviceLost);
            }
        };
        let proxy = self.proxy.clone();
        let failed = move |why| drop(proxy.send_event(Wake::DrawingFailed(why)));
        let display = self.display.clone();
        let painter = painter::create(context, display, &self.window, lost, failed)
            .map_err(ViewError::NoAdapter)?;
        if let Some(side) = painter.max_texture_side() {
            self.input.set_max_texture_side(side);
        }
        self.painter = Some(painter);
        Ok(())
    }

    /// Gives the device up and draws with a new one.
    ///
    /// # Errors
    /// If there is none.
    pub fn renew(&mut self, context: &egui::Context) -> Result<(), ViewError> {
        self.give_up();
        self.create_painter(context)?;
        if let Some(painter) = &self.painter {
            painter::upload_font(painter, context);
        }
        self.lose_in = None;
        Ok(())
    }

    fn give_up(&mut self) {
        self.closing.store(true, Ordering::Relaxed);
        self.painter = None;
    }

    /// Most pixels of a picture that the device holds in one buffer.
    pub fn max_pixels(&self) -> u64 {
        self.painter.as_ref().map_or(u64::MAX, painter::max_pixels)
    }

    /// Bytes of the shown layers on the device.
    pub fn picture_bytes(&self) -> u64 {
        self.painter.as_ref().map_or(0, painter::picture_bytes)
    }

    /// True if the device draws on the cores that render.
    pub fn is_software(&self) -> bool {
        self.painter.as_ref().is_some_and(painter::is_software)
    }

    /// The window has another size, at least a pixel each way.
    pub fn resize(&mut self, width: std::num::NonZeroU32, height: std::num::NonZeroU32) {
        if let Some(painter) = &mut self.painter {
            painter.on_window_resized(egui::ViewportId::ROOT, width, height);
        }
    }

    /// Draws what the panels gave out, and a copy of it for each of `captures`.
    pub fn paint(
        &mut self,
        primitives: &[egui::ClippedPrimitive],
        pixels_per_point: f32,
        textures: &mut egui::TexturesDelta,
        captures: Vec<egui::ScreenshotCallback>,
    ) {
        let Some(painter) = &mut self.painter else {
            return;
        };
        let captured = !captures.is_empty();
        painter.paint_and_update_textures(
            egui::ViewportId::ROOT,
            pixels_per_point,
            BACKGROUND,
            primitives,
            textures,
            captures,
            &self.window,
        );
        if captured {
            painter::wait(painter);
        }
        self.lose_in = self.lose_in.map(|n| n.saturating_sub(1));
        if self.lose_in == Some(0) {
            self.lose_in = None;
            painter::destroy_device(painter);
        }
    }

    /// Waits until all that was given to the device is drawn.
    pub fn wait(&self) {
        if let Some(painter) = &self.painter {
            painter::wait(painter);
        }
    }

    /// Prepares one more way to show the picture; false if all are there.
    pub fn warm_up(&self) -> bool {
        self.painter.as_ref().is_some_and(painter::warm_up)
    }
}

impl Drop for Shown {
    fn drop(&mut self) {
        self.give_up();
    }
}
