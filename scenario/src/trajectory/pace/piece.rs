//! The polynomial of degree 9 between two knots, as a linear map of how they are passed.
//!
//! With s in [0, 1] the share of the duration T that has passed, and d_(e,l) the derivative of order l at the start
//! (e = 0) or end (e = 1), the derivative of order k is
//!
//! x^(k) = sum over e, l of W_(k,e,l)(s) T^(l - k) d_(e,l), l = 0..4,
//!
//! W_(0,0,l)(s) = s^l / l! (1 - s)^5 sum over m = 0..4-l of C(4 + m, m) s^m, W_(0,1,l)(s) = (-1)^l W_(0,0,l)(1 - s).

use nalgebra::Vector4;

/// Position to snap: the orders that a knot fixes.
pub const KNOT_ORDERS: usize = 5;
const COEFFICIENT_COUNT: usize = 2 * KNOT_ORDERS;

/// Position (m) and heading (rad), and their derivatives to the fourth, per second to the order.
pub type Motion = [Vector4<f64>; KNOT_ORDERS];

/// W of one place: by order k, end e and order l.
#[derive(Debug, Clone, Copy)]
pub struct Place([[[f64; KNOT_ORDERS]; 2]; KNOT_ORDERS]);

impl Place {
    /// At s.
    pub fn new(s: f64) -> Self {
        let start = |l: usize, order: usize, s: f64| derivative(&coefficients(l), order, s);
        Self(std::array::from_fn(|order| {
            let end = |l: usize| if (l + order).is_multiple_of(2) { 1.0 } else { -1.0 } * start(l, order, 1.0 - s);
            [std::array::from_fn(|l| start(l, order, s)), std::array::from_fn(end)]
        }))
    }

    /// W T^(l - k) of the derivative of order k, by end and l, for the powers of T from -4 to 4.
    pub fn weights(&self, order: usize, powers: &[f64; 9]) -> [[f64; KNOT_ORDERS]; 2] {
        let mut weights = self.0[order];
        for weights in &mut weights {
            weights.iter_mut().enumerate().for_each(|(l, weight)| *weight *= powers[4 + l - order]);
        }
        weights
    }
}

/// The powers of `duration` from -4 to 4.
pub fn powers(duration: f64) -> [f64; 9] {
    std::array::from_fn(|power| duration.powi(power as i32 - 4))
}

/// W_(0,0,l), lowest power first.
fn coefficients(l: usize) -> [f64; COEFFICIENT_COUNT] {
    let factorial = |n: usize| (1..=n).map(|i| i as f64).product::<f64>();
    let choose = |n: usize, m: usize| factorial(n) / (factorial(m) * factorial(n - m));
    let mut coefficients = [0.0; COEFFICIENT_COUNT];
    for m in 0..KNOT_ORDERS - l {
        for power in 0..=KNOT_ORDERS {
            let sign = if power % 2 == 0 { 1.0 } else { -1.0 };
            coefficients[l + m + power] += sign * choose(5, power) * choose(4 + m, m) / factorial(l);
        }
    }
    coefficients
}

fn derivative(coefficients: &[f64; COEFFICIENT_COUNT], order: usize, s: f64) -> f64 {
    let falling = |power: usize| (0..order).map(|less| (power - less) as f64).product::<f64>();
    coefficients.iter().enumerate().skip(order).rev().fold(0.0, |sum, (power, c)| sum * s + c * falling(power))
}

#[cfg(test)]
mod tests {
    use super::*;
    use controller_core::reference::knot::Knot;
    use controller_core::reference::segment::Segment;

    #[test]
    fn a_place_of_a_piece_is_where_it_is_flown() {
        let any = |seed: f64| Vector4::new(seed.sin(), (1.7 * seed).cos(), (2.3 * seed).sin(), 0.1 * seed.cos());
        let ends: [Motion; 2] = [0.0, 1.0].map(|end| std::array::from_fn(|order| any(end + 3.0 * order as f64)));
        let duration = 0.8;
        let knots = [0, 800_000].map(|time_us| {
            let [position, derivatives @ ..] = ends[usize::from(time_us > 0)];
            Knot { time_us, position: position.xyz(), heading: position.w, derivatives }
        });
        let segment = Segment::between(&knots[0], &knots[1]);
        for time_us in [0_u64, 100_000, 555_555, 800_000] {
            let place = Place::new(time_us as f64 * 1e-6 / duration);
            let flown = segment.at(time_us);
            let vectors = [flown.position, flown.velocity, flown.acceleration, flown.jerk, flown.snap];
            for (order, flown) in vectors.into_iter().enumerate() {
                let weights = place.weights(order, &powers(duration));
                let sum: Vector4<f64> = ends
                    .iter()
                    .zip(weights)
                    .flat_map(|(end, weights)| end.iter().zip(weights))
                    .map(|(d, w)| d * w)
                    .sum();
                let off = (sum.xyz() - flown.map(f64::from)).norm();
                assert!(off < 1e-4 * (1.0 + sum.norm()), "order {order} at {time_us} us: {off}");
            }
        }
    }
}
