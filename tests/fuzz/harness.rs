//! Runs a target over many inputs and judges it.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use super::allocator::peak_of;
use super::mutate::{Numbers, mutated};

/// What is tried.
pub struct Target {
    /// Its name; the inputs depend on it.
    pub name: &'static str,
    /// What inputs are made from.
    pub corpus: Vec<Vec<u8>>,
    /// Words of its language.
    pub words: &'static [&'static str],
    /// Inputs of an ordinary run.
    pub count: u64,
    /// Most memory in bytes: what any input may take, and more for each byte of it.
    pub memory: (usize, usize),
    /// Tries an input; whether it was sound.
    pub run: fn(&[u8]) -> bool,
    /// Least share of the inputs that is sound: what is refused at once tells little.
    pub sound: f64,
}

/// An input that takes longer hangs. Other work may slow the machine down.
const HANG: Duration = Duration::from_secs(20);

impl Target {
    /// Tries the number of inputs that is asked for.
    pub fn fuzz(&self) {
        let times = std::env::var("LIGHTSCOPE_FUZZ").ok();
        let times: f64 = times.map_or(1.0, |t| t.parse().expect("LIGHTSCOPE_FUZZ is a number"));
        let count = (self.count as f64 * times) as u64;
        let trace = std::env::var_os("LIGHTSCOPE_FUZZ_TRACE").is_some();
        let watch = Watch::start(self.name);
        for input in &self.corpus {
            watch.look_at(input);
            let (_, sound) = self.try_input(input, u64::MAX);
            assert!(
                sound,
                "{} refuses its corpus: {:?}",
                self.name,
                String::from_utf8_lossy(input)
            );
        }
        let (mut most, mut share, mut sound) = (0, 0.0_f64, 0);
        let started = Instant::now();
        for number in 0..count {
            let mut numbers = Numbers::new(self.name, number);
            let input = mutated(&self.corpus, self.words, &mut numbers);
            if trace {
                keep(self.name, &input);
            }
            watch.look_at(&input);
            let (peak, was_sound) = self.try_input(&input, number);
            sound += u64::from(was_sound);
            let beyond = peak.saturating_sub(self.memory.0);
            share = share.max(beyond as f64 / input.len().max(1) as f64);
            most = most.max(peak);
        }
        let seconds = started.elapsed().as_secs_f64();
        println!(
            "{}: {count} inputs in {seconds:.1} s; at most {most} bytes of memory, beyond the first {} \
             {share:.0} a byte of input",
            self.name, self.memory.0
        );
        let sound = sound as f64 / count.max(1) as f64;
        println!("{}: {:.1} % are sound", self.name, 100.0 * sound);
        assert!(sound >= self.sound, "{}: only {sound} are sound", self.name);
    }

    fn try_input(&self, input: &[u8], number: u64) -> (usize, bool) {
        let mut outcome = Ok(false);
        let peak = peak_of(|| {
            outcome = catch_unwind(AssertUnwindSafe(|| (self.run)(input))).map_err(|_| ());
        });
        let limit = self.memory.0 + self.memory.1 * input.len();
        if outcome.is_err() || peak > limit {
            let path = keep(self.name, input);
            let what = match outcome {
                Err(()) => "panics".to_owned(),
                Ok(_) => format!("takes {peak} bytes, more than {limit}"),
            };
            panic!(
                "{} {what} on input {number} of {} bytes, {}:\n{}",
                self.name,
                input.len(),
                path.display(),
                String::from_utf8_lossy(&input[..input.len().min(2000)])
            );
        }
        (peak, outcome == Ok(true))
    }
}

/// Writes an input down.
fn keep(name: &str, input: &[u8]) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("fuzz-{name}"));
    fs::write(&path, input).expect("the input can be written");
    path
}

/// Ends the process if an input takes too long: there is no other way out of a loop.
struct Watch(Arc<Mutex<Option<Tried>>>);

/// Since when an input is tried.
type Tried = (Instant, Vec<u8>);

impl Watch {
    fn start(name: &'static str) -> Self {
        let current = Arc::new(Mutex::new(None::<Tried>));
        let watched = Arc::downgrade(&current);
        std::thread::spawn(move || {
            while let Some(current) = watched.upgrade() {
                let late = current.lock().expect("no panic within").clone();
                if let Some((since, input)) = late
                    && since.elapsed() > HANG
                {
                    let path = keep(name, &input);
                    eprintln!("{name} hangs on {}", path.display());
                    std::process::abort();
                }
                drop(current);
                std::thread::sleep(Duration::from_millis(500));
            }
        });
        Self(current)
    }

    fn look_at(&self, input: &[u8]) {
        let mut current = self.0.lock().expect("no panic within");
        let (since, bytes) = current.get_or_insert_with(|| (Instant::now(), Vec::new()));
        *since = Instant::now();
        bytes.clear();
        bytes.extend_from_slice(input);
    }
}
