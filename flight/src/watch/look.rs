//! What one tick shows of the vehicle, before it has lasted: far, still, lying, struck, held up, turning.
//!
//! What must last before it is believed, and for how long, is the business of [`super::Watch`].

use crate::chain::{Chain, Flown};
use crate::rules::Mode;
use crate::tilt::up;
use estimation::estimator::EstimatedState;
use nalgebra::Vector3;

/// The speed, m/s, that poses which lie may show of a standing vehicle.
const STANDING_SPEED_BY_POSES: f32 = 0.5;

/// How fast a vehicle sinks at least that meets the ground with a jerk, m/s.
const LEAST_SINKING_SPEED: f32 = 0.2;

/// By how much a landing may be slower than its reference and goes down all the same, m/s.
const LANDING_SLOWER_BY: f32 = 0.15;

/// How far below the vehicle the reference is when it has landed, m; and how slow the vehicle is then, m/s.
const REFERENCE_BELOW: f32 = 0.25;
const STANDING_SPEED: f32 = 0.1;

/// How far above the vehicle the reference may be that does not move towards it, m.
const REFERENCE_ABOVE: f32 = 0.5;

/// The speed, m/s, and the rate, rad/s, at most, of what lies on the ground.
const STILL_SPEED_AND_RATE: (f32, f32) = (0.15, 0.5);

/// The greatest vertical acceleration that the law commands on the ground, m/s^2, after a jerk and without one; and the
/// greatest that is measured instead.
pub(super) const HELD_UP_ACCELERATIONS: (f32, f32, f32) = (-0.25, -0.8, 0.4);

/// The acceleration that is measured at most after a touchdown, m/s^2: across, an attitude that is off by 8 degrees
/// leaves as much.
const LEANING_ACCELERATION: f32 = 1.5;

/// The force that an IMU may feel beside the rotors', m/s^2: wind, drag, and rotors that are not what they should be.
const UNEXPECTED_ACCELERATION: f32 = 4.0;

/// The greatest friction of feet on the ground, as a share of what it carries.
const FRICTION_SHARE_MAX: f32 = 1.0;

/// The cosine of the least tilt of a crash: 60 degrees, and 80 where the law wants the vehicle so.
const LYING_COSINE: f32 = 0.5;
const LYING_WANTED_COSINE: f32 = 0.173_648_2;

/// The least part of theta~ across, of a vehicle that lies beside where the law wants it: tan(30 degrees / 4).
const LYING_BESIDE: f32 = 0.131_652_5;

/// The acceleration that only a crash adds to what was commanded, m/s^2.
const STRUCK_ACCELERATION: f32 = 25.0;

/// The rate at which nothing turns that has been levelled for a while, rad/s.
const LEVELLED_RATE: f32 = 4.0;

/// The inputs of a tick: the low-passed estimate, and what the last tick flew.
pub(super) struct Look<'a> {
    pub mode: Mode,
    pub state: Option<&'a EstimatedState>,
    pub chain: Option<&'a Chain<'a>>,
    pub flown: Option<&'a Flown>,
}

