//! Which rotor has failed, and what it has left: from what the vehicle does beside what its commands make it do.
//!
//! Over an interval with the mean wrench w of the commands ([`super::super::actuators`]), in newtons, torques over the
//! longest arm l,
//!
//! | here | equation |
//! |---|---|
//! | residual e | (m b . (v' + g e3) - T, (J omega' + omega x J omega - tau) / l) |
//! | slow part e_s | e, averaged over `SLOW_TIME_CONSTANT_S`: wind, drag, a wrong mass or centre of mass, a battery that sags |
//! | quick part r | e - e_s, averaged over `QUICK_TIME_CONSTANT_S` |
//! | rotor i that lost a share lambda of its thrust f_i | r = -lambda f_i b_i, b_i its column of B in newtons |
//! | alignment | -r . b_i / (\|r\| \|b_i\|) |
//! | share | lambda = -r . b_i / (f_i \|b_i\|^2) |
//! | large enough | \|r\| >= `RESIDUAL_SHARE_MIN` F + `RESIDUAL_OF_COMMANDS` A + `RESIDUAL_OF_TURNING` F \|omega_12\|, F a rotor's share of the weight |
//! | commands A | the greatest \|w - w_s\| of late, w_s averaged as e_s; it fades within `FADING_TIME_CONSTANT_S` |
//! | evidence | grows by h (lambda / `GONE_SHARE`)^3 in a tick that tells, falls by h in one that contradicts |
//!
//! A failed rotor takes thrust and torque in one ratio and of one sign, and goes on doing so. So the rotor of the
//! greatest alignment is suspected while r is large enough, the alignment at least `ALIGNMENT_MIN` and lambda within
//! `LOST_SHARE_RANGE`. It is found once the evidence has grown to `EVIDENCE_MIN_S` and to the rotors' lag: a dead one
//! at once, one that has lost a third after some ten times as long. Another rotor starts anew: a gust, a hit or the
//! ground pushes otherwise, or not for so long. A rotor of which nothing is commanded tells nothing either way.
//!
//! A rotor that its own speed shows to fail ([`Measured::lost`](super::super::measured::Measured::lost)) is found as
//! soon as r points against its b_i most, and shows `AGREEING_SHARE` of the loss. A speed alone finds none: a controller
//! may report what is not so.
//!
//! What a model leaves out grows with what the vehicle does: a lag, an inertia or a thrust that is not what it should
//! be with the commands, the air's damping with the rates. So r has to be larger then, and a rotor that fails in the
//! middle of a flip is found a little later.
//!
//! While one is suspected the slow part waits. After a jump of the state, on the ground, or after a command that was
//! not carried out there is nothing to compare. At first the model is believed as if it had been right for
//! `INITIAL_AGE_S`; no rotor is suspected before `AGE_MIN_S`.

use crate::allocation::geometry::ROTORS_MAX;
use crate::allocation::remaining::LostRotor;
use crate::allocation::{Rotors, collected};
use crate::math;
use crate::vehicle::Vehicle;
use core::hint::cold_path;
use heapless::Vec;
use nalgebra::{Vector3, Vector4};

/// Time constants of the slow and the quick part, and of the greatest command of late, s.
const SLOW_TIME_CONSTANT_S: f64 = 1.0;
const QUICK_TIME_CONSTANT_S: f64 = 0.01;
const FADING_TIME_CONSTANT_S: f64 = 0.3;

/// The parts of the least |r| that tells anything.
const RESIDUAL_SHARE_MIN: f32 = 0.3;
const RESIDUAL_OF_COMMANDS: f32 = 0.45;
const RESIDUAL_OF_TURNING: f32 = 0.06;

/// The least alignment.
const ALIGNMENT_MIN: f32 = 0.96;

/// The shares that a rotor may have lost. More than all of it is something else.
const LOST_SHARE_RANGE: (f32, f32) = (0.25, 1.4);

/// The share that counts as a rotor that is gone, and the one beyond which it is taken to have nothing left.
const GONE_SHARE: f32 = 0.8;
const NOTHING_LEFT_SHARE: f32 = 0.87;

/// How long a rotor is suspected that is gone, beside the rotors' lag, s.
const EVIDENCE_MIN_S: f32 = 0.02;

/// The least thrust that tells what a rotor has lost, in its share of the weight.
const TELLING_THRUST_SHARE_MIN: f32 = 0.3;

