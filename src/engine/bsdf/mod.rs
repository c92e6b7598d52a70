//! Scattering at a surface, one event at a time.
//!
//! A [`Bsdf`] is a short list of lobes with weights. Its lobes are grouped into events as
//! CONTRACT rule 1 has it: all diffuse lobes are one event, all microfacet lobes are one, each
//! delta lobe is one of its own. P(event | point, wo) sums to 1 over the events, is greater than
//! 0 wherever the event's f is, and depends on nothing else.
//!
//! All directions are unit vectors in world space that point away from the surface; `wo` is the
//! direction already known (toward the eye in a camera walk, toward the light in a light walk),
//! `wi` the one to find or to evaluate.
