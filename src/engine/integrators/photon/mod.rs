//! Photon mapping (Jensen 1996, 2001): photons first, then a walk from the eye that ends at the
//! first diffuse event.
//!
//! There the light is found in four terms: `LD` by shadow rays, `L(S|G)+D` from the caustic map,
//! everything with another diffuse event from the global map directly, by gathering or from
//! interpolated gathers. What has no diffuse event is path traced. With a fixed map the picture is
//! biased and keeps the noise of the map; fresh maps a pass average the noise away, the bias of
//! their radius stays. Light of zero size that reaches the eye by mirrors alone is not found.

mod cache;
mod direct;
mod gather;
mod integrator;
mod noise_bias;
mod params;
mod view;
mod volume;
mod walk;

pub use gather::GatherRay;
pub use integrator::PhotonMapper;
pub use noise_bias::{NoiseBias, noise_and_bias};
pub use params::{Indirect, PhotonSettings};
pub use view::{PhotonQuery, PhotonView};

use super::{Entry, Missing, Params};
use crate::engine::scene::features::SceneFeatures;

/// Registry entry.
pub const ENTRY: Entry = Entry {
    id: "photon",
    label: "Photon mapping",
    summary: "The choice for caustics of small lights and for quick views of indirect light. \
              Biased: it blurs light over the radius of its photons.",
    params: params::PARAMS,
    missing,
    media: true,
    build: |params| Box::new(PhotonMapper::new(PhotonSettings::new(params))),
};

fn missing(features: &SceneFeatures, params: &Params) -> Option<Missing> {
    let settings = PhotonSettings::new(params);
    let shining = (
        "L.*(D|V).*E",
        "light that a medium emits sends no photons and no shadow rays",
    );
    let lights = (
        "LS(S|G)*E",
        "light of a point, spot or directional source that reaches the eye without a diffuse \
         surface on its way is met by no ray and lands as no photon",
    );
    let caustic = ("L(S|G)+DE", "the caustic map is switched off");
    let global = ("L.*D.*DE", "the global map is switched off");
    let bent = features.specular || features.glossy;
    let all = [
        (features.shining_media, shining),
        (features.zero_size_lights && features.specular, lights),
        (!settings.caustic_map && features.diffuse && bent, caustic),
        (!settings.global_map && features.diffuse, global),
    ];
    let lost = all.iter().filter(|(is_lost, _)| *is_lost);
    let (words, reasons): (Vec<&str>, Vec<&str>) = lost.map(|(_, lost)| *lost).unzip();
    (!words.is_empty()).then(|| Missing {
        words: words.join("|").into(),
        why: reasons.join("; ").into(),
    })
}
