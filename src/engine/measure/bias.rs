//! What an error estimated without a reference cannot see.

use crate::engine::integrators::Params;

/// What both halves of a render of this integrator have in common and their difference does not
/// show, in a sentence; none for unbiased methods.
pub fn unseen(integrator: &str, params: &Params) -> Option<&'static str> {
    Some(match integrator {
        "whitted" => "the light that this method leaves out is not in it",
        "monte-carlo" => "the light beyond its depth is not in it",
        "pssmlt" => {
            "the mean brightness, by which both halves are multiplied, has an error of its own"
        }
        "photon" if params.switch("fresh-maps") => "the blur of the photon estimates is not in it",
        "photon" => {
            "the photon maps are kept from pass to pass, so that their noise and their blur are \
             not in it"
        }
        "sppm" | "vcm" => "the blur of the photons, which shrinks from pass to pass, is not in it",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::integrators::REGISTRY;

    #[test]
    fn unbiased_methods_have_nothing_to_hide() {
        for entry in REGISTRY {
            let found = unseen(entry.id, &Params::defaults(entry.params));
            let unbiased = ["path", "light", "bdpt"].contains(&entry.id);
            assert_eq!(found.is_none(), unbiased, "{}", entry.id);
        }
    }
}
