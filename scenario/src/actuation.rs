//! `[rotors]` and `[sampling]`: what stands between the law's wrench and the body. Both may be left out.
//!
//! ```toml
//! [rotors]
//! position = [[0.12, 0.12, 0.0], [-0.12, 0.12, 0.0], [-0.12, -0.12, 0.0], [0.12, -0.12, 0.0]]   # m, body
//! spin = ["cw", "ccw", "cw", "ccw"]     # seen from above
//! thrust_coefficient = 5.57e-6          # k_eta, N/(rad/s)^2
//! drag_coefficient = 1.36e-7            # k_m, N m/(rad/s)^2
//! speed = [0.0, 1500.0]                 # least and greatest while flying, rad/s
//! lag = 0.005                           # first-order, s; 0 for none
//!
//! [sampling]
//! delay = 0.01                          # from a tick to the moment its wrench acts, s; whole plant steps
//! ```

use crate::sampled_loop::GREATEST_DELAY;
use crate::section::{FieldError, Section, in_line, vector_at};
use crate::timing::Timing;
use controller_core::allocation::{Rotor, Rotors, Spin};
use controller_core::certificate::configuration::Configuration;
use controller_core::error::ParameterError;
use toml::Value;

/// Longest lag and delay, s: slower actuators fly no multirotor.
const LONGEST: f64 = 1.0;

/// Reads the first-order lag of the rotors' speeds, s; zero without `[rotors]`.
///
/// # Errors
/// If it is negative or longer than any rotor's.
pub fn read_lag(root: &Section) -> Result<f64, FieldError> {
    root.optional_section("rotors")?.map_or(Ok(0.0), |section| read_time(&section, "lag"))
}

/// Reads `[rotors]`: carries `configuration` to the rotors. Without the section it stays as it is.
///
/// # Errors
/// Names the field that is missing or refused; `rotors` where together they cannot produce every wrench, `rotors.speed` if
/// the vehicle cannot hover between its ends.
pub fn read_rotors(root: &Section, configuration: Configuration) -> Result<Configuration, FieldError> {
    let Some(section) = root.optional_section("rotors")? else {
        return Ok(configuration);
    };
    section.allow(&["position", "spin", "thrust_coefficient", "drag_coefficient", "speed", "lag"])?;
    let positions = section.elements("position", "a list of positions [x, y, z]")?;
    let spins = section.elements("spin", "a list of \"cw\" and \"ccw\", one for each rotor")?;
    if spins.len() != positions.len() {
        let problem = format!("must have one element for each of {} positions, found {}", positions.len(), spins.len());
        return Err(FieldError::new(section.path_of("spin"), problem));
    }
    let thrust_coefficient = section.number("thrust_coefficient")? as f32;
    let drag_coefficient = section.number("drag_coefficient")? as f32;
    let (slowest, fastest) = read_speeds(&section)?;
    let thrust = |speed: f64| thrust_coefficient * (speed * speed) as f32;
    let mut list = Vec::new();
    for ((path, position), (spin_path, spin)) in positions.into_iter().zip(spins) {
        list.push(Rotor {
            position: vector_at(&path, position)?.map(|component| component as f32),
            spin: read_spin(spin_path, spin)?,
            thrust_coefficient,
            drag_coefficient,
            thrust_min: thrust(slowest),
            thrust_max: thrust(fastest),
        });
    }
    let rotors = Rotors::new(&list).map_err(|error| root.refused(&in_file(error)))?;
    mounted(root, configuration, rotors)
}

/// The field of the file that a refused field of one rotor comes from: all have the same coefficients and speeds.
fn in_file(error: ParameterError) -> ParameterError {
    let field = match error.field.split(',').next() {
        Some("rotors.thrust_coefficient") => "rotors.thrust_coefficient",
        Some("rotors.drag_coefficient") => "rotors.drag_coefficient",
        Some("rotors.thrust_min" | "rotors.thrust_max") => "rotors.speed",
        _ => error.field,
    };
    ParameterError { field, ..error }
}

/// Carries `configuration` to the rotors; refuses those that cannot hover it.
fn mounted(root: &Section, configuration: Configuration, rotors: Rotors) -> Result<Configuration, FieldError> {
    let hover = configuration.vehicle().mass * configuration.vehicle().gravity;
    let together = |thrust: fn(&Rotor) -> f32| rotors.iter().map(thrust).sum::<f32>();
    let (least, greatest) = (together(|rotor| rotor.thrust_min), together(|rotor| rotor.thrust_max));
    configuration.with_rotors(rotors).map_err(|error| {
        let found = root.lookup(error.field).unwrap_or_default();
        let problem = format!(
            "cannot hover: must let the rotors' thrust together reach from below to above {hover} N, found {found} rad/s: \
             {least} to {greatest} N"
        );
        FieldError::new(error.field, problem)
    })
}

/// Reads `[sampling]`: the delay in plant steps.
///
/// # Errors
/// If it is negative, longer than the sampled loops can be judged with, or no whole number of plant steps.
pub fn read_delay(root: &Section, timing: &Timing) -> Result<u64, FieldError> {
    let Some(section) = root.optional_section("sampling")? else {
        return Ok(0);
    };
    section.allow(&["delay"])?;
    let delay = read_time(&section, "delay")?;
    let greatest = f64::from(GREATEST_DELAY) * timing.period();
    if delay > greatest {
        let problem = format!("must be at most {GREATEST_DELAY} control periods, {greatest} s, found {delay}");
        return Err(FieldError::new(section.path_of("delay"), problem));
    }
    let steps = delay / timing.step();
    let whole = steps.round();
    if (steps - whole).abs() > 1e-6 {
        let nearest = whole * timing.step();
        let problem = format!("must be a whole number of plant steps, found {delay} s (nearest: {nearest:e} s)");
        return Err(FieldError::new(section.path_of("delay"), problem));
    }
    Ok(whole as u64)
}

fn read_time(section: &Section, key: &str) -> Result<f64, FieldError> {
    let time = section.number_or(key, 0.0)?;
    if (0.0..=LONGEST).contains(&time) {
        Ok(time)
    } else {
        Err(FieldError::new(section.path_of(key), format!("must be from 0 to {LONGEST} s, found {time}")))
    }
}

fn read_speeds(section: &Section) -> Result<(f64, f64), FieldError> {
    const WANTED: &str = "[least, greatest] in rad/s, 0 <= least < greatest";
    let elements = section.elements("speed", WANTED)?;
    let found = || elements.iter().map(|(_, value)| in_line(value)).collect::<Vec<_>>().join(", ");
    let refuse = || FieldError::new(section.path_of("speed"), format!("must be {WANTED}, found [{}]", found()));
    let numbers: Vec<f64> = elements.iter().filter_map(|(_, value)| number(value)).collect();
    match numbers.as_slice() {
        [least, greatest] if elements.len() == 2 && 0.0 <= *least && least < greatest && greatest.is_finite() => {
            Ok((*least, *greatest))
        }
        _ => Err(refuse()),
    }
}

fn number(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))
}

fn read_spin(path: String, value: &Value) -> Result<Spin, FieldError> {
    match value.as_str() {
        Some("cw") => Ok(Spin::Clockwise),
        Some("ccw") => Ok(Spin::CounterClockwise),
        _ => Err(FieldError::new(
            path,
            format!("must be \"cw\" or \"ccw\" as seen from above, found {}", in_line(value)),
        )),
    }
}

#[cfg(test)]
mod tests;
