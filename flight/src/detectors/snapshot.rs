//! What one tick shows of the vehicle, without debouncing: far, still, lying, struck, held up, turning.
//!
//! [`super::Detectors`] decides how long each must last.

use crate::chain::{Chain, Flown};
use crate::rules::Mode;
use crate::tilt::tilt_cosine;
use estimation::estimator::EstimatedState;
use nalgebra::Vector3;

/// The speed that lying poses may show of a standing vehicle.
const STANDING_SPEED_BY_POSES_MAX_M_PER_S: f32 = 0.5;

/// The sink speed of a vehicle that meets the ground with an impact.
const IMPACT_SINK_SPEED_MIN_M_PER_S: f32 = 0.2;

/// How much slower than its reference a landing may go down.
const LANDING_SPEED_TOLERANCE_M_PER_S: f32 = 0.15;

/// How far below the vehicle the reference is when it has landed, and how slow the vehicle is then.
const LANDED_REFERENCE_BELOW_MIN_M: f32 = 0.25;
const LANDED_SPEED_MAX_M_PER_S: f32 = 0.1;

/// How far above the vehicle the reference may be while the vehicle does not move.
const HELD_DOWN_REFERENCE_ABOVE_MIN_M: f32 = 0.5;

/// The motion of a vehicle that stands or lies on the ground.
const STILL_SPEED_MAX_M_PER_S: f32 = 0.15;
const STILL_RATE_MAX_RAD_PER_S: f32 = 0.5;

/// The vertical acceleration that the law commands on the ground, after an impact and without one; and the one that is
/// measured instead.
const COMMANDED_AFTER_IMPACT_MAX_M_PER_S2: f32 = -0.25;
pub(super) const COMMANDED_WITHOUT_IMPACT_MAX_M_PER_S2: f32 = -0.8;
const MEASURED_ON_GROUND_MAX_M_PER_S2: f32 = 0.4;

/// The acceleration that is measured after a touchdown, horizontal included: an attitude error of 8 degrees leaves as
/// much.
const LEANING_ACCELERATION_MAX_M_PER_S2: f32 = 1.5;

/// The force beside the rotors' that an IMU may measure: wind, drag, and rotors weaker or stronger than modelled.
const UNEXPECTED_ACCELERATION_MAX_M_PER_S2: f32 = 4.0;

/// The friction of feet on the ground, as a share of the load.
const FRICTION_SHARE_MAX: f32 = 1.0;

/// The tilt of a crash: 60 degrees, and 80 where the law commands it.
const LYING_COSINE: f32 = 0.5;
const LYING_UNDER_LAW_COSINE: f32 = 0.173_648_2;

/// The horizontal part of theta~ of a vehicle that lies away from the commanded attitude: tan(30 degrees / 4).
const LYING_MRP_MIN: f32 = 0.131_652_5;

/// The acceleration beside the commanded one that only a crash gives.
const STRUCK_ACCELERATION_MIN_M_PER_S2: f32 = 25.0;

/// The rate of a vehicle that has been levelled for a while.
const LEVELLED_RATE_MAX_RAD_PER_S: f32 = 4.0;

/// The inputs of a tick: the low-passed estimate, and what the last tick flew.
pub(super) struct Snapshot<'a> {
    pub mode: Mode,
    pub state: Option<&'a EstimatedState>,
    pub chain: Option<&'a Chain<'a>>,
    pub flown: Option<&'a Flown>,
}

