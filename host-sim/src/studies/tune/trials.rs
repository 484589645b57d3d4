//! The flights that judge a candidate, and their figures, which a pilot feels and `compare` measures.
//!
//! | trial | task | figures |
//! |---|---|---|
//! | recovery | from roll -179 degrees, yaw 100 degrees off, at rest: hover there | height lost, m; time until within 0.1 m for good, and until within 0.1 rad of yaw, s |
//! | gust | hover; 5 m/s of wind begin, 2.5 m/s^2 unless the file's `[drag]` says otherwise | deepest excursion, m; offset left at the end, m |
//! | step | hover 1 m from where it is | time until within 0.1 m for good, s |
//! | noise | hover with gyro 0.01 rad/s, 3 ms late, and poses of 2 mm and 0.2 degrees, 20 ms late | change of a rotor's command within 10 ms, as a share of its thrust in hover, rms; position, m, rms |
//! | storm | hover; 12 m/s of wind begin | deepest excursion, m |
//! | far step | hover 10 m away, across and up | time until within 0.1 m for good, s |
//! | weak rotors | 1 m step with rotors that deliver 60 % | time until within 0.1 m for good, s |
//! | heavy | the recovery with 1.6 times the mass | height lost, m; time until within 0.1 m for good, s |
//!
//! The cost is their weighted sum, [`TrialFigures::cost`], averaged over the models of [`COST_MODELS`]: the vehicle as the file
//! says, and as it may really be. The last four go beyond a law's promise; they are flown on the file's own model
//! only.

use crate::flight::Flight;
use crate::flight::course::Course;
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
use std::fmt;
use std::sync::Arc;

const ARRIVAL_DISTANCE_M: f64 = 0.1;
/// The time at which the gust begins.
const GUST_START_S: f64 = 1.0;
/// Wind of the gust; and the drag of a vehicle whose file gives none, 1/s.
const GUST_M_PER_S: f64 = 5.0;
const DEFAULT_DRAG_PER_S: f64 = 0.5;
const STORM_M_PER_S: f64 = 12.0;
/// The greatest duration of each trial.
const GUST_FLIGHT_S: f64 = 6.0;
const STORM_FLIGHT_S: f64 = 8.0;
const STEP_FLIGHT_S: f64 = 12.0;
const NOISE_FLIGHT_S: f64 = 4.0;
/// A flight in still air ends once position and yaw have been settled for this time.
const SETTLED_FOR_S: f64 = 2.0;
/// Between two poses, and from the moment that one shows to its arrival.
const POSE_PERIOD_S: f64 = 0.01;
const POSE_DELAY_S: f64 = 0.02;
/// How late a gyro, an accelerometer and rotor speeds are by their filters: a BMI088's own of 116 Hz makes 1.9 ms
/// (second order: sqrt(2) / (2 pi f)), and a low-pass of 200 Hz against vibration another 1.1 ms.
const IMU_DELAY_S: f64 = 0.003;
/// Noise of an accelerometer's mean over [`POSE_PERIOD_S`]; white, so that of a shorter time is larger.
const ACCELEROMETER_NOISE_M_PER_S2: f64 = 0.05;
/// The thrust scale of weak rotors, and the mass factor of a heavy vehicle.
const WEAK_THRUST_SCALE: f64 = 0.6;
const HEAVY_MASS_FACTOR: f64 = 1.6;

/// How far off the centre of mass may be, as a share of the longest arm: 5 mm are little on the Hummingbird, and turn
/// over a vehicle of a hand's size.
const CENTRE_OFFSET_MAX_SHARE: f64 = 0.03;

/// A vehicle as it may really be, relative to the file's model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Model {
    /// Factor on the mass.
    pub mass: f64,
    /// The thrust scale.
    pub thrust: f64,
    /// Centre of mass, m, body; on small vehicles nearer, by `CENTRE_OFFSET_MAX_SHARE`.
    pub centre_of_mass: [f64; 2],
    /// Factor on the rotors' lag.
    pub lag: f64,
    /// Further delay, s, rounded to plant steps.
    pub delay: f64,
}

