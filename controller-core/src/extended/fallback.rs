//! The fallback: a flight that makes no progress goes on with the same law, slowed down until nothing limits it.
//! Section 13 of `docs/extended-law.md`.
//!
//! While nothing is limited V_0 falls and the vehicle arrives. That the limiter of [`super::direction_limiter`] falls
//! silent is not proven for bandwidths as high as the law's own. With all bandwidths times sigma, k_p times sigma^2 and
//! feedback of at most M_s, the frame never needs more than a part of the reserve ([`Slowed`]): V_0 decides alone.
//!
//! Progress is looked at in windows of [`PROGRESS_WINDOW_S`]. The vehicle is near where sqrt(|p~|^2 + (1 s |v~|)^2) is
//! below [`NEAR_DISTANCE_M`]. Progress is a window whose greatest |v~| is less than ever since the vehicle was near, or
//! whose greatest
//! |p~| is less than ever since that, in either case by a tenth or by [`PROGRESS_STEP_MAX`]: so often in a row as that
//! is finite.
//!
//! | law | at a window's end |
//! |---|---|
//! | own | goes on, if the vehicle was near in this window or made progress; otherwise the law is slowed, from filters that start afresh |
//! | slowed | goes on, until it has lasted [`FIRST_STAY_S`] times 2^(k - 1), k being how often it came, and the vehicle is near |
//!
//! A vehicle that noise and gusts move is near in every window; one that comes from far away, or falls and brakes,
//! makes progress. Each stay is twice as long as the last: so from some time on one of the two laws flies for good.

use super::parameters::ExtendedParameters;
use crate::math;
use crate::math::real::Real;
use core::hint::cold_path;
use nalgebra::Vector3;

/// s.
pub const PROGRESS_WINDOW_S: f32 = 20.0;

/// Near the target, m; what is below it makes no progress.
pub const NEAR_DISTANCE_M: f32 = 0.5;

/// Progress from far away, m or m/s.
pub const PROGRESS_STEP_MAX: f32 = 5.0;

/// |p~| grows by more than this, m, beside twice what |v~| makes of it, only where reference or state jump: all begins
/// anew.
const JUMP_DISTANCE_M: f32 = 0.5;

/// The first stay, s.
pub const FIRST_STAY_S: f32 = 20.0;

/// A stay is doubled so often at most: then it lasts for centuries.
const STAY_DOUBLINGS_MAX: u32 = 30;

/// |v~| counts as a distance times this, s.
const SPEED_LEAD_S: f32 = 1.0;

/// M_s, m/s^2: the slowed law's greatest feedback.
const SLOW_LEVEL_M_PER_S2: f64 = 1.0;

/// The part of alpha_0, and of Omega and sqrt(alpha_0), that the slowed law may need along each axis.
const TURN_SHARE: f64 = 0.2;

/// The reference's vertical acceleration that this counts with, m/s^2.
const REFERENCE_FALL_M_PER_S2: f64 = 1.0;

/// What |u| counts as at least, m/s^2.
const COMMAND_MIN_M_PER_S2: f64 = 0.5;

/// sigma and M_s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slowed<R> {
    /// sigma: what bandwidths are multiplied by.
    pub factor: R,
    /// M_s, m/s^2.
    pub level: R,
}

impl<R: Real> Slowed<R> {
    /// c + d, x + d and y + d start and stay within M_s, so |c'| <= 2 k_f M_s and |c''| <= 2 k_f (k_s + k_f) M_s: so
    /// much slower that this takes `TURN_SHARE` of what turns rho at the least |u|, g - D_z+ - M_s less the
    /// reference's.
    pub fn new(parameters: &ExtendedParameters, gravity: f32) -> Self {
        let p = parameters;
        let [k_f, k_s, reserve, rate] = [p.k_f, p.k_s, p.turn_reserve, p.turn_rate].map(R::from);
        let level = R::from(SLOW_LEVEL_M_PER_S2);
        let min = (R::from(gravity) - R::from(p.force_up) - level - REFERENCE_FALL_M_PER_S2)
            .greater(R::from(COMMAND_MIN_M_PER_S2))
            * TURN_SHARE;
        let by_acceleration = (reserve * min / (k_f * 2.0 * (k_s + k_f) * level)).sqrt_of_rounded();
        let by_rate = rate.lesser(reserve.sqrt_of_rounded()) * min / (k_f * 2.0 * level);
        Self { factor: by_acceleration.lesser(by_rate).lesser(R::from(1.0)), level }
    }

