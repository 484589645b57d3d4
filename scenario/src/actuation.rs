//! `[rotors]` and `[sampling]`: what stands between the law's wrench and the body. Both may be left out.

pub mod idle;
pub mod propulsion;
mod spin_order;

use crate::key::{Bounds, Key, Layout, Values};
use crate::plausibility::likely_slip;
use crate::sampled_loop::DELAY_MAX_SAMPLES;
use crate::section::{FieldError, Section, in_line, vector_at};
use crate::timing::Timing;
use controller_core::allocation::{Rotor, Rotors, Spin};
use controller_core::error::{ParameterError, Reason};
use controller_core::vehicle::Vehicle;
use idle::LeastCommand;
use propulsion::Propulsion;
use toml::Value;

/// Slower actuators fly no multirotor.
const LAG_OR_DELAY_MAX_S: f64 = 1.0;

const LAG_OR_DELAY_BOUNDS: Bounds = Bounds::between(0.0, LAG_OR_DELAY_MAX_S, "s").checked_later();

/// The keys of `[rotors]`.
pub const ROTORS: Layout = Layout {
    name: "rotors",
    about: "What delivers thrust and torque. Either thrust_coefficient, drag_coefficient and speed, or thrust_max, \
            thrust_min and torque_per_thrust say how much. Left out: both act directly, within [limits].",
    keys: &[
        Key::new("position", Values::List(&Values::Vector(Bounds::any("m"))), "Of each rotor, m, body."),
        Key::new("spin", Values::List(&Values::Choice(&["cw", "ccw"])), "Of each rotor, seen from above."),
        Key::number("lag", LAG_OR_DELAY_BOUNDS, "First-order, of the speeds."),
        propulsion::SPEED_KEYS[0],
        propulsion::SPEED_KEYS[1],
        propulsion::SPEED_KEYS[2],
        propulsion::THRUST_KEYS[0],
        propulsion::THRUST_KEYS[1],
        propulsion::THRUST_KEYS[2],
        idle::KEYS[0],
        idle::KEYS[1],
    ],
};

/// The keys of `[sampling]`.
pub const SAMPLING: Layout = Layout {
    name: "sampling",
    about: "When commands act.",
    keys: &[Key::number("delay", LAG_OR_DELAY_BOUNDS, "From a tick to the moment its wrench acts; whole plant steps.")
        .or(0.0)],
};

/// Reads the first-order lag of the rotors' speeds, s; zero without `[rotors]`.
///
/// # Errors
/// If it is missing, since the law counts on it and no lag is the cautious one; negative or longer than any rotor's.
pub fn read_lag(root: &Section) -> Result<f64, FieldError> {
    let Some(section) = root.optional_section("rotors")? else { return Ok(0.0) };
    if !section.has("lag") {
        let problem = "missing, must be the time in which the rotors follow a command, s: begin with 0.03, which is \
                       much, and identify it from a flight (docs/identify.md)";
        return Err(FieldError::new("rotors.lag", problem));
    }
    read_time(&section, "lag")
}

/// Reads `[rotors]` of `vehicle`, with their least command; none without the section.
///
/// # Errors
/// Names the field that is missing or refused; `rotors` where together they cannot produce every wrench; what says how
/// much thrust they have if it cannot hover the vehicle.
pub fn read_rotors(root: &Section, vehicle: &Vehicle) -> Result<Option<(Rotors, LeastCommand)>, FieldError> {
    let Some(section) = root.open(&ROTORS)? else {
        return Ok(None);
    };
    let positions = section.elements("position", "a list of positions [x, y, z]")?;
    let spins = section.elements("spin", "a list of \"cw\" and \"ccw\", one for each rotor")?;
    if spins.len() != positions.len() {
        let problem = format!("must have one element for each of {} positions, found {}", positions.len(), spins.len());
        return Err(FieldError::new(section.path_of("spin"), problem));
    }
    let each = Propulsion::read(&section)?;
    let least = LeastCommand::read(&section, &each)?;
    let mut list = Vec::new();
    for ((path, position), (spin_path, spin)) in positions.into_iter().zip(spins) {
        list.push(Rotor {
            position: vector_at(&path, position)?.map(|component| component as f32),
            spin: read_spin(spin_path, spin)?,
            thrust_coefficient: each.thrust_coefficient,
            drag_coefficient: each.drag_coefficient,
            thrust_min: least.thrust_min,
            thrust_max: each.thrust_max,
        });
    }
    let rotors = Rotors::new(&list).map_err(|error| match error.reason {
        Reason::DoesNotSpan => spin_order::refused(&list),
        _ => root.refused(&each.in_file(error)),
    })?;
    let rotors = if each.has_speeds() { rotors } else { rotors.of_nominal_speed() };
    let hover = vehicle.mass * vehicle.gravity;
    let checked = match rotors.check_hover(hover) {
        // Idle lifts it: whether its rotors are a vehicle's at all is asked first.
        Err(ParameterError { reason: Reason::NotBelow(_), .. }) if least.is_of_idle() => Ok(()),
        checked => checked,
    };
    checked.map_err(|error| {
        let field = each.in_file(error).field;
        let found = root.lookup(field).unwrap_or_default();
        let (min, max) = rotors.thrust_together();
        let problem = format!(
            "cannot hover: must let the rotors' thrust together reach from below to above {hover} N, found {found} {}: \
             {min} to {max} N{}",
            each.unit(),
            likely_slip(root, vehicle, Some(&rotors))
        );
        FieldError::new(field, problem)
    })?;
    Ok(Some((rotors, least)))
}

/// Reads `[sampling]`: the delay in plant steps.
///
/// # Errors
/// If it is negative, longer than the sampled loops can be judged with, or no whole number of plant steps.
pub fn read_delay(root: &Section, timing: &Timing) -> Result<u64, FieldError> {
    let Some(section) = root.open(&SAMPLING)? else {
        return Ok(0);
    };
    let delay = read_time(&section, "delay")?;
    let max = f64::from(DELAY_MAX_SAMPLES) * timing.period();
    if delay > max {
        let problem = format!("must be at most {DELAY_MAX_SAMPLES} control periods, {max} s, found {delay}");
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
    let time = section.number(key)?;
    if (0.0..=LAG_OR_DELAY_MAX_S).contains(&time) {
        Ok(time)
    } else {
        let in_seconds = time / 1000.0;
        let is_slip = (0.0..=LAG_OR_DELAY_MAX_S).contains(&in_seconds);
        let slip = if is_slip { format!("; if it is in ms, write {in_seconds}") } else { String::new() };
        Err(FieldError::new(
            section.path_of(key),
            format!("must be from 0 to {LAG_OR_DELAY_MAX_S} s, found {time}{slip}"),
        ))
    }
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
