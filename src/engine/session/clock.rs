//! Wall and process time of a job.

use std::time::Duration;

use cpu_time::ProcessTime;
use std::time::Instant;

/// Measures `t_wall` and `t_cpu` from the moment a job is accepted; pauses are left out.
#[derive(Clone, Copy, Debug)]
pub struct RenderClock {
    wall: Duration,
    cpu: Duration,
    running: Option<(Instant, ProcessTime)>,
}

impl RenderClock {
    /// Starts now.
    pub fn start() -> Self {
        Self {
            wall: Duration::ZERO,
            cpu: Duration::ZERO,
            running: Some(now()),
        }
    }

    /// Stands still until [`Self::resume`].
    pub fn pause(&mut self) {
        if let Some((wall, cpu)) = self.running.take() {
            self.wall += wall.elapsed();
            self.cpu += cpu.elapsed();
        }
    }

    /// Goes on.
    pub fn resume(&mut self) {
        self.running.get_or_insert_with(now);
    }

    /// `t_wall` in seconds.
    pub fn wall(&self) -> f64 {
        (self.wall + self.running.map_or(Duration::ZERO, |(w, _)| w.elapsed())).as_secs_f64()
    }

    /// `t_cpu` in seconds.
    pub fn cpu(&self) -> f64 {
        (self.cpu + self.running.map_or(Duration::ZERO, |(_, c)| c.elapsed())).as_secs_f64()
    }
}

fn now() -> (Instant, ProcessTime) {
    (Instant::now(), ProcessTime::now())
}
