//! Where Russian roulette stops being sure to let a walk go on.

/// Survival of walks that lost nothing: with 1 a walk between perfect mirrors would not end.
///
/// It is also what bounds the variance of bright rooms. In a closed room of albedo ρ a walk that
/// survives with q in place of ρ carries (ρ/q)ᵏ after k events, with probability qᵏ; the second
/// moment Σ (ρ²/q)ᵏ is finite while ρ² < q, here up to ρ = 0.99995. Every walk, from the eye or
/// from a light, takes this same number: with 0.98 the variance of whoever took it was infinite
/// from ρ = 0.99 on.
pub const MAX_SURVIVAL: f32 = 0.9999;
