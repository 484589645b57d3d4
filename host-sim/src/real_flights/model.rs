//! The vehicle that a part of a flight shows, and how it moves on from a state.
//!
//! ```text
//! p' = v      v' = R f - g e3      R' = R hat(omega)                  world z up
//! f = (a + s (S - S_0)) e3 - diag(D/m) R' v + f_0                     S: thrusts behind the rotors' lag
//! omega_i' = (c/J_i) tau_i - beta_i omega_i + e_i                     no coupling: it is small near hover
//! ```
//!
//! a, s, T and D/m are [`super::forces`]'s; c/J, beta and e the least-squares fit of how rates change within 0.1 s,
//! about axes whose inertia the log shows ([`super::torques`]): about others commands foretell nothing, and turning
//! goes on as it is. f_0 is what the poses' motion shows beside the accelerometer's forces: markers are not quite
//! level.

use super::flown::{Flown, PERIOD_S, Sample};
use super::forces::{Forces, lagged};
use super::regression::Sums;
use super::torques::torque;
use controller_core::allocation::Rotors;
use nalgebra::{DVector, UnitQuaternion, Vector3};

/// Within which rates change for the fit, samples.
const CHANGE_SAMPLES: usize = 10;

/// The numbers of one vehicle.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundVehicle {
    /// a, m/s^2: of the last part of the flight.
    pub level: f64,
    /// s, 1/kg.
    pub response: f64,
    /// S_0, N.
    pub mean_thrust: f64,
    /// T up and down, s.
    pub lags: [f64; 2],
    /// D/m, 1/s.
    pub drag: Vector3<f64>,
    /// f_0, m/s^2.
    pub beside: Vector3<f64>,
    /// c/J, 1/(kg m^2).
    pub turning: Vector3<f64>,
    /// beta, 1/s.
    pub damping: Vector3<f64>,
    /// e, rad/s^2.
    pub steady: Vector3<f64>,
    /// m/s^2.
    pub gravity: f64,
}

/// Where a vehicle is, and how it moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// m, world.
    pub position: Vector3<f64>,
    /// m/s, world.
    pub velocity: Vector3<f64>,
    /// Body to world.
    pub attitude: UnitQuaternion<f64>,
    /// rad/s, body.
    pub rates: Vector3<f64>,
}

impl Motion {
    /// As a sample has it.
    pub fn of_sample(sample: &Sample) -> Self {
        Self { position: sample.position, velocity: sample.velocity, attitude: sample.attitude, rates: sample.rates }
    }
}

impl FoundVehicle {
    /// The vehicle that `flown` shows; `turns` are the axes about which commands turn it.
    ///
    /// # Errors
    /// If it does not show one.
    pub fn new(
        flown: &Flown,
        forces: &Forces,
        rotors: &Rotors,
        gravity: f64,
        turns: [bool; 3],
    ) -> Result<Self, String> {
        let lags = forces.lag_values();
        let strength = forces.strengths.last().copied().unwrap_or(forces.strength.value);
        let mut found = Self {
            level: strength * forces.mean_thrust,
            response: forces.response.value * forces.strength.value,
            mean_thrust: forces.mean_thrust,
            lags,
            drag: Vector3::from_fn(|axis, _| forces.drag[axis].value),
            beside: Vector3::zeros(),
            turning: Vector3::zeros(),
            damping: Vector3::zeros(),
            steady: Vector3::zeros(),
            gravity,
        };
        let acting = lagged(&flown.samples, lags);
        found.beside = found.missing_force(&flown.samples, &acting);
        for axis in (0..3).filter(|axis| turns[*axis]) {
            let fit = fitted_turning(&flown.samples, &acting, rotors, axis).ok_or("shows no turning")?;
            (found.turning[axis], found.damping[axis], found.steady[axis]) = (fit[0], fit[1], fit[2]);
        }
        Ok(found)
    }

    /// f_0: over the flight, what was gained of speed along the body's axes beyond what the model gives.
    fn missing_force(&self, samples: &[Sample], acting: &[Vec<f64>]) -> Vector3<f64> {
        let (mut missing, mut count) = (Vector3::zeros(), 0.0);
        for (pair, thrusts) in samples.windows(CHANGE_SAMPLES + 1).zip(acting.iter().skip(CHANGE_SAMPLES / 2)) {
            let (first, last) = (&pair[0], &pair[CHANGE_SAMPLES]);
            let middle = &pair[CHANGE_SAMPLES / 2];
            let gained = (last.velocity - first.velocity) / (CHANGE_SAMPLES as f64 * PERIOD_S);
            let felt = middle.attitude.inverse_transform_vector(&(gained + Vector3::z() * self.gravity));
            missing += felt - self.force(thrusts, &middle.attitude.inverse_transform_vector(&middle.velocity));
            count += 1.0;
        }
        missing / f64::max(count, 1.0)
    }

    /// f, m/s^2, body: of these thrusts, N, at this velocity, m/s, body.
    pub fn force(&self, thrusts: &[f64], velocity: &Vector3<f64>) -> Vector3<f64> {
        let thrust = self.level + self.response * (thrusts.iter().sum::<f64>() - self.mean_thrust);
        Vector3::z() * thrust - self.drag.component_mul(velocity) + self.beside
    }

    /// omega', rad/s^2.
    pub fn turned(&self, thrusts: &[f64], rotors: &Rotors, rates: &Vector3<f64>) -> Vector3<f64> {
        self.turning.component_mul(&torque(thrusts, rotors)) - self.damping.component_mul(rates) + self.steady
    }
}

/// One period on: by force, m/s^2, body, and omega', rad/s^2, at its middle.
pub fn advanced(motion: &Motion, force: &Vector3<f64>, turned: &Vector3<f64>, gravity: f64) -> Motion {
    let rates = motion.rates + turned * PERIOD_S;
    let middle = (motion.rates + rates) * 0.5;
    let half = motion.attitude * UnitQuaternion::from_scaled_axis(middle * (PERIOD_S / 2.0));
    let acceleration = half * force - Vector3::z() * gravity;
    Motion {
        position: motion.position + (motion.velocity + acceleration * (PERIOD_S / 2.0)) * PERIOD_S,
        velocity: motion.velocity + acceleration * PERIOD_S,
        attitude: motion.attitude * UnitQuaternion::from_scaled_axis(middle * PERIOD_S),
        rates,
    }
}

/// c/J, beta and e about one axis.
fn fitted_turning(samples: &[Sample], acting: &[Vec<f64>], rotors: &Rotors, axis: usize) -> Option<[f64; 3]> {
    let torques: Vec<f64> = acting.iter().map(|thrusts| torque(thrusts, rotors)[axis]).collect();
    let mut sums = Sums::new(3);
    for (pair, torques) in samples.windows(CHANGE_SAMPLES + 1).zip(torques.windows(CHANGE_SAMPLES)) {
        let turned = pair.iter().take(CHANGE_SAMPLES).map(|sample| sample.rates[axis]).sum::<f64>() * PERIOD_S;
        let impulse = torques.iter().sum::<f64>() * PERIOD_S;
        let row = DVector::from_vec(vec![impulse, -turned, CHANGE_SAMPLES as f64 * PERIOD_S]);
        sums.add(&row, pair[CHANGE_SAMPLES].rates[axis] - pair[0].rates[axis]);
    }
    let (unknowns, _) = sums.solved()?;
    Some([unknowns[0], unknowns[1], unknowns[2]])
}