impl fmt::Display for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { mass, thrust, centre_of_mass: [x, y], lag, delay } = self;
        write!(f, "mass times {mass}, thrust times {thrust}, centre of mass at [{x}, {y}] m, ")?;
        write!(f, "lag times {lag}, {delay} s of further delay")
    }
}

/// The models a cost is averaged over: as the file says; and mass and thrust 10 % off, the centre of mass 5 mm, half as
/// much lag again, 5 ms of delay, in combinations.
pub const COST_MODELS: [Model; 4] = [
    Model { mass: 1.0, thrust: 1.0, centre_of_mass: [0.0, 0.0], lag: 1.0, delay: 0.0 },
    Model { mass: 1.1, thrust: 0.9, centre_of_mass: [0.004, 0.003], lag: 1.5, delay: 0.0 },
    Model { mass: 0.9, thrust: 1.1, centre_of_mass: [-0.003, 0.004], lag: 1.0, delay: 0.005 },
    Model { mass: 1.0, thrust: 1.0, centre_of_mass: [0.0, 0.0], lag: 1.5, delay: 0.005 },
];

/// The trials' figures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrialFigures {
    /// Height lost in the recovery, m.
    pub height_lost: f64,
    /// Until the recovery is within 0.1 m for good, s.
    pub recovered: f64,
    /// Until the recovery's yaw is within 0.1 rad for good, s.
    pub turned: f64,
    /// Deepest excursion in the gust, m.
    pub gust: f64,
    /// The offset at the gust's end, m.
    pub offset: f64,
    /// Until the step is within 0.1 m for good, s.
    pub step: f64,
    /// Change of a rotor's command within 10 ms under noise, rms, as a share of its thrust in hover; zero without
    /// rotors.
    pub activity: f64,
    /// Position under noise, m, rms.
    pub noise: f64,
    /// The figures beyond a law's promise, on the file's own model; `None` for another model.
    pub beyond: Option<HarderTrialFigures>,
    /// Commands that a limit cut, in all trials.
    pub clipped: u64,
}

/// The figures of the trials beyond a law's promise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HarderTrialFigures {
    /// Deepest excursion in the storm, m.
    pub storm: f64,
    /// Until the far step is within 0.1 m for good, s.
    pub far: f64,
    /// Until the step with weak rotors is within 0.1 m for good, s.
    pub weak: f64,
    /// Height lost in the heavy vehicle's recovery, m.
    pub heavy_lost: f64,
    /// Until it is within 0.1 m for good, s.
    pub heavy: f64,
}

/// A figure: its name, its unit, the value with which a pilot begins to be content, and its weight.
pub type Figure = (&'static str, &'static str, f64, f64);

/// The figures that every model shows, as [`TrialFigures::values`].
pub const MODEL_FIGURES: [Figure; 7] = [
    ("upside down: height lost", "m", 3.0, 1.0),
    ("upside down: back for good after", "s", 5.0, 1.0),
    ("upside down: yaw back after", "s", 8.0, 1.0),
    ("gust of 5 m/s: excursion", "m", 0.3, 1.0),
    ("step of 1 m: there after", "s", 2.0, 1.0),
    ("noise: position, rms", "m", 4e-3, 1.0),
    ("noise: rotor command's change in 10 ms", "of hovering", 0.05, 0.5),
];

/// The figures of the file's own model alone, as [`HarderTrialFigures::values`].
pub const OWN_MODEL_FIGURES: [Figure; 5] = [
    ("storm of 12 m/s: excursion", "m", 2.0, 0.5),
    ("step of 10 m: there after", "s", 5.0, 1.0),
    ("step with weak rotors: there after", "s", 4.0, 0.5),
    ("upside down, heavy: height lost", "m", 6.0, 0.5),
    ("upside down, heavy: back after", "s", 8.0, 0.5),
];

/// No figure counts more than this many times its content value, so that the other figures judge a vehicle that cannot
/// fly one of the trials.
const FIGURE_COST_MAX: f64 = 10.0;

/// The weighted sum of `values`.
fn weighted(figures: &[Figure], values: &[f64]) -> f64 {
    let parts = figures.iter().zip(values);
    parts.map(|((_, _, content, weight), value)| weight * (value / content).min(FIGURE_COST_MAX)).sum()
}

