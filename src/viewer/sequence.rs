//! A scene that is a sequence: which of its frames is shown, and when the next is due.

use super::workspace::{Request, Workspace};

/// Frames a second where the machine renders quickly enough: what films have.
const RATE: f64 = 24.0;
/// Most samples of each pixel that a frame may wait for.
pub const MAX_PASSES: u64 = 4096;

/// The frame that is shown, and how the next ones follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sequence {
    /// The frame shown, from 0.
    pub at: u32,
    /// They follow one another.
    pub plays: bool,
    /// Passes that each is shown with at least.
    pub passes: u64,
    /// Pictures that had been shown when the frame came: none of them is of it.
    came_at: u64,
    /// When the frame is old enough for the next.
    since: Option<f64>,
}

impl Default for Sequence {
    fn default() -> Self {
        Self {
            at: 0,
            plays: false,
            passes: 1,
            came_at: 0,
            since: None,
        }
    }
}

impl Sequence {
    /// Frame `at` came after `pictures` pictures.
    pub fn show(&mut self, at: u32, pictures: u64) {
        (self.at, self.came_at, self.since) = (at, pictures, None);
    }

    /// Whether the last of `pictures` pictures is of the frame that came last.
    pub fn is_shown_by(&self, pictures: u64) -> bool {
        pictures > self.came_at
    }
}

/// Asks for the next frame when it is due at the time `now`, in seconds; the time until then.
pub fn play(workspace: &mut Workspace, now: f64) -> Option<f64> {
    let count = workspace.scene.as_ref()?.frames.filter(|n| *n > 1)?;
    let sequence = &mut workspace.sequence;
    let reads = workspace.loading.is_some() || !workspace.requests.is_empty();
    if !sequence.plays || workspace.paused || reads {
        return None;
    }
    let since = *sequence.since.get_or_insert(now);
    let frame = workspace.frame.as_ref()?;
    let is_of_it = sequence.is_shown_by(workspace.frame_number) && !frame.is_coarse();
    if !is_of_it || frame.passes < sequence.passes {
        return None; // a picture wakes the window
    }
    let wait = since + 1.0 / RATE - now;
    if wait > 0.0 {
        return Some(wait);
    }
    let next = (sequence.at + 1) % count;
    workspace.requests.push(Request::Frame(next));
    None
}
