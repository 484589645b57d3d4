//! Small motions about a [relaxed hover](super::relaxed_hover), in samples: one tick of the reduced attitude's loop.
//!
//! Body axes, which turn with the vehicle at Omega about the law's n. eta = R' e3 = n + epsilon; omega = Omega n +
//! delta, delta_3 = 0, as yaw is not controlled. tau is the torque about x and y, c its command, Delta the lag:
//!
//! ```text
//! epsilon' = n x delta + Omega epsilon x n
//! delta' = J^-1 (tau - delta x J (Omega n) - Omega n x J delta)
//! tau' = (c(t - delay) - tau) / Delta
//! c_k = K_epsilon epsilon + K_delta delta + K_p p,   p = Delta tau + the commands that are still under way
//! ```
//!
//! c is held between ticks, so a tick's transition is a matrix exponential. K are differences of the law itself, the
//! allocation to the rotors left among it. What is left out: the position's loop, which is slower, yaw, sensors, and
//! every bound: at its ends a rotor pushes one way only.

use super::WithoutARotor;
use crate::sampled_loop::{Timing, spectral_radius};
use controller_core::vehicle::Vehicle;
use nalgebra::{DMatrix, Matrix2, Matrix3, Quaternion, SMatrix, UnitQuaternion, Vector2, Vector3, Vector4};

/// The differences' steps: rad, and rad/s; an impulse's is what makes that rate.
const TILT_STEP_RAD: f64 = 5e-3;
const RATE_STEP_RAD_PER_S: f64 = 0.05;

/// The least lag, in periods: below it a rotor is at its thrust long before the next tick.
const LAG_MIN_PERIODS: f64 = 0.01;

/// The states between ticks: epsilon, delta, tau, two of each.
const STATE_COUNT: usize = 6;
/// The same with the two components of the held command.
const STATES_AND_COMMAND: usize = STATE_COUNT + 2;

/// Of the matrix exponential: what is left out, of |A| up to 100, is below 1e-15.
const EXPONENTIAL_SQUARINGS: u32 = 16;
const EXPONENTIAL_TERMS: u32 = 8;

type State = SMatrix<f64, STATES_AND_COMMAND, STATES_AND_COMMAND>;

/// The largest magnitude of an eigenvalue of one tick: small motions of `vehicle` under `law`, as it turns at `rate`,
/// rad/s, die out below one.
#[must_use]
pub fn radius(law: &WithoutARotor, rate: f64, vehicle: &Vehicle, timing: &Timing) -> f64 {
    let Timing { period, rotor_lag, delay_samples } = *timing;
    let lag = rotor_lag.max(LAG_MIN_PERIODS * period);
    let (whole, fraction) = (delay_samples.floor() as usize, delay_samples.fract());
    let axis = law.axis();
    let [of_error, of_rate, of_pending] = slopes(law, (&axis, rate), vehicle, rotor_lag + delay_samples * period);

    let continuous = continuous((&axis, rate), vehicle, lag);
    let [late, rest] = [fraction * period, (1.0 - fraction) * period].map(|time| exponential(&(continuous * time)));
    // A command of so many ticks ago: first the older one, for the fraction, then the newer one.
    let older = rest.fixed_view::<STATE_COUNT, STATE_COUNT>(0, 0) * late.fixed_view::<STATE_COUNT, 2>(0, STATE_COUNT);
    let newer = rest.fixed_view::<STATE_COUNT, 2>(0, STATE_COUNT);
    let free = rest.fixed_view::<STATE_COUNT, STATE_COUNT>(0, 0) * late.fixed_view::<STATE_COUNT, STATE_COUNT>(0, 0);

    // c_(k-1), c_(k-2), ... follow epsilon, delta and tau.
    let held = whole + 1;
    let size = STATE_COUNT + 2 * held;
    let before = |age: usize| STATE_COUNT + 2 * (age - 1);
    let mut command = DMatrix::zeros(2, size);
    command.view_mut((0, 0), (2, 2)).copy_from(&of_error);
    command.view_mut((0, 2), (2, 2)).copy_from(&of_rate);
    command.view_mut((0, 4), (2, 2)).copy_from(&(of_pending * rotor_lag));
    for age in 1..=held {
        let time = if age <= whole { period } else { fraction * period };
        command.view_mut((0, before(age)), (2, 2)).copy_from(&(of_pending * time));
    }
    let mut tick = DMatrix::zeros(size, size);
    tick.view_mut((0, 0), (STATE_COUNT, STATE_COUNT)).copy_from(&free);
    for (age, response) in [(whole, newer.into_owned()), (whole + 1, older)] {
        if age == 0 {
            let mut now = tick.view_mut((0, 0), (STATE_COUNT, size));
            now += response * &command;
        } else {
            let mut then = tick.view_mut((0, before(age)), (STATE_COUNT, 2));
            then += response;
        }
    }
    tick.view_mut((STATE_COUNT, 0), (2, size)).copy_from(&command);
    for age in 2..=held {
        tick.view_mut((before(age), before(age - 1)), (2, 2)).fill_with_identity();
    }
    spectral_radius(tick)
}

