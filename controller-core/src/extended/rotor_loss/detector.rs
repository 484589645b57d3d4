//! Which rotor has failed, and what it has left: from what the vehicle does beside what its commands make it do.
//!
//! Over an interval with the mean wrench w of the commands ([`super::super::actuators`]),
//!
//! | here | equation |
//! |---|---|
//! | residual e | (m b . (v' + g e3) - T, (J omega' + omega x J omega - tau) / l), newtons; l the longest arm |
//! | slow part e_s | e, averaged over [`SLOW`]: wind, drag, a wrong mass or centre of mass, a battery that sags |
//! | quick part r | e - e_s, averaged over [`QUICK`] |
//! | rotor i that lost a share lambda of its thrust f_i | r = -lambda f_i b_i, b_i its column of B in newtons |
//! | alignment | a_i = -r . b_i / (\|r\| \|b_i\|) |
//! | share | lambda_i = -r . b_i / (f_i \|b_i\|^2) |
//!
//! A failed rotor takes thrust and torque in one ratio and of one sign, and goes on doing so. So the rotor of the greatest
//! alignment is suspected while r is large enough to tell, a_i at least [`ALIGNED`] and lambda_i within
//! [`SHARES`]; and found after [`TIME_GONE`] if it has lost nearly all, after [`TIME_LESS`] if it has lost less. Another
//! rotor, or none, starts anew: a gust, a hit or the ground pushes otherwise, or not for so long. While one is suspected
//! the slow part waits, and after a jump of the state, on the ground, or after a command that was not carried out there
//! is nothing to compare.

use crate::allocation::geometry::ROTORS_MAX;
use crate::allocation::remaining::Lost;
use crate::allocation::{Rotors, collected};
use crate::math;
use crate::vehicle::Vehicle;
use heapless::Vec;
use nalgebra::{Vector3, Vector4};

/// Time constants of the slow and the quick part, s.
const SLOW: f64 = 1.0;
const QUICK: f64 = 0.01;

/// The least |r| that tells anything, in a rotor's share of the weight.
const LARGE: f32 = 0.25;

/// The least alignment.
const ALIGNED: f32 = 0.9;

/// The shares that a rotor may have lost. More than all of it is something else.
const SHARES: (f32, f32) = (0.25, 1.4);

/// The share beyond which it is taken to be gone, and how long it is suspected before that, s.
const GONE: f32 = 0.8;
const TIME_GONE: f32 = 0.025;

/// How long a rotor that has lost less is suspected, s.
const TIME_LESS: f32 = 0.08;

/// The least thrust that tells what a rotor has lost, in its share of the weight.
const TELLING: f32 = 0.3;

/// A rotor as the detector sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Signature {
    /// b_i, and 1 / |b_i|.
    column: Vector4<f32>,
    per_length: f32,
    /// Its row of B+.
    row: Vector4<f32>,
}

/// The constants for one vehicle and one period.
#[derive(Debug, Clone, PartialEq)]
pub struct Detector {
    rotors: Vec<Signature, ROTORS_MAX>,
    inertia: Vector3<f32>,
    mass: f32,
    gravity: f32,
    per_arm: f32,
    /// A rotor's share of the weight, N.
    share: f32,
    /// 1 - e^(-h / time constant) of the slow and the quick part.
    slow: f32,
    quick: f32,
    period: f32,
}

/// What it remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Suspicion {
    /// e_s, N; none before the first interval.
    lasting: Option<Vector4<f32>>,
    /// r, N.
    residual: Vector4<f32>,
    /// Who is suspected, and for how long, s.
    rotor: usize,
    time: f32,
}

impl Suspicion {
    /// Of nobody.
    pub const NONE: Self = Self { lasting: None, residual: Vector4::new(0.0, 0.0, 0.0, 0.0), rotor: 0, time: 0.0 };

    /// After an interval that tells nothing.
    pub fn forget(&mut self) {
        *self = Self { lasting: self.lasting, ..Self::NONE };
    }
}

/// An interval.
#[derive(Debug, Clone, Copy)]
pub struct Interval<'a> {
    /// Its mean acceleration, m/s^2, world frame.
    pub acceleration: Vector3<f32>,
    /// Body rates at its start and end, rad/s.
    pub angular_velocities: [&'a Vector3<f32>; 2],
    /// R e3 in its middle, about.
    pub axis: Vector3<f32>,
    /// The mean wrench of the commands, N and N m.
    pub acted: Vector4<f32>,
}

