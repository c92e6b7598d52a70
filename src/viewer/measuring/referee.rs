//! Two algorithms side by side on the same view, judged while they render.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use glam::UVec2;

use super::Made;
use super::background::{Waker, Work};
use super::overlay::Overlay;
use crate::engine::film::tonemap::{NAN_COLOR, tonemap};
use crate::engine::integrators::{Cancel, Entry, Params};
use crate::engine::measure::duel::Duel;
use crate::engine::measure::error_image::{ErrorImage, ErrorKind};
use crate::engine::measure::referee::{FIRST_LOOK, LayerFinding, Rules, Verdict};
use crate::engine::session::{RenderJob, Settings};
use crate::viewer::display::Display;

/// How the two sides are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Arrangement {
    /// The first left of the middle, the second right of it.
    #[default]
    Split,
    /// The same with a border that moves.
    Wipe,
    /// One of them, in turn.
    Flip,
    /// The first less the second.
    Difference,
    /// Differences of blocks in standard errors.
    ZMap,
}

impl Arrangement {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Split,
        Self::Wipe,
        Self::Flip,
        Self::Difference,
        Self::ZMap,
    ];

    /// Name in the window.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Split => "split",
            Self::Wipe => "wipe",
            Self::Flip => "flip",
            Self::Difference => "difference",
            Self::ZMap => "z-map",
        }
    }
}

/// What is known so far.
#[derive(Clone)]
pub struct State {
    /// What can be said.
    pub verdict: Verdict,
    /// Layer by layer.
    pub findings: Vec<LayerFinding>,
    /// Runs a side.
    pub runs: u64,
    /// Seconds of both sides together.
    pub seconds: f64,
    /// Names of the sides.
    pub names: [String; 2],
    size: UVec2,
    images: [Vec<[f32; 3]>; 2],
    z_map: Vec<f32>,
}

/// A match, or none.
#[derive(Default)]
pub struct Match {
    /// Index of the opponent in the registry.
    pub opponent: usize,
    /// How both sides are shown.
    pub arrangement: Arrangement,
    /// Where the border lies, a share of the width.
    pub border: f32,
    /// The second side is shown by itself.
    pub flipped: bool,
    /// What is drawn.
    pub overlay: Overlay,
    /// What is known so far.
    pub state: Option<Arc<State>>,
    /// What went wrong.
    pub complaint: Option<String>,
    running: Option<Running>,
    drawn: Option<Drawn>,
}

/// What the overlay was made from.
#[derive(Clone, PartialEq)]
struct Drawn {
    state: usize,
    arrangement: Arrangement,
    border: f32,
    flipped: bool,
    display: Display,
}

struct Running {
    work: Work<Result<(), String>>,
    newest: Arc<AtomicU64>,
    shared: Arc<Mutex<Option<Arc<State>>>>,
}

impl Drop for Running {
    fn drop(&mut self) {
        self.newest.store(1, Ordering::Relaxed);
    }
}

impl Match {
    /// Starts `made` against another algorithm with its default parameters.
    pub fn start(&mut self, made: &Made, opponent: &'static Entry, wake: &Waker) {
        (self.state, self.complaint, self.drawn) = (None, None, None);
        self.border = 0.5;
        let sides = [job(made, None), job(made, Some(opponent))];
        let [Ok(first), Ok(second)] = sides else {
            self.complaint = Some("The view makes no sense.".to_owned());
            return;
        };
        let name = |s: &Settings| s.integrator.id.to_owned();
        let names = [name(&first.settings), name(&second.settings)];
        let newest = Arc::new(AtomicU64::new(0));
        let cancel = Cancel::new(Arc::clone(&newest), 0);
        let shared = Arc::new(Mutex::new(None));
        let (told, again) = (Arc::clone(&shared), wake.clone());
        let duel = Duel::new([first, second], Rules::default(), None);
        let work = move || {
            let pool = rayon::ThreadPoolBuilder::new()
                .build()
                .map_err(|error| format!("The referee cannot start: {error}"))?;
            pool.install(|| run(duel, &names, &cancel, &told, &again))
        };
        self.running = Work::start("referee", wake, work).map(|work| Running {
            work,
            newest,
            shared,
        });
        if self.running.is_none() {
            self.complaint = Some("No thread can be started for the referee.".to_owned());
        }
    }

    /// Gives up; what is known stays.
    pub fn stop(&mut self) {
        self.running = None;
    }

