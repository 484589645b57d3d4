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

/// Thrust of one rotor as a function of its command, exactly invertible.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThrustCurve {
    thrust_max: f32,
    linear: f32,
}

impl ThrustCurve {
    /// A curve with `thrust_max` f_max, N, at full command and nominal voltage, and `linear` a, in [0, 1].
    ///
    /// # Errors
    /// Names `rotors.thrust_max` or `rotors.curve`.
    pub fn new(thrust_max: f32, linear: f32) -> Result<Self, ParameterError> {
        require_positive(thrust_max, "rotors.thrust_max")?;
        require_finite(linear, "rotors.curve")?;
        require(linear >= 0.0, "rotors.curve", Reason::Negative)?;
        require(linear <= 1.0, "rotors.curve", Reason::Above(1.0))?;
        Ok(Self { thrust_max, linear })
    }

    /// The command in [0, 1] for a thrust, N, at a voltage ratio V_0 / V from [`Battery::ratio`].
    ///
    /// Thrusts out of reach give the nearest command; a NaN stops the rotor.
    pub fn command(&self, thrust: f32, ratio: f32) -> f32 {
        let fraction = (thrust / self.thrust_max).clamp(0.0, 1.0);
        let root = math::sqrt(self.linear * self.linear + 4.0 * (1.0 - self.linear) * fraction);
        // False for a command of zero, where a = 0 divides zero by zero, and for a NaN.
        if fraction > 0.0 { (2.0 * fraction / (self.linear + root) * ratio).min(1.0) } else { 0.0 }
    }

    /// The thrust, N, of a command in [0, 1] at a voltage ratio V_0 / V.
    pub fn thrust(&self, command: f32, ratio: f32) -> f32 {
        let command = command / ratio;
        self.thrust_max * command * (self.linear + (1.0 - self.linear) * command)
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