impl Look<'_> {
    /// Whether the vehicle is farther than `most`, m, from its reference.
    pub fn is_far(&self, most: f32) -> bool {
        self.mode.is_guided() && self.flown.is_some_and(|flown| !within(&flown.position_error, most))
    }

    /// Whether it stays where it should be going up; with a rotor lost it may turn on the ground.
    pub fn is_held_down(&self) -> bool {
        let (true, Some(state), Some(flown)) = (self.mode.is_guided(), self.state, self.flown) else { return false };
        within(&state.state.velocity, STILL_SPEED_AND_RATE.0)
            && flown.reference.position.z > state.state.position.z + REFERENCE_ABOVE
    }

    /// Whether the rotors do not deliver the commanded wrench.
    pub fn is_inexact(&self) -> bool {
        self.mode.flies() && self.chain.is_some_and(|chain| !chain.is_exact())
    }

    /// Whether the vehicle lies still on its side or its back, or does not turn to where the law wants it.
    pub fn lies(&self) -> bool {
        let beside = self.flown.map(|flown| flown.mrp.xy().norm_squared() > LYING_BESIDE * LYING_BESIDE);
        let tilted = |state: &EstimatedState, cosine| up(&state.state.attitude) < cosine;
        let lies = |state| match beside {
            Some(beside) => beside || tilted(state, LYING_WANTED_COSINE),
            None => tilted(state, LYING_COSINE),
        };
        self.mode.is_armed() && self.state.is_some_and(|state| is_still(state) && lies(state))
    }

    /// Whether it stands still where it should be going down, by the estimate.
    pub fn is_left_behind(&self) -> bool {
        let (Mode::Landing, Some(state), Some(flown)) = (self.mode, self.state, self.flown) else { return false };
        let stands = is_still(state) && within(&state.state.velocity, STANDING_SPEED);
        stands && flown.reference.position.z + REFERENCE_BELOW < state.state.position.z
    }

    /// Whether something strikes a vehicle in guided flight, by this very tick's `state`.
    pub fn is_struck(&self, state: Option<&EstimatedState>) -> bool {
        let (true, Some(state), Some(chain), Some(flown)) = (self.mode.is_guided(), state, self.chain, self.flown)
        else {
            return false;
        };
        !within(&chain.unexpected(flown, state), STRUCK_ACCELERATION)
    }

    /// The force that the IMU measures beside the rotors', m/s^2, world; and the commanded vertical acceleration.
    fn feels(&self) -> Option<(Vector3<f32>, f32, &EstimatedState)> {
        let (Some(state), Some(chain), Some(flown)) = (self.state, self.chain, self.flown) else { return None };
        Some((chain.unexpected(flown, state), chain.commanded_acceleration(flown), state))
    }

    /// The same, only where nothing but the IMU is left.
    fn by_imu(&self) -> Option<(Vector3<f32>, f32, &EstimatedState)> {
        self.feels().filter(|_| self.mode == Mode::Descending)
    }

    /// Whether a landing moves: down as it should, or as what stands does not, as far as its poses say.
    fn moves_landing(&self) -> bool {
        let (Some(state), Some(flown)) = (self.state, self.flown) else { return false };
        let speed = state.state.velocity.z;
        speed < flown.reference.velocity.z + LANDING_SLOWER_BY || speed.abs() > STANDING_SPEED_BY_POSES
    }

    /// With which upward acceleration something stops a vehicle that goes down, m/s^2, in this very tick's `state`.
    pub fn jerk(&self, state: Option<&EstimatedState>) -> f32 {
        // Also before it goes down, if it still sinks.
        let sinks = self.chain.is_some_and(Chain::sinks)
            || self.flown.is_some_and(|flown| flown.state.velocity.z < -LEAST_SINKING_SPEED);
        let now = Look { state, ..*self };
        now.feels().filter(|_| sinks).map_or(0.0, |(unexpected, ..)| unexpected.z)
    }

    /// Whether a vehicle that goes down should accelerate downwards and does not, `jerked` or `touched` before or not,
    /// or with a `hit`.
    pub fn is_held_up(&self, jerked: bool, touched: bool, hit: bool) -> bool {
        let (after_a_jerk, without, measured) = HELD_UP_ACCELERATIONS;
        let falling = if jerked { after_a_jerk } else { without };
        let may = self.mode == Mode::Descending || self.mode == Mode::Landing && jerked;
        self.feels().filter(|_| may).is_some_and(|(_, commanded, state)| {
            let moves = match self.mode {
                Mode::Landing => self.moves_landing(),
                _ => !hit && self.chain.is_some_and(|chain| chain.may_move(touched)),
            };
            !moves
                && self.chain.is_some_and(Chain::sinks)
                && commanded < falling
                && state.acceleration.z.abs() <= measured
                && within(&state.acceleration, if touched { LEANING_ACCELERATION } else { measured })
                && within(&state.state.angular_velocity, STILL_SPEED_AND_RATE.1)
        })
    }

    /// Whether the IMU measures a force that the rotors do not explain, nor, once the vehicle has `touched` it, the
    /// ground, along which it may slide.
    pub fn is_unexpected(&self, touched: bool) -> bool {
        self.by_imu().is_some_and(|(unexpected, _, state)| {
            let carried = touched && state.acceleration.z.abs() <= HELD_UP_ACCELERATIONS.2;
            let slides = carried && unexpected.xy().norm() <= FRICTION_SHARE_MAX * unexpected.z;
            !within(&unexpected, UNEXPECTED_ACCELERATION) && !slides
        })
    }

    /// Whether a vehicle that is levelled turns, or is not level; one that has lost a rotor does both.
    pub fn turns(&self) -> bool {
        let spins = self.chain.is_some_and(|chain| chain.lost().is_some());
        !spins
            && self.by_imu().is_some_and(|(_, _, EstimatedState { state, .. })| {
                !within(&state.angular_velocity, LEVELLED_RATE) || up(&state.attitude) < LYING_COSINE
            })
    }
}

/// Whether it neither moves nor turns, at this moment.
pub(in super::super) fn is_still(state: &EstimatedState) -> bool {
    let (speed, rate) = STILL_SPEED_AND_RATE;
    within(&state.state.velocity, speed) && within(&state.state.angular_velocity, rate)
}

/// Whether a vector is at most so long. A NaN is not.
fn within(vector: &Vector3<f32>, most: f32) -> bool {
    vector.norm_squared() <= most * most
}
