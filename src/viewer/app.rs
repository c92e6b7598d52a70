//! The event loop: input goes to the workspace, what it asks for is carried out, and the window
//! is drawn again only when something changed.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use winit::application::ApplicationHandler;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoopProxy};
use winit::window::{Fullscreen, WindowId};

use super::ViewError;
use super::loader::Loader;
use super::measuring::background::Waker;
use super::opening::Opening;
use super::panels;
use super::preferences::{self, Preferences};
use super::rendering::Rendering;
use super::shown::Shown;
use super::soak::{Report, Soak};
use super::source::Read;
use super::thumbnails::{self, Thumbnail};
use super::watch::Watch;
use super::workspace::{Request, Workspace};

/// Time without input after which the window prepares for what may be asked next.
const REST: Duration = Duration::from_millis(400);
/// Time between two steps of that: a step may keep the graphics device for most of it.
const STEP: Duration = Duration::from_millis(150);

/// What wakes the event loop from other threads.
#[derive(Debug)]
pub enum Wake {
    /// A frame is there.
    Frame,
    /// A scene is there.
    Loaded,
    /// A file was written, or was not.
    Saved(Result<String, String>),
    /// The window was copied.
    Captured(Arc<egui::ColorImage>),
    /// The graphics device is gone.
    DeviceLost,
    /// It refuses something.
    DrawingFailed(String),
    /// A tool that reads windows aloud wants something.
    Accessibility(egui_winit::accesskit_winit::Event),
    /// A picture of the gallery.
    Thumbnail(Thumbnail),
}

impl From<egui_winit::accesskit_winit::Event> for Wake {
    fn from(event: egui_winit::accesskit_winit::Event) -> Self {
        Self::Accessibility(event)
    }
}

/// The program around the workspace.
pub struct App {
    pub(super) workspace: Workspace,
    pub(super) proxy: EventLoopProxy<Wake>,
    loader: Loader,
    rendering: Rendering,
    context: egui::Context,
    shown: Option<Shown>,
    repaint_at: Option<Instant>,
    /// An input waits for its answer.
    input_due: bool,
    /// When to prepare one more way to show the picture.
    warm_up_at: Option<Instant>,
    watch: Watch,
    wants_thumbnails: bool,
    capture: bool,
    /// Where preferences are kept, if they are.
    remembers: Option<PathBuf>,
    soak: Option<Soak>,
    /// What the random hand found.
    pub report: Option<Report>,
    pub(super) clipboard: Option<arboard::Clipboard>,
    /// Why the window could not open.
    pub error: Option<ViewError>,
}

impl App {
    /// Starts to load the scene of `opening`, of which `read` was read already.
    ///
    /// # Errors
    /// If the system refuses to start threads.
    pub fn new(
        opening: Opening,
        read: Read,
        proxy: EventLoopProxy<Wake>,
    ) -> Result<Self, ViewError> {
        // An event loop that is gone no longer waits.
        let wake = |proxy: &EventLoopProxy<Wake>, what: fn() -> Wake| {
            let proxy = proxy.clone();
            move || drop(proxy.send_event(what()))
        };
        let rendering = Rendering::new(wake(&proxy, || Wake::Frame)).map_err(ViewError::Failed)?;
        let context = egui::Context::default();
        panels::apply_style(&context);
        let waker = Waker::new(wake(&proxy, || Wake::Frame));
        let mut app = Self {
            workspace: Workspace::new(opening.source.clone()),
            loader: Loader::new(wake(&proxy, || Wake::Loaded)),
            proxy,
            rendering,
            context,
            shown: None,
            repaint_at: None,
            input_due: false,
            warm_up_at: None,
            watch: Watch::new(Vec::new()),
            wants_thumbnails: true,
            capture: false,
            remembers: None,
            soak: None,
            report: None,
            clipboard: None,
            error: None,
        };
        app.workspace.measuring.waker = waker;
        app.load(opening, Some(read), false);
        Ok(app)
    }

