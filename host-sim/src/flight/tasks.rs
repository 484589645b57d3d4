//! Tasks that every study flies, and the circumstances it flies them in.

use controller_core::error::ParameterError;
use controller_core::heading::Heading;
use controller_core::reference::hover::Hover;
use nalgebra::Vector3;
use scenario::Scenario;
use scenario::body::{BodyState, attitude_from_euler};
use scenario::reality::drag::Drag;
use scenario::reality::truth::Truth;
use scenario::reality::wind::{Gust, Shape, Wind};
use scenario::timing::Timing;
use std::sync::Arc;

/// When a wind sets in.
pub const WIND_START_S: f64 = 1.0;

/// Drag of a vehicle whose file gives none.
const DEFAULT_DRAG_PER_S: f64 = 0.5;

/// Level and at rest at `position`, to hover at the origin.
pub fn hover(scenario: &Scenario, position: Vector3<f64>, duration: f64) -> Result<Scenario, ParameterError> {
    let zero = Vector3::zeros();
    let attitude = attitude_from_euler(0.0, 0.0, 0.0);
    let initial = BodyState { position, velocity: zero, attitude, angular_velocity: zero };
    let timing = Timing { ticks: (duration / scenario.timing.period()) as u64, ..scenario.timing };
    let trajectory = Arc::new(Hover::new(Vector3::zeros(), Heading::FORWARD)?);
    Ok(Scenario { initial, timing, trajectory, ..scenario.clone() })
}

/// The recovery that height is measured in: the attitude the paper starts from (roll -179 degrees, yaw 100 degrees off
/// the reference's heading), at rest, hovering where it starts, for `duration` s. Table I loses 23.3 m in it.
pub fn recovery(scenario: &Scenario, duration: f64) -> Result<Scenario, ParameterError> {
    Ok(turned_over(&hover(scenario, Vector3::zeros(), duration)?))
}

/// The same flight from the recovery's attitude, without ground.
pub fn turned_over(scenario: &Scenario) -> Scenario {
    let attitude = attitude_from_euler((-179.0_f64).to_radians(), 0.0, 100.0_f64.to_radians());
    let initial = BodyState { attitude, ..scenario.initial };
    let mut recovery = Scenario { name: "recovery".to_owned(), initial, ..scenario.clone() };
    // Height can only be lost where there is no ground.
    recovery.reality.ground = None;
    recovery
}

/// The drag of the scenario's vehicle: its file's, or a usual one.
pub fn drag(scenario: &Scenario) -> Drag {
    let mass = f64::from(scenario.configuration.vehicle().mass);
    scenario.reality.drag.unwrap_or(Drag { linear: Vector3::repeat(DEFAULT_DRAG_PER_S * mass), ..Drag::default() })
}

/// The same flight in a wind of `speed`, m/s, along x, that sets in at [`WIND_START_S`].
pub fn in_wind(scenario: &Scenario, speed: f64) -> Scenario {
    let mut windy = scenario.clone();
    windy.reality.drag = Some(drag(scenario));
    let gust = Gust { shape: Shape::Step, start: WIND_START_S, velocity: Vector3::new(speed, 0.0, 0.0) };
    windy.reality.wind = Some(Wind { gust: Some(gust), ..Wind::default() });
    windy
}

/// The same flight of a vehicle with `mass` times the file's mass, whose rotors deliver `thrust_scale` of the model's.
pub fn of_mass_and_thrust(scenario: &Scenario, mass: f64, thrust_scale: f64) -> Scenario {
    let mut other = scenario.clone();
    let truth = Truth::model(scenario.configuration.vehicle());
    other.reality.truth = Some(Truth { mass: truth.mass * mass, thrust_scale, ..truth });
    other
}

/// The vehicle of `file` in still air, with nothing that happens to it.
pub fn in_still_air(file: &Scenario) -> Scenario {
    let mut still_air = file.clone();
    still_air.reality.drag = Some(drag(file));
    let reality = &mut still_air.reality;
    (reality.wind, reality.disturbance, reality.failure, reality.sensors, reality.estimator) =
        (None, None, None, None, None);
    still_air
}
