//! Rotor thrust to motor command and back, whatever the battery has left.
//!
//! ```text
//! f / f_max = phi(u) = a u + (1 - a) u^2,   0 <= u <= 1,   0 <= a <= 1
//! u = phi^-1(y) = 2 y / (a + sqrt(a^2 + 4 (1 - a) y))
//! ```
//!
//! u is the command (0 stopped, 1 full), f_max the thrust of a full command at the nominal voltage. a = 0 is a rotor
//! whose speed follows the command, a = 1 one whose thrust does; real ones lie between. The inverse is written without
//! the difference of nearly equal numbers that the textbook root has, so that it keeps single precision at small
//! thrusts.
//!
//! A motor sees u V, the command times the battery's voltage. So the command that gives at V what u gives at the
//! nominal V_0 is u V_0 / V. The ratio V_0 / V is held within [[`VOLTAGE_RATIO_MIN`], [`VOLTAGE_RATIO_MAX`]], and
//! without a plausible, recent reading it is one: no compensation.
//!
//! A motor controller stalls below the command at which it idles, u_0. So every thrust that is asked for is answered by
//! u_0 at least, unless it is zero: that stops the rotor. The least thrust that an allocation may ask for is the one
//! whose command is u_0 with the fullest battery that is made up for, V = V_0 / [`VOLTAGE_RATIO_MIN`]:
//!
//! ```text
//! f_min = f_max phi(u_0 / VOLTAGE_RATIO_MIN)
//! ```
//!
//! Then no command is raised to u_0, and each rotor gives what is asked of it.
//!
//! A full command is all there is: below the nominal voltage the greatest thrust falls to f_max phi(V / V_0), and a
//! certificate for the end of the battery must be made with that thrust as the rotors' maximum.

use crate::error::{ParameterError, Reason, require, require_finite, require_positive};
use crate::math;

/// The least V_0 / V that a command is multiplied by: V at most 25 % above nominal.
pub const VOLTAGE_RATIO_MIN: f32 = 0.8;

/// The greatest V_0 / V that a command is multiplied by: V at least 25 % below nominal.
pub const VOLTAGE_RATIO_MAX: f32 = 4.0 / 3.0;

/// Readings below this part of the nominal voltage, or above its inverse multiple, are faults of the sensor.
const PLAUSIBLE_VOLTAGE_SHARE: f32 = 0.5;

/// The age from which a reading is not used, microseconds.
pub const VOLTAGE_STALE_AFTER_US: u64 = 1_000_000;

/// The greatest command at which motors may idle.
pub const IDLE_MAX: f32 = 0.3;

/// A motor with its controller and propeller, whatever its size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motor {
    /// a: the part of the thrust that grows with the command itself, in [0, 1].
    pub linear: f32,
    /// u_0: the command at which it idles, in [0, [`IDLE_MAX`]]; it turns reliably from there on.
    pub idle: f32,
}

impl Motor {
    /// Thrust goes with the square of the command, however small that is.
    pub const IDEAL: Self = Self { linear: 0.0, idle: 0.0 };
}

/// Thrust of one rotor as a function of its command, exactly invertible.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThrustCurve {
    thrust_max: f32,
    motor: Motor,
}

impl ThrustCurve {
    /// The curve of `motor`, with `thrust_max` f_max, N, at full command and nominal voltage.
    ///
    /// # Errors
    /// Names `rotors.thrust_max`, `rotors.thrust_curve` or `rotors.idle`.
    pub fn new(thrust_max: f32, motor: Motor) -> Result<Self, ParameterError> {
        require_positive(thrust_max, "rotors.thrust_max")?;
        for (value, max, field) in [(motor.linear, 1.0, "rotors.thrust_curve"), (motor.idle, IDLE_MAX, "rotors.idle")] {
            require_finite(value, field)?;
            require(value >= 0.0, field, Reason::Negative)?;
            require(value <= max, field, Reason::Above(max))?;
        }
        Ok(Self { thrust_max, motor })
    }

    /// The command in [0, 1] for a thrust, N, at a voltage ratio V_0 / V from [`Battery::ratio`].
    ///
    /// Thrusts out of reach give the nearest command, positive ones that of idling at least. Zero and NaN stop the
    /// rotor.
    pub fn command(&self, thrust: f32, ratio: f32) -> f32 {
        let Motor { linear, .. } = self.motor;
        let fraction = (thrust / self.thrust_max).clamp(0.0, 1.0);
        let root = math::sqrt(linear * linear + 4.0 * (1.0 - linear) * fraction);
        // False for a thrust of zero, where a = 0 divides zero by zero, and for a NaN.
        if fraction > 0.0 { self.held(2.0 * fraction / (linear + root) * ratio).min(1.0) } else { 0.0 }
    }

    /// What a motor makes of a command: idling at least, unless it is stopped.
    pub fn held(&self, command: f32) -> f32 {
        if command > 0.0 { command.max(self.motor.idle) } else { 0.0 }
    }

    /// f_min, N.
    pub fn thrust_min(&self) -> f32 {
        self.thrust(self.motor.idle, VOLTAGE_RATIO_MIN)
    }

    /// The command at which the motor idles.
    pub fn idle(&self) -> f32 {
        self.motor.idle
    }

    /// The thrust, N, of a command in [0, 1] at a voltage ratio V_0 / V.
    pub fn thrust(&self, command: f32, ratio: f32) -> f32 {
        let command = command / ratio;
        let Motor { linear, .. } = self.motor;
        self.thrust_max * command * (linear + (1.0 - linear) * command)
    }
}

/// The battery as the curve needs it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Battery {
    nominal: f32,
}

impl Battery {
    /// A battery whose curve was measured at `nominal` V_0, V.
    ///
    /// # Errors
    /// Names `battery.nominal`.
    pub fn new(nominal: f32) -> Result<Self, ParameterError> {
        require_positive(nominal, "battery.nominal")?;
        Ok(Self { nominal })
    }

    /// V_0 / V for a reading, V, taken `age` microseconds ago, in [[`VOLTAGE_RATIO_MIN`], [`VOLTAGE_RATIO_MAX`]].
    ///
    /// One, if the reading is older than [`VOLTAGE_STALE_AFTER_US`], not finite, or not within a factor of two of
    /// nominal.
    pub fn ratio(&self, voltage: f32, age: u64) -> f32 {
        // Also false for a NaN.
        let plausible =
            voltage > PLAUSIBLE_VOLTAGE_SHARE * self.nominal && voltage * PLAUSIBLE_VOLTAGE_SHARE < self.nominal;
        if plausible && age < VOLTAGE_STALE_AFTER_US {
            (self.nominal / voltage).clamp(VOLTAGE_RATIO_MIN, VOLTAGE_RATIO_MAX)
        } else {
            1.0
        }
    }
}

#[cfg(test)]
mod tests;
