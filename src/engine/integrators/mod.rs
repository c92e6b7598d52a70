//! Algorithms that estimate the rendering equation, and the table that drives command line,
//! window and tests.
//!
//! Adding one is a file with an [`Entry`] and a line in [`REGISTRY`].

pub mod bdpt;
pub mod bidirectional;
pub mod give_way;
pub mod light;
pub mod monte_carlo;
pub mod params;
pub mod pass;
pub mod path;
pub mod photon;
pub mod pssmlt;
pub mod pyramid;
pub mod replay;
pub mod sppm;
pub mod stats;
pub mod tiled;
pub mod vcm;
pub mod whitted;

pub use give_way::{GiveWay, Hold};
pub use params::{ParamKind, ParamSpec, ParamValue, Params};
pub use pass::{Cancel, Cancelled, Pass};
pub use photon::PhotonView;
pub use replay::{Recording, ReplayError, SampleId};
pub use stats::{BadSample, RenderStats};

use std::borrow::Cow;

use crate::engine::film::Film;
use crate::engine::scene::features::SceneFeatures;

/// One algorithm, prepared for one job.
pub trait Integrator: Send + Sync {
    /// Computes one pass, one more sample of every pixel, and adds it to `film`.
    ///
    /// # Errors
    /// [`Cancelled`] if the job was replaced meanwhile; the film is then as it was.
    fn render_pass(&mut self, pass: &Pass<'_>, film: &mut Film) -> Result<RenderStats, Cancelled>;

    /// Takes other parameters and keeps what does not depend on them. False if it keeps nothing:
    /// it is then built anew.
    fn update(&mut self, _params: &Params) -> bool {
        false
    }

    /// Whether it cannot deliver a picture of this view while the camera moves: a path-traced
    /// preview, labelled so, then stands in.
    fn needs_preview(&self, _pass: &Pass<'_>) -> bool {
        false
    }

    /// Computes one sample again, by the code that renders, and writes its steps down; `cx` is
    /// its pass.
    ///
    /// # Errors
    /// Why it cannot, in one sentence; or [`Cancelled`], as in a pass.
    fn replay(
        &mut self,
        cx: &Pass<'_>,
        sample: &SampleId,
        to: &mut Recording,
    ) -> Result<(), ReplayError>;

    /// What it prepared, for the user to read.
    fn facts(&self) -> Vec<Fact> {
        Vec::new()
    }

    /// Memory it holds from pass to pass, in bytes, as far as it grows with picture or scene.
    fn memory_bytes(&self) -> usize {
        0
    }

    /// Its photons, for display.
    fn photons(&self) -> Option<PhotonView> {
        None
    }
}

/// A line about what an integrator prepared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fact {
    /// What.
    pub label: &'static str,
    /// Counts and sizes, in words.
    pub value: String,
}

/// All that is known of an integrator without running it.
pub struct Entry {
    /// Id on the command line.
    pub id: &'static str,
    /// Name in the window.
    pub label: &'static str,
    /// One sentence: when to use it, when not.
    pub summary: &'static str,
    /// Its parameters.
    pub params: &'static [ParamSpec],
    /// The words it cannot find in a scene of these features, as an expression, with the reason.
    pub missing: fn(&SceneFeatures, &Params) -> Option<Missing>,
    /// Whether it renders participating media; scenes that hold some are refused otherwise.
    pub media: bool,
    /// Prepares it.
    pub build: fn(&Params) -> Box<dyn Integrator>,
}

impl Entry {
    /// Why it cannot render a scene of these features at all, in one sentence.
    pub fn refusal(&self, features: &SceneFeatures) -> Option<String> {
        if self.media || !features.media {
            return None;
        }
        let able = REGISTRY.iter().filter(|entry| entry.media);
        let ids: Vec<&str> = able.map(|entry| entry.id).collect();
        Some(format!(
            "{} does not know participating media, and this scene has some; choose one of {}",
            self.id,
            ids.join(", ")
        ))
    }
}

/// Paths that no strategy of an integrator can find.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Missing {
    /// An expression that the lost words match.
    pub words: Cow<'static, str>,
    /// Why, in one sentence.
    pub why: Cow<'static, str>,
}

/// Every integrator, in the order of the window's list.
pub const REGISTRY: &[Entry] = &[
    path::ENTRY,
    whitted::ENTRY,
    monte_carlo::ENTRY,
    light::ENTRY,
    bdpt::ENTRY,
    pssmlt::ENTRY,
    photon::ENTRY,
    sppm::ENTRY,
    vcm::ENTRY,
];

/// The parameter that [`tiled::SamplerKind`] reads.
const SAMPLER_PARAM: ParamSpec = ParamSpec {
    name: "sampler",
    kind: ParamKind::Choice(&["sobol", "independent"]),
    default: "sobol",
    unit: "",
    matters: |_| true,
    doc: "Owen-scrambled Sobol points, or independent random numbers.",
};

/// The integrator of that id.
pub fn find(id: &str) -> Option<&'static Entry> {
    REGISTRY.iter().find(|e| e.id == id)
}
