//! The flights a candidate is judged by, and what a pilot feels of them.
//!
//! | trial | what is asked | what counts |
//! |---|---|---|
//! | recovery | from roll -179 degrees, yaw 100 degrees off, at rest: hover there | height lost, m; time until within 0.1 m for good, and until within 0.1 rad of yaw, s |
//! | gust | hover; 5 m/s of wind begin, 2.5 m/s^2 unless the file's `[drag]` says otherwise | deepest excursion, m; offset left at the end, m |
//! | step | hover 1 m from where it is | time until within 0.1 m for good, s |
//! | noise | hover with gyro 0.01 rad/s, pose 2 mm and 0.2 degrees, all 20 ms late | change of a rotor's command per tick, N, rms; position, m, rms |
//!
//! The cost is their weighted sum, [`Shown::cost`], averaged over the models of [`MODELS`]: the vehicle as the file says, and as
//! it may really be.

use crate::course::Course;
use crate::flight::Flight;
use controller_core::error::ParameterError;
use controller_core::heading::Heading;
use controller_core::reference::hover::Hover;
use nalgebra::Vector3;
use scenario::Scenario;
use scenario::body::{BodyState, attitude_from_euler};
use scenario::reality::drag::Drag;
use scenario::reality::sensors::{Sensors, VelocitySource};
use scenario::reality::truth::Truth;
use scenario::reality::wind::{Gust, Shape, Wind};
use scenario::timing::Timing;
use std::sync::Arc;

/// How near is there, m.
const NEAR: f64 = 0.1;
/// When the gust begins, s.
const GUST_AT: f64 = 1.0;
/// Wind of the gust, m/s, and what it does to a vehicle of whose drag the file says nothing, 1/s.
const GUST: f64 = 5.0;
const GUST_DRAG: f64 = 0.5;
/// How long each trial lasts, s.
const GUST_TIME: f64 = 9.0;
const STEP_TIME: f64 = 12.0;
const NOISE_TIME: f64 = 6.0;

/// How far off the centre of mass may be, as a share of the longest arm: 5 mm are little on the Hummingbird, and turn over a
/// vehicle of a hand's size.
const OFF_CENTRE_MAX: f64 = 0.03;

/// A vehicle as it may really be, relative to the file's model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Model {
    /// Factor on the mass.
    pub mass: f64,
    /// What rotors deliver.
    pub thrust: f64,
    /// Centre of mass, m, body; on small vehicles nearer, by [`OFF_CENTRE_MAX`].
    pub centre_of_mass: [f64; 2],
    /// Factor on the rotors' lag.
    pub lag: f64,
    /// Further delay, s, rounded to plant steps.
    pub delay: f64,
}

/// The models a cost is averaged over: as the file says; and mass and thrust 10 % off, the centre of mass 5 mm, half as
/// much lag again, 5 ms of delay, in combinations.
pub const MODELS: [Model; 4] = [
    Model { mass: 1.0, thrust: 1.0, centre_of_mass: [0.0, 0.0], lag: 1.0, delay: 0.0 },
    Model { mass: 1.1, thrust: 0.9, centre_of_mass: [0.004, 0.003], lag: 1.5, delay: 0.0 },
    Model { mass: 0.9, thrust: 1.1, centre_of_mass: [-0.003, 0.004], lag: 1.0, delay: 0.005 },
    Model { mass: 1.0, thrust: 1.0, centre_of_mass: [0.0, 0.0], lag: 1.5, delay: 0.005 },
];

/// What the trials showed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shown {
    /// Height lost in the recovery, m.
    pub height_lost: f64,
    /// Until the recovery is within 0.1 m for good, s.
    pub recovered: f64,
    /// Until the recovery's yaw is within 0.1 rad for good, s.
    pub turned: f64,
    /// Deepest excursion in the gust, m.
    pub gust: f64,
    /// What is left of it at the end, m.
    pub offset: f64,
    /// Until the step is within 0.1 m for good, s.
    pub step: f64,
    /// Change of a rotor's command per tick under noise, N, rms.
    pub activity: f64,
    /// Position under noise, m, rms.
    pub noise: f64,
    /// Commands that a limit cut, in all trials.
    pub clipped: u64,
}

impl Shown {
    /// The weighted sum that a search makes small. Each term is one where a pilot would begin to be content: 3 m of height, 5 s until
    /// recovered, 8 s until turned, 0.6 m of excursion, 2 s for a step, 2 mm under noise, 0.02 N of activity. The last counts half.
    #[must_use]
    pub fn cost(&self) -> f64 {
        self.height_lost / 3.0
            + self.recovered / 5.0
            + self.turned / 8.0
            + self.gust / 0.6
            + self.step / 2.0
            + 0.5 * (self.activity / 0.02)
            + self.noise / 2e-3
    }
}

