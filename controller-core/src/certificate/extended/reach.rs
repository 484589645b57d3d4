//! What u, u', u'' can be under the extended law, from a reset. Section 9 of `docs/extended-law.md`.
//!
//! u = g e3 + u_f + p_d'' + kappa p_d' - d is a sum of three independent parts, each with its derivatives:
//!
//! | part | across | vertical |
//! |---|---|---|
//! | feedback u_f, filtered twice | M_h; 2 k_f U_l M_h; 2 k_f M_h (k_s + k_f U_l^2) | [-M_z-, M_z+]; k_f U_l (M_z+ + M_z-); k_f (M_z+ + M_z-) (k_s + k_f U_l^2) |
//! | reference with its drag | K_a12 + kappa K_v; K_j + kappa K_a12; K_s + kappa K_j | K_a3; K_j; K_s |
//! | force estimate d | sqrt(2) D; sqrt(2) S / k_d; sqrt(2) S | D_z; S_z / k_d; S_z |
//!
//! (value; first; second derivative). The feedback across is a vector in a disc, so along every direction it is one axis of
//! the paper's cascade with level M_h.
//!
//! **Near its ends the vertical command moves slowly.** From the corner (-M, -M) of the cascade's reachable set (M = (M_z+ + M_z-) / 2
//! about its middle) the extremal arc has u_f + M = x(t) = 2M (1 - E_s) - y(t), u_s - u_f = y(t) = 2M k_s (E_f - E_s) / (k_s - k_f). So at
//! u_f = x - M, |u_f'| is at most k_f y(t(x)), up to the arc's greatest y and its mirror image at the other end.

use crate::certificate::reachable::half_l1_norm;
use crate::extended::parameters::Extended;
use crate::math;
use crate::reference::ReferenceBounds;
use core::f64::consts::SQRT_2;

/// Points of the arc between its corner and its greatest y.
const ARC_POINTS: usize = 32;

/// Bounds on everything reachable, m/s^2, m/s^3, m/s^4.
#[derive(Debug, Clone, PartialEq)]
pub struct Reach {
    /// Greatest |(u_x, u_y)|.
    pub across: f64,
    /// Least u_z.
    pub vertical_least: f64,
    /// Greatest u_z.
    pub vertical_greatest: f64,
    /// Greatest |(u'_x, u'_y)|.
    pub across_rate: f64,
    /// Greatest |(u''_x, u''_y)|.
    pub across_acceleration: f64,
    /// Greatest |u''_z|.
    pub vertical_acceleration: f64,
    /// Greatest |u'_z| beside what the feedback makes.
    other_vertical_rate: f64,
    /// By how much u_z may differ from g + u_f.
    slack: f64,
    /// g - M_z- and g + M_z+.
    feedback: (f64, f64),
    /// (x, k_f y) along the arc.
    arc: [(f64, f64); ARC_POINTS + 1],
}

impl Reach {
    /// For references within `bounds`.
    #[must_use]
    pub fn new(parameters: &Extended, bounds: &ReferenceBounds, gravity: f64) -> Self {
        let (p, e) = (&parameters.position, &parameters.estimates);
        let double = f64::from;
        let drag = double(e.drag_across);
        let [bandwidth, bandwidth_z] = [e.force_bandwidth_across, e.force_bandwidth_vertical].map(double);
        let (level, snap) = (double(e.force_across), double(e.force_snap_across));
        let (level_z, snap_z) = (double(e.force_vertical), double(e.force_snap_vertical));
        let [speed, across, vertical, jerk, rest] = [
            bounds.horizontal_speed,
            bounds.horizontal_acceleration,
            bounds.vertical_acceleration,
            bounds.jerk,
            bounds.snap,
        ]
        .map(double);

        let (k_f, k_s, m_h) = (double(p.k_f_across), double(p.k_s_across), double(p.m_across));
        let half_l1 = half_l1_norm(k_f, k_s);
        let (down, up) = (double(p.m_down), double(p.m_up));
        let (k_f_z, k_s_z, span) = (double(p.k_f_vertical), double(p.k_s_vertical), up + down);
        let half_l1_z = half_l1_norm(k_f_z, k_s_z);
        let slack = vertical + level_z;
        Self {
            across: m_h + across + drag * speed + SQRT_2 * level,
            vertical_least: gravity - down - slack,
            vertical_greatest: gravity + up + slack,
            across_rate: 2.0 * k_f * half_l1 * m_h + jerk + drag * across + SQRT_2 * snap / bandwidth,
            across_acceleration: 2.0 * k_f * m_h * (k_s + k_f * half_l1 * half_l1) + rest + drag * jerk + SQRT_2 * snap,
            vertical_acceleration: k_f_z * span * (k_s_z + k_f_z * half_l1_z * half_l1_z) + rest + snap_z,
            other_vertical_rate: jerk + snap_z / bandwidth_z,
            slack,
            feedback: (gravity - down, gravity + up),
            arc: arc(k_f_z, k_s_z, span),
        }
    }

