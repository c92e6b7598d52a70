//! Arguments as they are typed.

mod measuring;
mod replay;
mod stability;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use glam::UVec2;

use crate::engine::film::ToneMap;
use crate::engine::measure::Region;

use super::suggest::did_you_mean;
pub use measuring::{ReferenceArgs, ReportArgs};
pub use replay::ReplayArgs;
pub use stability::StabilityArgs;

/// Renders scenes by global illumination. Without a command it opens the window.
#[derive(Debug, Parser)]
#[command(version, args_conflicts_with_subcommands = true)]
pub struct Cli {
    /// Scene to open: an id of `lightscope list scenes`, or a file (.toml, .json, .obj).
    pub scene: Option<String>,
    /// What to do instead of opening the window.
    #[command(subcommand)]
    pub command: Option<Command>,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene into a file.
    Render(RenderArgs),
    /// Compare a picture with a reference, layer by layer.
    Compare(CompareArgs),
    /// Measure algorithms against each other and write a page about it.
    Report(ReportArgs),
    /// Render a reference: a picture whose standard error is known pixel by pixel.
    Reference(ReferenceArgs),
    /// Follow one sample of a render again, step by step.
    Replay(ReplayArgs),
    /// Prove the limits of this program on this machine: stiff and extreme cases.
    Stability(StabilityArgs),
    /// List what there is to choose from.
    List(ListArgs),
    /// Say what a scene or a picture holds.
    Info(InfoArgs),
    /// Measure how fast this machine renders.
    Bench(BenchArgs),
}

/// Arguments of `render`.
#[derive(Clone, Debug, Args)]
#[command(
    after_help = "Without --spp, --seconds and --error it computes 64 samples per pixel; \
                        with several of them it stops at the first one reached."
)]
pub struct RenderArgs {
    /// Scene: an id of `lightscope list scenes`, or a file (`./NAME` is always a file).
    pub scene: String,
    /// Picture to write; the name's end (.exr, .png, .hdr) chooses the format.
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Algorithm: an id of `lightscope list integrators`.
    #[arg(long, value_name = "ID", default_value = "path")]
    pub integrator: String,
    /// Parameter of the algorithm; may be repeated.
    #[arg(long, value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// Path expression such as `L.*DSE`, a layer of its own (EXR); may be repeated.
    #[arg(long, value_name = "EXPR")]
    pub expression: Vec<String>,
    /// Also write the layers direct, specular, caustic and indirect (EXR).
    #[arg(long)]
    pub components: bool,
    /// Leave out the whole picture and compute the layers alone (EXR).
    #[arg(long)]
    pub no_whole: bool,
    /// Stop after this many samples per pixel.
    #[arg(long, value_name = "N", value_parser = at_least_one, allow_negative_numbers = true)]
    pub spp: Option<u64>,
    /// Stop after this many seconds.
    #[arg(long, value_name = "T", value_parser = positive, allow_negative_numbers = true)]
    pub seconds: Option<f64>,
    /// Stop when the estimated RMSE divided by the image mean falls to this.
    #[arg(long, value_name = "E", value_parser = positive, allow_negative_numbers = true)]
    pub error: Option<f64>,
    /// Pixels, such as 640x480 [default: what the scene says].
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<UVec2>,
    /// Threads; 0 is one a core.
    #[arg(long, value_name = "N", default_value = "0", value_parser = threads, allow_negative_numbers = true)]
    pub threads: usize,
    /// Frames of a sequence, such as 0-47 or all; `#` in the output's name is their number.
    #[arg(long, value_name = "A-B")]
    pub frames: Option<String>,
    /// Seed of all random numbers.
    #[arg(
        long,
        value_name = "N",
        default_value = "0",
        value_parser = seed,
        allow_negative_numbers = true
    )]
    pub seed: u64,
    /// Most scattering events of a path; 0 shows emitters only [default: unlimited].
    #[arg(long, value_name = "N", value_parser = depth, allow_negative_numbers = true)]
    pub max_depth: Option<u32>,
    /// Exposure of a PNG in stops.
    #[arg(long, value_name = "EV", default_value_t = 0.0, value_parser = exposure, allow_negative_numbers = true)]
    pub exposure: f32,
    /// Tone map of a PNG: linear, reinhard, filmic or agx.
    #[arg(long, value_name = "ID", default_value = "linear", value_parser = tone_map)]
    pub tonemap: ToneMap,
    /// Reference picture; its errors go into the log and the last line.
    #[arg(long, value_name = "REF.exr")]
    pub reference: Option<PathBuf>,
    /// Write a line of JSON a pass: t_wall t_cpu pass spp rays, and rmse relmse nmse against the
    /// reference.
    #[arg(long, value_name = "FILE.jsonl")]
    pub log: Option<PathBuf>,
    /// Instead of the picture write those of every strategy of bidirectional path tracing, weighted
    /// and unweighted, for paths of up to N vertices: layers of an EXR, or a sheet as PNG.
    #[arg(long, value_name = "N", value_parser = vertices, allow_negative_numbers = true)]
    pub pyramid: Option<u64>,
    /// Print the final figures as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `compare`.