    /// The greatest |c'| and |c''|, m/s^3 and m/s^4, where across and along the vertical feedback is M_s at once.
    pub fn derivatives(&self, parameters: &ExtendedParameters) -> [R; 2] {
        let [k_f, k_s] = [parameters.k_f, parameters.k_s].map(|bandwidth| R::from(bandwidth) * self.factor);
        let jerk = k_f * 2.0 * self.level * R::from(2.0).sqrt();
        [jerk, jerk * (k_s + k_f)]
    }
}

/// The greatest speed of approach of the slowed law, m/s: M_s stops it within 2 m.
const SLOW_SPEED_M_PER_S: f32 = 2.0;

/// The constants of the slowed law.
pub fn slowed(parameters: &ExtendedParameters, gravity: f32) -> ExtendedParameters {
    let by = Slowed::<f64>::new(parameters, gravity).factor as f32;
    let p = parameters;
    ExtendedParameters {
        k_p_across: by * by * p.k_p_across,
        k_p_vertical: by * by * p.k_p_vertical,
        k_v_across: by * p.k_v_across,
        k_v_vertical: by * p.k_v_vertical,
        k_f: by * p.k_f,
        k_s: by * p.k_s,
        k_d: by * p.k_d,
        v_across: math::min(p.v_across, SLOW_SPEED_M_PER_S),
        v_up: math::min(p.v_up, SLOW_SPEED_M_PER_S),
        v_down: math::min(p.v_down, SLOW_SPEED_M_PER_S),
        ..*p
    }
}

/// Whole microseconds: a sum of them never stalls.
const fn micros(seconds: f32) -> u64 {
    (seconds * 1e6 + 0.5) as u64
}

/// The fallback's memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fallback {
    /// Whether the law is slowed.
    slow: bool,
    /// How often it was since the reset.
    times: u32,
    /// Since the window's start, or the stay's, us.
    elapsed: u64,
    /// |p~| in the last tick, m.
    now: f32,
    /// Whether the vehicle was near in this window.
    near: bool,
    /// The greatest |p~| and |v~| of this window, m and m/s.
    max: [f32; 2],
    /// What progress is counted from, likewise.
    best: [f32; 2],
}

impl Fallback {
    /// After a reset.
    pub const FRESH: Self =
        Self { slow: false, times: 0, elapsed: 0, now: f32::MAX, near: false, max: [0.0; 2], best: [f32::MAX; 2] };

    /// Whether the law is slowed.
    pub fn is_slow(&self) -> bool {
        self.slow
    }

    /// How often it was slowed since the reset.
    pub fn times(&self) -> u32 {
        self.times
    }

    /// A tick of `period`, s, with the errors p~, m, and v~, m/s; returns whether the law is slowed from now on.
    pub fn observe(&mut self, position: &Vector3<f32>, velocity: &Vector3<f32>, period: f32) -> bool {
        let errors = [position.norm_squared(), velocity.norm_squared()].map(math::sqrt);
        let [distance, speed] = errors;
        let near =
            distance * distance + speed * speed * (SPEED_LEAD_S * SPEED_LEAD_S) < NEAR_DISTANCE_M * NEAR_DISTANCE_M;
        let jumped = distance > self.now + JUMP_DISTANCE_M + 2.0 * speed * period;
        self.now = distance;
        self.elapsed = self.elapsed.saturating_add(micros(period));
        if self.slow {
            cold_path();
            if near && self.elapsed >= self.stay() {
                *self = self.next_window([f32::MAX; 2]);
            }
            return false;
        }
        if jumped {
            cold_path();
            *self = self.next_window([f32::MAX; 2]);
        }
        self.near |= near;
        for (max, error) in self.max.iter_mut().zip(errors) {
            *max = math::max(*max, error);
        }
        if self.elapsed < micros(PROGRESS_WINDOW_S) {
            return false;
        }
        cold_path();
        let [farthest, fastest] = self.max;
        let [distance, speed] = self.best;
        let is_less =
            |now: f32, best: f32| best > NEAR_DISTANCE_M && now < best - math::min(0.1 * best, PROGRESS_STEP_MAX);
        *self = if self.near {
            self.next_window([f32::MAX; 2])
        } else if is_less(fastest, speed) {
            self.next_window([farthest, fastest])
        } else if is_less(farthest, distance) {
            self.next_window([farthest, speed])
        } else {
            Self { slow: true, times: self.times.saturating_add(1), now: self.now, ..Self::FRESH }
        };
        self.slow
    }

    /// The next window of the law's own bandwidths.
    fn next_window(&self, best: [f32; 2]) -> Self {
        Self { times: self.times, now: self.now, best, ..Self::FRESH }
    }

    /// How long this stay is at least, us.
    fn stay(&self) -> u64 {
        let doublings = self.times.saturating_sub(1);
        micros(FIRST_STAY_S) << if doublings < STAY_DOUBLINGS_MAX { doublings } else { STAY_DOUBLINGS_MAX }
    }
}
