//! The window: a picture that converges, and a panel beside it.
//!
//! [`workspace::Workspace`] is everything the window knows, without threads, files or graphics;
//! `panels` draw and change it; `app` feeds it input, carries out what it asks for and hands its
//! [`model::Model`] to the render session, from which only immutable frames come back. The
//! picture is drawn by `gpu` within egui's render pass.

mod app;
mod balance;
pub mod browser;
pub mod commands;
pub mod display;
mod export;
mod exposure;
mod false_color;
mod files;
mod gpu;
pub mod history;
pub mod latency;
mod loader;
pub mod measuring;
pub mod model;
pub mod navigation;
pub mod notices;
pub mod opening;
pub mod panels;
pub mod photons;
pub mod picking;
mod plot_files;
pub mod preferences;
mod rendering;
mod saver;
pub mod sequence;
mod shown;
pub mod soak;
pub mod source;
pub mod state;
pub mod thumbnails;
mod watch;
pub mod workspace;

use std::fmt;
use std::time::Duration;

use winit::event_loop::EventLoop;

use app::{App, Wake};
use opening::Opening;
use source::Read;

/// Why there is no window.
#[derive(Debug)]
pub enum ViewError {
    /// No screen to open a window on.
    NoDisplay,
    /// Nothing that draws into a window.
    NoAdapter(String),
    /// Something else, in a sentence.
    Failed(String),
}

/// What works without a window.
const WAY_OUT: &str = "`lightscope render SCENE -o OUT.png` needs no window";

impl fmt::Display for ViewError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoDisplay => write!(
                f,
                "there is no display to open a window on (DISPLAY and WAYLAND_DISPLAY name none \
                 that answers); {WAY_OUT}"
            ),
            Self::NoAdapter(why) => write!(
                f,
                "no graphics driver can draw in a window ({why}); install one, such as Debian's \
                 mesa-vulkan-drivers, which works without a graphics card, or do without: {WAY_OUT}"
            ),
            Self::Failed(sentence) => f.write_str(sentence),
        }
    }
}

/// Opens the window and lets a random hand play with it for `length`.
///
/// # Errors
/// Without display or graphics driver.
pub fn soak(
    opening: Opening,
    read: Read,
    length: Duration,
    seed: u64,
) -> Result<soak::Report, ViewError> {
    let event_loop = event_loop()?;
    let mut app = App::new(opening, read, event_loop.create_proxy())?;
    app.soak(length, seed);
    show(event_loop, &mut app)?;
    Ok(app.report.take().unwrap_or_default())
}

/// Opens the window and returns when it is closed. `read` is what was read of the scene already,
/// so that a wrong one was refused before there is a window.
///
/// # Errors
/// Without display or graphics driver.
pub fn run(opening: Opening, read: Read) -> Result<(), ViewError> {
    let event_loop = event_loop()?;
    let mut app = App::new(opening, read, event_loop.create_proxy())?;
    app.use_preferences();
    show(event_loop, &mut app)
}

fn event_loop() -> Result<EventLoop<Wake>, ViewError> {
    EventLoop::<Wake>::with_user_event()
        .build()
        .map_err(|_| ViewError::NoDisplay)
}

fn show(event_loop: EventLoop<Wake>, app: &mut App) -> Result<(), ViewError> {
    event_loop
        .run_app(app)
        .map_err(|error| ViewError::Failed(format!("the window failed: {error}")))?;
    match app.error.take() {
        Some(error) => Err(error),
        None => Ok(()),
    }
}
