//! What a model leaves out, one thing after the other: ours beside others on a vehicle that is not as its file says.
//!
//! In each scene the vehicle starts upside down where it is to hover; above the ground it starts level, 1 m higher. No
//! law knows what is different. Ours flies as it is certified, with its file's estimates.
//!
//! | scene | what is different |
//! |---|---|
//! | delay | everything acts 20 ms later |
//! | mass | 1.6 times the mass |
//! | battery | three quarters of the voltage |
//! | wind | 8 m/s, with turbulence of 2 m/s along it |
//! | ground | rotors that the ground lifts, 5 cm above where the vehicle stands |
//! | flywheels | rotors whose inertia makes all of their lag: J_r = 2 k_m w lag, w in hover |
//! | drag | twice the drag, and rotors that flap with a tenth of the moment that their drag has about an arm |
//! | deadband | commands within 2 % of a rotor's speed that change nothing |
//! | mild | 10 ms, 1.2 times the mass, 0.9 of the voltage, half of wind, deadband and further drag, flywheels |
//!
//! A flight is lost if it ends early or more than `LOST_DISTANCE_M` from its reference.

use super::rows::FigureRow;
use super::scene_figures::{SceneFigures, fly_scene_within};
use super::scenes::Scene;
use crate::flight::law_on_vehicle::LawOnVehicle;
use crate::flight::tasks::{drag, hover, recovery};
use controller_core::error::ParameterError;
use nalgebra::Vector3;
use scenario::Scenario;
use scenario::reality::battery::Battery;
use scenario::reality::drag::Drag;
use scenario::reality::ground::Ground;
use scenario::reality::truth::Truth;
use scenario::reality::wind::{Turbulence, Wind};

const FLIGHT_S: f64 = 20.0;
/// Turbulence moves a vehicle by more than 0.1 m.
const ARRIVAL_DISTANCE_M: f64 = 0.5;
/// A vehicle that is farther away at the end is lost.
const LOST_DISTANCE_M: f64 = 5.0;
/// For a turbulence of 1 m/s along the wind: MIL-F-8785C at 10 m.
const WIND_AT_20_FEET_M_PER_S: f64 = 5.3;
const TURBULENCE_ALTITUDE_M: f64 = 10.0;
/// Of how far above where it stands a vehicle hovers over the ground, and of how much higher it starts.
const HOVER_HEIGHT_M: f64 = 0.05;
const STARTS_HIGHER_M: f64 = 1.0;
/// Of the least distance between two rotors.
const ROTOR_RADIUS_SHARE: f64 = 0.45;

/// What is different, each as a part of its whole measure.
#[derive(Debug, Clone, Copy, Default)]
struct Different {
    delay: f64,
    mass: f64,
    sag: f64,
    wind: f64,
    turbulence: f64,
    flywheels: f64,
    drag: f64,
    deadband: f64,
}

/// All scenes, in the order of the table.
pub fn all(file: &Scenario) -> Result<Vec<Scene>, ParameterError> {
    let nothing = Different::default();
    let recovered = |different: Different| recovery(&really(file, &different), FLIGHT_S);
    let mild = Different {
        delay: 0.01,
        mass: 0.2,
        sag: 0.1,
        wind: 4.0,
        turbulence: 1.0,
        flywheels: 1.0,
        drag: 0.5,
        deadband: 0.01,
    };
    let scenes = [
        ("delay", "everything acts 20 ms later", recovered(Different { delay: 0.02, ..nothing })?),
        ("mass", "1.6 times the mass", recovered(Different { mass: 0.6, ..nothing })?),
        ("battery", "three quarters of the voltage", recovered(Different { sag: 0.25, ..nothing })?),
        ("wind", "8 m/s with 2 m/s of gusts", recovered(Different { wind: 8.0, turbulence: 2.0, ..nothing })?),
        ("ground", "hover 5 cm above the ground, whose effect nobody knows", over_ground(file)?),
        ("flywheels", "rotors with inertia", recovered(Different { flywheels: 1.0, ..nothing })?),
        ("drag", "twice the drag, and flapping", recovered(Different { drag: 1.0, ..nothing })?),
        ("deadband", "commands within 2 % change nothing", recovered(Different { deadband: 0.02, ..nothing })?),
        ("mild", "a milder dose of everything", recovered(mild)?),
    ];
    Ok(scenes.map(|(name, task, scenario)| Scene { name, task, scenario }).into())
}

/// The vehicle of `file` in still air with what is different.
fn really(file: &Scenario, different: &Different) -> Scenario {
    let mut real = file.clone();
    let vehicle = file.configuration.vehicle();
    let mass = f64::from(vehicle.mass);
    let reality = &mut real.reality;
    (reality.disturbance, reality.failure, reality.sensors, reality.estimator) = (None, None, None, None);
    let model = Truth::model(vehicle);
    reality.truth = Some(Truth {
        mass: mass * (1.0 + different.mass),
        rotor_inertia: different.flywheels * flywheel(file),
        deadband: different.deadband,
        ..model
    });
    reality.drag = Some(more(&drag(file), different.drag, file));
    reality.wind = (different.wind > 0.0).then(|| Wind {
        steady: Vector3::x() * different.wind,
        gust: None,
        turbulence: Some(Turbulence {
            wind_at_20_feet: WIND_AT_20_FEET_M_PER_S * different.turbulence,
            altitude: TURBULENCE_ALTITUDE_M,
            airspeed: different.wind,
            seed: 1,
        }),
    });
    reality.battery = (different.sag > 0.0 && file.configuration.rotors().is_some()).then(|| {
        let voltage = 1.0 - different.sag;
        Battery {
            full_voltage: voltage,
            empty_voltage: voltage,
            resistance: 0.0,
            capacity: f64::MAX,
            charge: 1.0,
            efficiency: 1.0,
            nominal_voltage: 1.0,
        }
    });
    real.delay_steps += (different.delay / file.timing.step()).round() as u64;
    real
}

