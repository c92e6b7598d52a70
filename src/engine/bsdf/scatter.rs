//! The lobes at one point of a surface, as integrators see them: event by event.

use arrayvec::ArrayVec;
use glam::{Vec2, Vec3A};

use super::Transport;
use super::lambert;
use super::lobe::Lobe;
use super::shares::Shares;
use super::view::{Crossing, View};
use crate::engine::event::{Event, Letter};
use crate::engine::geometry::interaction::SurfaceInteraction;
use crate::engine::math::Rgb;

/// The most lobes of a surface.
pub const MAX_LOBES: usize = 8;

/// A sampled direction.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// Unit direction, away from the surface.
    pub wi: Vec3A,
    /// f_event · |cosθi| / pdf_dir; for a delta event the lobe's weight / P(event | wo).
    pub weight: Rgb,
    /// P(event | wo) · p_event(wi | wo) in 1/sr; for a delta event P(event | wo).
    pub pdf_dir: f32,
    /// The event drawn.
    pub event: Event,
    /// Index on `wi`'s side over the index on `wo`'s side on transmission, 1 on reflection.
    pub eta: f32,
}

/// An event between two known directions.
#[derive(Clone, Copy, Debug, Default)]
pub struct Evaluation {
    /// As [`Bsdf::eval`].
    pub f: Rgb,
    /// As [`Bsdf::pdf`] toward `wi`.
    pub toward: f32,
    /// The same from `wi` toward `wo`.
    pub back: f32,
}

#[derive(Clone, Copy, Debug)]
struct Weighted {
    weight: Rgb,
    lobe: Lobe,
}

impl Weighted {
    /// Its f·|cosθ| and density.
    #[inline]
    fn eval(&self, view: &View, crossing: &Crossing, transport: Transport) -> (Rgb, f32) {
        let (f, pdf) = self.lobe.eval(view, crossing, transport);
        (self.weight * f, pdf)
    }
}

#[inline]
fn bit(letter: Letter) -> u8 {
    1 << letter as u8
}

/// Scattering at one point.
///
/// Invariant: every weight is finite, not negative and not black.
#[derive(Clone, Debug)]
pub struct Bsdf {
    n_g: Vec3A,
    n_s: Vec3A,
    /// Bit mask of the letters of `lobes`.
    letters: u8,
    /// What most surfaces are: one Lambert lobe, and one normal. Nothing is to be chosen there, and
    /// every factor between the normals is 1.
    plain: bool,
    lobes: ArrayVec<Weighted, MAX_LOBES>,
}

impl Bsdf {
    /// A black surface at `si`.
    #[inline]
    pub fn new(si: &SurfaceInteraction) -> Self {
        Self {
            n_g: si.n_g,
            n_s: si.n_s,
            letters: 0,
            plain: false,
            lobes: ArrayVec::new_const(),
        }
    }

    /// Makes it a black surface at `si`, in the same place of memory.
    #[inline]
    pub fn reset(&mut self, si: &SurfaceInteraction) {
        (self.n_g, self.n_s) = (si.n_g, si.n_s);
        (self.letters, self.plain) = (0, false);
        self.lobes.clear();
    }

    /// Adds a lobe; a black one is dropped.
    ///
    /// # Panics
    /// Beyond [`MAX_LOBES`] lobes, which the building of materials excludes.
    #[inline]
    pub fn push(&mut self, weight: Rgb, lobe: Lobe) {
        debug_assert!(weight.is_finite(), "weight {weight:?} of {lobe:?}");
        if !weight.is_black() {
            self.letters |= bit(lobe.letter());
            self.plain = self.lobes.is_empty() && lobe == Lobe::Lambert && self.n_g == self.n_s;
            self.lobes.push(Weighted { weight, lobe });
        }
    }

