//! `[gains]` and `[estimates]` of the extended law.
//!
//! ```toml
//! [gains]                    # every key may be left out: its default follows from the vehicle's numbers
//! v_across = 6.0             # m/s
//! ```
//!
//! Every key is one of [`ExtendedParameters::TABLE`]; `docs/scenario-file.md` lists them, and
//! [`constants::written`] prints them all.

use crate::constants;
use crate::section::{FieldError, Section};
use controller_core::configuration::ExtendedLaw;
use controller_core::error::ParameterError;
use controller_core::extended::actuators::{ActuatorModel, ActuatorParameters, DELAY_MAX_TICKS};
use controller_core::extended::controller::Controller;
use controller_core::extended::defaults::{self, Airframe, NOTHING_GIVEN};
use controller_core::extended::parameters::{Extended, ExtendedParameters};

/// Constants that the law had once, and what is in their place.
const RETIRED_CONSTANTS: [(&str, &str); 9] = [
    ("w", "k_tilt is the tilt's stiffness, c_1 the heading's"),
    ("eta", "nothing is needed in its place"),
    ("k_t", "k_tilt is the tilt's stiffness"),
    ("m_t", "m_tilt is the level of the tilt's feedback"),
    ("eta_t", "nothing is needed in its place"),
    ("m_all", "m_tilt is the level of the tilt's feedback; damping takes what torque is left"),
    ("k_omega_z", "c_2 is the heading's damping"),
    ("m_omega_z", "yaw takes what torque is left"),
    ("turn_acceleration", "it follows from the rotors' torque"),
];

/// Reads both sections for `airframe`, from which missing constants follow.
///
/// # Errors
/// Names the field that is unknown or refused.
pub fn read_extended(root: &Section, airframe: &Airframe) -> Result<ExtendedLaw, FieldError> {
    let mut given = NOTHING_GIVEN;
    for name in ["gains", "estimates"] {
        let Some(section) = root.optional_section(name)? else { continue };
        refuse_retired(&section, name)?;
        let read = constants::read(root, &section, name, &ExtendedParameters::TABLE)?;
        given = core::array::from_fn(|place| read[place].or(given[place]));
    }
    let parameters = defaults::constants(airframe, &given);
    let parameters = Extended::new(parameters, airframe.vehicle).map_err(|error| refused(root, &error))?;
    Controller::check_period(&parameters, airframe.period).map_err(|error| refused(root, &error))?;
    check_delay(root, &airframe.actuators, airframe.period)?;
    Ok(ExtendedLaw { parameters, actuators: airframe.actuators })
}

/// A refusal by the law's constructors in terms of the file, which may leave the refused constant out.
#[must_use]
pub fn refused(root: &Section, error: &ParameterError) -> FieldError {
    let ParameterError { field, reason } = error;
    let is_constant = ExtendedParameters::TABLE.iter().any(|constant| constant.path == *field);
    if !is_constant || root.value(field).is_some() {
        return root.refused(error);
    }
    let problem = format!(
        "these numbers and those of [limits] and [rotors] make {field}, which the file leaves out and which {reason}: \
         check them, or give it a value"
    );
    FieldError::new("vehicle", problem)
}

/// Refuses a constant that the law no longer has, and names what is in its place.
fn refuse_retired(section: &Section, name: &str) -> Result<(), FieldError> {
    match RETIRED_CONSTANTS.iter().find(|(key, _)| section.has(key)) {
        Some((key, instead)) => {
            let problem = format!("the law no longer has it: {instead}; leave it out, and a formula takes its place");
            Err(FieldError::new(format!("{name}.{key}"), problem))
        }
        None => Ok(()),
    }
}

/// Refuses a delay longer than the memory of the law's actuator model.
fn check_delay(root: &Section, actuators: &ActuatorParameters, period: f32) -> Result<(), FieldError> {
    const DELAY_MAX_PERIODS: usize = DELAY_MAX_TICKS - 1;
    ActuatorModel::new(actuators, period).map(|_| ()).map_err(|_| {
        let field = if root.has("sampling") { "sampling.delay" } else { "sensors.delay" };
        let longest = DELAY_MAX_PERIODS as f64 * f64::from(period);
        let problem = format!(
            "under the extended law must be, both delays together, at most {DELAY_MAX_PERIODS} control periods, {longest:.3} s, found {} s",
            actuators.delay
        );
        FieldError::new(field, problem)
    })
}
