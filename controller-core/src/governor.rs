//! The reference governor: any stream of setpoints in, a reference inside Omega_r out.
//!
//! The certificate covers references inside its [`ReferenceBounds`]; people send steps. In between, once per tick:
//!
//! ```text
//! setpoint -> target -> pursuit (|alpha| in a cylinder) -> x_0 -> three moving averages -> spline -> Reference
//! ```
//!
//! - `braking`, `pursuit`: the command x_0, a double integrator that makes for the target and stops on it;
//! - `lead`: where the command must be for the output to be on a moving point;
//! - `windows`: why averages of these lengths keep acceleration, jerk and snap inside, and which lengths;
//! - `smoother`: the averages in integers, and the quintic spline that makes the output one smooth function of time;
//! - `turning`: the same for the heading;
//! - `bridge`: how a reference already accelerating is taken over.
//!
//! What holds by construction: every bound, at every instant (on a bridge: every tick), whatever is sent (NaN is refused);
//! position to snap are one function and its derivatives, snap moves by at most 2 K_s in [`GovernorLimits::snap_ramp`],
//! psi'' likewise; from rest, a constant position is reached along the straight segment without overshoot, exactly (the
//! averages of a monotone approach are monotone), and a stop is a straight braking of the command followed by the
//! averages. Arrival from states in motion is shown by campaign.
//!
//! What it costs: the averages add (T_1+T_2+T_3) to the time-optimal double integrator. For K_a12 2.5, K_a3 0.5, K_j 4,
//! K_s 10 that is 2.2 s: 10 m take 6.3 s. A moving point is followed without lag where it keeps turning and accelerating
//! as it does, within the bounds; what changes within a second or two comes out smoothed, and a circle too tight for the
//! averages comes out smaller. A start that accelerates is first brought to a
//! steady velocity (`bridge`); setpoints take effect then.

mod braking;
mod bridge;
mod lead;
mod pursuit;
mod setpoint;
mod smoother;
mod turning;
mod windows;

pub use setpoint::{Motion, POSITION_RANGE, Setpoint, Turn};

use crate::error::{InputError, ParameterError, Reason, require, require_positive};
use crate::reference::{Reference, ReferenceBounds};
use bridge::Bridge;
use core::fmt;
use lead::Lead;
use nalgebra::Vector3;
use pursuit::Pursuit;
use smoother::{Knot, Smoother};
use turning::{TurnGoal, Turning};
use windows::Windows;

/// Ticks of commands remembered: what the three averages may span together.
const HISTORY: usize = 512;

/// The greatest speed limit and starting speed, m/s.
pub const SPEED_RANGE: f32 = 256.0;

/// What the governor needs beyond the bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GovernorLimits {
    /// Greatest horizontal speed asked for, m/s. (The bounds know none; a faster start is slowed down.)
    pub horizontal_speed: f32,
    /// Greatest vertical speed asked for, m/s.
    pub vertical_speed: f32,
    /// How long snap takes from one end of its bound to the other, s.
    pub snap_ramp: f32,
    /// How long psi'' takes from one end of its bound to the other, s.
    pub heading_ramp: f32,
    /// How long velocities, rates and feed-forwards are valid without renewal, s.
    pub timeout: f32,
}

impl Default for GovernorLimits {
    #[inline]
    fn default() -> Self {
        Self { horizontal_speed: 5.0, vertical_speed: 2.0, snap_ramp: 0.1, heading_ramp: 0.2, timeout: 0.5 }
    }
}

/// Why a governor does not start.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum GovernorError {
    /// A bound, limit or period it cannot work with.
    Parameter(ParameterError),
    /// A starting reference that is not finite or out of range.
    Start(InputError),
    /// A starting reference from which no way to rest inside the bounds was found.
    NoWayOn {
        /// The part of the reference to blame.
        field: &'static str,
    },
}

impl From<ParameterError> for GovernorError {
    #[inline]
    fn from(error: ParameterError) -> Self {
        Self::Parameter(error)
    }
}

impl From<InputError> for GovernorError {
    #[inline]
    fn from(error: InputError) -> Self {
        Self::Start(error)
    }
}

impl fmt::Display for GovernorError {
    #[inline]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Parameter(error) => write!(f, "{error}"),
            Self::Start(error) => write!(f, "{error}"),
            Self::NoWayOn { field } => write!(f, "{field}: cannot be brought to rest within the reference bounds"),
        }
    }
}

impl core::error::Error for GovernorError {}

/// What the position is to do, in length units and ticks where exactness matters.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Goal {
    Stop,
    Position(Vector3<i64>),
    Velocity(Vector3<i64>),
    /// A point seen `age` ticks ago: units, m/s, m/s^2.
    Moving {
        position: Vector3<i64>,
        velocity: Vector3<f32>,
        acceleration: Vector3<f32>,
    },
}