impl HarderTrialFigures {
    /// The values of [`OWN_MODEL_FIGURES`].
    #[must_use]
    pub fn values(&self) -> [f64; 5] {
        [self.storm, self.far, self.weak, self.heavy_lost, self.heavy]
    }
}

impl TrialFigures {
    /// The values of [`MODEL_FIGURES`].
    #[must_use]
    pub const fn values(&self) -> [f64; 7] {
        [self.height_lost, self.recovered, self.turned, self.gust, self.step, self.noise, self.activity]
    }

    /// The weighted sum that a search minimises. A figure of only one of the [`COST_MODELS`] counts as if all had it.
    #[must_use]
    pub fn cost(&self) -> f64 {
        let beyond = self.beyond.map_or(0.0, |beyond| weighted(&OWN_MODEL_FIGURES, &beyond.values()));
        weighted(&MODEL_FIGURES, &self.values()) + COST_MODELS.len() as f64 * beyond
    }
}

/// All trials in the circumstances of `scenario`, on `model`, with `recovery` s for the recovery; `start` begins a
/// flight of the judged law in given circumstances. `None` if one of the flights ends early.
#[must_use]
pub fn fly_trials(
    scenario: &Scenario,
    start: impl Fn(&Scenario) -> Option<Flight>,
    model: &Model,
    recovery: f64,
) -> Option<TrialFigures> {
    let course = |scenario: &Scenario| Course::fly(scenario, start(scenario)?, ARRIVAL_DISTANCE_M).ok();
    let settled =
        |scenario: &Scenario| Course::until_settled(scenario, start(scenario)?, ARRIVAL_DISTANCE_M, SETTLED_FOR_S).ok();
    let real = really(scenario, model);
    let hovering = |position, duration| hover(&real, position, duration).ok();
    let windy = |speed: f64, duration: f64| {
        let mut windy = hovering(Vector3::zeros(), duration)?;
        let mass = f64::from(scenario.configuration.vehicle().mass);
        let unknown = Drag { linear: Vector3::repeat(DEFAULT_DRAG_PER_S * mass), ..Drag::default() };
        windy.reality.drag = scenario.reality.drag.or(Some(unknown));
        let gust = Gust { shape: Shape::Step, start: GUST_START_S, velocity: Vector3::new(speed, 0.0, 0.0) };
        windy.reality.wind = Some(Wind { gust: Some(gust), ..Wind::default() });
        course(&windy)
    };
    let stepped = |position| settled(&hovering(position, STEP_FLIGHT_S)?);
    let near = Vector3::new(-1.0, 0.0, 0.0);

    let recovered = settled(&turned_over(&hovering(Vector3::zeros(), recovery)?))?;
    let (gusty, step) = (windy(GUST_M_PER_S, GUST_FLIGHT_S)?, stepped(near)?);
    let mut noisy = hovering(Vector3::zeros(), NOISE_FLIGHT_S)?;
    noisy.reality.sensors = Some(noise(scenario.timing.period()));
    let noisy = course(&noisy)?;
    let mut clipped = recovered.clipped + gusty.clipped + step.clipped + noisy.clipped;

    let beyond = if *model == COST_MODELS[0] {
        let storm = windy(STORM_M_PER_S, STORM_FLIGHT_S)?;
        let far = stepped(Vector3::new(-6.0, -6.0, -5.3))?;
        let truth = Truth::model(scenario.configuration.vehicle());
        let other = |mut scenario: Scenario, mass: f64, thrust_scale: f64| {
            scenario.reality.truth = Some(Truth { mass: truth.mass * mass, thrust_scale, ..truth.clone() });
            settled(&scenario)
        };
        let weak = other(hovering(near, STEP_FLIGHT_S)?, 1.0, WEAK_THRUST_SCALE)?;
        let heavy = other(turned_over(&hovering(Vector3::zeros(), recovery)?), HEAVY_MASS_FACTOR, 1.0)?;
        clipped += [&storm, &far, &weak, &heavy].map(|course| course.clipped).iter().sum::<u64>();
        Some(HarderTrialFigures {
            storm: storm.excursion,
            far: far.settled.unwrap_or(STEP_FLIGHT_S),
            weak: weak.settled.unwrap_or(STEP_FLIGHT_S),
            heavy_lost: heavy.height_lost,
            heavy: heavy.settled.unwrap_or(recovery),
        })
    } else {
        None
    };

    Some(TrialFigures {
        height_lost: recovered.height_lost,
        recovered: recovered.settled.unwrap_or(recovery),
        turned: recovered.turned.unwrap_or(recovery),
        gust: gusty.excursion,
        offset: gusty.end_error,
        step: step.settled.unwrap_or(STEP_FLIGHT_S),
        activity: noisy.activity / hovering_thrust(scenario),
        noise: noisy.rms,
        beyond,
        clipped,
    })
}

