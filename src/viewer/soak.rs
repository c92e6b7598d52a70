//! A random hand on the real window, for minutes or hours: nothing may fail, and memory must not
//! grow. The hand is the same for the same seed; what is drawn meanwhile depends on the machine.

use std::fmt;
use std::time::{Duration, Instant};

use egui::{Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, PointerButton, TouchPhase};
use winit::dpi::LogicalSize;

use super::model::Model;
use super::shown::Shown;
use super::source::SceneSource;
use super::workspace::{Request, Workspace};
use crate::engine::integrators::{Params, REGISTRY};
use crate::engine::io::embedded;
use crate::engine::math::hash::combine;
use crate::engine::scene::features::SceneFeatures;

/// Time between two deeds.
const PAUSE: Duration = Duration::from_millis(40);
/// Deeds of a round.
const DEEDS: u32 = 100;
/// Time after a round in which everything is as it was at the start, so that memory compares.
const REST: Duration = Duration::from_secs(1);
/// Longest wait for a scene at the end of a round.
const PATIENCE: Duration = Duration::from_secs(60);
/// Window at rest, in points.
const HOME: [f32; 2] = [900.0, 640.0];
/// Rounds below which memory says nothing: in the first minute most is used for the first time.
const TELLING: usize = 18;
/// What memory may grow from the first half of the rounds to the second beside a share of it:
/// allocators and drivers keep some of what was freed.
const SLACK: u64 = 48 << 20;
/// That share.
const GROWTH: f64 = 0.05;
/// Keys that change what is shown, and what it does not hurt to press at any time.
const KEYS: [Key; 18] = [
    Key::Num0,
    Key::Num1,
    Key::Num2,
    Key::Num3,
    Key::Num4,
    Key::Num5,
    Key::F,
    Key::T,
    Key::X,
    Key::I,
    Key::P,
    Key::L,
    Key::Home,
    Key::Plus,
    Key::Minus,
    Key::Space,
    Key::F1,
    Key::Z,
];

/// What a soak found.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// How long it took, in seconds.
    pub seconds: f64,
    /// What the hand did.
    pub deeds: u64,
    /// Frames that arrived.
    pub frames: u64,
    /// Bytes of the process at the end of each round; empty where the system does not say.
    pub memory: Vec<u64>,
    /// Errors that the window showed.
    pub errors: Vec<String>,
}

impl Report {
    /// Medians of the memory of the first and of the second half of the rounds after the first
    /// third, which counts for nothing: most is used for the first time then. None after few rounds.
    pub fn halves(&self) -> Option<[u64; 2]> {
        if self.memory.len() < TELLING {
            return None;
        }
        let rounds = self.memory.get(self.memory.len().div_ceil(3)..)?;
        let (first, second) = rounds.split_at(rounds.len() / 2);
        Some([median(first)?, median(second)?])
    }

    /// Whether memory did not grow, as far as the system tells.
    pub fn is_flat(&self) -> bool {
        self.halves().is_none_or(|[first, second]| {
            second.saturating_sub(first) <= SLACK + (first as f64 * GROWTH) as u64
        })
    }

    /// Whether nothing is wrong.
    pub fn is_good(&self) -> bool {
        self.errors.is_empty() && self.frames > 0 && self.is_flat()
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mb = |bytes: u64| bytes as f64 / f64::from(1 << 20);
        writeln!(
            f,
            "{:.0} s, {} deeds of a random hand, {} frames, {} rounds",
            self.seconds,
            self.deeds,
            self.frames,
            self.memory.len()
        )?;
        match self.halves() {
            Some([first, second]) => writeln!(
                f,
                "memory at rest after a third of the time: median of one half {:.0} MiB, of the other {:.0} MiB: {}",
                mb(first),
                mb(second),
                if self.is_flat() { "flat" } else { "it grows" }
            )?,
            None => writeln!(
                f,
                "memory at rest: whether it grows is not known before {TELLING} rounds"
            )?,
        }
        write!(f, "MiB after each round:")?;
        self.memory
            .iter()
            .try_for_each(|&bytes| write!(f, " {:.0}", mb(bytes)))?;
        write!(f, "\nerrors: {}", self.errors.len())?;
        self.errors.iter().try_for_each(|e| write!(f, "\n  {e}"))
    }
}

