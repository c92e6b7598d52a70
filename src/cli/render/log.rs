//! The log of a render: a line of JSON a pass, and errors against a reference.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use glam::UVec2;
use serde::Serialize;

use crate::cli::error::CliError;
use crate::cli::picture;
use crate::engine::film::Frame;
use crate::engine::measure::Metrics;
use crate::engine::session::Renderer;

/// Where passes are written down; it may do nothing.
pub struct Log {
    file: Option<(PathBuf, BufWriter<File>)>,
    reference: Option<Vec<[f32; 3]>>,
    frame: Option<Frame>,
    last: Option<Metrics>,
}

#[derive(Serialize)]
struct Line {
    t_wall: f64,
    t_cpu: f64,
    pass: u64,
    spp: u64,
    rays: u64,
    #[serde(flatten)]
    errors: Option<Errors>,
}

#[derive(Serialize)]
struct Errors {
    rmse: f64,
    relmse: f64,
    nmse: Option<f64>,
}

impl Log {
    /// Opens the file and reads the reference, which must have `size` pixels.
    pub fn open(
        file: Option<&Path>,
        reference: Option<&Path>,
        size: UVec2,
    ) -> Result<Self, CliError> {
        let reference = reference
            .map(|path| whole_of_size(path, size))
            .transpose()?;
        let file = file.map(|path| {
            let file = File::create(path).map_err(|error| cannot_write(path, &error))?;
            Ok((path.to_owned(), BufWriter::new(file)))
        });
        Ok(Self {
            file: file.transpose()?,
            reference,
            frame: None,
            last: None,
        })
    }

    /// Writes down the pass that was just completed. The clock stands still meanwhile.
    pub fn pass(&mut self, renderer: &mut Renderer) -> Result<(), CliError> {
        if self.file.is_none() {
            return Ok(());
        }
        renderer.clock().pause();
        self.evaluate(renderer);
        let (pass, rays) = (renderer.passes(), renderer.stats().rays);
        let (t_wall, t_cpu) = (renderer.clock().wall(), renderer.clock().cpu());
        let errors = self.last.map(|m| Errors {
            rmse: m.rmse,
            relmse: m.relmse,
            nmse: m.nmse,
        });
        let line = Line {
            t_wall,
            t_cpu,
            pass,
            spp: pass,
            rays,
            errors,
        };
        if let Some((path, file)) = &mut self.file {
            serde_json::to_writer(&mut *file, &line)
                .map_err(std::io::Error::from)
                .and_then(|()| file.write_all(b"\n"))
                .and_then(|()| file.flush())
                .map_err(|error| cannot_write(path, &error))?;
        }
        renderer.clock().resume();
        Ok(())
    }

    /// The errors of the last pass.
    pub fn finish(mut self, renderer: &Renderer) -> Option<Metrics> {
        self.evaluate(renderer);
        self.last
    }

    fn evaluate(&mut self, renderer: &Renderer) {
        let Some(reference) = &self.reference else {
            return;
        };
        let frame = self
            .frame
            .get_or_insert_with(|| Frame::empty(renderer.plan().clone()));
        renderer.snapshot(None, 0, frame);
        self.last = Metrics::new(&frame.layers[0].pixels, reference);
    }
}

fn whole_of_size(path: &Path, size: UVec2) -> Result<Vec<[f32; 3]>, CliError> {
    let reference = picture::read_reference(path)?;
    let (width, height) = (reference.size.x, reference.size.y);
    if reference.size != size {
        return Err(CliError::usage(format!(
            "the reference {} has {width}x{height} pixels, but the picture will have {}x{}; \
             `--size {width}x{height}` makes them equal",
            path.display(),
            size.x,
            size.y
        )));
    }
    let whole = reference
        .layers
        .into_iter()
        .find(|layer| layer.label == picture::WHOLE);
    whole.map(|layer| layer.pixels).ok_or_else(|| {
        CliError::usage(format!(
            "the reference {} has no channels R, G and B",
            path.display()
        ))
    })
}

fn cannot_write(path: &Path, error: &std::io::Error) -> CliError {
    CliError::failed(format!("{} cannot be written: {error}", path.display()))
}
