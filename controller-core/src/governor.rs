//! The reference governor: any stream of setpoints in, a reference inside Omega_r out.
//!
//! The certificate covers references inside its [`ReferenceBounds`]; operators send steps. In between, once per knot:
//!
//! ```text
//! setpoint -> target -> pursuit (|alpha| in a cylinder) -> x_0 -> two moving averages --\
//!          -> stream -> feedback -> envelope --------------------------------------------+-> head -> average -> spline -> Reference
//! ```
//!
//! A spline has a knot in every control tick up to 100 Hz, and above that in every second, third ... so that knots lie
//! `KNOT_INTERVAL_MIN_S` or more apart. In the ticks between two knots the reference is the spline at their time. So
//! neither the bounds nor the memory depend on the rate. In the parts below a tick is the time between two knots.
//!
//! - `braking`, `pursuit`: the command x_0, a double integrator that makes for the target and stops on it;
//! - `lead`: where the command must be for the output to be on a moving point;
//! - `windows`: why averages of these lengths keep acceleration, jerk and snap inside, and which lengths;
//! - `averages`: the first two, of the command, in integers: a head that keeps the bounds under any setpoint;
//! - `stream`, `stream_follower`, `blend`, `envelope`: a head that is on a stream of setpoints as it is sent, where
//!   that keeps the bounds;
//! - `demand`: what a stream asks of the bounds, for those who send it;
//! - `smoother`, `steady`: the last average and the quintic spline that makes the output one smooth function of time,
//!   and where the averages begin;
//! - `heading_governor`: the same for the heading;
//!
//! What holds by construction: every bound, at every instant, whatever is sent (NaN is refused);
//! position to snap are one function and its derivatives, snap moves by at most 2 K_s in [`GovernorLimits::snap_ramp`],
//! psi'' likewise; from rest, a constant position is reached along the straight segment without overshoot, exactly (the
//! averages of a monotone approach are monotone), and a stop is a straight braking of the command followed by the
//! averages. Arrival from states in motion, and catching up with a stream, are shown by campaign.
//!
//! What it costs: the averages add (T_1+T_2+T_3) to the time-optimal double integrator. For K_a12 2.5, K_a3 0.5, K_j 4,
//! K_s 10 that is 2.2 s: 10 m take 6.3 s. A moving point is followed without lag where it keeps turning and
//! accelerating as it does; once caught up with, a stream inside the bounds is flown as it is sent. One outside comes
//! out smoothed and smaller.

mod averages;
mod blend;
mod braking;
mod demand;
mod envelope;
mod goal;
mod head_and_stream;
mod heading_governor;
mod lead;
mod limits;
mod pursuit;
mod setpoint;
mod smoother;
mod steady;
mod stream;
mod stream_follower;
mod windows;

pub use demand::FollowingReport;
pub use limits::{GovernorLimits, SPEED_RANGE_M_PER_S};
pub use setpoint::{HeadingSetpoint, Motion, POSITION_RANGE_M, Setpoint};

use crate::error::{InputError, ParameterError, Reason, require, require_positive};
use crate::heading::Heading;
use crate::math::{self, clamp, f32_to_i64, i64_to_f32, saturate};
use crate::reference::{Reference, ReferenceBounds};
use crate::state::check_vectors;
use averages::Averages;
use goal::Goal;
use heading_governor::{HeadingGoal, HeadingGovernor};
use lead::Lead;
use nalgebra::Vector3;
use pursuit::Pursuit;
use setpoint::Parts;
use smoother::{Knot, Smoother};
use steady::Steady;
use stream::Stream;
use stream_follower::{HeadDrive, StreamFollower};
use windows::Windows;

/// Where a governor lies: 9 KB, most of them the commands that its averages remember. Its user makes it, where it
/// stays.
#[derive(Debug, Clone, PartialEq)]
pub struct Memory(Governor);

impl Memory {
    /// For any governor. All zeros, which is at rest at the origin: a static one takes no flash.
    pub const EMPTY: Self = Self(Governor {
        tick: 0.0,
        parts: 0,
        part: 0,
        period: 0.0,
        timeout: 0,
        windows: Windows::NONE,
        per_snap: 0.0,
        ahead: 0.0,
        spread: 0.0,
        pursuit: Pursuit::NONE,
        lead: Lead::NONE,
        averages: Averages::NONE,
        smoother: Smoother::NONE,
        follower: StreamFollower::NONE,
        knot: Knot::NONE,
        crackle: Vector3::new(0.0, 0.0, 0.0),
        turning: HeadingGovernor::NONE,
        goal: Goal::STOP,
        goal_age: 0,
        goal_late: 0.0,
        turn: HeadingGoal::STOP,
        turn_age: 0,
    });
}

