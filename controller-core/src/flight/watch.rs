//! What a flight looks like: whether the vehicle follows its reference, has landed, or lies on its back.
//!
//! - *Landed*, with an estimate: the reference has gone on down and the vehicle has not, and stands still. Nothing in the air does that.
//! - *Landed*, by the IMU alone: something has stopped the vehicle with a jerk, and the law now asks for less thrust than carries it.
//!   Or, where the ground was soft, for so little that the vehicle must fall faster, and it does not. Rotors that give 8 % more
//!   than the law knows would look the same: with the law's thrust scale they do not.
//! - *The IMU is doubtful*, where nothing else is left: it feels another force than the rotors are asked for, or the vehicle does not
//!   come upright, or turns on.
//! - *Crashed*: tilted by 60 degrees or more and still. A vehicle that recovers in the air from there turns or falls.

use super::chain::{Chain, Flown};
use super::exchange::{Battery, Inputs};
use super::lasting::Lasting;
use super::leaning::up;
use super::rules::{BATTERY_LASTING, Mode, OVERRUN_LASTING, SATURATION_LASTING, TRACKING_LASTING};
use crate::estimator::EstimatedState;
use nalgebra::Vector3;

/// How long it must look like the ground, us.
pub const GROUND_LASTING: u64 = 500_000;

/// How far below the vehicle the reference is when it has landed, m.
const GONE_ON: f32 = 0.25;

/// The speed, m/s, and the rate, rad/s, at most, of what lies on the ground.
const STILL: (f32, f32) = (0.15, 0.5);

/// The upward acceleration that only the ground gives, m/s^2.
const JERK: f32 = 5.0;

/// The vertical acceleration that the law asks for at most on the ground, m/s^2, after a jerk and without one; and the greatest that
/// is measured instead.
const HELD_UP: (f32, f32, f32) = (-0.25, -0.8, 0.4);

/// The force that an IMU may feel beside the rotors', m/s^2: wind, drag, and rotors that are not what they should be.
const UNEXPECTED: f32 = 4.0;

/// The rate at which nothing turns that has been levelled for a while, rad/s; and that while, us.
const TURNING: f32 = 4.0;
const TURNING_LASTING: u64 = 800_000;

/// How long an IMU may not fit, us.
const DOUBT_LASTING: u64 = 300_000;

/// The cosine of the least tilt of a crash, 60 degrees.
const LYING_COSINE: f32 = 0.5;

/// Since when what holds.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Watch {
    tracking: Lasting,
    saturated: Lasting,
    lying: Lasting,
    resting: Lasting,
    low: Lasting,
    critical: Lasting,
    late: Lasting,
    doubtful: Lasting,
    turning: Lasting,
    /// Whether something has stopped a vehicle that goes down by the IMU alone.
    jerked: bool,
    /// Whether a low battery has had its landing: whoever flies on knows.
    low_is_told: bool,
}

/// What is so.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(super) struct Seen {
    pub tracking_lost: bool,
    pub saturated: bool,
    pub landed: bool,
    pub crashed: bool,
    pub battery_low: bool,
    pub battery_critical: bool,
    pub overrun: bool,
    pub imu_doubtful: bool,
}

impl Watch {
    /// Looks at what the last tick led to.
    pub fn tick(
        &mut self,
        mode: Mode,
        state: Option<&EstimatedState>,
        chain: Option<&Chain>,
        tracking_error_max: f32,
        inputs: &Inputs,
    ) -> Seen {
        let now = inputs.now;
        let flown = chain.and_then(Chain::flown).filter(|_| mode.flies());
        let far =
            flown.filter(|_| mode.is_guided()).is_some_and(|flown| !within(&flown.position_error, tracking_error_max));
        let inexact = mode.flies() && chain.is_some_and(|chain| !chain.is_exact());
        let lying =
            mode.is_armed() && state.is_some_and(|state| is_still(state) && up(&state.state.attitude) < LYING_COSINE);
        self.jerked = match (mode, state, flown, chain) {
            (Mode::Descending, Some(state), Some(flown), Some(chain)) => {
                self.jerked || chain.sinks() && chain.unexpected(flown, state).z > JERK
            }
            _ => false,
        };
        let on_ground = match (mode, state, flown, chain) {
            (Mode::Landing, Some(state), Some(flown), _) => is_still(state) && is_left_behind(state, flown),
            (Mode::Descending, Some(state), Some(flown), Some(chain)) => {
                is_held_up(state, chain.asked_acceleration(flown), self.jerked)
            }
            _ => false,
        };
        let doubtful = match (mode, state, flown, chain) {
            (Mode::Descending, Some(state), Some(flown), Some(chain)) => {
                !within(&chain.unexpected(flown, state), UNEXPECTED)
            }
            _ => false,
        };
        let turning = mode == Mode::Descending
            && state.is_some_and(|EstimatedState { state, .. }| {
                state.angular_velocity.norm_squared() > TURNING * TURNING || up(&state.attitude) < LYING_COSINE
            });
        let is_standing = mode.flies() && chain.is_some_and(Chain::is_standing);
        let battery_low = self.low.is_so(inputs.battery == Battery::Low, BATTERY_LASTING, now);
        Seen {
            tracking_lost: self.tracking.is_so(far, TRACKING_LASTING, now),
            saturated: self.saturated.is_so(inexact, SATURATION_LASTING, now),
            landed: self.resting.is_so(on_ground, GROUND_LASTING, now) || is_standing,
            crashed: self.lying.is_so(lying, GROUND_LASTING, now),
            battery_low: battery_low && !self.low_is_told,
            battery_critical: self.critical.is_so(inputs.battery == Battery::Critical, BATTERY_LASTING, now),
            imu_doubtful: self.doubtful.is_so(doubtful, DOUBT_LASTING, now)
                | self.turning.is_so(turning, TURNING_LASTING, now),
            overrun: self.late.is_so(inputs.is_late, OVERRUN_LASTING, now),
        }
    }

    /// A low battery has been acted on.
    pub fn tell_low(&mut self) {
        self.low_is_told = true;
    }
}

/// Whether a vector is at most so long. One that is made of no numbers is not.
fn within(vector: &Vector3<f32>, most: f32) -> bool {
    vector.norm_squared() <= most * most
}

fn is_still(state: &EstimatedState) -> bool {
    let (speed, rate) = STILL;
    let state = &state.state;
    state.velocity.norm_squared() < speed * speed && state.angular_velocity.norm_squared() < rate * rate
}

fn is_left_behind(state: &EstimatedState, flown: &Flown) -> bool {
    flown.reference.position.z + GONE_ON < state.state.position.z
}

/// Whether a vehicle that should accelerate upwards by `asked`, m/s^2, and does not, stands on something.
fn is_held_up(state: &EstimatedState, asked: f32, jerked: bool) -> bool {
    let (after_a_jerk, without, measured) = HELD_UP;
    let falling = if jerked { after_a_jerk } else { without };
    let turns = state.state.angular_velocity.norm_squared() < STILL.1 * STILL.1;
    turns && asked < falling && state.acceleration.norm_squared() < measured * measured
}