    /// Uses what was remembered of the last window, and remembers this one.
    pub fn use_preferences(&mut self) {
        self.remembers = preferences::file();
        if let Some(file) = &self.remembers {
            self.workspace.preferences = Preferences::load(file);
        }
    }

    /// A random hand plays with the window for `length`.
    pub fn soak(&mut self, length: Duration, seed: u64) {
        self.soak = Some(Soak::new(length, seed, self.workspace.model.clone()));
    }

    /// Lets the random hand do what is due.
    fn soak_step(&mut self, event_loop: &ActiveEventLoop) {
        let (Some(soak), Some(shown)) = (&mut self.soak, &mut self.shown) else {
            return;
        };
        if soak.next() > Instant::now() {
            return;
        }
        self.report = soak.step(&mut self.workspace, shown);
        if self.report.is_some() {
            event_loop.exit();
        }
        self.input_due = true;
        self.request_redraw();
    }

    /// Starts to read a scene.
    fn load(&mut self, opening: Opening, read: Option<Read>, again: bool) {
        self.workspace.loading = Some(opening.source.clone());
        if let Err(error) = self.loader.start(opening, read, again) {
            self.workspace.loading = None;
            self.workspace.notices.set_error("scene", error);
        }
    }

    fn open(&mut self, event_loop: &ActiveEventLoop) -> Result<(), ViewError> {
        let size = self.workspace.preferences.window;
        let shown = Shown::open(&self.context, event_loop, &self.proxy, size)?;
        self.workspace.max_pixels = shown.max_pixels();
        self.shown = Some(shown);
        self.touched();
        Ok(())
    }

    /// The user did something: what can wait does.
    fn touched(&mut self) {
        self.warm_up_at = Instant::now().checked_add(REST);
    }

    fn request_redraw(&self) {
        if let Some(shown) = &self.shown {
            shown.window.request_redraw();
        }
    }

    /// Takes over what other threads have made.
    fn take_news(&mut self) {
        if let Some(loaded) = self.loader.finished() {
            self.workspace.loading = None;
            let same = loaded.opening.source == self.workspace.model.source;
            match loaded.scene {
                Ok(scene) => {
                    self.watch = Watch::new(loaded.files);
                    let (opening, again) = (loaded.opening, loaded.again);
                    self.workspace
                        .show_scene(opening, scene, again, loaded.hash);
                }
                Err(sentence) => {
                    self.workspace.sequence.plays = false;
                    // The old scene stays; it is read again when one of its files is mended.
                    if same {
                        self.watch = Watch::new(loaded.files);
                    }
                    self.workspace.notices.set_error("scene", sentence);
                }
            }
            self.set_title();
        }
        if let Some(frame) = self.rendering.new_frame() {
            let made = self.rendering.made(&frame);
            self.workspace.show_frame(Arc::clone(&frame));
            if let Some(made) = made {
                self.workspace.measuring.observe(made, &frame);
            }
        }
    }

    fn set_title(&self) {
        if let Some(shown) = &self.shown {
            let name = self.workspace.model.source.short_name();
            shown.window.set_title(&format!("{name} – lightscope"));
        }
    }

    fn redraw(&mut self, event_loop: &ActiveEventLoop) {
        self.take_news();
        let Some(shown) = &mut self.shown else { return };
        let size = shown.window.inner_size();
        if size.width == 0 || size.height == 0 {
            return;
        }
        // Where software draws, an answer has all cores for itself.
        let hold = (std::mem::take(&mut self.input_due) && shown.is_software())
            .then(|| self.rendering.hold());
        let input = shown.input.take_egui_input(&shown.window);
        let workspace = &mut self.workspace;
        workspace.gpu_bytes = shown.picture_bytes();
        let mut output = self.context.run_ui(input, |ui| panels::show(ui, workspace));
        shown
            .input
            .handle_platform_output(&shown.window, output.platform_output);
        let delay = output
            .viewport_output
            .get(&egui::ViewportId::ROOT)
            .map_or(Duration::MAX, |viewport| viewport.repaint_delay);
        self.repaint_at = Instant::now().checked_add(delay);
        let scale = output.pixels_per_point;
        let primitives = self.context.tessellate(output.shapes, scale);
        let mut captures = Vec::new();
        if std::mem::take(&mut self.capture) {
            let proxy = self.proxy.clone();
            let send = move |image| drop(proxy.send_event(Wake::Captured(image)));
            captures.push(egui::ScreenshotCallback::new(send));
        }
        shown.paint(&primitives, scale, &mut output.textures_delta, captures);
        // A surface that had no picture is tried again.
        if self
            .context
            .has_requested_repaint_for(&egui::ViewportId::ROOT)
        {
            shown.window.request_redraw();
        }
        if hold.is_some() {
            shown.wait();
        }
        drop(hold);
        self.carry_out(event_loop);
        self.make_thumbnails();
        self.follow();
    }

