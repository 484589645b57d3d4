//! What one rotor of `[rotors]` delivers, in either of two forms: coefficients and speeds, or, where the speeds are not
//! known, thrusts and the torque for each newton of them.
//!
//! Thrust is proportional to the squared speed in both. In the second a rotor is taken to turn with
//! [`NOMINAL_SPEED_RAD_PER_S`] at its maximum thrust: k_eta = thrust_max / [`NOMINAL_SPEED_RAD_PER_S`]^2, k_m =
//! torque_per_thrust k_eta. The wrench, its lag and a thrust curve do not depend on that speed; what the air does to a
//! rotor (`[drag]`, per rad/s) and the power that it draws from a `[battery]` do.

use crate::key::{Bounds, Key, Values};
use crate::section::{FieldError, Section};
use controller_core::error::{ParameterError, Reason};

/// The speed of a rotor of the second form at its maximum thrust, rad/s.
pub const NOMINAL_SPEED_RAD_PER_S: f64 = 1000.0;

/// The keys of the first form.
pub const SPEED_KEYS: [Key; 3] = [
    Key::number("thrust_coefficient", Bounds::physical("N/(rad/s)^2"), "k_eta, of the thrust.").optional(),
    Key::number("drag_coefficient", Bounds::physical("N m/(rad/s)^2"), "k_m, of the drag torque.").optional(),
    Key::new("speed", Values::Range(Bounds::not_negative("rad/s")), "Least and greatest while flying, rad/s.")
        .optional(),
];

/// The keys of the second form.
pub const THRUST_KEYS: [Key; 3] = [
    Key::number("thrust_max", Bounds::physical("N"), "Of each rotor.").optional(),
    Key::number("thrust_min", Bounds::not_negative("N").checked_later(), "Of each rotor while flying.").or(0.0),
    Key::number("torque_per_thrust", Bounds::physical("m"), "k_m / k_eta.").optional(),
];

/// The coefficients of each rotor; all are alike.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Propulsion {
    form: Form,
    /// k_eta, N/(rad/s)^2.
    pub thrust_coefficient: f32,
    /// k_m, N m/(rad/s)^2.
    pub drag_coefficient: f32,
    /// Minimum thrust while flying, N, as these keys have it.
    pub thrust_min: f32,
    /// Maximum thrust, N.
    pub thrust_max: f32,
}

/// How the file says it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    Speeds,
    Thrusts,
}

impl Propulsion {
    /// Reads it from `[rotors]`.
    ///
    /// # Errors
    /// Names the field that is missing or no number, or keys of both forms.
    pub fn read(section: &Section) -> Result<Self, FieldError> {
        match form(section)? {
            Form::Speeds => read_speeds(section),
            Form::Thrusts => read_thrusts(section),
        }
    }

    /// The field of the file that a refused field of one rotor comes from.
    #[must_use]
    pub fn in_file(&self, error: ParameterError) -> ParameterError {
        // Without the rotor's number.
        let refused = error.field.split(',').next().unwrap_or_default();
        let (field, reason) = match (self.form, refused, error.reason) {
            (Form::Speeds, "rotors.thrust_min" | "rotors.thrust_max", reason) => ("rotors.speed", reason),
            (Form::Speeds, "rotors.thrust_coefficient" | "rotors.drag_coefficient", reason) => (refused, reason),
            (Form::Thrusts, "rotors.thrust_min", reason) => (refused, reason),
            (Form::Thrusts, "rotors.thrust_max" | "rotors.thrust_coefficient", reason) => ("rotors.thrust_max", reason),
            (Form::Thrusts, "rotors.drag_coefficient", Reason::NotBelow(limit)) => {
                ("rotors.torque_per_thrust", Reason::NotBelow(limit / self.thrust_coefficient))
            }
            (Form::Thrusts, "rotors.drag_coefficient", reason) => ("rotors.torque_per_thrust", reason),
            (Form::Thrusts, "rotors.speed", reason @ Reason::NotBelow(_)) => ("rotors.thrust_min", reason),
            (Form::Thrusts, "rotors.speed", reason) => ("rotors.thrust_max", reason),
            (_, _, reason) => (error.field, reason),
        };
        ParameterError { field, reason }
    }

    /// Whether the file says at which speeds the rotors turn.
    #[must_use]
    pub fn has_speeds(&self) -> bool {
        self.form == Form::Speeds
    }

    /// The key of the least thrust in the file.
    #[must_use]
    pub fn least_key(&self) -> &'static str {
        match self.form {
            Form::Speeds => "speed",
            Form::Thrusts => "thrust_min",
        }
    }

    /// The unit of the thrust range in the file.
    #[must_use]
    pub fn unit(&self) -> &'static str {
        match self.form {
            Form::Speeds => "rad/s",
            Form::Thrusts => "N",
        }
    }
}

/// Which form the file has.
fn form(section: &Section) -> Result<Form, FieldError> {
    let first = |keys: [Key; 3]| keys.map(|key| key.name).into_iter().find(|key| section.has(key));
    let either = format!(
        "{}, or thrust_max, torque_per_thrust and, unless it is zero, thrust_min",
        SPEED_KEYS.map(|key| key.name).join(", ")
    );
    match (first(SPEED_KEYS), first(THRUST_KEYS)) {
        (Some(_), None) => Ok(Form::Speeds),
        (None, Some(_)) => Ok(Form::Thrusts),
        (Some(of_speeds), Some(of_thrusts)) => Err(FieldError::new(
            section.path_of(of_thrusts),
            format!("cannot stand beside {of_speeds}; these belong together: {either}"),
        )),
        (None, None) => Err(FieldError::new(
            section.path_of("thrust_max"),
            format!("missing, and so is every other key that says what a rotor delivers: give {either}"),
        )),
    }
}

fn read_speeds(section: &Section) -> Result<Propulsion, FieldError> {
    let thrust_coefficient = section.number("thrust_coefficient")? as f32;
    let drag_coefficient = section.number("drag_coefficient")? as f32;
    let [slowest, fastest] = read_range(section)?;
    let thrust = |speed: f64| thrust_coefficient * (speed * speed) as f32;
    let (thrust_min, thrust_max) = (thrust(slowest), thrust(fastest));
    Ok(Propulsion { form: Form::Speeds, thrust_coefficient, drag_coefficient, thrust_min, thrust_max })
}

fn read_thrusts(section: &Section) -> Result<Propulsion, FieldError> {
    const KEY: &str = "torque_per_thrust";
    let thrust_max = section.number("thrust_max")?;
    let thrust_min = section.number("thrust_min")? as f32;
    if !section.has(KEY) {
        let problem = "missing, must be the propeller's drag torque over its thrust, m: yaw cannot be known without it \
                       (a thrust stand or the propeller's data have it)";
        return Err(FieldError::new(section.path_of(KEY), problem));
    }
    let thrust_coefficient = thrust_max / (NOMINAL_SPEED_RAD_PER_S * NOMINAL_SPEED_RAD_PER_S);
    let drag_coefficient = (section.number(KEY)? * thrust_coefficient) as f32;
    let (thrust_coefficient, thrust_max) = (thrust_coefficient as f32, thrust_max as f32);
    Ok(Propulsion { form: Form::Thrusts, thrust_coefficient, drag_coefficient, thrust_min, thrust_max })
}

fn read_range(section: &Section) -> Result<[f64; 2], FieldError> {
    const SPEED_REQUIREMENT: &str = "[least, greatest] in rad/s, 0 <= least < greatest";
    section.range("speed", SPEED_REQUIREMENT, |min, max| 0.0 <= min && min < max && max.is_finite())
}

#[cfg(test)]
mod tests;