/// The bounded-reference generator. Memory: about 7 KB.
#[derive(Debug, Clone, PartialEq)]
pub struct Governor {
    bounds: ReferenceBounds,
    period: f32,
    /// Ticks after which what must be renewed is stale.
    timeout: u32,
    windows: Windows,
    pursuit: Pursuit,
    lead: Lead,
    smoother: Smoother,
    turning: Turning,
    bridge: Option<(Bridge, u32)>,
    goal: Goal,
    goal_age: u32,
    turn: TurnGoal,
    turn_age: u32,
}

impl Governor {
    /// A governor for `bounds` that ticks every `period` seconds, starting at `initial`.
    ///
    /// # Errors
    /// [`GovernorError::Parameter`] for a period outside (0, 0.1] s, a limit or bound that is not positive, or bounds too
    /// unlike each other for the integers; otherwise as [`Self::restart`].
    #[inline]
    pub fn new(
        bounds: ReferenceBounds,
        limits: GovernorLimits,
        period: f32,
        initial: &Reference,
    ) -> Result<Self, GovernorError> {
        let bounds = bounds.validated()?;
        require_positive(period, "governor.period")?;
        require(period <= 0.1, "governor.period", Reason::NotAbove(0.1))?;
        for (value, most, field) in [
            (limits.horizontal_speed, SPEED_RANGE, "governor.horizontal_speed"),
            (limits.vertical_speed, SPEED_RANGE, "governor.vertical_speed"),
            (limits.snap_ramp, LONGEST_TIME, "governor.snap_ramp"),
            (limits.heading_ramp, LONGEST_TIME, "governor.heading_ramp"),
            (limits.timeout, LONGEST_TIME, "governor.timeout"),
        ] {
            require_positive(value, field)?;
            require(value <= most, field, Reason::NotAbove(most))?;
        }
        let windows = Windows::design(&bounds, &limits, period)?;
        let mut governor = Self {
            bounds,
            period,
            timeout: windows::ticks(limits.timeout, period) as u32,
            windows,
            pursuit: Pursuit::new(&windows, limits.horizontal_speed, limits.vertical_speed, period),
            lead: Lead {
                delay: windows.delay() * period,
                variance: windows.variance() * period * period,
                acceleration: windows.horizontal / (windows.per_metre * period * period),
            },
            smoother: Smoother::new(&windows, period),
            turning: Turning::new(&bounds, &limits, period)?,
            bridge: None,
            goal: Goal::Stop,
            goal_age: 0,
            turn: TurnGoal::Stop,
            turn_age: 0,
        };
        governor.restart(initial)?;
        Ok(governor)
    }

    /// Takes over from any reference, in motion or not; without setpoints it is brought to a smooth stop.
    ///
    /// A change of mode, not a tick: the search for a way on (see the module `bridge`) has no tick's time limit.
    ///
    /// # Errors
    /// [`GovernorError::Start`] for numbers not finite or out of range, [`GovernorError::NoWayOn`] for a reference outside
    /// the bounds or about to leave them. The governor goes on as before then.
    #[inline]
    pub fn restart(&mut self, from: &Reference) -> Result<(), GovernorError> {
        from.check()?;
        crate::state::check_vector(&from.position, POSITION_RANGE, "initial.position")?;
        crate::state::check_vector(&from.velocity, SPEED_RANGE, "initial.velocity")?;
        let start = Knot {
            position: from.position,
            velocity: from.velocity,
            acceleration: from.acceleration,
            jerk: from.jerk,
            snap: from.snap,
        };
        if !self.bounds.contain(from, 1e-6) {
            return Err(GovernorError::NoWayOn { field: "initial reference" });
        }
        let bridge = if bridge::is_steady(&start) {
            None
        } else {
            let found = Bridge::search(&start, &self.bounds, self.period, self.windows.first());
            Some(found.ok_or(GovernorError::NoWayOn { field: "initial.acceleration" })?)
        };
        self.turning.start(&from.heading)?;
        self.bridge = bridge.map(|bridge| (bridge, 0));
        self.settle(&start);
        self.stop();
        Ok(())
    }

    /// Hands a steady knot to the smoother.
    #[inline]
    fn settle(&mut self, knot: &Knot) {
        self.smoother.start(self.length(&knot.position), self.length(&(knot.velocity * self.period)));
    }

    /// Metres as length units.
    #[inline]
    fn length(&self, metres: &Vector3<f32>) -> Vector3<i64> {
        metres.map(|component| (component * self.windows.per_metre) as i64)
    }

