//! `[vehicle]`, `[limits]` and `[gains]`: what the law and its certificate are about.
//!
//! `[vehicle] gravity` is 9.81 m/s^2 where it is left out. `[limits]`, or a key of it, may be left out beside
//! `[rotors]`: then the limits are what the rotors can give, all their maximum thrusts together and
//! [`max_torques`].
//!
//! `[control] law` is `"paper"` or `"extended"` ([`crate::extended`]). Left out it is the paper's where `[gains]` has a
//! gain that the paper's law alone has. `[control] thrust_floor` (N) is an option of the paper's law: see
//! [`controller_core::projection`].

use crate::bounds::{DEFAULT_SPEED_M_PER_S, read_bounds};
use crate::constants;
use crate::extended::{read_extended, refused};
use crate::inertia;
use crate::key::{Bounds, Key, Layout};
use crate::reality::drag::{self, Drag};
use crate::section::{FieldError, Section};
use crate::timing::CONTROL;
use controller_core::allocation::{Rotors, max_torques};
use controller_core::certificate::airframe::flyable;
use controller_core::configuration::Configuration;
use controller_core::error::ParameterError;
use controller_core::extended::actuators::ActuatorParameters;
use controller_core::extended::defaults::Airframe;
use controller_core::extended::parameters::ExtendedParameters;
use controller_core::gains::{GainParameters, Gains};
use controller_core::reference::ReferenceBounds;
use controller_core::vehicle::{LimitParameters, Limits, Vehicle, VehicleParameters};
use nalgebra::Vector3;

const DEFAULT_GRAVITY_M_PER_S2: f64 = 9.81;

/// The keys of `[vehicle]`.
pub const VEHICLE: Layout = Layout {
    name: "vehicle",
    about: "The vehicle as its controller knows it.",
    keys: &[
        Key::number("mass", Bounds::physical("kg"), "With all that flies."),
        Key::new("inertia", inertia::VALUES, "About body x, y, z, or the whole matrix, if it is diagonal."),
        Key::number("gravity", Bounds::physical("m/s^2"), "Downwards.").or(DEFAULT_GRAVITY_M_PER_S2),
    ],
};

/// The keys of `[limits]`.
pub const LIMITS: Layout = Layout {
    name: "limits",
    about: "What the law may command. Each left out: what [rotors] can give.",
    keys: &[
        Key::number("thrust_max", Bounds::physical("N"), "Above the weight.").optional(),
        Key::vector("torque_max", Bounds::physical("N m"), "About each body axis.").optional(),
    ],
};

/// Reads the law and its options, for a vehicle with its limits and rotors, if there are any, and the bounds of its
/// references. Its own reference is within `own`; so the paper law's bounds must be no less. The extended law's
/// estimates count on rotors that respond as `actuators` says.
///
/// # Errors
/// Names the field that is missing, of another law, or leaves the law undefined: M_p >= g - K_a3; `rotors.position` if
/// thrust alone would not lift a rotor, under the extended law.
pub fn read_configuration(
    root: &Section,
    (vehicle, limits, rotors): (Vehicle, Limits, Option<Rotors>),
    own: &ReferenceBounds,
    actuators: ActuatorParameters,
    period: f64,
) -> Result<Configuration, FieldError> {
    let (configuration, bounds) = if is_papers_law(root)? {
        if root.has("estimates") {
            let problem = "only the extended law estimates: set control.law = \"extended\", or leave the section out";
            return Err(FieldError::new("estimates", problem));
        }
        let gains = read_gains(root, &vehicle)?;
        let bounds = read_bounds(root, own, || {
            own.covering(&ReferenceBounds { horizontal_speed: DEFAULT_SPEED_M_PER_S, ..ReferenceBounds::REST })
        })?;
        (Configuration::new(vehicle, limits, gains, bounds), bounds)
    } else {
        rotors.iter().try_for_each(check_lifted)?;
        let drag = drag::read(root, rotors.is_some())?;
        let drag = drag.map_or(0.0, |drag| known_drag(&drag, &vehicle, rotors.as_ref()));
        let (rotors, vehicle, limits) = (rotors.as_ref(), &vehicle, &limits);
        let airframe = Airframe { vehicle, limits, rotors, actuators, period: period as f32, drag };
        let law = read_extended(root, &airframe)?;
        let bounds = read_bounds(root, &ReferenceBounds::REST, || flyable(&airframe, law))?;
        (Configuration::extended(*vehicle, *limits, law, bounds), bounds)
    };
    let configuration = configuration.map_err(|error| undefined(root, &vehicle, &bounds, &error))?;
    let configuration = match root.open(&CONTROL)? {
        Some(control) if control.has("thrust_floor") => {
            let floor = control.number("thrust_floor")? as f32;
            configuration.with_thrust_floor(floor).map_err(|error| root.refused(&error))?
        }
        _ => configuration,
    };
    match rotors {
        Some(rotors) => configuration.with_rotors(rotors).map_err(|error| refused(root, &error)),
        None => Ok(configuration),
    }
}

/// Refuses rotors that thrust alone would not lift, from which no constants of the extended law follow.
fn check_lifted(rotors: &Rotors) -> Result<(), FieldError> {
    let Some(index) = rotors.pseudo_inverse().iter().position(|row| row.x <= 0.0) else { return Ok(()) };
    let problem = format!(
        "leaves rotor {} without a share of the thrust, which the extended law needs: the centre of mass, \
         from which positions count, must lie well amid the rotors",
        index + 1
    );
    Err(FieldError::new("rotors.position", problem))
}

