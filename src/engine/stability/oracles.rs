//! Closed forms and quadratures in f64, apart from the engine's own formulas.

use std::f64::consts::PI;

/// Mean over a square view of half angle tangent `tan` of the radiance of a plane of albedo
/// `rho` at distance `far`, perpendicular to the view, under a point light of `intensity` on the
/// axis at height `d`: ρ I cosθ/(π r²).
pub fn falloff(rho: f64, intensity: f64, d: f64, far: f64, tan: f64) -> f64 {
    let half = far * tan;
    let n = 400;
    let mut sum = 0.0;
    for i in 0..n {
        for j in 0..n {
            let at = |k: i32| half * (2.0 * (f64::from(k) + 0.5) / f64::from(n) - 1.0);
            let r2 = d * d + at(i).powi(2) + at(j).powi(2);
            sum += d / (r2 * r2.sqrt());
        }
    }
    rho * intensity / PI * sum / f64::from(n * n)
}

/// Directional albedo at `cos` of a GGX reflector of Fresnel factor 1 with separable Smith
/// shadowing (Walter et al. 2007, equations 20, 33 and 34), over the distribution of normals.
pub fn ggx_albedo(alpha: f64, cos: f64) -> f64 {
    let o = [(1.0 - cos * cos).sqrt(), 0.0, cos];
    let g1 = |z: f64| {
        let tan2 = (1.0 - z * z) / (z * z);
        2.0 / (1.0 + (1.0 + alpha * alpha * tan2).sqrt())
    };
    let (rings, sectors) = (1000, 500);
    let mut sum = 0.0;
    for i in 0..rings {
        // D cosθ dω of the normal is uniform in u: tan²θ = α² u/(1 − u). Towards u = 1, where
        // normals turn to grazing, the grid becomes denser.
        let s = (f64::from(i) + 0.5) / f64::from(rings);
        let (u, du) = (1.0 - (1.0 - s).powi(4), 4.0 * (1.0 - s).powi(3));
        let tan2 = alpha * alpha * u / (1.0 - u);
        let z = 1.0 / (1.0 + tan2).sqrt();
        let r = (1.0 - z * z).sqrt();
        for j in 0..sectors {
            let phi = 2.0 * PI * (f64::from(j) + 0.5) / f64::from(sectors);
            let h = [r * phi.cos(), r * phi.sin(), z];
            let oh = o[0] * h[0] + o[2] * h[2];
            let i_z = 2.0 * oh * h[2] - o[2];
            if oh > 0.0 && i_z > 0.0 {
                sum += oh / (cos * z) * g1(cos) * g1(i_z) * du;
            }
        }
    }
    sum / f64::from(rings * sectors)
}

/// Chandrasekhar's H for isotropic scattering of `albedo`: iteration of
/// 1/H(μ) = √(1−ϖ) + ϖ/2 ∫ μ′ H(μ′)/(μ + μ′) dμ′ (*Radiative Transfer*, 1950, sections 33, 41).
pub fn chandrasekhar_h(albedo: f64) -> impl Fn(f64) -> f64 {
    let n = 400;
    let nodes: Vec<f64> = (0..n)
        .map(|i| (f64::from(i) + 0.5) / f64::from(n))
        .collect();
    let evaluate = move |values: &[f64], nodes: &[f64], mu: f64| {
        let terms = nodes.iter().zip(values).map(|(x, h)| x * h / (mu + x));
        1.0 / ((1.0 - albedo).sqrt() + 0.5 * albedo * terms.sum::<f64>() / nodes.len() as f64)
    };
    let mut values = vec![1.0; nodes.len()];
    for _ in 0..200 {
        values = nodes
            .iter()
            .map(|mu| evaluate(&values, &nodes, *mu))
            .collect();
    }
    move |mu| evaluate(&values, &nodes, mu)
}

/// Unpolarised Fresnel reflectance into an index `n` from 1.
pub fn fresnel(n: f64, cos: f64) -> f64 {
    let sin2 = (1.0 - cos * cos) / (n * n);
    let t = (1.0 - sin2).sqrt();
    let s = (cos - n * t) / (cos + n * t);
    let p = (n * cos - t) / (n * cos + t);
    0.5 * (s * s + p * p)
}

/// Share of the disc of a parallel beam that a ball of radius 1 and index `n` refracts twice and
/// lets land within `reach` of the axis on a plane at `distance` behind its centre: ∫ 2b T² db.
pub fn through_ball(n: f64, distance: f64, reach: f64) -> f64 {
    let steps = 200_000;
    let mut sum = 0.0;
    for i in 0..steps {
        let b = (f64::from(i) + 0.5) / f64::from(steps);
        let theta = b.asin();
        let landing = landing_of(b, n, distance);
        if landing.abs() <= reach {
            let t = 1.0 - fresnel(n, theta.cos());
            sum += 2.0 * b * t * t;
        }
    }
    sum / f64::from(steps)
}

/// Distance from the axis at which the ray of height `b` lands on that plane, after two
/// refractions by the ball, traced in two dimensions.
fn landing_of(b: f64, n: f64, distance: f64) -> f64 {
    // It enters at (−cosθ, b) along +x; normals point outward.
    let p = [-(1.0 - b * b).sqrt(), b];
    let inside = refract([1.0, 0.0], p, 1.0 / n);
    let t = -2.0 * (p[0] * inside[0] + p[1] * inside[1]);
    let q = [p[0] + t * inside[0], p[1] + t * inside[1]];
    let out = refract(inside, [-q[0], -q[1]], n);
    if out[0] <= 0.0 {
        return f64::INFINITY;
    }
    q[1] + (distance - q[0]) / out[0] * out[1]
}

/// The direction `d` refracted at the unit normal `m` that faces it; `ratio` of the indices.
fn refract(d: [f64; 2], m: [f64; 2], ratio: f64) -> [f64; 2] {
    let cos = -(d[0] * m[0] + d[1] * m[1]);
    let k = (1.0 - ratio * ratio * (1.0 - cos * cos)).max(0.0).sqrt();
    [0, 1].map(|i| ratio * d[i] + (ratio * cos - k) * m[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_forms_meet_their_limits() {
        assert!((ggx_albedo(1e-3, 0.5) - 1.0).abs() < 1e-4);
        // A narrow view sees the axis alone.
        assert!((falloff(0.5, 7.0, 2.0, 1.0, 1e-4) - 0.5 * 7.0 / (PI * 4.0)).abs() < 1e-8);
        assert!((fresnel(1.5, 1.0) - 0.04).abs() < 1e-12);
        // A ball of air is no ball.
        assert!((through_ball(1.0 + 1e-9, 3.0, 2.0) - 1.0).abs() < 1e-6);
        // Near the axis the ball's focal length counts: n/(2(n−1)) = 1.5 from the centre.
        assert!(landing_of(1e-4, 1.5, 1.5).abs() < 1e-9);
        let h = chandrasekhar_h(1e-9);
        assert!((h(0.5) - 1.0).abs() < 1e-6);
    }
}
