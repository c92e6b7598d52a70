//! What the figures were measured on.

use serde::Serialize;

/// The machine and the program.
#[derive(Clone, Debug, Serialize)]
pub struct Machine {
    /// Name of the processor, where the system tells it.
    pub processor: String,
    /// Threads of the machine.
    pub cores: usize,
    /// Threads that rendered.
    pub threads: usize,
    /// Operating system and instruction set.
    pub system: String,
    /// Version of this program.
    pub version: &'static str,
}

impl Machine {
    /// This one.
    pub fn this() -> Self {
        let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let named = |line: &&str| line.starts_with("model name");
        let name = info
            .lines()
            .find(named)
            .and_then(|line| line.split_once(':'));
        Self {
            processor: name.map_or("unknown".to_owned(), |(_, n)| n.trim().to_owned()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            threads: rayon::current_num_threads(),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            version: env!("CARGO_PKG_VERSION"),
        }
    }
}
