//! `[rotors] idle` and `thrust_curve`: the least command of a rotor in flight, and the least thrust that follows from
//! it.
//!
//! ```text
//! thrust_min = max(what speed[0] or thrust_min says, f_max phi(idle / VOLTAGE_RATIO_MIN))
//! ```
//!
//! with phi of [`controller_core::allocation::curve`]. Everything that commands rotors takes its least thrust from
//! here: law, certificate, simulated vehicle and boards.

use super::propulsion::Propulsion;
use crate::key::{Bounds, Key};
use crate::section::{FieldError, Section};
use controller_core::allocation::curve::VOLTAGE_RATIO_MIN;
use controller_core::allocation::{Motor, Rotors, ThrustCurve};
use controller_core::vehicle::Vehicle;
use std::fmt;

/// What motor controllers hold while nobody says otherwise, part of a full command: the digital idle of Betaflight
/// (`dshot_idle_value = 550`) and of PX4 (`DSHOT_MIN = 0.055`).
pub const DEFAULT_IDLE: f64 = 0.055;

/// [`IDLE_MAX`](controller_core::allocation::curve::IDLE_MAX) as files have it.
const IDLE_MAX_SHARE: f64 = 0.3;

/// The keys.
pub const KEYS: [Key; 2] = [
    Key::number("idle", Bounds::between(0.0, IDLE_MAX_SHARE, ""), "Least command in flight, share of a full one.")
        .or(DEFAULT_IDLE),
    Key::number("thrust_curve", Bounds::SHARE, "a of the thrust a u + (1 - a) u^2 of a command u.").or(0.0),
];

/// A rotor's least command in flight, and what it comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeastCommand {
    /// The motors.
    pub motor: Motor,
    /// Least thrust of each rotor, N.
    pub thrust_min: f32,
    /// The command of that thrust at nominal voltage, share of a full one.
    pub command: f32,
    source: Source,
    /// The key that says zero, if one does.
    zero: Option<&'static str>,
}

/// What the least thrust comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Source {
    /// This key of the file.
    Range(&'static str),
    /// The file's `idle`.
    Idle,
    /// [`DEFAULT_IDLE`].
    Default,
}

impl LeastCommand {
    /// Reads the keys in `[rotors]`, whose rotors are `each`.
    ///
    /// # Errors
    /// Names the field that is refused.
    pub fn read(section: &Section, each: &Propulsion) -> Result<Self, FieldError> {
        let [idle, linear] = [section.number("idle")? as f32, section.number("thrust_curve")? as f32];
        let motor = Motor { linear, idle };
        // Thrusts that no rotor has are refused with the rotors.
        let curve = ThrustCurve::new(each.thrust_max, motor).ok();
        let of_idle = curve.map_or(0.0, |curve| curve.thrust_min());
        let (key, is_raised) = (each.least_key(), (0.0..of_idle).contains(&each.thrust_min));
        let source = match (is_raised, section.has("idle")) {
            (false, _) => Source::Range(key),
            (true, true) => Source::Idle,
            (true, false) => Source::Default,
        };
        let thrust_min = if is_raised { of_idle } else { each.thrust_min };
        let command = curve.map_or(0.0, |curve| curve.command(thrust_min, 1.0));
        let zero = (each.thrust_min == 0.0 && section.has(key)).then_some(key);
        Ok(Self { motor, thrust_min, command, source, zero })
    }

    /// Whether idle decides, not the file's range.
    #[must_use]
    pub fn is_of_idle(&self) -> bool {
        !matches!(self.source, Source::Range(_))
    }

    /// Checks that `rotors` of a plausible `vehicle`, with this least command, need not lift it.
    ///
    /// # Errors
    /// Names `rotors.idle`.
    pub fn check_hover(&self, vehicle: &Vehicle, rotors: &Rotors) -> Result<(), FieldError> {
        let (weight, (least, _)) = (vehicle.mass * vehicle.gravity, rotors.thrust_together());
        if least < weight {
            return Ok(());
        }
        let Motor { idle, linear } = self.motor;
        let problem = format!(
            "lifts the vehicle: the rotors' least thrusts together must be below {weight} N, found {least} N from idle = \
             {idle} and thrust_curve = {linear}; lower it to what the motors hold"
        );
        Err(FieldError::new("rotors.idle", problem))
    }

    /// What no motor controller is known to hold, in a sentence with the remedy.
    #[must_use]
    pub fn doubt(&self) -> Option<String> {
        const REMEDY: &str = "measure the lowest at which the motor turns reliably (docs/thrust-stand.md)";
        let Motor { idle, .. } = self.motor;
        if f64::from(self.command) < DEFAULT_IDLE {
            let held = format!("motors may stall below {DEFAULT_IDLE}, which Betaflight and PX4 hold");
            return Some(format!("rotors.idle is {idle}: {held}; {REMEDY}, or leave the key out"));
        }
        self.zero.map(|key| {
            let (command, thrust) = (100.0 * self.command, self.thrust_min);
            format!(
                "rotors.{key} begins at 0, where no motor turns: idle = {idle} raises it to {command:.1} % of a full \
                 command, {thrust:.3} N; {REMEDY} and write it there"
            )
        })
    }
}

impl fmt::Display for LeastCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { motor: Motor { idle, .. }, thrust_min, command, source, .. } = self;
        write!(f, "at least {:.1} % of a full command, {thrust_min:.4} N each: rotors.", 100.0 * command)?;
        let fullest = 100.0 * (1.0 / VOLTAGE_RATIO_MIN - 1.0);
        match source {
            Source::Range(key) => write!(f, "{key}"),
            Source::Idle => write!(f, "idle = {idle} with a battery {fullest:.0} % above nominal"),
            Source::Default => write!(f, "idle = {idle} (default) with a battery {fullest:.0} % above nominal"),
        }
    }
}

#[cfg(test)]
mod tests;