    /// True if nothing is scattered.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.lobes.is_empty()
    }

    /// The lobes and their weights, in the order of `Event::Specular`'s indices.
    pub fn lobes(&self) -> impl Iterator<Item = (Rgb, Lobe)> {
        self.lobes.iter().map(|l| (l.weight, l.lobe))
    }

    /// Whether `event` exists here.
    #[inline]
    pub fn has(&self, event: Event) -> bool {
        match event {
            Event::Specular(i) => self
                .lobes
                .get(usize::from(i))
                .is_some_and(|l| l.lobe.letter() == Letter::S),
            _ => self.letters & bit(event.letter()) != 0,
        }
    }

    /// The events that shadow rays, connections and merging sum over.
    #[inline]
    pub fn non_delta_events(&self) -> impl Iterator<Item = Event> {
        let events = [Event::Diffuse, Event::Glossy];
        events.into_iter().filter(|&event| self.has(event))
    }

    /// Whether anything is left to evaluate: a lobe with a density.
    #[inline]
    pub fn has_non_delta(&self) -> bool {
        self.letters & (bit(Letter::D) | bit(Letter::G)) != 0
    }

    /// The delta events.
    #[inline]
    pub fn delta_events(&self) -> impl Iterator<Item = Event> {
        (0..self.lobes.len())
            .map(|i| Event::Specular(i as u8))
            .filter(|&e| self.has(e))
    }

    /// P(event | wo): it depends on the point and on `wo` only and sums to 1 over the events, or
    /// to 0 if nothing is scattered.
    #[inline]
    pub fn event_probability(&self, event: Event, wo: Vec3A) -> f32 {
        View::new(self.n_g, self.n_s, wo).map_or(0.0, |view| self.shares(&view).probability(event))
    }

    /// Picks an event by `u_event`, then a direction by `u`.
    ///
    /// None: absorbed. That is no error but belongs to the distribution: the surface is black
    /// ([`Self::is_empty`]), a microfacet sample was masked, or the direction fell between the
    /// geometric and the shading normal's horizon.
    #[inline]
    pub fn sample(
        &self,
        wo: Vec3A,
        u_event: f32,
        u: Vec2,
        transport: Transport,
    ) -> Option<BsdfSample> {
        if let Some(weight) = self.plain() {
            let (wi, pdf_dir) = lambert::sample(self.n_g, wo, u)?;
            return Some(BsdfSample {
                wi,
                weight,
                pdf_dir,
                event: Event::Diffuse,
                eta: 1.0,
            });
        }
        let view = View::new(self.n_g, self.n_s, wo)?;
        let shares = self.shares(&view);
        let (event, u_lobe) = shares.pick_event(u_event)?;
        self.sample_from(&view, &shares, event, u_lobe, u, transport)
    }

    /// Samples the direction of a given event: `u_lobe` picks among its lobes. The densities
    /// contain P(event) as those of [`Self::sample`] do.
    #[inline]
    pub fn sample_event(
        &self,
        event: Event,
        wo: Vec3A,
        u_lobe: f32,
        u: Vec2,
        transport: Transport,
    ) -> Option<BsdfSample> {
        let view = View::new(self.n_g, self.n_s, wo)?;
        let shares = self.shares(&view);
        self.sample_from(&view, &shares, event, u_lobe, u, transport)
    }

    /// f_event(wo, wi) · |cosθi| in 1/sr; 0 for delta events.
    #[inline]
    pub fn eval(&self, event: Event, wo: Vec3A, wi: Vec3A, transport: Transport) -> Rgb {
        let Some((view, crossing)) = self.directions(wo, wi) else {
            return Rgb::BLACK;
        };
        let mut f = Rgb::BLACK;
        for (_, l) in self.lobes_of(event) {
            f += l.weight * l.lobe.eval(&view, &crossing, transport).0;
        }
        f * view.adjoint(&crossing, transport)
    }

    /// P(event | wo) · p_event(wi | wo) in 1/sr; 0 for delta events, whose P is
    /// [`Self::event_probability`].
    #[inline]
    pub fn pdf(&self, event: Event, wo: Vec3A, wi: Vec3A) -> f32 {
        if self.plain().is_some() && event == Event::Diffuse {
            return lambert::pdf_both_ways(self.n_g, wo, wi).map_or(0.0, |(toward, _)| toward);
        }
        let Some((view, crossing)) = self.directions(wo, wi) else {
            return 0.0;
        };
        // The density is the same for either transport.
        self.eval_and_pdf(event, &view, &crossing, Transport::Radiance)
            .1
    }

    /// What [`Self::eval`] and [`Self::pdf`] both ways say, by two evaluations of the lobes instead
    /// of three; black without densities where nothing is scattered.
    #[inline]
    pub fn eval_both_ways(
        &self,
        event: Event,
        wo: Vec3A,
        wi: Vec3A,
        transport: Transport,
    ) -> Evaluation {
        if let Some(weight) = self.plain()
            && event == Event::Diffuse
        {
            let both = lambert::pdf_both_ways(self.n_g, wo, wi);
            return both.map_or(Evaluation::default(), |(toward, back)| Evaluation {
                f: weight * toward,
                toward,
                back,
            });
        }
        let Some((view, crossing)) = self.directions(wo, wi) else {
            return Evaluation::default();
        };
        let (f, toward) = self.eval_and_pdf(event, &view, &crossing, transport);
        if f.is_black() {
            return Evaluation::default();
        }
        let back = view.reversed(&crossing).map_or(0.0, |(view, crossing)| {
            self.eval_and_pdf(event, &view, &crossing, Transport::Radiance)
                .1
        });
        Evaluation {
            f: f * view.adjoint(&crossing, transport),
            toward,
            back,
        }
    }

    /// The weight of the only lobe, if the surface is plain.
    #[inline]
    fn plain(&self) -> Option<Rgb> {
        self.plain.then(|| self.lobes[0].weight)
    }

    /// Before the factor of the adjoint. Apart from what is inlined for plain surfaces.
    #[inline(never)]
    fn eval_and_pdf(
        &self,
        event: Event,
        view: &View,
        crossing: &Crossing,
        transport: Transport,
    ) -> (Rgb, f32) {
        self.eval_lobes(&self.shares(view), event, view, crossing, transport)
    }

    /// By the shares of the lobes.
    #[inline]
    fn eval_lobes(
        &self,
        shares: &Shares,
        event: Event,
        view: &View,
        crossing: &Crossing,
        transport: Transport,
    ) -> (Rgb, f32) {
        let (mut f, mut pdf) = (Rgb::BLACK, 0.0);
        for (i, l) in self.lobes_of(event) {
            let (f_lobe, pdf_lobe) = l.eval(view, crossing, transport);
            f += f_lobe;
            pdf += shares.lobe[i] * pdf_lobe;
        }
        (f, if pdf > 0.0 { pdf / shares.total } else { 0.0 })
    }

    #[inline]
    fn directions(&self, wo: Vec3A, wi: Vec3A) -> Option<(View, Crossing)> {
        let view = View::new(self.n_g, self.n_s, wo)?;
        let crossing = view.crossing(wi)?;
        Some((view, crossing))
    }

    /// The lobes with a density that make up `event`.
    #[inline]
    fn lobes_of(&self, event: Event) -> impl Iterator<Item = (usize, &Weighted)> {
        let density = !event.is_delta();
        self.lobes
            .iter()
            .enumerate()
            .filter(move |(_, l)| density && l.lobe.letter() == event.letter())
    }

    #[inline]
    fn shares(&self, view: &View) -> Shares {
        let mut shares = Shares::default();
        for (i, l) in self.lobes.iter().enumerate() {
            let share = l.weight.mean() * l.lobe.albedo(view);
            shares.lobe[i] = share;
            shares.total += share;
            match l.lobe.letter() {
                Letter::D => shares.diffuse += share,
                Letter::G => shares.glossy += share,
                Letter::S | Letter::V => shares.delta_lobes |= 1 << i,
            }
        }
        shares
    }

    #[inline]
    fn sample_from(
        &self,
        view: &View,
        shares: &Shares,
        event: Event,
        u_lobe: f32,
        u: Vec2,
        transport: Transport,
    ) -> Option<BsdfSample> {
        if let Event::Specular(i) = event {
            return self.sample_delta(view, shares, usize::from(i), transport);
        }
        let lobes = self.lobes_of(event).map(|(i, _)| i);
        let (i, u_lobe) = shares.pick_lobe(lobes, shares.of(event), u_lobe)?;
        let wi = self.lobes[i].lobe.sample(view, u_lobe, u)?;
        self.sampled(view, shares, event, &self.lobes[i], wi, transport)
    }

    /// What became of `wi`, which the lobe `from` gave: all lobes of the event together.
    #[inline]
    fn sampled(
        &self,
        view: &View,
        shares: &Shares,
        event: Event,
        from: &Weighted,
        wi: Vec3A,
        transport: Transport,
    ) -> Option<BsdfSample> {
        let crossing = view.crossing(wi)?;
        let (f, pdf_dir) = self.eval_lobes(shares, event, view, &crossing, transport);
        let weight = f * (view.adjoint(&crossing, transport) / pdf_dir);
        // A density of 0 or a weight of 0: rejected by the side rules, or rounded over an edge.
        (pdf_dir > 0.0 && !weight.is_black() && weight.is_finite()).then_some(BsdfSample {
            wi,
            weight,
            pdf_dir,
            event,
            eta: if crossing.same_side {
                1.0
            } else {
                from.lobe.eta(view)
            },
        })
    }

    #[inline]
    fn sample_delta(
        &self,
        view: &View,
        shares: &Shares,
        i: usize,
        transport: Transport,
    ) -> Option<BsdfSample> {
        let l = self.lobes.get(i)?;
        let event = Event::Specular(i as u8);
        let probability = shares.probability(event);
        let s = l.lobe.sample_delta(view, transport)?;
        let crossing = view.crossing(s.wi)?;
        let weight = l.weight * (s.weight * view.adjoint(&crossing, transport) / probability);
        let allowed = crossing.same_side != l.lobe.transmits();
        (allowed && probability > 0.0 && weight.is_finite()).then_some(BsdfSample {
            wi: s.wi,
            weight,
            pdf_dir: probability,
            event,
            eta: s.eta,
        })
    }
}
