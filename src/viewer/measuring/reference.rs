//! What errors are measured against: a picture that was opened, or one that is rendered beside
//! the window.

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use glam::UVec2;

use super::Made;
use super::background::{Waker, Work};
use crate::engine::integrators::{Cancel, Entry, Params};
use crate::engine::io::image::{self, Encoding};
use crate::engine::math::hash::combine;
use crate::engine::measure::metrics::channel_means;
use crate::engine::measure::runs::RunMeans;
use crate::engine::session::{RenderJob, Renderer, Settings};
use crate::picture::exr_file;

/// Runs that a reference is made of, at least.
const RUNS: u64 = 8;

/// A reference.
pub struct Reference {
    /// Where it comes from.
    pub label: String,
    /// Its size.
    pub size: UVec2,
    /// Row by row from the top left.
    pub pixels: Vec<[f32; 3]>,
    /// Mean over pixels and channels.
    pub mean: f64,
    /// Its own standard error over its mean, where it is known.
    pub error: Option<f64>,
    /// The picture it was made for; one that was opened suits any of its size.
    of: Option<Made>,
}

impl Reference {
    fn new(label: String, size: UVec2, pixels: Vec<[f32; 3]>) -> Self {
        let mean = channel_means(&pixels).map_or(0.0, |m| m.iter().sum::<f64>() / 3.0);
        Self {
            label,
            size,
            pixels,
            mean,
            error: None,
            of: None,
        }
    }

    /// Reads one.
    ///
    /// # Errors
    /// A sentence.
    pub fn open(path: &Path) -> Result<Self, String> {
        let shown = path.display();
        let is_exr = path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("exr"));
        let label = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        if !is_exr {
            let image = image::read(path, Encoding::Linear).map_err(|error| error.to_string())?;
            let size = UVec2::new(image.width as u32, image.height as u32);
            return Ok(Self::new(label, size, image.pixels));
        }
        let picture =
            exr_file::read(path).map_err(|error| format!("{shown} cannot be read: {error}"))?;
        let size = picture.size;
        let whole = picture.whole().map(|whole| whole.pixels.clone());
        let whole = whole.ok_or_else(|| format!("{shown} has no channels R, G and B"))?;
        Ok(Self::new(label, size, whole))
    }

    /// Whether errors of that picture can be measured against it.
    pub fn suits(&self, made: &Made) -> bool {
        self.size == made.size && self.of.as_ref().is_none_or(|of| of.same_picture(made))
    }
}

/// A reference on its way.
pub struct Making {
    work: Work<Result<Reference, String>>,
    newest: Arc<AtomicU64>,
    /// Seconds it will take, about.
    pub seconds: f64,
    start: Instant,
    error: Arc<Mutex<Option<f64>>>,
}

impl Making {
    /// Renders what `made` shows with another algorithm for `seconds`: independent runs, so that
    /// its standard error is known. On half of the cores, so that the window's own render goes on.
    ///
    /// # Errors
    /// A sentence if the system refuses to start a thread.
    pub fn start(
        made: &Made,
        integrator: &'static Entry,
        seconds: f64,
        wake: &Waker,
    ) -> Result<Self, String> {
        let newest = Arc::new(AtomicU64::new(0));
        let cancel = Cancel::new(Arc::clone(&newest), 0);
        let error = Arc::new(Mutex::new(None));
        let (told, made, again) = (Arc::clone(&error), made.clone(), wake.clone());
        let work = move || {
            let threads = std::thread::available_parallelism().map_or(1, usize::from);
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads((threads / 2).max(1))
                .build()
                .map_err(|error| format!("the reference cannot be rendered: {error}"))?;
            pool.install(|| {
                make(&made, integrator, seconds, &cancel, |e| {
                    *told.lock().unwrap_or_else(PoisonError::into_inner) = e;
                    again.wake();
                })
            })
        };
        let work = Work::start("reference", wake, work)
            .ok_or("no thread can be started for the reference")?;
        Ok(Self {
            work,
            newest,
            seconds,
            start: Instant::now(),
            error,
        })
    }

    /// The reference, once.
    pub fn finished(&mut self) -> Option<Result<Reference, String>> {
        let done = self.work.finished()?;
        Some(done.unwrap_or_else(|()| Err("a bug stopped the reference".to_owned())))
    }

    /// Share that is done.
    pub fn share(&self) -> f32 {
        (self.start.elapsed().as_secs_f64() / self.seconds).min(1.0) as f32
    }

    /// Its standard error over its mean so far.
    pub fn error(&self) -> Option<f64> {
        *self.error.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Making {
    fn drop(&mut self) {
        self.newest.store(1, Ordering::Relaxed);
    }
}

fn make(
    made: &Made,
    integrator: &'static Entry,
    seconds: f64,
    cancel: &Cancel,
    mut tell: impl FnMut(Option<f64>),
) -> Result<Reference, String> {
    let params = if made.settings.integrator.id == integrator.id {
        made.settings.params.clone()
    } else {
        Params::defaults(integrator.params)
    };
    let mut layers = made.settings.layers.clone();
    (layers.components, layers.no_whole) = (false, false);
    layers.expressions.clear();
    let desc = crate::engine::scene::desc::CameraDesc {
        width: made.size.x,
        height: made.size.y,
        ..made.view
    };
    let mut job = RenderJob {
        scene: Arc::clone(&made.scene),
        camera: crate::engine::camera::Camera::new(&desc)?,
        size: made.size,
        settings: Settings {
            integrator,
            params,
            layers,
            seed: 0,
        },
        navigating: false,
    };
    let start = Instant::now();
    let end = start + Duration::from_secs_f64(seconds);
    let (mut runs, mut passes) = (RunMeans::default(), 0);
    // Never so short that there are not enough runs, never endless.
    while runs.runs() < 2 || Instant::now() < end {
        // Seeds that the window's own render does not have.
        job.settings.seed = combine(made.settings.seed, 0x7ef_0000 + runs.runs());
        let mut renderer = Renderer::new(&job).map_err(|error| error.to_string())?;
        while passes == 0 || renderer.passes() < passes {
            if renderer.render_pass(cancel).is_err() {
                return Err("the reference was given up".to_owned());
            }
            let long = renderer.clock().wall() >= seconds / RUNS as f64;
            if passes == 0 && long && renderer.passes().is_multiple_of(2) {
                passes = renderer.passes();
            }
        }
        runs.add(&renderer.frame().layers[..1]);
        tell(runs.relative_error());
    }
    let error = runs.relative_error();
    let known = runs.known().swap_remove(0);
    let label = format!(
        "{}, {} runs of {passes} samples",
        integrator.id,
        runs.runs()
    );
    Ok(Reference {
        error,
        of: Some(made.clone()),
        ..Reference::new(label, made.size, known.mean)
    })
}
