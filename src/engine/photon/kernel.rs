//! Kernels of the density estimate. Each is a function of x = (distance/radius)² with the mean 1
//! over the disc, ∫₀¹ k(x) dx = 1; divided by the disc's area it is a density.

/// How photons are weighed by their distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Kernel {
    /// All alike.
    #[default]
    Box,
    /// Falls linearly to 0 at the radius (Jensen 2001, eq. 7.10 with k = 1).
    Cone,
    /// Falls as a Gaussian, shifted to 0 at the radius (Jensen 2001, eq. 7.12).
    Gaussian,
    /// 1 − x: of the least mean square error for its width (Epanechnikov 1969).
    Epanechnikov,
}

/// Width of the Gaussian (Pavicic 1990, *Convenient Anti-aliasing Filters that Minimize Bumpy
/// Sampling*, as Jensen takes it).
const BETA: f32 = 1.953;
/// Brings the mean of [`gaussian`] to 1.
const GAUSSIAN_SCALE: f32 = 1.728_309_3;

impl Kernel {
    /// All of them, in the order of the window's list.
    pub const ALL: [Self; 4] = [Self::Box, Self::Cone, Self::Gaussian, Self::Epanechnikov];

    /// Id on the command line.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Box => "box",
            Self::Cone => "cone",
            Self::Gaussian => "gaussian",
            Self::Epanechnikov => "epanechnikov",
        }
    }

    /// The kernel of that id.
    pub fn find(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|k| k.id() == id)
    }

    /// The weight at x = (distance/radius)² in [0, 1].
    #[inline]
    pub fn weight(self, x: f32) -> f32 {
        match self {
            Self::Box => 1.0,
            Self::Cone => 3.0 * (1.0 - x.sqrt()).max(0.0),
            Self::Gaussian => GAUSSIAN_SCALE * gaussian(x),
            Self::Epanechnikov => 2.0 * (1.0 - x).max(0.0),
        }
    }
}

#[inline]
fn gaussian(x: f32) -> f32 {
    (1.0 - (1.0 - (-0.5 * BETA * x).exp()) / (1.0 - (-BETA).exp())).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kernel_has_the_mean_one_and_is_never_negative() {
        for kernel in Kernel::ALL {
            let n = 1 << 16;
            let values = (0..n).map(|i| kernel.weight((i as f32 + 0.5) / n as f32));
            let sum: f64 = values.inspect(|w| assert!(*w >= 0.0)).map(f64::from).sum();
            let mean = sum / f64::from(n);
            assert!((mean - 1.0).abs() < 1e-5, "{}: {mean}", kernel.id());
            assert_eq!(Kernel::find(kernel.id()), Some(kernel));
        }
        assert_eq!(Kernel::find("sinc"), None);
    }
}