/// Whether it says that an algorithm knows no media: the hand asks for what cannot be had, too.
fn is_refusal(sentence: &str) -> bool {
    let foggy = SceneFeatures {
        media: true,
        ..SceneFeatures::default()
    };
    let mut refusals = REGISTRY.iter().filter_map(|entry| entry.refusal(&foggy));
    refusals.any(|refusal| refusal == sentence)
}

fn median(values: &[u64]) -> Option<u64> {
    let mut sorted = values.to_vec();
    sorted.sort_unstable();
    sorted.get(sorted.len() / 2).copied()
}

/// What the hand is at.
#[derive(Clone, Copy, Debug)]
enum Stage {
    /// A round, with so many deeds done.
    Deeds(u32),
    /// Everything is put back; waits for the scene since then.
    Return(Instant),
    /// At rest until then.
    Rest(Instant),
}

/// The hand.
pub struct Soak {
    seed: u64,
    drawn: u64,
    start: Instant,
    length: Duration,
    next: Instant,
    stage: Stage,
    home: Model,
    report: Report,
}

impl Soak {
    /// Starts now, with the window as `home` says at rest.
    pub fn new(length: Duration, seed: u64, home: Model) -> Self {
        let now = Instant::now();
        Self {
            seed,
            drawn: 0,
            start: now,
            length,
            next: now,
            stage: Stage::Return(now),
            home,
            report: Report::default(),
        }
    }

    /// When something is to be done next.
    pub fn next(&self) -> Instant {
        self.next
    }

    /// A number below `n`.
    fn draw(&mut self, n: usize) -> usize {
        self.drawn += 1;
        (combine(self.seed, self.drawn) % n as u64) as usize
    }

    /// A number from `lo` to `hi`.
    fn between(&mut self, lo: f32, hi: f32) -> f32 {
        lo + (hi - lo) * self.draw(1 << 16) as f32 / 65_536.0
    }

    /// Does what is due. The report when the time is over.
    pub fn step(&mut self, workspace: &mut Workspace, shown: &mut Shown) -> Option<Report> {
        let now = Instant::now();
        if now < self.next {
            return None;
        }
        self.next = now + PAUSE;
        for (_, sentence) in workspace.notices.errors() {
            if !is_refusal(sentence) && !self.report.errors.contains(sentence) {
                self.report.errors.push(sentence.clone());
            }
        }
        match self.stage {
            Stage::Deeds(DEEDS..) => {
                self.put_back(workspace, shown);
                self.stage = Stage::Return(now);
            }
            Stage::Deeds(done) => {
                self.deed(workspace, shown);
                self.report.deeds += 1;
                self.stage = Stage::Deeds(done + 1);
            }
            Stage::Return(since) => {
                let reads = workspace.loading.is_some() || !workspace.requests.is_empty();
                let back = workspace.model.source == self.home.source;
                if !reads && back && workspace.frame.is_some() {
                    // The scene was read meanwhile: what else was changed is put back, too.
                    self.put_back(workspace, shown);
                    self.stage = Stage::Rest(now + REST);
                } else if !reads && !back {
                    // Another one was on its way when the first was asked for.
                    self.put_back(workspace, shown);
                } else if since.elapsed() > PATIENCE {
                    let sentence = "The first scene does not come back.".to_owned();
                    self.report.errors.push(sentence);
                    return Some(self.finish(workspace));
                }
            }
            Stage::Rest(until) if now < until => {}
            Stage::Rest(_) => {
                let memory = memory_stats::memory_stats();
                self.report
                    .memory
                    .extend(memory.map(|m| m.physical_mem as u64));
                if self.start.elapsed() >= self.length {
                    return Some(self.finish(workspace));
                }
                self.stage = Stage::Deeds(0);
            }
        }
        None
    }

    fn finish(&mut self, workspace: &Workspace) -> Report {
        self.report.seconds = self.start.elapsed().as_secs_f64();
        self.report.frames = workspace.frame_number;
        self.report.clone()
    }

    fn put_back(&self, workspace: &mut Workspace, shown: &Shown) {
        let [width, height] = HOME;
        let _ = shown
            .window
            .request_inner_size(LogicalSize::new(width, height));
        if workspace.model.source != self.home.source {
            let source = self.home.source.clone();
            workspace.requests.push(Request::Load(source));
        } else {
            let home = workspace.model.home;
            workspace.model = self.home.clone();
            workspace.model.home = home;
            workspace.model.view = home;
        }
        workspace.preferences.panel = true;
        (workspace.help, workspace.gallery, workspace.inspector) = (false, false, false);
        workspace.paused = false;
        workspace.hold = None;
    }