impl Snapshot<'_> {
    /// Whether the vehicle is farther than `max`, m, from its reference.
    pub fn is_far(&self, max: f32) -> bool {
        self.mode.is_guided() && self.flown.is_some_and(|flown| !within(&flown.position_error, max))
    }

    /// Whether it stays where it should be going up; with a rotor lost it may turn on the ground.
    pub fn is_held_down(&self) -> bool {
        let (true, Some(state), Some(flown)) = (self.mode.is_guided(), self.state, self.flown) else { return false };
        within(&state.state.velocity, STILL_SPEED_MAX_M_PER_S)
            && flown.reference.position.z > state.state.position.z + HELD_DOWN_REFERENCE_ABOVE_MIN_M
    }

    /// Whether the rotors do not deliver the commanded wrench.
    pub fn is_inexact(&self) -> bool {
        self.mode.flies() && self.chain.is_some_and(|chain| !chain.is_exact())
    }

    /// Whether the vehicle lies still on its side or its back, or does not turn to the commanded attitude.
    pub fn lies(&self) -> bool {
        let beside = self.flown.map(|flown| flown.mrp.xy().norm_squared() > LYING_MRP_MIN * LYING_MRP_MIN);
        let tilted = |state: &EstimatedState, cosine| tilt_cosine(&state.state.attitude) < cosine;
        let lies = |state| match beside {
            Some(beside) => beside || tilted(state, LYING_UNDER_LAW_COSINE),
            None => tilted(state, LYING_COSINE),
        };
        self.mode.is_armed() && self.state.is_some_and(|state| is_still(state) && lies(state))
    }

    /// Whether it stands still where it should be going down, by the estimate.
    pub fn is_left_behind(&self) -> bool {
        let (Mode::Landing, Some(state), Some(flown)) = (self.mode, self.state, self.flown) else { return false };
        let stands = is_still(state) && within(&state.state.velocity, LANDED_SPEED_MAX_M_PER_S);
        stands && flown.reference.position.z + LANDED_REFERENCE_BELOW_MIN_M < state.state.position.z
    }

    /// Whether something strikes a vehicle in guided flight, by this very tick's `state`.
    pub fn is_struck(&self, state: Option<&EstimatedState>) -> bool {
        let (true, Some(state), Some(chain), Some(flown)) = (self.mode.is_guided(), state, self.chain, self.flown)
        else {
            return false;
        };
        !within(&chain.unexpected(flown, state), STRUCK_ACCELERATION_MIN_M_PER_S2)
    }

    /// The force that the IMU measures beside the rotors', m/s^2, world; and the commanded vertical acceleration.
    fn feels(&self) -> Option<(Vector3<f32>, f32, &EstimatedState)> {
        let (Some(state), Some(chain), Some(flown)) = (self.state, self.chain, self.flown) else { return None };
        Some((chain.unexpected(flown, state), chain.commanded_acceleration(flown), state))
    }

    /// The same, only in flight without a pose.
    fn by_imu(&self) -> Option<(Vector3<f32>, f32, &EstimatedState)> {
        self.feels().filter(|_| self.mode == Mode::Descending)
    }

    /// Whether a landing moves: down as it should, or as what stands does not, as far as its poses say.
    fn moves_landing(&self) -> bool {
        let (Some(state), Some(flown)) = (self.state, self.flown) else { return false };
        let speed = state.state.velocity.z;
        speed < flown.reference.velocity.z + LANDING_SPEED_TOLERANCE_M_PER_S
            || speed.abs() > STANDING_SPEED_BY_POSES_MAX_M_PER_S
    }

    /// The upward acceleration that stops a vehicle that goes down, m/s^2, in this very tick's `state`.
    pub fn impact_acceleration(&self, state: Option<&EstimatedState>) -> f32 {
        // Also before it goes down, if it still sinks.
        let sinks = self.chain.is_some_and(Chain::sinks)
            || self.flown.is_some_and(|flown| flown.state.velocity.z < -IMPACT_SINK_SPEED_MIN_M_PER_S);
        let now = Snapshot { state, ..*self };
        now.feels().filter(|_| sinks).map_or(0.0, |(unexpected, ..)| unexpected.z)
    }

    /// Whether a vehicle that goes down should accelerate downwards and does not, after an `impact`, a touchdown or a
    /// `hit`, or without.
    pub fn is_held_up(&self, impact: bool, touched: bool, hit: bool) -> bool {
        let falling = if impact { COMMANDED_AFTER_IMPACT_MAX_M_PER_S2 } else { COMMANDED_WITHOUT_IMPACT_MAX_M_PER_S2 };
        let measured = MEASURED_ON_GROUND_MAX_M_PER_S2;
        let may = self.mode == Mode::Descending || self.mode == Mode::Landing && impact;
        self.feels().filter(|_| may).is_some_and(|(_, commanded, state)| {
            let moves = match self.mode {
                Mode::Landing => self.moves_landing(),
                _ => !hit && self.chain.is_some_and(|chain| chain.may_move(touched)),
            };
            !moves
                && self.chain.is_some_and(Chain::sinks)
                && commanded < falling
                && state.acceleration.z.abs() <= measured
                && within(&state.acceleration, if touched { LEANING_ACCELERATION_MAX_M_PER_S2 } else { measured })
                && within(&state.state.angular_velocity, STILL_RATE_MAX_RAD_PER_S)
        })
    }

    /// Whether the IMU measures a force that the rotors do not explain, nor, once the vehicle has `touched` it, the
    /// ground, along which it may slide.
    pub fn is_unexpected(&self, touched: bool) -> bool {
        self.by_imu().is_some_and(|(unexpected, _, state)| {
            let carried = touched && state.acceleration.z.abs() <= MEASURED_ON_GROUND_MAX_M_PER_S2;
            let slides = carried && unexpected.xy().norm() <= FRICTION_SHARE_MAX * unexpected.z;
            !within(&unexpected, UNEXPECTED_ACCELERATION_MAX_M_PER_S2) && !slides
        })
    }

    /// Whether a vehicle that is levelled turns, or is not level; one that has lost a rotor does both.
    pub fn turns(&self) -> bool {
        let spins = self.chain.is_some_and(|chain| chain.lost().is_some());
        !spins
            && self.by_imu().is_some_and(|(_, _, EstimatedState { state, .. })| {
                !within(&state.angular_velocity, LEVELLED_RATE_MAX_RAD_PER_S)
                    || tilt_cosine(&state.attitude) < LYING_COSINE
            })
    }
}

/// Whether it neither moves nor turns, at this moment.
pub(in super::super) fn is_still(state: &EstimatedState) -> bool {
    within(&state.state.velocity, STILL_SPEED_MAX_M_PER_S)
        && within(&state.state.angular_velocity, STILL_RATE_MAX_RAD_PER_S)
}

/// Whether a vector is at most `max` long. A NaN is not.
fn within(vector: &Vector3<f32>, max: f32) -> bool {
    vector.norm_squared() <= max * max
}
