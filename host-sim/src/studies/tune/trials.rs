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
//! The cost is their weighted sum, [`TrialFigures::cost`], averaged over the models of `COST_MODELS`: the vehicle as
//! the file says, and as it may really be. The last four go beyond a law's promise; they are flown on the file's own
//! model only.

use super::figures::{HarderTrialFigures, TrialFigures};
use super::models::{COST_MODELS, Model};
use crate::flight::Flight;
use crate::flight::course::Course;
use crate::flight::tasks::{hover, in_wind, of_mass_and_thrust, turned_over};
use nalgebra::Vector3;
use scenario::Scenario;
use scenario::reality::sensors::{Sensors, VelocitySource};
use scenario::reality::truth::Truth;

const ARRIVAL_DISTANCE_M: f64 = 0.1;
const GUST_M_PER_S: f64 = 5.0;
const STORM_M_PER_S: f64 = 12.0;
/// The greatest duration of each trial.
const GUST_FLIGHT_S: f64 = 6.0;
const STORM_FLIGHT_S: f64 = 8.0;
const STEP_FLIGHT_S: f64 = 12.0;
const NOISE_FLIGHT_S: f64 = 4.0;
/// Where the steps to the origin begin.
const NEAR_STEP_M: Vector3<f64> = Vector3::new(-1.0, 0.0, 0.0);
const FAR_STEP_M: Vector3<f64> = Vector3::new(-6.0, -6.0, -5.3);
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

/// All trials in the circumstances of `scenario`, on `model`, with `recovery` s for the recovery; `start` begins a
/// flight of the judged law in given circumstances. `None` if one of the flights ends early.
pub fn fly_trials(
    scenario: &Scenario,
    start: impl Fn(&Scenario) -> Option<Flight>,
    model: &Model,
    recovery: f64,
) -> Option<TrialFigures> {
    let trials = Trials { real: really(scenario, model), start, recovery };
    let recovered = trials.settled(&turned_over(&trials.hovering(Vector3::zeros(), recovery)?))?;
    let gusty = trials.windy(GUST_M_PER_S, GUST_FLIGHT_S)?;
    let step = trials.stepped(NEAR_STEP_M)?;
    let mut noisy = trials.hovering(Vector3::zeros(), NOISE_FLIGHT_S)?;
    noisy.reality.sensors = Some(noise(scenario.timing.period()));
    let noisy = trials.course(&noisy)?;
    let (beyond, clipped) = if *model == COST_MODELS[0] { trials.harder()? } else { (None, 0) };
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
        clipped: clipped + recovered.clipped + gusty.clipped + step.clipped + noisy.clipped,
    })
}

/// The vehicle and the law of all trials.
struct Trials<Start> {
    /// The vehicle as it really is.
    real: Scenario,
    start: Start,
    /// s.
    recovery: f64,
}

impl<Start: Fn(&Scenario) -> Option<Flight>> Trials<Start> {
    fn course(&self, scenario: &Scenario) -> Option<Course> {
        Course::fly(scenario, (self.start)(scenario)?, ARRIVAL_DISTANCE_M).ok()
    }

    fn settled(&self, scenario: &Scenario) -> Option<Course> {
        Course::until_settled(scenario, (self.start)(scenario)?, ARRIVAL_DISTANCE_M, SETTLED_FOR_S).ok()
    }

    fn hovering(&self, position: Vector3<f64>, duration: f64) -> Option<Scenario> {
        hover(&self.real, position, duration).ok()
    }

    /// Hovering in wind that sets in.
    fn windy(&self, speed: f64, duration: f64) -> Option<Course> {
        self.course(&in_wind(&self.hovering(Vector3::zeros(), duration)?, speed))
    }

    /// From `position` to the origin.
    fn stepped(&self, position: Vector3<f64>) -> Option<Course> {
        self.settled(&self.hovering(position, STEP_FLIGHT_S)?)
    }

    /// The figures beyond a law's promise, and how many of their commands a limit cut.
    fn harder(&self) -> Option<(Option<HarderTrialFigures>, u64)> {
        let storm = self.windy(STORM_M_PER_S, STORM_FLIGHT_S)?;
        let far = self.stepped(FAR_STEP_M)?;
        let weak = of_mass_and_thrust(&self.hovering(NEAR_STEP_M, STEP_FLIGHT_S)?, 1.0, WEAK_THRUST_SCALE);
        let turned = turned_over(&self.hovering(Vector3::zeros(), self.recovery)?);
        let weak = self.settled(&weak)?;
        let heavy = self.settled(&of_mass_and_thrust(&turned, HEAVY_MASS_FACTOR, 1.0))?;
        let figures = HarderTrialFigures {
            storm: storm.excursion,
            far: far.settled.unwrap_or(STEP_FLIGHT_S),
            weak: weak.settled.unwrap_or(STEP_FLIGHT_S),
            heavy_lost: heavy.height_lost,
            heavy: heavy.settled.unwrap_or(self.recovery),
        };
        Some((Some(figures), [&storm, &far, &weak, &heavy].map(|course| course.clipped).iter().sum()))
    }
}

/// Each rotor's thrust in hover, N; a vehicle without rotors counts as if it had four.
fn hovering_thrust(scenario: &Scenario) -> f64 {
    let vehicle = scenario.configuration.vehicle();
    let rotors = scenario.configuration.rotors().map_or(4, |rotors| rotors.len());
    f64::from(vehicle.mass * vehicle.gravity) / rotors as f64
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
