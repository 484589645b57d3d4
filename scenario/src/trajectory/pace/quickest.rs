//! The quickest motion along legs that takes no more of any row than there is: descent with a barrier.
//!
//! Free are how each knot is passed (velocity to snap; between the points also where) and the duration of each piece.
//! At some places of each piece, denser towards its ends, the rows' shares s of [`Limits`] and of the corridor,
//! (distance / corridor)^2, are below one, and
//!
//! rho times the whole duration + sum of b(s), b(s) = -ln(1 - x) - x - x^2 / 2, x = (s - [`IDLE`]) / (1 - [`IDLE`]),
//!
//! falls (b = 0 below x = 0: a row with room changes nothing), for a rho that grows. Steps are Newton's
//! ([`super::equations`]). A step that takes more than nine tenths of what any row has left, or does not descend, is
//! shortened, and then damped.
//!
//! It finds a local optimum, whose pieces stay within the rows at the places looked at.

use super::blocks::Part;
use super::equations::{DURATION_UNKNOWN, IDLE_SHARE, SHARE_COUNT, barrier, equations};
use super::limits::Limits;
use super::merge::Leg;
use super::piece::Motion;
use super::places::Places;
use super::way::Way;

/// By how much rho grows, and how many steps are made with each.
const BARRIER_GROWTH: f64 = 4.0;
const NEWTON_STEPS_MAX: usize = 20;
/// What the value falls by for each place in a step that is worth another.
const DECREASE_PER_PLACE_MIN: f64 = 1e-3;
/// The greatest and, inverse, the least duration of a leg from rest to rest, s.
const LEG_DURATION_MAX_S: f64 = 1e3;
/// How often a step is halved, and damped ten times more.
const STEP_HALVINGS_MAX: u32 = 3;
const DAMPINGS_MAX: u32 = 12;
/// The least damping, and that of unknowns that no row depends on.
const DAMPING_MIN: f64 = 1e-9;

/// What is looked for, and where it is looked at.
pub struct Search<'a> {
    limits: &'a Limits,
    places: Places,
}

impl<'a> Search<'a> {
    /// Within `limits`, with so many `places` of each piece.
    pub fn new(limits: &'a Limits, places: usize) -> Self {
        Self { limits, places: Places::new(places) }
    }

    /// From rest to rest along each leg, with half of what rest leaves of the limits; none where rest leaves nothing.
    pub fn stopping(&self, legs: Vec<Leg>) -> Option<Way> {
        let lasting = |way: &Way| {
            let rest = self.most(&way.clone().stretched(LEG_DURATION_MAX_S));
            let (mut fails, mut holds) = (1.0 / LEG_DURATION_MAX_S, LEG_DURATION_MAX_S);
            while holds > 1.01 * fails {
                let middle = (fails * holds).sqrt();
                let fits = self.most(&way.clone().stretched(middle)) < 0.5 * (1.0 + rest);
                *if fits { &mut holds } else { &mut fails } = middle;
            }
            holds
        };
        Some(Way::stopping(legs, lasting)).filter(|way| self.most(way) < 1.0)
    }

    /// Whether another `speed` for all legs, m/s, would change nothing: it is far above what `way` has.
    pub fn leaves_idle(&self, way: &Way, speed: f64) -> bool {
        let idle = IDLE_SHARE * speed * speed;
        let slow =
            |piece: usize| self.places.each().all(|(place, _)| way.motion(piece, place)[1].xyz().norm_squared() < idle);
        (0..way.pieces.len()).all(slow)
    }

    /// The greatest share at the places.
    pub fn most(&self, way: &Way) -> f64 {
        self.shares(way).into_iter().fold(0.0, f64::max)
    }

    /// All shares at all places.
    fn shares(&self, way: &Way) -> Vec<f64> {
        let mut shares = Vec::with_capacity(way.pieces.len() * self.places.count() * SHARE_COUNT);
        for (piece, (leg, _)) in way.pieces.iter().enumerate() {
            let leg = &way.legs[*leg];
            let corridor = |motion: &Motion| leg.off(&motion[0].xyz()).norm_squared() / (leg.corridor * leg.corridor);
            for (place, between) in self.places.each() {
                let motion = way.motion(piece, place);
                shares.extend(self.limits.shares(&motion, leg.speed));
                shares.extend([corridor(&motion), corridor(&way.motion(piece, between))]);
            }
        }
        shares
    }