    /// Hands the model to the render session where it changed.
    fn follow(&mut self) {
        self.rendering.set_paused(self.workspace.paused);
        let Some(scene) = self.workspace.scene.clone() else {
            return;
        };
        let (model, size) = (&self.workspace.model, self.workspace.pixels());
        let navigating = self.workspace.navigating;
        match self.rendering.follow(&scene, model, size, navigating) {
            Ok(()) => self.workspace.notices.clear_error("view"),
            Err(sentence) => self.workspace.notices.set_error("view", sentence),
        }
    }

    fn carry_out(&mut self, event_loop: &ActiveEventLoop) {
        let requests = std::mem::take(&mut self.workspace.requests);
        // While a lower resolution stands in for the picture, what takes it away waits.
        let (waiting, due): (Vec<Request>, Vec<Request>) = requests
            .into_iter()
            .partition(|request| request.needs_picture() && self.workspace.is_coarse());
        self.workspace.requests = waiting;
        for request in due {
            match request {
                Request::Load(source) => self.load(Opening::scene(source), None, false),
                Request::Open(path) => match Opening::file(&path) {
                    Ok(opening) => self.load(opening, None, false),
                    Err(sentence) => self.workspace.notices.set_error("scene", sentence),
                },
                Request::Reload => self.show_frame(self.workspace.sequence.at),
                Request::Frame(frame) => self.show_frame(frame),
                Request::SaveAs(path) => self.save_as(path),
                Request::Save(format) => self.save(format),
                Request::SavePlot(extension) => self.save_plot(extension),
                Request::SaveWindow => {
                    self.capture = true;
                    self.request_redraw();
                }
                Request::Copy => self.copy(),
                Request::FullScreen => self.toggle_full_screen(),
                Request::Quit => event_loop.exit(),
            }
        }
    }

    /// Reads a frame of the scene that is shown; of a still the only one, 0, again.
    fn show_frame(&mut self, frame: u32) {
        let source = self.workspace.model.source.clone();
        self.load(Opening::of_frame(source, frame), None, true);
    }

    /// Renders the gallery's pictures when they are wanted first.
    fn make_thumbnails(&mut self) {
        if self.workspace.gallery && std::mem::take(&mut self.wants_thumbnails) {
            let proxy = self.proxy.clone();
            thumbnails::start(move |t| proxy.send_event(Wake::Thumbnail(t)).is_ok());
        }
    }

    fn toggle_full_screen(&self) {
        if let Some(shown) = &self.shown {
            let next = match shown.window.fullscreen() {
                Some(_) => None,
                None => Some(Fullscreen::Borderless(None)),
            };
            shown.window.set_fullscreen(next);
        }
    }

    /// Makes everything on the graphics card anew.
    fn recover(&mut self, event_loop: &ActiveEventLoop) {
        let Some(shown) = &mut self.shown else {
            return;
        };
        // The gallery's pictures went with the device.
        self.workspace.textures.clear();
        match shown.renew(&self.context) {
            Ok(()) => {
                self.workspace.max_pixels = shown.max_pixels();
                self.workspace.notices.clear_error("graphics");
                self.workspace
                    .notices
                    .say("The graphics device was lost; the window goes on with a new one.");
                self.touched();
            }
            Err(error) => {
                self.error = Some(error);
                event_loop.exit();
            }
        }
    }