    /// Whether it is at work.
    pub fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// Takes over what is known.
    pub fn poll(&mut self) {
        let Some(running) = &self.running else { return };
        let state = running
            .shared
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone();
        self.state = state.or(self.state.take());
        match running.work.finished() {
            None => {}
            Some(Ok(Ok(()))) => self.running = None,
            Some(Ok(Err(sentence))) => (self.running, self.complaint) = (None, Some(sentence)),
            Some(Err(())) => {
                self.running = None;
                self.complaint = Some("A bug stopped the referee.".to_owned());
            }
        }
    }

    /// Makes the overlay anew if anything about it has changed.
    pub fn draw(&mut self, display: &Display) {
        let Some(state) = self.state.clone() else {
            return;
        };
        let wanted = Drawn {
            state: Arc::as_ptr(&state) as usize,
            arrangement: self.arrangement,
            border: self.border,
            flipped: self.flipped,
            display: *display,
        };
        if self.drawn.as_ref() == Some(&wanted) {
            return;
        }
        self.drawn = Some(wanted);
        let [a, b] = &state.images;
        let border = match self.arrangement {
            Arrangement::Difference => {
                match ErrorImage::new(ErrorKind::Signed, state.size, a, b) {
                    Some(image) => self.overlay.set_error(&image),
                    None => self.overlay.clear(),
                }
                return;
            }
            Arrangement::ZMap => return self.overlay.set_z_map(state.size, &state.z_map),
            Arrangement::Flip if self.flipped => 0.0,
            Arrangement::Flip => 1.0,
            Arrangement::Split => 0.5,
            Arrangement::Wipe => self.border,
        };
        let edge = (border * state.size.x as f32).round() as usize;
        let width = state.size.x as usize;
        let shown = |i: usize| {
            let rgb = if i % width < edge { a[i] } else { b[i] };
            let nan = rgb.iter().any(|x| x.is_nan());
            let [r, g, b] = match nan {
                true => NAN_COLOR,
                false => tonemap(display.tonemap, display.exposure, rgb),
            };
            [r, g, b, 255]
        };
        let pixels = (0..a.len()).map(shown).collect();
        self.overlay.set(state.size, pixels, None);
    }
}

fn job(made: &Made, opponent: Option<&'static Entry>) -> Result<RenderJob, String> {
    let desc = crate::engine::scene::desc::CameraDesc {
        width: made.size.x,
        height: made.size.y,
        ..made.view
    };
    let mut settings = made.settings.clone();
    settings.layers.no_whole = false;
    if let Some(opponent) = opponent {
        settings.integrator = opponent;
        settings.params = Params::defaults(opponent.params);
    }
    Ok(RenderJob {
        scene: Arc::clone(&made.scene),
        camera: crate::engine::camera::Camera::new(&desc)?,
        size: made.size,
        settings,
        navigating: false,
    })
}

/// Renders until there is a verdict.
fn run(
    mut duel: Duel,
    names: &[String; 2],
    cancel: &Cancel,
    told: &Mutex<Option<Arc<State>>>,
    wake: &Waker,
) -> Result<(), String> {
    loop {
        match duel.step(cancel) {
            Err(error) => return Err(error.to_string()),
            // It was given up.
            Ok(Err(_)) => return Ok(()),
            Ok(Ok(())) => {}
        }
        let referee = duel.referee();
        let [Some(a), Some(b)] = [referee.image(0), referee.image(1)] else {
            continue;
        };
        let blocks = crate::engine::measure::blocks::grid(referee.size());
        let none = || vec![0.0; blocks.x as usize * blocks.y as usize];
        let state = State {
            verdict: referee.verdict(),
            findings: referee.findings().to_vec(),
            runs: referee.runs(),
            seconds: referee.seconds(),
            names: names.clone(),
            size: referee.size(),
            images: [a, b],
            z_map: referee.z_map(0).unwrap_or_else(none),
        };
        let decided = !matches!(state.verdict, Verdict::Needs(_));
        *told.lock().unwrap_or_else(PoisonError::into_inner) = Some(Arc::new(state));
        wake.wake();
        if decided {
            return Ok(());
        }
    }
}

/// The verdict in words.
pub fn sentence(state: &State) -> String {
    let [a, b] = &state.names;
    let rate = Rules::default().false_alarms * 100.0;
    match &state.verdict {
        Verdict::Agree => {
            let within = Rules::default().tolerance * 100.0;
            format!("{a} and {b} agree within {within} % of the mean.")
        }
        Verdict::Differ(layers) => format!(
            "{a} and {b} differ in {} (false alarms: {rate} %).",
            layers.join(", ")
        ),
        Verdict::Needs(seconds) if state.runs < FIRST_LOOK => format!(
            "Run {} of the {FIRST_LOOK} before the first verdict; {seconds:.0} s more.",
            state.runs
        ),
        Verdict::Needs(seconds) => format!("No difference yet; about {seconds:.0} s more."),
    }
}