    /// Greatest |u'_z| while u_z is between `least` and `greatest`.
    #[must_use]
    pub fn vertical_rate(&self, least: f64, greatest: f64) -> f64 {
        // How far from its ends the feedback can be at most.
        let (low, high) = self.feedback;
        let from_below = greatest + self.slack - low;
        let from_above = high - (least - self.slack);
        let room = math::greater_f64(math::lesser_f64(from_below, from_above), 0.0);
        let found = self.arc.iter().find(|(x, _)| *x >= room);
        let [.., (_, most)] = self.arc;
        self.other_vertical_rate + found.map_or(most, |(_, rate)| *rate)
    }
}

/// The extremal arc from a corner of a box of width `span` to where u_f moves fastest, as (x, |u_f'|), both rising.
fn arc(k_f: f64, k_s: f64, span: f64) -> [(f64, f64); ARC_POINTS + 1] {
    let spread = k_s - k_f;
    // y is greatest where k_f E_f = k_s E_s.
    let latest = if spread.abs() < 1e-6 * k_f { 1.0 / k_f } else { math::ln_1p(spread / k_f) / spread };
    core::array::from_fn(|point| {
        let time = latest * point as f64 / ARC_POINTS as f64;
        let slow = math::exp(-k_s * time);
        let x_s = if (spread * time).abs() < 1e-9 { time } else { math::exp_m1(spread * time) / spread };
        // E_f - E_s = E_s (e^(spread t) - 1).
        let y = span * k_s * slow * x_s;
        let x = -span * math::exp_m1(-k_s * time) - y;
        (math::greater_f64(x, 0.0), k_f * y)
    })
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::extended::example;

    /// Where all parts are at their worst at once, out of the middle of the vertical box and at its ends.
    #[test]
    fn every_part_of_the_table_is_in_what_is_reachable() {
        let parameters = Extended::new(example::PARAMETERS, &example::vehicle()).unwrap();
        let reach = Reach::new(&parameters, &example::REFERENCES, 9.81);
        let is = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-6, "{found}, not {expected}");
        // Both bandwidths across are 6, both vertical ones 4: U_l is 1/e.
        let (u, drag) = ((-1.0_f64).exp(), 0.47);
        is(reach.across, 2.0 + 2.4675 + drag * 3.0 + SQRT_2 * 2.6);
        is(reach.across_rate, 2.0 * 6.0 * u * 2.0 + 3.876 + drag * 2.4675 + SQRT_2 * 28.0 / 10.0);
        is(reach.across_acceleration, 2.0 * 6.0 * 2.0 * (6.0 + 6.0 * u * u) + 6.089 + drag * 3.876 + SQRT_2 * 28.0);
        is(reach.vertical_least, 9.81 - 1.5 - 0.1755 - 0.5);
        is(reach.vertical_greatest, 9.81 + 6.0 + 0.1755 + 0.5);
        is(reach.vertical_acceleration, 4.0 * 7.5 * (4.0 + 4.0 * u * u) + 6.089 + 20.0);
        let slowest = 3.876 + 20.0 / 15.0;
        let (least, greatest) = (reach.vertical_least, reach.vertical_greatest);
        is(reach.vertical_rate(least, greatest), 4.0 * u * 7.5 + slowest);
        // At an end of u_z all are at theirs, the feedback too, and it stands still there; a metre a second squared on, it may be as far.
        let (_, there) = *reach.arc.iter().find(|(x, _)| *x >= 1.0 - 1e-9).unwrap();
        for (end, inwards) in [(least, 1.0), (greatest, -1.0)] {
            is(reach.vertical_rate(end, end), slowest);
            let on = end + inwards;
            is(reach.vertical_rate(on.min(end), on.max(end)), there + slowest);
        }
    }

    /// The cascade flown with inputs of one switch, which make the boundary of what it reaches.
    #[test]
    fn the_arc_is_as_fast_as_any_flight_of_the_cascade_at_that_place() {
        for (k_f, k_s) in [(3.0, 3.0), (2.0, 7.0), (6.0, 2.5)] {
            let span = 2.0;
            let arc = arc(k_f, k_s, span);
            assert!(arc.windows(2).all(|pair| pair[0].0 <= pair[1].0 && pair[0].1 <= pair[1].1));
            let (mut closest, step) = (0.0_f64, 1e-4);
            for held in 1..60 {
                let (mut u_f, mut u_s) = (-1.0_f64, -1.0_f64);
                for i in 0..60_000 {
                    let input = if i < held * 400 { 1.0 } else { -1.0 };
                    let rate = k_f * (u_s - u_f);
                    u_f += step * rate;
                    u_s += step * k_s * (input - u_s);
                    let room = (u_f + 1.0).min(1.0 - u_f).max(0.0);
                    let bound = arc.iter().find(|(x, _)| *x >= room).map_or(arc[ARC_POINTS].1, |(_, rate)| *rate);
                    assert!(rate.abs() <= bound * 1.001 + 1e-3, "{k_f} {k_s} at {room}: {rate} beyond {bound}");
                    closest = closest.max(rate.abs() / bound);
                }
            }
            assert!(closest > 0.99, "{closest}");
        }
    }
}