/// The part of a loss that a rotor's speed shows, which the motion has to show as well.
const AGREEING_SHARE: f32 = 0.25;

/// For how long the model is taken to have been right before the first interval, s, and until when that counts for more
/// than what has been seen.
const INITIAL_AGE_S: f32 = 0.3;
const AGE_MIN_S: f32 = 0.45;

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
    inertia_per_period: Vector3<f32>,
    mass: f32,
    gravity: f32,
    per_arm: f32,
    /// F, N.
    share: f32,
    /// 1 - e^(-h / time constant).
    slow: f32,
    quick: f32,
    /// What is left of A^2 after a period.
    faded_squared: f32,
    /// The evidence that is enough, s.
    enough: f32,
    period: f32,
}

/// What it remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Suspicion {
    /// e_s and w_s, N; none before the first interval.
    lasting: Option<[Vector4<f32>; 2]>,
    /// For how long they have been averaged, s, up to `SLOW_TIME_CONSTANT_S`.
    age: f32,
    /// r, N.
    residual: Vector4<f32>,
    /// A^2, N^2.
    commands_squared: f32,
    /// Who is suspected, and the evidence against it, s.
    rotor: usize,
    evidence: f32,
}

impl Suspicion {
    /// Of nobody.
    pub const NONE: Self = Self {
        lasting: None,
        age: INITIAL_AGE_S,
        residual: Vector4::new(0.0, 0.0, 0.0, 0.0),
        commands_squared: 0.0,
        rotor: 0,
        evidence: 0.0,
    };

    /// After an interval that tells nothing.
    pub fn forget(&mut self) {
        self.residual = Vector4::zeros();
        self.evidence = 0.0;
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
    /// For ticks `period` seconds apart and rotors of so much `lag`, s. Without rotors it finds nothing.
    pub fn new(vehicle: &Vehicle, rotors: Option<&Rotors>, lag: f32, period: f32) -> Self {
        let columns = || rotors.into_iter().flat_map(Rotors::effectiveness).map(|column| column.map(|x| x as f32));
        let per_arm = rotors.map_or(0.0, |rotors| 1.0 / rotors.max_arm());
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
            inertia_per_period: vehicle.inertia / period,
            mass: vehicle.mass,
            gravity: vehicle.gravity,
            per_arm,
            share: vehicle.mass * vehicle.gravity / count as f32,
            slow: averaging(SLOW_TIME_CONSTANT_S),
            quick: averaging(QUICK_TIME_CONSTANT_S),
            faded_squared: math::exp(-2.0 * f64::from(period) / FADING_TIME_CONSTANT_S) as f32,
            // Half a period: sums of periods are rounded.
            enough: EVIDENCE_MIN_S + lag - 0.5 * period,
            period,
        }
    }

    /// Takes an interval in; the rotor that is found.
    #[inline(never)] // a step behind a shield calls the same
    pub fn observe(&self, suspicion: &mut Suspicion, interval: &Interval) -> Option<LostRotor> {
        let (residual, acted) = (self.residual(interval), self.newtons(&interval.acted));
        // Inputs in range can overflow together.
        if !(residual.norm_squared() + acted.norm_squared()).is_finite() {
            suspicion.forget();
            return None;
        }
        let [lasting, steady] = suspicion.lasting.unwrap_or([Vector4::zeros(), acted]);
        suspicion.residual += (residual - lasting - suspicion.residual) * self.quick;
        let faded = suspicion.commands_squared * self.faded_squared;
        suspicion.commands_squared = math::max(faded, (acted - steady).norm_squared());

        let Some((rotor, lost)) = self.suspected(suspicion, interval) else {
            let mut averaging = self.slow;
            if suspicion.age < SLOW_TIME_CONSTANT_S as f32 {
                cold_path();
                // An average of all that there was, at first.
                averaging = math::max(averaging, self.period / (suspicion.age + self.period));
                suspicion.age += self.period;
            }
            if suspicion.evidence > 0.0 && self.is_observable(suspicion.rotor, interval) {
                suspicion.evidence = math::max(suspicion.evidence - self.period, 0.0);
            }
            let average = [lasting + (residual - lasting) * averaging, steady + (acted - steady) * averaging];
            suspicion.lasting = Some(average);
            return None;
        };
        cold_path();
        suspicion.lasting = Some([lasting, steady]);
        let before = if rotor == suspicion.rotor { suspicion.evidence } else { 0.0 };
        let share = math::min(lost / GONE_SHARE, 1.0);
        suspicion.evidence = before + self.period * share * share * share;
        suspicion.rotor = rotor;
        let left = if lost > NOTHING_LEFT_SHARE { 0.0 } else { 1.0 - lost };
        (suspicion.evidence > self.enough).then_some(LostRotor { rotor, left })
    }