/// The error of a law that is undefined for references within `bounds`, whose vertical acceleration takes of gravity.
fn undefined(root: &Section, vehicle: &Vehicle, bounds: &ReferenceBounds, error: &ParameterError) -> FieldError {
    let taken = bounds.vertical_acceleration;
    if root.value(error.field).is_none() && root.has("reference_bounds") {
        let left = vehicle.gravity - taken;
        let problem = format!(
            "leaves {left} m/s^2 of vehicle.gravity to fall with, and {} needs more (left out: 0.63 of it), found {taken}",
            error.field
        );
        return FieldError::new("reference_bounds.vertical_acceleration", problem);
    }
    let FieldError { field, problem } = root.refused(error);
    let why = format!("(vehicle.gravity less the reference's vertical acceleration K_a3 = {taken})");
    FieldError::new(field, format!("{problem} {why}"))
}

/// Whether the law is the paper's: by `[control] law`, or by a gain in `[gains]` that the extended law does not have.
fn is_papers_law(root: &Section) -> Result<bool, FieldError> {
    if let Some(control) = root.open(&CONTROL)?.filter(|control| control.has("law")) {
        return Ok(control.choice("law")? == "paper");
    }
    let extended = constants::keys(&ExtendedParameters::TABLE, "gains");
    let own = constants::keys(&GainParameters::TABLE, "gains").into_iter().filter(|key| !extended.contains(key));
    Ok(root.optional_section("gains")?.is_some_and(|gains| own.into_iter().any(|key| gains.has(key))))
}

/// The drag across from the file's `[drag]`, per velocity and mass at hover, 1/s.
pub fn known_drag(drag: &Drag, vehicle: &Vehicle, rotors: Option<&Rotors>) -> f32 {
    let turning: f64 = rotors.map_or(0.0, |rotors| {
        let each = f64::from(vehicle.mass * vehicle.gravity) / rotors.len() as f64;
        rotors.iter().map(|rotor| (each / f64::from(rotor.thrust_coefficient)).sqrt()).sum()
    });
    let linear = 0.5 * (drag.linear.x + drag.linear.y);
    ((linear + drag.rotor_across * turning) / f64::from(vehicle.mass)) as f32
}

/// Reads `[vehicle]`.
///
/// # Errors
/// Names the field that is missing or not physical.
pub fn read_vehicle(root: &Section) -> Result<Vehicle, FieldError> {
    let section = root.section("vehicle")?.with(&VEHICLE)?;
    section.require_all(&["mass", "inertia"])?;
    let mass = section.number("mass")? as f32;
    let moments = inertia::read(&section, "inertia")?;
    let gravity = section.number("gravity")? as f32;
    let parameters = VehicleParameters { mass, inertia: moments.map(|moment| moment as f32), gravity };
    let vehicle = Vehicle::new(parameters).map_err(|error| {
        let impossible = inertia::impossible("vehicle.inertia", &moments, &error);
        impossible.unwrap_or_else(|| root.refused(&error))
    })?;
    if !(mass * gravity).is_finite() {
        let problem =
            format!("must have a weight, with vehicle.gravity = {gravity}, within {:e} N, found {mass:e}", f32::MAX);
        return Err(FieldError::new("vehicle.mass", problem));
    }
    Ok(vehicle)
}

/// Reads `[limits]`; what is left out comes from `rotors`.
///
/// # Errors
/// Names the field that is missing or refused, or `rotors.position` if the rotors cannot push without turning the
/// vehicle.
pub fn read_limits(root: &Section, vehicle: &Vehicle, rotors: Option<&Rotors>) -> Result<Limits, FieldError> {
    let missing = |field: &str, requirement: &str| {
        let problem = format!(
            "missing, must be {requirement} (it may be left out only beside [rotors], which are the limit then)"
        );
        FieldError::new(field, problem)
    };
    let section = match root.open(&LIMITS)? {
        None if rotors.is_none() => return Err(missing("limits", "a section")),
        section => section,
    };
    let with = |key: &str| section.as_ref().filter(|section| section.has(key));
    let thrust_max = match (with("thrust_max"), rotors) {
        (Some(section), _) => section.number("thrust_max")? as f32,
        (None, Some(rotors)) => rotors.thrust_together().1,
        (None, None) => return Err(missing("limits.thrust_max", "a number")),
    };
    let torque_max = match (with("torque_max"), rotors) {
        (Some(section), _) => section.vector("torque_max")?.map(|torque| torque as f32),
        (None, Some(rotors)) => rotors_torque_max(rotors)?,
        (None, None) => return Err(missing("limits.torque_max", "a list of three numbers")),
    };
    Limits::new(LimitParameters { thrust_max, torque_max }, vehicle).map_err(|error| root.refused(&error))
}

/// The maximum torque of `rotors` about each axis alone, N m.
fn rotors_torque_max(rotors: &Rotors) -> Result<Vector3<f32>, FieldError> {
    let torques = max_torques(rotors);
    if torques.min() > 0.0 {
        return Ok(torques);
    }
    let problem = "cannot push without turning the vehicle: the centre of mass, from which positions count, must lie \
                   amid the rotors";
    Err(FieldError::new("rotors.position", problem))
}

/// Reads `[gains]` of the paper's law: all of them are needed.
fn read_gains(root: &Section, vehicle: &Vehicle) -> Result<Gains, FieldError> {
    let section = root.section("gains")?;
    section.allow(&constants::keys(&GainParameters::TABLE, "gains"))?;
    section.require_all(&constants::keys(&GainParameters::TABLE, "gains"))?;
    let mut values = [0.0; GainParameters::COUNT];
    for (value, constant) in values.iter_mut().zip(&GainParameters::TABLE) {
        *value = section.number(constant.key)? as f32;
    }
    Gains::new(GainParameters::from_values(values), vehicle).map_err(|error| root.refused(&error))
}