/// Of the vehicle of `file`, from 1 m above.
fn over_ground(file: &Scenario) -> Result<Scenario, ParameterError> {
    let mut real = hover(&really(file, &Different::default()), Vector3::z() * STARTS_HIGHER_M, FLIGHT_S)?;
    let rotors = file.configuration.rotors().map_or(&[][..], |rotors| rotors);
    let places = rotors.iter().map(|rotor| rotor.position.xy().map(f64::from));
    let apart = places.clone().flat_map(|one| places.clone().map(move |other| (one - other).norm()));
    let least = apart.filter(|apart| *apart > 0.0).fold(f64::INFINITY, f64::min);
    real.reality.ground = Some(Ground { height: -HOVER_HEIGHT_M });
    if let Some(truth) = real.reality.truth.as_mut().filter(|_| least.is_finite()) {
        truth.rotor_radius = ROTOR_RADIUS_SHARE * least;
    }
    Ok(real)
}

/// The speed of a rotor of the vehicle of `file` in hover, rad/s, and its coefficient k_m; nothing without rotors.
fn hovering(file: &Scenario) -> Option<(f64, f64)> {
    let (vehicle, rotors) = (file.configuration.vehicle(), file.configuration.rotors()?);
    let rotor = rotors.first()?;
    let thrust = vehicle.mass * vehicle.gravity / rotors.len() as f32;
    Some((rotor.speed_at(thrust).into(), rotor.drag_coefficient.into()))
}

/// J_r = 2 k_m w lag, kg m^2.
fn flywheel(file: &Scenario) -> f64 {
    hovering(file).map_or(0.0, |(speed, drag)| 2.0 * drag * speed * file.rotor_lag)
}

/// `own` and so much of it again, with rotors that flap in proportion.
fn more(own: &Drag, part: f64, file: &Scenario) -> Drag {
    let factor = 1.0 + part;
    let rotors = file.configuration.rotors().map_or(&[][..], |rotors| rotors);
    let arm = rotors.iter().map(|rotor| f64::from(rotor.position.xy().norm())).fold(0.0, f64::max);
    // The whole vehicle's linear drag is that of its rotors in hover.
    let of_rotors = hovering(file).map_or(0.0, |(speed, _)| own.linear.x / (speed * rotors.len() as f64));
    Drag {
        linear: own.linear * factor,
        frame: own.frame * factor,
        rotor_across: own.rotor_across * factor,
        rotor_along: own.rotor_along * factor,
        translational_lift: own.translational_lift,
        flapping: own.flapping + 0.1 * part * arm * own.rotor_across.max(of_rotors),
    }
}

/// The rows of each law's figures in each of the `scenes`, in the laws' order.
pub fn rows(scenes: &[(&'static str, Vec<Option<SceneFigures>>)]) -> Vec<FigureRow> {
    type Get = fn(Option<&SceneFigures>) -> f64;
    const REALISM_FIGURES: [(&str, &str, f64, Get); 4] = [
        ("lost", "flights", 0.0, |figures| f64::from(u8::from(!figures.is_some_and(is_held)))),
        ("height lost", "m", 0.01, |figures| figures.map_or(f64::INFINITY, |figures| figures.height_lost)),
        ("within 0.5 m for good after", "s", 0.02, |figures| {
            figures.and_then(|figures| figures.settled).unwrap_or(f64::INFINITY)
        }),
        ("position error, last half, RMS", "mm", 0.1, |figures| {
            figures.map_or(f64::INFINITY, |figures| 1e3 * figures.rms)
        }),
    ];
    let of_scene = |(scene, figures): &(&'static str, Vec<Option<SceneFigures>>)| {
        let values = |get: Get| figures.iter().map(|figures| get(figures.as_ref())).collect();
        let row =
            |(figure, unit, grain, get)| FigureRow { scene, figure, unit, values: values(get), grain, limit: None };
        REALISM_FIGURES.map(row)
    };
    scenes.iter().flat_map(of_scene).collect()
}

/// Whether a flight that did not end early is not lost.
pub fn is_held(figures: &SceneFigures) -> bool {
    figures.end_error <= LOST_DISTANCE_M
}

/// Flies `scene`; none if it cannot be flown to its end.
pub fn fly_realism_scene(law: &LawOnVehicle, scene: &Scene) -> Option<SceneFigures> {
    fly_scene_within(law, scene, ARRIVAL_DISTANCE_M)
}

#[cfg(test)]
mod tests;