    fn deed(&mut self, workspace: &mut Workspace, shown: &mut Shown) {
        match self.draw(24) {
            0..8 => self.drag(workspace, shown),
            8..13 => self.resize(shown),
            13..18 => {
                let at = self.draw(KEYS.len());
                press(shown, KEYS[at]);
            }
            18..20 => {
                let entry = &REGISTRY[self.draw(REGISTRY.len())];
                let settings = &mut workspace.model.settings;
                settings.integrator = entry;
                settings.params = Params::defaults(entry.params);
            }
            20 => {
                let scenes = embedded::all();
                let id = scenes[self.draw(scenes.len())].id.to_owned();
                let source = SceneSource::Embedded(id);
                workspace.requests.push(Request::Load(source));
            }
            21 => self.wheel(workspace, shown),
            22 => press_with(shown, Key::Z, Modifiers::COMMAND),
            _ => press(shown, Key::G),
        }
    }

    /// A place on the picture, in points.
    fn place(&mut self, workspace: &Workspace, shown: &Shown) -> egui::Pos2 {
        let scale = shown.window.scale_factor() as f32;
        let area = workspace.area.as_vec2() / scale;
        let x = self.between(0.0, area.x.max(1.0));
        egui::pos2(x, self.between(0.0, area.y.max(1.0)))
    }

    /// Orbits or pans, sometimes without letting go until the next time.
    fn drag(&mut self, workspace: &Workspace, shown: &mut Shown) {
        let buttons = [
            PointerButton::Primary,
            PointerButton::Primary,
            PointerButton::Secondary,
        ];
        let button = buttons[self.draw(buttons.len())];
        let (from, to) = (self.place(workspace, shown), self.place(workspace, shown));
        let lets_go = self.draw(4) > 0;
        let press = |pos, pressed| Event::PointerButton {
            pos,
            button,
            pressed,
            modifiers: Modifiers::NONE,
        };
        let events = &mut shown.input.egui_input_mut().events;
        events.extend([
            Event::PointerMoved(from),
            press(from, true),
            Event::PointerMoved(to),
        ]);
        if lets_go {
            events.push(press(to, false));
        }
    }

    fn wheel(&mut self, workspace: &Workspace, shown: &mut Shown) {
        let at = self.place(workspace, shown);
        let notches = self.between(-3.0, 3.0);
        shown.input.egui_input_mut().events.extend([
            Event::PointerMoved(at),
            Event::MouseWheel {
                unit: MouseWheelUnit::Line,
                source: MouseWheelSource::Wheel,
                delta: egui::vec2(0.0, notches),
                phase: TouchPhase::Move,
                modifiers: Modifiers::NONE,
            },
        ]);
    }

    fn resize(&mut self, shown: &Shown) {
        let width = self.between(320.0, 1400.0);
        let height = self.between(240.0, 900.0);
        let _ = shown
            .window
            .request_inner_size(LogicalSize::new(width, height));
    }
}

fn press(shown: &mut Shown, key: Key) {
    press_with(shown, key, Modifiers::NONE);
}

fn press_with(shown: &mut Shown, key: Key, modifiers: Modifiers) {
    let event = |pressed| Event::Key {
        key,
        physical_key: None,
        pressed,
        repeat: false,
        modifiers,
    };
    let events = &mut shown.input.egui_input_mut().events;
    events.extend([event(true), event(false)]);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(memory: impl IntoIterator<Item = u64>) -> Report {
        Report {
            frames: 1,
            memory: memory.into_iter().map(|mb| mb << 20).collect(),
            ..Report::default()
        }
    }

    #[test]
    fn memory_that_grows_is_seen_and_noise_is_not() {
        let noise = (0..20).map(|round| 200 + [0, 30, -10, 10, 40][round % 5]);
        assert!(report(noise.map(|mb: i64| mb as u64)).is_good());
        let leak = report((0..20).map(|round| 200 + 20 * round));
        assert!(!leak.is_flat(), "{leak}");
        assert!(report([200, 500]).is_flat(), "two rounds say nothing");
    }

    #[test]
    fn an_error_or_no_picture_is_not_good() {
        let mut wrong = report([100, 100, 100]);
        wrong.errors.push("a".to_owned());
        assert!(!wrong.is_good());
        assert!(!Report::default().is_good());
    }
}
