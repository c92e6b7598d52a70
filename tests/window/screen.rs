//! An X server without a screen, and the program on it.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use image::RgbImage;

/// A scene of the reference suite.
pub fn reference(name: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    root.join("tests/reference")
        .join(name)
        .join("scene.json")
        .display()
        .to_string()
}

/// Waits until `condition` holds; false after `seconds`.
pub fn wait_until(seconds: f64, mut condition: impl FnMut() -> bool) -> bool {
    let start = Instant::now();
    while start.elapsed().as_secs_f64() < seconds {
        if condition() {
            return true;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    false
}

/// The file in `folder` whose name ends in `end`, once it is there.
pub fn saved(folder: &Path, end: &str) -> PathBuf {
    let find = || {
        let entries = std::fs::read_dir(folder).expect("the folder");
        let paths = entries.filter_map(|e| e.ok().map(|e| e.path()));
        paths
            .filter(|p| {
                !p.file_name()
                    .is_some_and(|n| n.to_string_lossy().starts_with('.'))
            })
            .find(|p| p.to_string_lossy().ends_with(end))
    };
    assert!(
        wait_until(PATIENCE, || find().is_some()),
        "no file *{end} is written"
    );
    find().expect("a file")
}

/// Seconds after which something that is waited for counts as missing: many, for machines that do
/// other work beside the test.
const PATIENCE: f64 = 90.0;

/// Seconds in which a window must close.
pub const CLOSING: f64 = 2.0;

/// One screen at a time: programs that render on all cores would starve each other.
static ALONE: Mutex<()> = Mutex::new(());

/// The part of the screen that the picture fills beside the panel, at the tests' window size.
pub const WIDTH: u32 = 560;
pub const HEIGHT: u32 = 600;

/// A server of its own; it ends with the test.
pub struct Screen {
    server: Child,
    /// Its name, as in DISPLAY.
    pub display: String,
    _alone: MutexGuard<'static, ()>,
}

impl Screen {
    /// Nothing where the tools are not installed, which CI does not accept.
    pub fn start() -> Option<Self> {
        for tool in ["Xvfb", "xdotool", "import", "xclip"] {
            let found = Command::new(tool).arg("-help").output().is_ok();
            if !found {
                eprintln!(
                    "skipped: {tool} is missing; install xvfb, xdotool, imagemagick and xclip"
                );
                assert!(std::env::var_os("CI").is_none(), "CI must have {tool}");
                return None;
            }
        }
        let alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        let mut server = Command::new("Xvfb")
            .args([
                "-displayfd",
                "1",
                "-screen",
                "0",
                "1000x700x24",
                "-noreset",
                "-nolisten",
                "tcp",
            ])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("Xvfb starts");
        let mut line = String::new();
        let output = server.stdout.take().expect("its output");
        BufReader::new(output)
            .read_line(&mut line)
            .expect("the number of the display");
        Some(Self {
            server,
            _alone: alone,
            display: format!(":{}", line.trim()),
        })
    }

    /// The program on this screen, in `folder`.
    pub fn command(&self, folder: &Path) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_lightscope"));
        command
            .env("DISPLAY", &self.display)
            .env_remove("WAYLAND_DISPLAY")
            .env("XDG_CONFIG_HOME", folder.join("config"))
            .current_dir(folder)
            .stdin(Stdio::null());
        command
    }

    /// Runs a tool on this screen.
    fn tool(&self, name: &str, args: &[&str]) -> Output {
        Command::new(name)
            .args(args)
            .env("DISPLAY", &self.display)
            .output()
            .expect("the tool runs")
    }

    pub fn xdotool(&self, args: &[&str]) -> Output {
        self.tool("xdotool", args)
    }

    /// What the screen shows.
    pub fn picture(&self) -> RgbImage {
        let output = self.tool("import", &["-window", "root", "png:-"]);
        image::load_from_memory(&output.stdout)
            .expect("a picture of the screen")
            .to_rgb8()
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// The program in its window.
pub struct Program<'a> {
    screen: &'a Screen,
    child: Child,
    window: String,
}

impl<'a> Program<'a> {
    /// Starts it and waits for its window, which has the keyboard then.
    pub fn start(screen: &'a Screen, folder: &Path, scene: &str) -> Self {
        let mut command = screen.command(folder);
        command.arg(scene);
        Self::spawn(screen, command)
    }

    /// The same for a command.
    pub fn spawn(screen: &'a Screen, mut command: Command) -> Self {
        let child = command.spawn().expect("it starts");
        let mut program = Self {
            screen,
            child,
            window: String::new(),
        };
        let found = wait_until(30.0, || {
            let output = screen.xdotool(&["search", "--name", "lightscope"]);
            let ids = String::from_utf8_lossy(&output.stdout).into_owned();
            program.window = ids.lines().next().unwrap_or_default().to_owned();
            !program.window.is_empty()
        });
        assert!(found, "no window appears");
        program.resize(900, 640);
        program
    }

    pub fn key(&self, key: &str) {
        self.focus();
        self.screen.xdotool(&["key", key]);
    }

    /// Holds a key for `seconds`.
    pub fn hold(&self, key: &str, seconds: f64) {
        self.focus();
        self.screen.xdotool(&["keydown", key]);
        std::thread::sleep(Duration::from_secs_f64(seconds));
        self.screen.xdotool(&["keyup", key]);
    }

    /// Types a text as a hand does.
    pub fn type_text(&self, text: &str) {
        self.focus();
        self.screen.xdotool(&["type", "--delay", "60", text]);
    }

    fn focus(&self) {
        // Without a window manager nobody else gives the window the keyboard.
        self.screen
            .xdotool(&["windowfocus", "--sync", &self.window]);
    }

    /// Number of the window.
    pub fn window(&self) -> &str {
        &self.window
    }

    /// Takes the window from the screen, as minimising does.
    pub fn hide(&self) {
        self.screen
            .xdotool(&["windowunmap", "--sync", &self.window]);
    }

    /// Shows it again.
    pub fn unhide(&self) {
        self.screen.xdotool(&["windowmap", "--sync", &self.window]);
    }

    /// Turns the wheel by so many notches, forward if positive.
    pub fn wheel(&self, at: [i32; 2], notches: i32) {
        let [x, y] = at.map(|v| v.to_string());
        self.screen.xdotool(&["mousemove", &x, &y]);
        let button = if notches > 0 { "4" } else { "5" };
        let times = notches.unsigned_abs().to_string();
        self.screen
            .xdotool(&["click", "--repeat", &times, "--delay", "40", button]);
    }

    /// What is on the clipboard as a picture, if there is one.
    pub fn clipboard(&self) -> Option<RgbImage> {
        let args = ["-selection", "clipboard", "-t", "image/png", "-o"];
        let output = self.screen.tool("xclip", &args);
        Some(image::load_from_memory(&output.stdout).ok()?.to_rgb8())
    }

    pub fn resize(&self, width: u32, height: u32) {
        let (w, h) = (width.to_string(), height.to_string());
        self.screen.xdotool(&["windowsize", &self.window, &w, &h]);
    }

    /// Drags with a button from `from` by `by`, in a few steps as a hand does.
    pub fn drag(&self, button: &str, from: [i32; 2], by: [i32; 2]) {
        let at = |share: i32| {
            let x = from[0] + by[0] * share / 4;
            let y = from[1] + by[1] * share / 4;
            self.screen
                .xdotool(&["mousemove", &x.to_string(), &y.to_string()]);
            std::thread::sleep(Duration::from_millis(30));
        };
        at(0);
        self.screen.xdotool(&["mousedown", button]);
        (1..=4).for_each(at);
        self.screen.xdotool(&["mouseup", button]);
    }

    /// What lies left of the panel.
    pub fn picture(&self) -> RgbImage {
        let screen = self.screen.picture();
        image::imageops::crop_imm(&screen, 0, 0, WIDTH, HEIGHT).to_image()
    }

    /// Waits until something bright is shown where the picture is.
    pub fn wait_for_picture(&self) {
        let seen = wait_until(30.0, || mean(&self.picture()) > 20.0);
        assert!(seen, "no picture appears");
    }

    /// Waits until the picture changes no more but for its noise.
    pub fn settle(&self) -> RgbImage {
        let mut last = self.picture();
        let mut quiet = 0;
        let settled = wait_until(PATIENCE, || {
            std::thread::sleep(Duration::from_millis(500));
            let now = self.picture();
            quiet = if difference(&last, &now) < 1.0 {
                quiet + 1
            } else {
                0
            };
            last = now;
            quiet == 3
        });
        assert!(settled, "the picture does not settle");
        last
    }

    /// Waits until the picture satisfies `condition`.
    pub fn wait_for(&self, what: &str, condition: impl Fn(&RgbImage) -> bool) {
        let seen = wait_until(PATIENCE, || condition(&self.picture()));
        if !seen {
            let path = std::env::temp_dir().join("lightscope-window.png");
            let _ = self.picture().save(&path);
            panic!("{what}: not seen; the last picture is {}", path.display());
        }
    }

    /// Closes the window, which must be quick and leave no error.
    pub fn quit(&mut self) {
        self.key("ctrl+q");
        assert!(wait_until(CLOSING, || self.has_ended()), "it does not end");
        assert_eq!(self.exit_code(), Some(0));
    }

    pub fn has_ended(&mut self) -> bool {
        matches!(self.child.try_wait(), Ok(Some(_)))
    }

    pub fn exit_code(&mut self) -> Option<i32> {
        self.child.wait().ok()?.code()
    }
}

impl Drop for Program<'_> {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Mean of all bytes.
pub fn mean(image: &RgbImage) -> f64 {
    let sum: u64 = image.as_raw().iter().map(|b| u64::from(*b)).sum();
    sum as f64 / image.as_raw().len() as f64
}

/// Mean absolute difference of pictures that were averaged over blocks first, so that noise does
/// not count.
pub fn difference(a: &RgbImage, b: &RgbImage) -> f64 {
    let filter = image::imageops::FilterType::Triangle;
    let small = |i: &RgbImage| image::imageops::resize(i, 16, 16, filter);
    let (a, b) = (small(a), small(b));
    let pairs = a.as_raw().iter().zip(b.as_raw());
    let sum: f64 = pairs.map(|(a, b)| f64::from(a.abs_diff(*b))).sum();
    sum / a.as_raw().len() as f64
}