impl Detector {
    /// For ticks `period` seconds apart. Without rotors it finds nothing.
    #[must_use]
    pub fn new(vehicle: &Vehicle, rotors: Option<&Rotors>, period: f32) -> Self {
        let columns = || rotors.into_iter().flat_map(Rotors::effectiveness).map(|column| column.map(|x| x as f32));
        let arm = columns().map(|column| column.yz().norm_squared()).fold(f32::MIN_POSITIVE, math::greater);
        let per_arm = 1.0 / math::sqrt(arm);
        let scale = Vector4::new(1.0, per_arm, per_arm, per_arm);
        let rows = rotors.into_iter().flat_map(Rotors::pseudo_inverse).map(|row| row.map(|x| x as f32));
        let signatures = columns().zip(rows).map(|(column, row)| {
            let column = column.component_mul(&scale);
            Signature { column, per_length: 1.0 / math::sqrt(column.norm_squared()), row }
        });
        let averaging = |time: f64| -math::exp_m1(-f64::from(period) / time) as f32;
        let count = rotors.map_or(1, |rotors| rotors.len());
        Self {
            rotors: collected(signatures),
            inertia: vehicle.inertia,
            mass: vehicle.mass,
            gravity: vehicle.gravity,
            per_arm,
            share: vehicle.mass * vehicle.gravity / count as f32,
            slow: averaging(SLOW),
            quick: averaging(QUICK),
            period,
        }
    }

    /// Takes an interval in; the rotor that is found.
    pub fn observe(&self, suspicion: &mut Suspicion, interval: &Interval) -> Option<Lost> {
        let residual = self.residual(interval);
        // Inputs in range can overflow together.
        if !(residual.norm_squared() < f32::MAX) {
            suspicion.forget();
            return None;
        }
        let lasting = suspicion.lasting.unwrap_or(residual);
        suspicion.residual += (residual - lasting - suspicion.residual) * self.quick;
        let square = suspicion.residual.norm_squared();
        let least = LARGE * self.share;
        let suspected = if square > least * least { self.suspected(suspicion, interval) } else { None };
        let Some((rotor, lost)) = suspected else {
            suspicion.time = 0.0;
            suspicion.lasting = Some(lasting + (residual - lasting) * self.slow);
            return None;
        };
        suspicion.lasting = Some(lasting);
        suspicion.time = if rotor == suspicion.rotor { suspicion.time + self.period } else { self.period };
        suspicion.rotor = rotor;
        let is_gone = lost > GONE;
        let time = if is_gone { TIME_GONE } else { TIME_LESS };
        // Half a period: sums of periods are rounded.
        let found = suspicion.time > time - 0.5 * self.period;
        found.then_some(Lost { rotor, left: if is_gone { 0.0 } else { 1.0 - lost } })
    }

    /// e, N.
    fn residual(&self, interval: &Interval) -> Vector4<f32> {
        let Interval { acceleration, angular_velocities: [start, end], axis, acted } = interval;
        let mean = (*start + *end) * 0.5;
        let turned = self.inertia.component_mul(&(*end - *start)) / self.period;
        let torque = turned + mean.cross(&self.inertia.component_mul(&mean));
        let thrust = self.mass * (acceleration.dot(axis) + self.gravity * axis.z);
        let torque = (torque - Vector3::new(acted.y, acted.z, acted.w)) * self.per_arm;
        Vector4::new(thrust - acted.x, torque.x, torque.y, torque.z)
    }

    /// The rotor that r is most aligned with, and the share that it has lost.
    fn suspected(&self, suspicion: &Suspicion, interval: &Interval) -> Option<(usize, f32)> {
        let residual = &suspicion.residual;
        let (mut greatest, mut which) = (0.0, None);
        for (index, rotor) in self.rotors.iter().enumerate() {
            let along = -residual.dot(&rotor.column) * rotor.per_length;
            if along > greatest {
                (greatest, which) = (along, Some((index, rotor)));
            }
        }
        let (index, rotor) = which?;
        let thrust = rotor.row.dot(&interval.acted);
        let lost = greatest * rotor.per_length / math::greater(thrust, TELLING * self.share);
        let aligned = greatest * greatest >= ALIGNED * ALIGNED * residual.norm_squared();
        let (least, most) = SHARES;
        (aligned && thrust > TELLING * self.share && lost >= least && lost <= most).then_some((index, lost))
    }
}

#[cfg(test)]
mod tests;