    fn accessibility(&mut self, event: egui_winit::accesskit_winit::WindowEvent) {
        use egui_winit::accesskit_winit::WindowEvent;
        match event {
            WindowEvent::InitialTreeRequested => self.context.enable_accesskit(),
            WindowEvent::AccessibilityDeactivated => self.context.disable_accesskit(),
            WindowEvent::ActionRequested(request) => {
                if let Some(shown) = &mut self.shown {
                    shown.input.on_accesskit_action_request(request);
                }
            }
        }
    }

    /// Prepares what may be asked next, one step at a time.
    fn warm_up(&mut self) {
        if self.warm_up_at.is_none_or(|at| at > Instant::now()) {
            return;
        }
        let more = match &self.shown {
            // The picture comes first.
            Some(shown) => self.workspace.frame.is_none() || shown.warm_up(),
            None => false,
        };
        self.warm_up_at = more.then(|| Instant::now() + STEP);
    }
}

impl ApplicationHandler<Wake> for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.shown.is_some() {
            return;
        }
        match self.open(event_loop) {
            Ok(()) => {
                self.set_title();
                self.request_redraw();
            }
            Err(error) => {
                self.error = Some(error);
                event_loop.exit();
            }
        }
    }

    fn user_event(&mut self, event_loop: &ActiveEventLoop, event: Wake) {
        match event {
            Wake::Frame | Wake::Loaded => {}
            Wake::Saved(Ok(sentence)) => self.workspace.notices.say(sentence),
            Wake::Saved(Err(sentence)) => self.workspace.notices.set_error("save", sentence),
            Wake::Captured(image) => self.save_window(&image),
            Wake::DeviceLost => self.recover(event_loop),
            Wake::DrawingFailed(why) => {
                // Told once: each repaint may fail in the same way.
                let graphics = ("graphics", why);
                if self.workspace.notices.errors().contains(&graphics) {
                    return;
                }
                self.workspace.notices.set_error(graphics.0, graphics.1);
            }
            Wake::Accessibility(event) => self.accessibility(event.window_event),
            Wake::Thumbnail(thumbnail) => self.workspace.thumbnails.push(thumbnail),
        }
        self.request_redraw();
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(shown) = &mut self.shown else { return };
        match &event {
            WindowEvent::CloseRequested => event_loop.exit(),
            WindowEvent::RedrawRequested => return self.redraw(event_loop),
            WindowEvent::Resized(size) => {
                let sides = std::num::NonZeroU32::new(size.width)
                    .zip(std::num::NonZeroU32::new(size.height));
                if let Some((width, height)) = sides {
                    let points = size.to_logical(shown.window.scale_factor());
                    self.workspace.preferences.window = [points.width, points.height];
                    shown.resize(width, height);
                }
            }
            _ => {}
        }
        if shown.input.on_window_event(&shown.window, &event).repaint {
            shown.window.request_redraw();
            self.input_due = true;
            self.touched();
        }
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        let due = self.repaint_at.is_some_and(|at| at <= Instant::now());
        if due {
            self.repaint_at = None;
            self.request_redraw();
        }
        if self.watch.changed(Instant::now()) {
            self.show_frame(self.workspace.sequence.at);
            self.request_redraw();
        }
        self.warm_up();
        self.soak_step(event_loop);
        let deed = self.soak.as_ref().map(Soak::next);
        let times = [
            self.repaint_at,
            self.watch.next_look(),
            self.warm_up_at,
            deed,
        ];
        event_loop.set_control_flow(match times.into_iter().flatten().min() {
            Some(at) => ControlFlow::WaitUntil(at),
            None => ControlFlow::Wait,
        });
    }

    fn exiting(&mut self, _: &ActiveEventLoop) {
        if let Some(file) = &self.remembers {
            self.workspace.preferences.save(file);
        }
    }
}