    /// Replaces the target. At any time, any number of times between ticks.
    ///
    /// # Errors
    /// [`InputError`] names the field that is not finite or out of range; the target stays as it was and ages on.
    #[inline]
    pub fn accept(&mut self, setpoint: &Setpoint) -> Result<(), InputError> {
        setpoint.check()?;
        self.goal_age = 0;
        self.goal = match setpoint.motion {
            Motion::Position(position) => Goal::Position(self.length(&position)),
            Motion::Velocity(velocity) => Goal::Velocity(self.length(&(velocity * self.period))),
            Motion::PositionVelocityAcceleration { position, velocity, acceleration } => {
                Goal::Moving { position: self.length(&position), velocity, acceleration }
            }
        };
        let rate = |rate: f32| turning::units(rate, self.period);
        let turn = match setpoint.turn {
            Turn::Keep => return Ok(()),
            Turn::Angle { angle, rate: turning } => {
                TurnGoal::Angle { phase: turning::phase(angle), rate: rate(turning) }
            }
            Turn::Rate(turning) => TurnGoal::Rate { rate: rate(turning) },
        };
        self.turn = turn;
        self.turn_age = 0;
        Ok(())
    }

    /// Gives up every target and comes to rest, smoothly and as soon as the bounds allow.
    #[inline]
    pub fn stop(&mut self) {
        self.goal = Goal::Stop;
        self.turn = TurnGoal::Stop;
    }

    /// Whether the reference is at rest where it was asked to be, and stays there until told otherwise.
    #[must_use]
    #[inline]
    pub fn at_rest(&self) -> bool {
        let commanded = self.pursue() != Vector3::zeros();
        self.bridge.is_none() && !commanded && self.smoother.at_rest() && self.turning.at_rest(&self.turn_goal())
    }

    /// The reference one period later.
    #[inline]
    pub fn tick(&mut self) -> Reference {
        self.goal_age = self.goal_age.saturating_add(1);
        self.turn_age = self.turn_age.saturating_add(1);
        self.turning.tick(&self.turn_goal());
        let knot = match self.bridge {
            Some((bridge, elapsed)) => self.cross(&bridge, elapsed + 1),
            None => {
                let acceleration = self.pursue();
                self.smoother.push(acceleration);
                self.smoother.knot()
            }
        };
        Reference {
            position: knot.position,
            velocity: knot.velocity,
            acceleration: knot.acceleration,
            jerk: knot.jerk,
            snap: knot.snap,
            heading: self.turning.heading(),
        }
    }

    /// One tick on the bridge; the smoother starts where it ends.
    #[inline]
    fn cross(&mut self, bridge: &Bridge, elapsed: u32) -> Knot {
        let knot = bridge.knot(elapsed as f32);
        if elapsed < bridge.duration() {
            self.bridge = Some((*bridge, elapsed));
        } else {
            self.bridge = None;
            self.settle(&knot);
        }
        knot
    }

    /// The commanded acceleration of this tick.
    #[inline]
    fn pursue(&self) -> Vector3<i32> {
        let (x, u) = (self.smoother.commanded(), self.smoother.speed());
        let still = Vector3::zeros();
        match self.goal {
            Goal::Stop => self.pursuit.towards_velocity(still, u),
            Goal::Velocity(_) if self.goal_age > self.timeout => self.pursuit.towards_velocity(still, u),
            Goal::Velocity(velocity) => self.pursuit.towards_velocity(velocity, u),
            Goal::Position(target) => self.pursuit.towards_position(target - x, u),
            Goal::Moving { position, .. } if self.goal_age > self.timeout => {
                self.pursuit.towards_position(position - x, u)
            }
            Goal::Moving { position, velocity, acceleration } => {
                let (ahead, feed) = self.ahead(&velocity, &acceleration);
                let acceleration = acceleration * (self.windows.per_metre * self.period * self.period);
                self.pursuit.towards_moving(position + ahead - x, feed, &acceleration, u)
            }
        }
    }

    /// Where the command must be for the averages to come out on a moving point, relative to where that was last seen,
    /// and how fast it must move, units a tick.
    #[inline]
    fn ahead(&self, velocity: &Vector3<f32>, acceleration: &Vector3<f32>) -> (Vector3<i64>, Vector3<i64>) {
        // The command at hand is where it was a tick ago.
        let age = (self.goal_age as f32 - 1.0) * self.period;
        let (ahead, feed) = self.lead.of(velocity, acceleration, age);
        (self.length(&ahead), self.length(&(feed * self.period)))
    }

    /// The heading's goal of this tick.
    #[inline]
    fn turn_goal(&self) -> TurnGoal {
        let stale = self.turn_age > self.timeout;
        match self.turn {
            TurnGoal::Stop => TurnGoal::Stop,
            TurnGoal::Rate { .. } if stale => TurnGoal::Stop,
            TurnGoal::Rate { rate } => TurnGoal::Rate { rate },
            TurnGoal::Angle { phase, .. } if stale => TurnGoal::Angle { phase, rate: 0 },
            TurnGoal::Angle { phase, rate } => {
                let lead = self.turn_age as f32 - 1.0 + self.turning.delay();
                TurnGoal::Angle { phase: phase.wrapping_add((rate as f32 * lead) as i64), rate }
            }
        }
    }
}

/// The longest ramp or timeout, s.
const LONGEST_TIME: f32 = 60.0;

#[cfg(test)]
mod tests;