    /// Whether the motion agrees, after [`Self::observe`], that a rotor is `lost`.
    pub fn agrees(&self, suspicion: &Suspicion, interval: &Interval, lost: &LostRotor) -> bool {
        self.most_aligned(&suspicion.residual).is_some_and(|(index, rotor, along)| {
            index == lost.rotor && self.share_lost(rotor, along, interval) > AGREEING_SHARE * (1.0 - lost.left)
        })
    }

    /// A wrench in newtons.
    fn newtons(&self, wrench: &Vector4<f32>) -> Vector4<f32> {
        let arm = self.per_arm;
        wrench.component_mul(&Vector4::new(1.0, arm, arm, arm))
    }

    /// The thrust that a rotor is taken to deliver in an interval, N, and what is missing of it by the torque about the
    /// tilt's axes.
    pub fn missing(&self, rotor: usize, interval: &Interval) -> [f32; 2] {
        let Some(Signature { column, row, .. }) = self.rotors.get(rotor) else { return [0.0; 2] };
        let along = self.residual(interval).yz().dot(&column.yz());
        [row.dot(&interval.acted), -along / math::max(column.yz().norm_squared(), f32::MIN_POSITIVE)]
    }

    /// e, N.
    fn residual(&self, interval: &Interval) -> Vector4<f32> {
        let Interval { acceleration, angular_velocities: [start, end], axis, acted } = interval;
        let mean = (*start + *end) * 0.5;
        let turned = self.inertia_per_period.component_mul(&(*end - *start));
        let torque = turned + mean.cross(&self.inertia.component_mul(&mean));
        let thrust = self.mass * (acceleration.dot(axis) + self.gravity * axis.z);
        self.newtons(&(Vector4::new(thrust, torque.x, torque.y, torque.z) - acted))
    }

    /// Whether a rotor is commanded so much thrust that a loss would show.
    fn is_observable(&self, rotor: usize, interval: &Interval) -> bool {
        self.rotors
            .get(rotor)
            .is_some_and(|rotor| rotor.row.dot(&interval.acted) > TELLING_THRUST_SHARE_MIN * self.share)
    }

    /// The rotor against whose b_i a residual points most, and how far, N.
    fn most_aligned(&self, residual: &Vector4<f32>) -> Option<(usize, &Signature, f32)> {
        let (mut max, mut which) = (0.0, None);
        for (index, rotor) in self.rotors.iter().enumerate() {
            let along = -residual.dot(&rotor.column) * rotor.per_length;
            if along > max {
                (max, which) = (along, Some((index, rotor, along)));
            }
        }
        which
    }

    /// lambda of a rotor against which r points so far, N.
    fn share_lost(&self, rotor: &Signature, along: f32, interval: &Interval) -> f32 {
        let thrust = rotor.row.dot(&interval.acted);
        along * rotor.per_length / math::max(thrust, TELLING_THRUST_SHARE_MIN * self.share)
    }

    /// The rotor that r is most aligned with, and the share that it has lost.
    fn suspected(&self, suspicion: &Suspicion, interval: &Interval) -> Option<(usize, f32)> {
        let residual = &suspicion.residual;
        let (square, large) = (residual.norm_squared(), RESIDUAL_SHARE_MIN * self.share);
        if square <= large * large || suspicion.age <= AGE_MIN_S {
            return None;
        }
        cold_path();
        let [_, end] = interval.angular_velocities;
        let turning = RESIDUAL_OF_TURNING * self.share * math::sqrt(end.xy().norm_squared());
        let min = large + turning + RESIDUAL_OF_COMMANDS * math::sqrt(suspicion.commands_squared);
        if square <= min * min {
            return None;
        }
        let (index, rotor, along) = self.most_aligned(residual)?;
        let lost = self.share_lost(rotor, along, interval);
        let aligned = along * along >= ALIGNMENT_MIN * ALIGNMENT_MIN * square;
        let (min, most) = LOST_SHARE_RANGE;
        let tells = self.is_observable(index, interval);
        (aligned && tells && lost >= min && lost <= most).then_some((index, lost))
    }
}

#[cfg(test)]
mod tests;