    /// The value for `rho` with these shares.
    fn value(way: &Way, rho: f64, shares: &[f64]) -> f64 {
        rho * way.duration() + shares.iter().map(|share| barrier(*share)[0]).sum::<f64>()
    }

    /// `way` with a share of a step. What a knot's derivatives are follows how long its pieces take.
    fn moved(way: &Way, step: &[Part], share: f64) -> Way {
        let mut moved = way.clone();
        let longer = |piece: usize| share * step[piece][DURATION_UNKNOWN].clamp(-1.0, 1.0);
        for (number, (knot, part)) in moved.knots.iter_mut().zip(step).enumerate() {
            let around = number.saturating_sub(1)..way.pieces.len().min(number + 1);
            let mean = around.clone().map(longer).sum::<f64>() / around.len() as f64;
            for (order, derivative) in knot.iter_mut().enumerate() {
                let slower = order as f64 * mean;
                let change = part.fixed_rows::<4>(4 * order) * share;
                *derivative = (*derivative * (1.0 + slower) + change) * (-slower).exp();
            }
        }
        for (piece, (_, duration)) in moved.pieces.iter_mut().enumerate() {
            *duration *= longer(piece).exp();
        }
        moved
    }

    /// What damps unknowns that no row depends on: the inverse squares of a leg's length over powers of a duration.
    fn scales(way: &Way) -> Vec<Part> {
        let scale = |knot: usize| {
            let around = &way.pieces[knot.saturating_sub(1)..way.pieces.len().min(knot + 1)];
            let duration = around.iter().map(|(_, duration)| duration).sum::<f64>() / around.len() as f64;
            let leg = &way.legs[around[0].0];
            let length = (leg.to - leg.from).xyz().norm().max(leg.corridor);
            Part::from_fn(|unknown, _| match (unknown, unknown % 4) {
                (DURATION_UNKNOWN, _) => 1.0,
                (_, 3) => duration.powi(unknown as i32 / 4).powi(2),
                _ => (duration.powi(unknown as i32 / 4) / length).powi(2),
            })
        };
        (0..way.knots.len()).map(scale).collect()
    }

    /// Descends from `way`, which takes less than one of every row, until what the barrier holds back is below the last
    /// of the `gaps`, as a share of the duration; the first is where it begins.
    pub fn descend(&self, mut way: Way, [first, last]: [f64; 2]) -> Way {
        let places = (way.pieces.len() * self.places.count()) as f64;
        let mut gap = first;
        loop {
            let rho = places / (gap * way.duration());
            let mut damping = DAMPING_MIN;
            let mut shares = self.shares(&way);
            for _ in 0..NEWTON_STEPS_MAX {
                let value = Self::value(&way, rho, &shares);
                let Some((next, next_shares)) = self.step(&way, &shares, rho, &mut damping) else { break };
                (way, shares) = (next, next_shares);
                if value - Self::value(&way, rho, &shares) < DECREASE_PER_PLACE_MIN * places {
                    break;
                }
            }
            if gap <= last {
                return way;
            }
            gap = (gap / BARRIER_GROWTH).max(last);
        }
    }

    /// A step that descends, with the shares there.
    fn step(&self, way: &Way, shares: &[f64], rho: f64, damping: &mut f64) -> Option<(Way, Vec<f64>)> {
        let equations = equations(self.limits, &self.places, way, shares, rho);
        let scales = Self::scales(way);
        let value = Self::value(way, rho, shares);
        for _ in 0..DAMPINGS_MAX {
            let damped =
                |knot: usize, diagonal: &Part| (diagonal + scales[knot]) * *damping + scales[knot] * DAMPING_MIN;
            let step = equations.solve(damped).unwrap_or_default();
            for halved in 0..if step.is_empty() { 0 } else { STEP_HALVINGS_MAX } {
                let moved = Self::moved(way, &step, 0.5_f64.powi(halved as i32));
                let moved_shares = self.shares(&moved);
                let is_within =
                    moved_shares.iter().zip(shares).all(|(after, before)| 1.0 - after > 0.1 * (1.0 - before));
                if is_within && Self::value(&moved, rho, &moved_shares) < value {
                    if halved == 0 {
                        *damping = (*damping * 0.2).max(DAMPING_MIN);
                    }
                    return Some((moved, moved_shares));
                }
            }
            *damping *= 10.0;
        }
        None
    }
}