/// Each rotor's thrust in hover, N; a vehicle without rotors counts as if it had four.
fn hovering_thrust(scenario: &Scenario) -> f64 {
    let vehicle = scenario.configuration.vehicle();
    let rotors = scenario.configuration.rotors().map_or(4, |rotors| rotors.len());
    f64::from(vehicle.mass * vehicle.gravity) / rotors as f64
}

/// The recovery that height is measured in: the attitude the paper starts from (roll -179 degrees, yaw 100 degrees off
/// the reference's heading), at rest, hovering where it starts, for `duration` s. Table I loses 23.3 m in it.
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
    if *model != COST_MODELS[0] {
        let own = Truth::model(vehicle);
        real.reality.truth = Some(Truth {
            mass: own.mass * model.mass,
            centre_of_mass: off_centre(scenario, model),
            thrust_scale: model.thrust,
            ..own
        });
        real.rotor_lag *= model.lag;
        real.delay_steps += (model.delay / scenario.timing.step()).round() as u64;
    }
    // As in `compare`.
    (real.reality.wind, real.reality.disturbance, real.reality.failure) = (None, None, None);
    // An estimated state costs every candidate alike.
    real.reality.estimator = None;
    real
}

/// Where the centre of mass of the scenario's vehicle really is, m, body.
fn off_centre(scenario: &Scenario, model: &Model) -> Vector3<f64> {
    let [x, y] = model.centre_of_mass;
    let off = Vector3::new(x, y, 0.0);
    let Some(rotors) = scenario.configuration.rotors() else { return off };
    let arm = rotors.iter().map(|rotor| f64::from(rotor.position.xy().norm())).fold(0.0, f64::max);
    off.cap_magnitude(CENTRE_OFFSET_MAX_SHARE * arm)
}

/// The measured state of the trial under noise.
#[must_use]
pub fn noise(period: f64) -> Sensors {
    let ticks = |time: f64| (time / period).round() as u64;
    let accelerometer = ACCELEROMETER_NOISE_M_PER_S2 * (POSE_PERIOD_S / period).sqrt();
    Sensors {
        gyro_noise: 0.01,
        gyro_bias: Vector3::zeros(),
        position_noise: 2e-3,
        attitude_noise: 0.2_f64.to_radians(),
        velocity: VelocitySource::Observer { bandwidth: 8.0, noise: accelerometer, bias: Vector3::zeros() },
        pose_every: ticks(POSE_PERIOD_S).max(1),
        dropout: 0.0,
        delay_ticks: 0,
        pose_delay_ticks: ticks(POSE_DELAY_S),
        imu_delay: IMU_DELAY_S,
        seed: 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_vehicle_is_as_far_off_centre_as_a_large_one_for_its_size() {
        let large = Scenario::parse(scenario::STUDY, "study.toml").unwrap();
        let small = scenario::STUDY
            .replace("0.120208", "0.0300520")
            .replace("[2.24e-3, 2.9e-3, 5.3e-3]", "[2e-4, 2.6e-4, 4e-4]");
        let small = Scenario::parse(&small, "small.toml").unwrap();
        let [of_large, of_small] = [&large, &small].map(|scenario| off_centre(scenario, &COST_MODELS[1]));
        assert_eq!(of_large, Vector3::new(0.004, 0.003, 0.0));
        assert!((of_small.norm() - 0.03 * 0.0425).abs() < 1e-5, "{of_small}");
        assert!(of_small.cross(&of_large).norm() < 1e-12);
    }
}