#[derive(Debug, Args)]
pub struct CompareArgs {
    /// The picture.
    #[arg(value_name = "A")]
    pub image: PathBuf,
    /// The reference: a picture, or a folder with ref.exr, direct.exr, …
    #[arg(value_name = "B")]
    pub reference: PathBuf,
    /// Compare a part of the pictures alone: left top pixel and size, such as 10,20,64x48.
    #[arg(long, value_name = "X,Y,WxH")]
    pub region: Option<Region>,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `list`.
#[derive(Debug, Args)]
pub struct ListArgs {
    /// What to list.
    #[arg(value_name = "scenes|integrators|cases")]
    pub what: Listing,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// What can be listed.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Listing {
    /// The scenes within the program.
    Scenes,
    /// The algorithms and their parameters.
    Integrators,
    /// The cases of `stability`.
    Cases,
}

/// Arguments of `info`.
#[derive(Debug, Args)]
pub struct InfoArgs {
    /// Scene id, scene file or picture (.exr, .png, .hdr).
    #[arg(value_name = "SCENE|IMAGE")]
    pub what: String,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `bench`.
#[derive(Debug, Args)]
pub struct BenchArgs {
    /// What to measure.
    #[command(subcommand)]
    pub what: Bench,
}

/// What can be measured.
#[derive(Debug, Subcommand)]
pub enum Bench {
    /// Time from a change of camera to the first picture.
    FirstFrame(FirstFrameArgs),
    /// Error of every integrator after the same time, on scenes with references.
    Integrators(BenchIntegratorsArgs),
    /// What a user of the window waits for: camera to picture, input to answer of the panels.
    #[cfg(feature = "viewer")]
    Latency(FirstFrameArgs),
    /// Noise and bias of photon mapping, apart and without a reference.
    NoiseBias(BenchNoiseBiasArgs),
    /// Time to build photon maps, and queries a second where eye rays land.
    Photons(BenchPhotonsArgs),
    /// Rays a second on one mesh, single-threaded.
    Rays(BenchRaysArgs),
    /// Error against time on scenes with references, single-threaded.
    Scenes(BenchScenesArgs),
    /// A random hand plays with the window: nothing may fail and memory must not grow.
    #[cfg(feature = "viewer")]
    Soak(BenchSoakArgs),
}

/// Arguments of `bench soak`.
#[cfg(feature = "viewer")]
#[derive(Debug, Args)]
pub struct BenchSoakArgs {
    /// How long, in seconds.
    #[arg(long, value_name = "T", default_value = "600", value_parser = at_least_one, allow_negative_numbers = true)]
    pub seconds: u64,
    /// Seed of what the hand does.
    #[arg(long, value_name = "N", default_value = "0")]
    pub seed: u64,
}

/// Arguments of `bench first-frame` and `bench latency`.
#[derive(Debug, Args)]
pub struct FirstFrameArgs {
    /// Scene: an id or a file.
    #[arg(long, default_value = super::scene::DEFAULT_SCENE)]
    pub scene: String,
    /// Pixels.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size)]
    pub size: UVec2,
    /// Changes of camera.
    #[arg(long, value_name = "N", default_value = "200", value_parser = at_least_one, allow_negative_numbers = true)]
    pub changes: u64,
    /// Threads; 0 is one a core.
    #[arg(long, value_name = "N", default_value = "0", value_parser = threads, allow_negative_numbers = true)]
    pub threads: usize,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `bench integrators`.
#[derive(Debug, Args)]
pub struct BenchIntegratorsArgs {
    /// Folders with scene.json and ref.exr, or pairs of a scene and its reference.
    #[arg(required = true, value_name = "DIR|SCENE=REF.exr")]
    pub scenes: Vec<String>,
    /// Seconds of each render by the clock; of several, one render is looked at after each.
    #[arg(long, value_name = "T,T…", value_delimiter = ',', default_value = "30", value_parser = positive, allow_negative_numbers = true)]
    pub seconds: Vec<f64>,
    /// Threads; 0 is one a core.
    #[arg(long, value_name = "N", default_value = "2", value_parser = threads, allow_negative_numbers = true)]
    pub threads: usize,
    /// Algorithms [default: all].
    #[arg(long, value_name = "ID,ID…", value_delimiter = ',')]
    pub integrators: Vec<String>,
    /// Parameter of one algorithm, such as photon.fresh-maps=on; may be repeated.
    #[arg(long, value_name = "ID.NAME=VALUE")]
    pub set: Vec<String>,
    /// What is compared: whole, direct, specular, caustic or indirect.
    #[arg(long, value_name = "LAYER", default_value = "whole")]
    pub layer: String,
    /// Compare the paths of an expression that the references hold as a layer, and compute these
    /// alone.
    #[arg(long, value_name = "EXPR", conflicts_with = "layer")]
    pub expression: Option<String>,
    /// Show K = 1000 · relMSE · CPU seconds in place of relMSE.
    #[arg(long)]
    pub efficiency: bool,
    /// Independent maps from which `photon` reports its own bias; 0: no report.
    #[arg(long, value_name = "N", default_value = "0", value_parser = maps, allow_negative_numbers = true)]
    pub bias_maps: u32,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `bench noise-bias`.
#[derive(Debug, Args)]
pub struct BenchNoiseBiasArgs {
    /// Scene: an id or a file.
    #[arg(long, default_value = super::scene::DEFAULT_SCENE)]
    pub scene: String,
    /// Parameter of photon mapping; may be repeated.
    #[arg(long, value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// Independent maps, at least two.
    #[arg(long, value_name = "N", default_value = "16", value_parser = at_least_one, allow_negative_numbers = true)]
    pub maps: u64,
    /// Threads; 0 is one a core.
    #[arg(long, value_name = "N", default_value = "0", value_parser = threads, allow_negative_numbers = true)]
    pub threads: usize,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `bench photons`.
#[derive(Debug, Args)]
pub struct BenchPhotonsArgs {
    /// Scene: an id or a file.
    #[arg(long, default_value = super::scene::DEFAULT_SCENE)]
    pub scene: String,
    /// Photons of each map.
    #[arg(long, value_name = "N,N…", value_delimiter = ',', default_value = "100000,1000000,10000000", value_parser = at_least_one, allow_negative_numbers = true)]
    pub photons: Vec<u64>,
    /// Photons of a query.
    #[arg(long, value_name = "N", default_value = "50", value_parser = at_least_one, allow_negative_numbers = true)]
    pub nearest: u64,
    /// Points that eye rays land on; each is a query.
    #[arg(long, value_name = "N", default_value = "100000", value_parser = at_least_one, allow_negative_numbers = true)]
    pub queries: u64,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `bench rays`.
#[derive(Debug, Args)]
pub struct BenchRaysArgs {
    /// Mesh (.obj).
    #[arg(value_name = "MESH.obj")]
    pub mesh: PathBuf,
    /// Rays: two little-endian u32 counts (primary, bounce), then six f32 a ray (origin, unit
    /// direction) [default: 512 × 512 rays of the mesh's own view, and a bounce of each].
    #[arg(long, value_name = "RAYS.bin")]
    pub rays: Option<PathBuf>,
    /// Repetitions, of which the best counts.
    #[arg(long, value_name = "N", default_value = "3", value_parser = at_least_one, allow_negative_numbers = true)]
    pub repeats: u64,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `bench scenes`.
#[derive(Debug, Args)]
pub struct BenchScenesArgs {
    /// Folders with scene.json and ref.exr.
    #[arg(required = true, value_name = "DIR")]
    pub folders: Vec<PathBuf>,
    /// Seconds of process time a scene.
    #[arg(long, value_name = "T", default_value = "10", value_parser = positive, allow_negative_numbers = true)]
    pub seconds: f64,
    /// Algorithm.
    #[arg(long, value_name = "ID", default_value = "path")]
    pub integrator: String,
    /// Parameter of the algorithm; may be repeated.
    #[arg(long, value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// Sides of pictures, and with them memory, stay within what the formats hold.
const MAX_SIDE: u32 = 65_536;
/// Most pixels: about 8192 × 8192.
const MAX_PIXELS: u64 = 1 << 26;
/// Most threads; more than any machine has cores.
const MAX_THREADS: usize = 1024;

fn seed(text: &str) -> Result<u64, String> {
    let right = "it must be a whole number from 0 to 18446744073709551615";
    text.parse().map_err(|_| right.to_owned())
}

fn depth(text: &str) -> Result<u32, String> {
    let right = "it must be a whole number of events, from 0 to 4294967295";
    text.parse().map_err(|_| right.to_owned())
}

fn at_least_one(text: &str) -> Result<u64, String> {
    match text.parse() {
        Ok(n) if n >= 1 => Ok(n),
        _ => Err("it must be a whole number of at least 1".to_owned()),
    }
}

/// The longest paths of a pyramid: n vertices have n strategies.
fn vertices(text: &str) -> Result<u64, String> {
    match text.parse() {
        Ok(n) if (2..=12).contains(&n) => Ok(n),
        _ => Err("it must be a whole number from 2 to 12".to_owned()),
    }
}

/// None, or enough to know the spread of.
fn maps(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(n) if n == 0 || (2..=10_000).contains(&n) => Ok(n),
        _ => Err("it must be 0 or a whole number from 2 to 10000".to_owned()),
    }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x > 0.0 && x.is_finite() => Ok(x),
        _ => Err("it must be a number above 0".to_owned()),
    }
}

fn threads(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(n) if n <= MAX_THREADS => Ok(n),
        _ => Err(format!(
            "it must be a whole number from 0 (one a core) to {MAX_THREADS}"
        )),
    }
}

fn exposure(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(ev) if ev.abs() <= 100.0 => Ok(ev),
        _ => Err("it must be a number of stops from -100 to 100".to_owned()),
    }
}

fn tone_map(text: &str) -> Result<ToneMap, String> {
    ToneMap::find(text).ok_or_else(|| {
        let ids = ToneMap::ALL.map(ToneMap::id);
        format!(
            "it must be one of {}{}",
            ids.join(", "),
            did_you_mean(text, ids)
        )
    })
}

fn size(text: &str) -> Result<UVec2, String> {
    let sides = text.split_once(['x', 'X', '×']);
    let parsed = sides.and_then(|(w, h)| Some(UVec2::new(w.parse().ok()?, h.parse().ok()?)));
    let Some(size) = parsed else {
        return Err("it must be width x height, such as 640x480".to_owned());
    };
    let pixels = u64::from(size.x) * u64::from(size.y);
    if pixels == 0 || size.max_element() > MAX_SIDE || pixels > MAX_PIXELS {
        return Err(format!(
            "both sides must lie between 1 and {MAX_SIDE}, and the picture may have at most \
             {MAX_PIXELS} pixels"
        ));
    }
    Ok(size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_description_of_the_arguments_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn sizes_are_read_and_bounded() {
        assert_eq!(size("640x480"), Ok(UVec2::new(640, 480)));
        assert_eq!(size("1X65536"), Ok(UVec2::new(1, 65_536)));
        for wrong in [
            "",
            "640",
            "x",
            "640x",
            "0x480",
            "640x-1",
            "65537x1",
            "65536x65536",
            "1e3x2",
        ] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn numbers_are_bounded() {
        assert_eq!((at_least_one("1"), positive("0.5")), (Ok(1), Ok(0.5)));
        assert!(at_least_one("0").is_err() && at_least_one("-1").is_err());
        assert!(
            ["0", "-1", "nan", "inf", "x"]
                .iter()
                .all(|t| positive(t).is_err())
        );
        assert!(threads("0").is_ok() && threads("1025").is_err());
        assert!(exposure("-3.5").is_ok() && exposure("NaN").is_err());
        assert!(tone_map("agx").is_ok());
        assert!(
            tone_map("filmc")
                .unwrap_err()
                .contains("did you mean \"filmic\"?")
        );
    }
}