/// All trials in the circumstances of `scenario`, on `model`, with `recovery` s for the recovery; `start` begins a flight of what is
/// judged in the circumstances that it is given. None if one of them cannot be flown to its end.
#[must_use]
pub fn show(
    scenario: &Scenario,
    start: impl Fn(&Scenario) -> Option<Flight>,
    model: &Model,
    recovery: f64,
) -> Option<Shown> {
    let course = |scenario: &Scenario| Course::over(scenario, start(scenario)?, NEAR).ok();
    let real = really(scenario, model);
    let hovering = |position, duration| hover(&real, position, duration).ok();

    let recovered = course(&turned_over(&hovering(Vector3::zeros(), recovery)?))?;
    let mut gusty = hovering(Vector3::zeros(), GUST_TIME)?;
    let mass = f64::from(scenario.configuration.vehicle().mass);
    gusty.reality.drag =
        scenario.reality.drag.or(Some(Drag { linear: Vector3::repeat(GUST_DRAG * mass), ..Drag::default() }));
    let gust = Gust { shape: Shape::Step, start: GUST_AT, velocity: Vector3::new(GUST, 0.0, 0.0) };
    gusty.reality.wind = Some(Wind { gust: Some(gust), ..Wind::default() });
    let gusty = course(&gusty)?;
    let step = course(&hovering(Vector3::new(-1.0, 0.0, 0.0), STEP_TIME)?)?;
    let mut noisy = hovering(Vector3::zeros(), NOISE_TIME)?;
    noisy.reality.sensors = Some(noise(scenario.timing.period()));
    let noisy = course(&noisy)?;

    Some(Shown {
        height_lost: recovered.height_lost,
        recovered: recovered.settled.unwrap_or(recovery),
        turned: recovered.turned.unwrap_or(recovery),
        gust: gusty.excursion,
        offset: gusty.end_error,
        step: step.settled.unwrap_or(STEP_TIME),
        activity: noisy.activity,
        noise: noisy.rms,
        clipped: recovered.clipped + gusty.clipped + step.clipped + noisy.clipped,
    })
}

/// The recovery that height is measured in: the attitude the paper starts from (roll -179 degrees, yaw 100 degrees off the
/// heading asked for), at rest, hovering where it starts, for `duration` s. Table I loses 23.3 m in it.
///
/// # Errors
/// None for a hover at the origin.
pub fn recovery(scenario: &Scenario, duration: f64) -> Result<Scenario, ParameterError> {
    Ok(turned_over(&hover(scenario, Vector3::zeros(), duration)?))
}

fn turned_over(scenario: &Scenario) -> Scenario {
    let attitude = attitude_from_euler((-179.0_f64).to_radians(), 0.0, 100.0_f64.to_radians());
    let initial = BodyState { attitude, ..scenario.initial };
    let mut recovery = Scenario { name: "recovery".to_owned(), initial, ..scenario.clone() };
    // Height can only be lost where there is no ground.
    recovery.reality.ground = None;
    recovery
}

/// Level and at rest at `position`, to hover at the origin.
pub fn hover(scenario: &Scenario, position: Vector3<f64>, duration: f64) -> Result<Scenario, ParameterError> {
    let zero = Vector3::zeros();
    let attitude = attitude_from_euler(0.0, 0.0, 0.0);
    let initial = BodyState { position, velocity: zero, attitude, angular_velocity: zero };
    let timing = Timing { ticks: (duration / scenario.timing.period()) as u64, ..scenario.timing };
    let trajectory = Arc::new(Hover::new(Vector3::zeros(), Heading::FORWARD)?);
    Ok(Scenario { initial, timing, trajectory, ..scenario.clone() })
}

/// The scenario's vehicle as `model` says that it is.
fn really(scenario: &Scenario, model: &Model) -> Scenario {
    let mut real = scenario.clone();
    let vehicle = scenario.configuration.vehicle();
    if *model != MODELS[0] {
        let own = Truth::of_model(vehicle);
        real.reality.truth = Some(Truth {
            mass: own.mass * model.mass,
            centre_of_mass: off_centre(scenario, model),
            thrust_scale: model.thrust,
            ..own
        });
        real.rotor_lag *= model.lag;
        real.delay_steps += (model.delay / scenario.timing.step()).round() as u64;
    }
    real.reality.wind = None;
    // What a state that is estimated costs, every candidate pays alike.
    real.reality.estimator = None;
    real
}

/// Where the centre of mass of the scenario's vehicle really is, m, body.
fn off_centre(scenario: &Scenario, model: &Model) -> Vector3<f64> {
    let [x, y] = model.centre_of_mass;
    let off = Vector3::new(x, y, 0.0);
    let Some(rotors) = scenario.configuration.rotors() else { return off };
    let arm = rotors.iter().map(|rotor| f64::from(rotor.position.xy().norm())).fold(0.0, f64::max);
    off.cap_magnitude(OFF_CENTRE_MAX * arm)
}

/// What the trial under noise is told of the state.
#[must_use]
pub fn noise(period: f64) -> Sensors {
    Sensors {
        gyro_noise: 0.01,
        gyro_bias: Vector3::zeros(),
        position_noise: 2e-3,
        attitude_noise: 0.2_f64.to_radians(),
        velocity: VelocitySource::Observer { bandwidth: 8.0, noise: 0.05, bias: Vector3::zeros() },
        pose_every: 1,
        dropout: 0.0,
        delay_ticks: (0.02 / period).round() as u64,
        seed: 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_vehicle_is_as_far_off_centre_as_a_large_one_for_its_size() {
        let large = Scenario::parse(scenario::STUDY, "study.toml").unwrap();
        let small = scenario::STUDY.replace("0.120208", "0.0300520");
        let small = Scenario::parse(&small, "small.toml").unwrap();
        let [of_large, of_small] = [&large, &small].map(|scenario| off_centre(scenario, &MODELS[1]));
        assert_eq!(of_large, Vector3::new(0.004, 0.003, 0.0));
        assert!((of_small.norm() - 0.03 * 0.0425).abs() < 1e-5, "{of_small}");
        assert!(of_small.cross(&of_large).norm() < 1e-12);
    }
}