/// e^A, from the series of A / 2^[`EXPONENTIAL_SQUARINGS`], squared that often.
fn exponential(matrix: &State) -> State {
    let small = matrix / f64::from(EXPONENTIAL_SQUARINGS).exp2();
    let one = State::identity();
    let series = (1..=EXPONENTIAL_TERMS).rev().fold(one, |sum, k| one + small * sum / f64::from(k));
    (0..EXPONENTIAL_SQUARINGS).fold(series, |power, _| power * power)
}

/// The motion in continuous time, its command held.
fn continuous((n, rate): (&Vector3<f64>, f64), vehicle: &Vehicle, lag: f64) -> State {
    let inertia = Matrix3::from_diagonal(&vehicle.inertia.map(f64::from));
    let omega = n * rate;
    // epsilon is across n, and delta has no z: each from its x and y.
    let across = SMatrix::<f64, 3, 2>::new(1.0, 0.0, 0.0, 1.0, -n.x / n.z, -n.y / n.z);
    let level = SMatrix::<f64, 3, 2>::new(1.0, 0.0, 0.0, 1.0, 0.0, 0.0);
    let gyroscopic = omega.cross_matrix() * inertia - (inertia * omega).cross_matrix();
    let per_inertia = inertia.map_diagonal(|x| 1.0 / x).xy();
    let top = |matrix: SMatrix<f64, 3, 2>| matrix.fixed_view::<2, 2>(0, 0).into_owned();
    let spread = Matrix2::from_diagonal(&per_inertia);
    let mut rates = State::zeros();
    rates.fixed_view_mut::<2, 2>(0, 0).copy_from(&top(-omega.cross_matrix() * across));
    rates.fixed_view_mut::<2, 2>(0, 2).copy_from(&top(n.cross_matrix() * level));
    rates.fixed_view_mut::<2, 2>(2, 2).copy_from(&(-spread * top(gyroscopic * level)));
    rates.fixed_view_mut::<2, 2>(2, 4).copy_from(&spread);
    rates.fixed_view_mut::<2, 2>(4, 4).copy_from(&Matrix2::from_diagonal_element(-1.0 / lag));
    rates.fixed_view_mut::<2, 2>(4, 6).copy_from(&Matrix2::from_diagonal_element(1.0 / lag));
    rates
}

/// K_epsilon, K_delta and K_p, by differences; commands act `late`, s.
fn slopes(law: &WithoutARotor, (n, rate): (&Vector3<f64>, f64), vehicle: &Vehicle, late: f64) -> [Matrix2<f64>; 3] {
    let omega = n * rate;
    let inertia = vehicle.inertia.map(f64::from);
    let holding = omega.cross(&inertia.component_mul(&omega));
    let upright = UnitQuaternion::rotation_between(n, &Vector3::z()).unwrap_or_default();
    let torque = |error: Vector2<f64>, rate: Vector2<f64>, pending: Vector2<f64>| {
        // R' e3 = n + epsilon.
        let eta = Vector3::new(n.x + error.x, n.y + error.y, n.z - (n.xy().dot(&error)) / n.z);
        let moved = UnitQuaternion::rotation_between(&eta, n).unwrap_or_default();
        let attitude = (upright * moved).into_inner();
        let attitude = Quaternion::from(attitude.coords.map(|x| x as f32));
        let turning = (omega + rate.push(0.0)).map(|x| x as f32);
        let impulse = (holding.xy() * late + pending).map(|x| x as f32);
        let pending = Vector4::new(0.0, impulse.x, impulse.y, 0.0);
        law.clone().stepped(attitude, turning, &pending).0.map(f64::from).xy()
    };
    let zero = Vector2::zeros();
    let difference = |step: f64, at: &dyn Fn(Vector2<f64>) -> Vector2<f64>| {
        let each = [Vector2::x(), Vector2::y()].map(|axis| (at(axis * step) - at(axis * -step)) / (2.0 * step));
        Matrix2::from_columns(&each)
    };
    let impulse = RATE_STEP_RAD_PER_S * inertia.xy().min();
    [
        difference(TILT_STEP_RAD, &|error| torque(error, zero, zero)),
        difference(RATE_STEP_RAD_PER_S, &|rate| torque(zero, rate, zero)),
        if late > 0.0 { difference(impulse, &|pending| torque(zero, zero, pending)) } else { Matrix2::zeros() },
    ]
}

#[cfg(test)]
mod tests;
