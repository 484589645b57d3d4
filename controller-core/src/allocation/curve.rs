//! Rotor thrust to motor command and back, whatever the battery has left.
//!
//! ```text
//! f / f_max = phi(u) = a u + (1 - a) u^2,   0 <= u <= 1,   0 <= a <= 1
//! u = phi^-1(y) = 2 y / (a + sqrt(a^2 + 4 (1 - a) y))
//! ```
//!
//! u is the command (0 stopped, 1 full), f_max the thrust of a full command at the nominal voltage. a = 0 is a rotor whose
//! speed follows the command, a = 1 one whose thrust does; real ones lie between. The inverse is written without the
//! difference of nearly equal numbers that the textbook root has, so that it keeps single precision at small thrusts.
//!
//! A motor sees u V, the command times the battery's voltage. So the command that gives at V what u gives at the nominal
//! V_0 is u V_0 / V. The ratio V_0 / V is held within [[`RATIO_MIN`], [`RATIO_MAX`]], and without a plausible, recent
//! reading it is one: no compensation.
//!
//! A full command is all there is: below the nominal voltage the greatest thrust falls to f_max phi(V / V_0), and a
//! certificate for the end of the battery must be asked for with that thrust as the rotors' maximum.

use crate::error::{ParameterError, Reason, require, require_finite, require_positive};
use crate::math;

/// The least V_0 / V that a command is multiplied by: V at most 25 % above nominal.
pub const RATIO_MIN: f32 = 0.8;

/// The greatest V_0 / V that a command is multiplied by: V at least 25 % below nominal.
pub const RATIO_MAX: f32 = 4.0 / 3.0;

/// Readings below this part of the nominal voltage, or above its inverse multiple, are faults of the sensor.
const PLAUSIBLE: f32 = 0.5;

/// The age from which a reading is not used, microseconds.
pub const STALE_AFTER: u64 = 1_000_000;

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
        require(linear <= 1.0, "rotors.curve", Reason::NotBelow(1.0))?;
        Ok(Self { thrust_max, linear })
    }

    /// The command in [0, 1] for a thrust, N, at a voltage ratio V_0 / V from [`Battery::ratio`].
    ///
    /// Thrusts out of reach give the nearest command; a NaN stops the rotor.
    #[must_use]
    pub fn command(&self, thrust: f32, ratio: f32) -> f32 {
        let fraction = (thrust / self.thrust_max).clamp(0.0, 1.0);
        let root = math::sqrt(self.linear * self.linear + 4.0 * (1.0 - self.linear) * fraction);
        // False for nothing asked for, where a = 0 divides zero by zero, and for a NaN.
        if fraction > 0.0 { (2.0 * fraction / (self.linear + root) * ratio).min(1.0) } else { 0.0 }
    }

    /// The thrust, N, of a command in [0, 1] at a voltage ratio V_0 / V.
    #[must_use]
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

    /// V_0 / V for a reading, V, taken `age` microseconds ago, in [[`RATIO_MIN`], [`RATIO_MAX`]].
    ///
    /// One, if the reading is older than [`STALE_AFTER`], not finite, or not within a factor of two of nominal.
    #[must_use]
    pub fn ratio(&self, voltage: f32, age: u64) -> f32 {
        // Also false for a NaN.
        let plausible = voltage > PLAUSIBLE * self.nominal && voltage * PLAUSIBLE < self.nominal;
        if plausible && age < STALE_AFTER { (self.nominal / voltage).clamp(RATIO_MIN, RATIO_MAX) } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_round_trip_keeps_single_precision() {
        for linear in [0.0, 1e-6, 0.1, 0.5, 0.9, 1.0] {
            let curve = ThrustCurve::new(7.5, linear).unwrap();
            for i in 0..=100_000 {
                // Down to a millionth of full thrust.
                let thrust = 7.5 * (i as f32 / 100_000.0) * (i as f32 / 100_000.0);
                let back = curve.thrust(curve.command(thrust, 1.0), 1.0);
                assert!((back - thrust).abs() <= 8.0 * f32::EPSILON * thrust, "{linear} {thrust} {back}");
            }
        }
    }

    #[test]
    fn nothing_is_no_command_and_full_thrust_is_a_full_one() {
        for linear in [0.0, 0.3, 1.0] {
            let curve = ThrustCurve::new(3.0, linear).unwrap();
            assert_eq!(curve.command(0.0, 1.0), 0.0);
            assert!((curve.command(3.0, 1.0) - 1.0).abs() <= f32::EPSILON);
            assert!((curve.thrust(1.0, 1.0) - 3.0).abs() <= 3.0 * f32::EPSILON);
        }
    }

    #[test]
    fn thrusts_out_of_reach_give_the_nearest_command_and_a_nan_stops_the_rotor() {
        let curve = ThrustCurve::new(3.0, 0.4).unwrap();
        assert_eq!(curve.command(-1.0, 1.0), 0.0);
        assert_eq!(curve.command(f32::INFINITY, RATIO_MAX), 1.0);
        assert_eq!(curve.command(f32::NAN, 1.0), 0.0);
    }

    #[test]
    fn a_sagging_battery_does_not_change_the_thrust() {
        let curve = ThrustCurve::new(4.0, 0.2).unwrap();
        let battery = Battery::new(16.0).unwrap();
        for voltage in [13.0, 14.8, 16.0, 16.8] {
            let ratio = battery.ratio(voltage, 0);
            let command = curve.command(2.0, ratio);
            // The motor's own view: a nominal battery with the command it effectively sees.
            let seen = curve.thrust(command * voltage / 16.0, 1.0);
            assert!((seen - 2.0).abs() < 2e-6, "{voltage} {seen}");
        }
    }

    #[test]
    fn compensation_stays_within_its_range() {
        let battery = Battery::new(16.0).unwrap();
        assert_eq!(battery.ratio(9.0, 0), RATIO_MAX);
        assert_eq!(battery.ratio(31.0, 0), RATIO_MIN);
    }

    #[test]
    fn without_a_believable_reading_there_is_no_compensation() {
        let battery = Battery::new(16.0).unwrap();
        for voltage in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -12.0, 7.9, 33.0] {
            assert_eq!(battery.ratio(voltage, 0), 1.0);
        }
        assert_eq!(battery.ratio(12.8, STALE_AFTER), 1.0);
        assert_eq!(battery.ratio(12.8, STALE_AFTER - 1), 1.25);
    }

    #[test]
    fn curves_that_bend_the_wrong_way_are_refused() {
        assert_eq!(ThrustCurve::new(1.0, -0.1).unwrap_err().reason, Reason::Negative);
        assert_eq!(ThrustCurve::new(1.0, 1.1).unwrap_err().field, "rotors.curve");
        assert_eq!(ThrustCurve::new(1.0, f32::NAN).unwrap_err().reason, Reason::NotFinite);
        assert_eq!(ThrustCurve::new(0.0, 0.5).unwrap_err().field, "rotors.thrust_max");
        assert_eq!(Battery::new(0.0).unwrap_err().field, "battery.nominal");
    }
}