/// The bounded-reference generator.
#[derive(Debug, Clone, PartialEq)]
pub struct Governor {
    /// The time between two control ticks, s; how many of them there are between two knots, and since the last but one.
    tick: f32,
    parts: u32,
    part: u32,
    /// The time between two knots, s.
    period: f32,
    /// Ticks after which what must be renewed is stale.
    timeout: u32,
    windows: Windows,
    /// The head's snap of one m/s^2 per tick squared, as the integers have it.
    per_snap: f32,
    /// By how much the head is ahead of the knot, s, and half the variance of what lies between, s^2.
    ahead: f32,
    spread: f32,
    pursuit: Pursuit,
    lead: Lead,
    averages: Averages,
    smoother: Smoother,
    follower: StreamFollower,
    /// The newest knot, and the fifth derivative on the way to it, m/s^5.
    knot: Knot,
    crackle: Vector3<f32>,
    turning: HeadingGovernor,
    goal: Goal,
    /// Control ticks since it came.
    goal_age: u32,
    /// How long before it came the goal was true, s.
    goal_late: f32,
    turn: HeadingGoal,
    turn_age: u32,
}

impl Governor {
    /// A governor in `memory` for `bounds` that ticks every `period` seconds, at rest at the origin along world x. What
    /// was there before is lost.
    ///
    /// # Errors
    /// For a period outside (0, 0.1] s, a limit or bound that is not positive, or bounds too unlike each other for the
    /// integers.
    pub fn new<'m>(
        bounds: &ReferenceBounds,
        limits: &GovernorLimits,
        period: f32,
        memory: &'m mut Memory,
    ) -> Result<&'m mut Self, ParameterError> {
        for (value, path) in bounds.values().into_iter().zip(ReferenceBounds::PATHS) {
            require_positive(value, path)?;
        }
        for (value, max, field) in [
            (period, 0.1, "governor.period"),
            (limits.horizontal_speed, SPEED_RANGE_M_PER_S, "governor.horizontal_speed"),
            (limits.vertical_speed, SPEED_RANGE_M_PER_S, "governor.vertical_speed"),
            (limits.snap_ramp, DURATION_MAX_S, "governor.snap_ramp"),
            (limits.heading_ramp, DURATION_MAX_S, "governor.heading_ramp"),
            (limits.timeout, DURATION_MAX_S, "governor.timeout"),
        ] {
            require_positive(value, field)?;
            require(value <= max, field, Reason::Above(max))?;
        }
        // In place: built apart and moved here, a governor would take its size in code and on the stack.
        *memory = Memory::EMPTY;
        let Memory(governor) = memory;
        governor.timeout = windows::ticks(limits.timeout, period) as u32;
        governor.tick = period;
        governor.parts = parts(period);
        governor.part = governor.parts;
        let period = period * governor.parts as f32;
        let windows = Windows::design(bounds, limits, period)?;
        governor.turning.design(bounds, limits, period)?;
        governor.averages.design(&windows);
        governor.smoother.design(&windows, period);
        let horizontal_speed = limits.horizontal_speed.min(bounds.horizontal_speed);
        governor.pursuit = Pursuit::new(&windows, horizontal_speed, limits.vertical_speed, period);
        governor.lead = Lead {
            delay: windows.delay() * period,
            variance: windows.variance() * period * period,
            acceleration: windows.horizontal / (windows.per_metre * period * period),
        };
        governor.design_follower(&windows, bounds, limits, period);
        governor.windows = windows;
        governor.period = period;
        Ok(governor)
    }

    /// Starts anew at a steady motion: `position` and `velocity`, pointing along `heading`, which does not turn (its
    /// rates are dropped). Without setpoints it is brought to a smooth stop.
    ///
    /// # Errors
    /// For numbers not finite or out of range; the governor goes on as before then.
    pub fn start(
        &mut self,
        position: &Vector3<f32>,
        velocity: &Vector3<f32>,
        heading: &Heading,
    ) -> Result<(), InputError> {
        check_vectors(&[
            (position, POSITION_RANGE_M, "initial.position"),
            (velocity, SPEED_RANGE_M_PER_S, "initial.velocity"),
        ])?;
        let (position, speed) = (self.length(position), self.length(&(velocity * self.period)));
        let ahead = self.windows.span() + 1;
        let steady = |position: i64, speed: i64| {
            // The trail, rounded to the nearest unit, and the two ticks that the control points are ahead.
            Steady { commanded: position + ((speed * ahead + 1) >> 1), speed, acceleration: 0 }
        };
        self.go_on(&[steady(position.x, speed.x), steady(position.y, speed.y), steady(position.z, speed.z)]);
        self.part = self.parts;
        self.follower.start();
        self.turning.start(heading_governor::nearest_phase(heading));
        self.stop();
        Ok(())
    }

    /// Goes on as if the command had always been in this steady acceleration.
    fn go_on(&mut self, steady: &[Steady; 3]) {
        let [x, y, z] = steady;
        self.averages.start(
            Vector3::new(x.commanded, y.commanded, z.commanded),
            Vector3::new(x.speed, y.speed, z.speed),
            Vector3::new(x.acceleration, y.acceleration, z.acceleration).map(|whole| whole as i32),
        );
        self.smoother.start(steady, &self.windows);
        self.knot = self.smoother.knot();
        self.crackle = Vector3::zeros();
    }

    /// Metres as length units, no more than [`LENGTH_MAX_UNITS`].
    fn length(&self, metres: &Vector3<f32>) -> Vector3<i64> {
        (metres * self.windows.per_metre).map(|length| f32_to_i64(saturate(length, LENGTH_MAX_UNITS)))
    }

    /// Replaces the target. At any time, any number of times between ticks.
    ///
    /// # Errors
    /// [`InputError`] names the field that is not finite or out of range; the target stays as it was and ages on.
    pub fn accept(&mut self, setpoint: &Setpoint) -> Result<(), InputError> {
        self.accept_late(setpoint, 0.0)
    }

    /// The same for a setpoint that was true `late` seconds ago, cut to [0, [`SETPOINT_AGE_MAX_S`]]: a moving point has
    /// gone on since.
    ///
    /// # Errors
    /// As [`Self::accept`]'s.
    pub fn accept_late(&mut self, setpoint: &Setpoint, late: f32) -> Result<(), InputError> {
        let Parts { position, velocity, acceleration, turn } = setpoint.checked()?;
        let held = position.map(|position| position.is_some());
        let last = (self.goal_age <= self.timeout).then_some(&self.goal);
        let late = clamp(late, 0.0, SETPOINT_AGE_MAX_S);
        let stream = Goal::stream(held, velocity, acceleration, last, self.goal_time() - late);
        self.goal_late = late;
        let position = self.length(&Vector3::from(position.map(Option::unwrap_or_default)));
        self.goal = Goal { position, held, stream };
        self.goal_age = 0;
        if let Some((angle, rate)) = turn {
            self.turn = HeadingGoal {
                phase: angle.map(heading_governor::phase),
                rate: heading_governor::units(rate, self.period),
            };
            self.turn_age = 0;
        }
        Ok(())
    }

    /// The time since the goal was true, s, at the last tick.
    fn goal_time(&self) -> f32 {
        self.goal_age as f32 * self.tick + self.goal_late
    }

    /// Gives up every target and comes to rest, smoothly and as soon as the bounds allow.
    pub fn stop(&mut self) {
        self.goal = Goal::STOP;
        self.turn = HeadingGoal::STOP;
    }

    /// Whether the reference is at rest at its goal, and stays there until another setpoint.
    pub fn at_rest(&self) -> bool {
        self.follower.is_averaged()
            && self.crackle == Vector3::zeros()
            && self.pursue() == Vector3::zeros()
            && self.smoother.at_rest(self.averages.commanded())
            && self.turning.at_rest(&self.turn_goal())
    }

    /// How far the reference would go if it were stopped now, m: what it is behind the command, and the command's own
    /// braking. Infinite where it follows a stream directly.
    pub fn way_to_rest(&self) -> f32 {
        if !self.follower.is_averaged() {
            return f32::INFINITY;
        }
        let behind = (self.averages.commanded() - self.smoother.place()).map(i64_to_f32);
        let way = behind + self.pursuit.braking_way(&self.averages.speed().map(i64_to_f32));
        math::sqrt(way.norm_squared()) / self.windows.per_metre
    }

    /// How the stream that is sent is followed, if there is one: position, velocity and acceleration, not at rest.
    pub fn following(&self) -> Option<FollowingReport> {
        self.follower.following()
    }

    /// The reference one period later.
    pub fn tick(&mut self) -> Reference {
        self.goal_age = self.goal_age.saturating_add(1);
        self.turn_age = self.turn_age.saturating_add(1);
        if self.part >= self.parts {
            self.part = 0;
            self.move_on();
        }
        self.part += 1;
        let back = self.parts.saturating_sub(self.part) as f32 * self.tick;
        let Knot { position, velocity, acceleration, jerk, snap } = self.knot.earlier(back, &self.crackle);
        Reference { position, velocity, acceleration, jerk, snap, heading: self.turning.heading(back) }
    }

    /// To the next knot.
    fn move_on(&mut self) {
        let head = self.head_motion();
        let averaged = if self.follower.is_averaging() { self.averages.push(&self.pursue()) } else { Vector3::zeros() };
        let sought = self.stream_target(&head);
        let snap = match self.follower.tick(&head, sought.as_ref(), &averaged, 1.0 / self.per_snap) {
            // To the nearest unit: so braking ends.
            HeadDrive::Snap(snap) => (snap * self.per_snap).map(|units| (units + 0.5_f32.copysign(units)) as i32),
            HeadDrive::Averages => averaged,
            HeadDrive::Restarted => {
                self.go_on(&self.smoother.steady(&self.windows));
                self.averages.push(&self.pursue())
            }
        };
        self.smoother.push(&snap);
        self.turning.tick(&self.turn_goal());
        let before = self.knot.snap;
        self.knot = self.smoother.knot();
        self.crackle = (self.knot.snap - before) / self.period;
    }

    /// The acceleration commanded for the next knot.
    fn pursue(&self) -> Vector3<i32> {
        let u = self.averages.speed();
        let Goal { position, held, stream } = &self.goal;
        let stale = self.goal_age > self.timeout;
        let Stream { velocity, acceleration, .. } = if stale { &Stream::STILL } else { stream };
        // The command at hand is where it was a control tick ago.
        let age = (self.goal_age as f32 - 1.0) * self.tick + self.goal_late;
        let (ahead, feed) = self.lead.ahead_and_velocity(velocity, acceleration, age);
        let away = position + self.length(&ahead) - self.averages.commanded();
        let [x, y, z] = *held;
        let error = Vector3::new(i64::from(x), i64::from(y), i64::from(z)).component_mul(&away);
        let acceleration = acceleration * (self.windows.per_metre * self.period * self.period);
        let wanted = self.pursuit.approach(&error, &self.length(&(feed * self.period)), &acceleration);
        self.pursuit.towards_velocity(&wanted, u)
    }

    /// The heading's goal at the knot at hand.
    fn turn_goal(&self) -> HeadingGoal {
        let rate = if self.turn_age > self.timeout { 0 } else { self.turn.rate };
        let lead = (self.turn_age as f32 - 1.0) * self.tick / self.period + self.turning.delay();
        let phase = self.turn.phase.map(|phase| phase.wrapping_add(f32_to_i64(i64_to_f32(rate) * lead)));
        HeadingGoal { phase, rate }
    }
}

/// The least time between two knots, s: a hundredth of a second is short beside the averages, and keeps them in memory.
const KNOT_INTERVAL_MIN_S: f32 = 0.01;

/// The control ticks of `period`, s, between two knots.
fn parts(period: f32) -> u32 {
    // A little less: a period is a rounded number.
    let exact = KNOT_INTERVAL_MIN_S / period * (1.0 - windows::ROUNDING_MARGIN);
    let whole = exact as u32;
    whole.saturating_add(u32::from((whole as f32) < exact)).max(1)
}

/// The greatest length, units: 2^61, so that a target, its lead and the command's own place add up within 64 bits.
const LENGTH_MAX_UNITS: f32 = 2_305_843_009_213_693_952.0;

/// How late a setpoint counts as at most, s: a line with more is not one to stream over.
pub const SETPOINT_AGE_MAX_S: f32 = 0.3;

/// The longest ramp or timeout, s.
const DURATION_MAX_S: f32 = 60.0;

#[cfg(test)]
mod tests;
