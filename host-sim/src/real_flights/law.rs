//! Our law beside the one that flew.
//!
//! *Beside*: on each recorded state and setpoint, what our law would have commanded there, and what was.
//!
//! *Instead*: our law flies the vehicle that the flight showed, on a path near its setpoints
//! ([`super::setpoint_path`]). What the model does not explain acts as it did that day:
//!
//! ```text
//! force    m (R f_acc - model)         at each sample
//! torque   J omega' - model            its mean over half a second: faster, the commands in the log hide it
//! state    true, plus what our estimator was off that day
//! ```
//!
//! Both flights are held against the same setpoints, smoothed over 0.8 s. The simulated vehicle is as the model says in
//! between, so this is a prediction, and no flight.

use super::estimation::Estimated;
use super::flown::{Flown, PERIOD_S, Sample};
use super::forces::{Forces, lagged};
use super::setpoint_path::SetpointPath;
use super::torques::torque;
use crate::identification::identify::output::{Values, rewritten};
use crate::vehicle::actuators::ActuatorDemand;
use crate::vehicle::reality::RealVehicle;
use controller_core::extended::measured::Measured;
use controller_core::law::Law;
use controller_core::state::State;
use nalgebra::{UnitQuaternion, Vector3};
use scenario::Scenario;
use scenario::body::BodyState;

/// Samples to either side of a mean torque.
const TORQUE_SAMPLES: usize = 25;

/// The distance from the setpoints.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tracking {
    /// RMS, m.
    pub rms: f64,
    /// The greatest, m.
    pub greatest: f64,
    /// By how much the setpoints' time must be shifted that the distance is least, s.
    pub late: f64,
    /// What is left then, RMS, m.
    pub rms_late: f64,
}

/// What came of both.
#[derive(Debug, Clone, PartialEq)]
pub struct LawBeside {
    /// Of the verdict on the vehicle found.
    pub certified: bool,
    /// Where the vehicle was.
    pub flown: Tracking,
    /// Of the path near the setpoints.
    pub reference: Tracking,
    /// Where our law would have had it.
    pub ours: Tracking,
    /// Thrust over weight, mean: flown and ours on the recorded states; and RMS of their difference.
    pub thrust: [f64; 3],
    /// How far apart both point thrust: RMS of the angle between our wanted and the flown direction, degrees.
    pub degrees: f64,
    /// Ticks at which a rotor's command was cut, of all.
    pub clipped: usize,
    /// See there.
    pub ticks: usize,
    /// Positions, for a picture: setpoint, flown, ours.
    pub track: Vec<[Vector3<f64>; 3]>,
}

/// The scenario's text with the numbers that a flight showed.
///
/// # Errors
/// If the scenario's text cannot be rewritten.
pub fn rewritten_by(original: &str, scenario: &Scenario, forces: &Forces) -> Result<String, String> {
    let vehicle = scenario.configuration.vehicle();
    let mass = f64::from(vehicle.mass);
    let [up, down] = forces.lag_values();
    let lag = if forces.lags.is_some() { (up + down) / 2.0 } else { scenario.rotor_lag };
    let values = Values {
        mass,
        inertia: vehicle.inertia.map(f64::from).into(),
        thrust_scale: forces.strength.value * mass,
        lag,
        delay: scenario.delay(),
        centre_of_mass: [0.0; 2],
        drag: forces.drag.map(|drag| drag.value.max(0.0) * mass),
    };
    rewritten(original, &scenario.name, &values, scenario.timing.step())
}

/// Flies it.
///
/// # Errors
/// If there is no path near the setpoints, or the vehicle found cannot be flown.
pub fn beside(
    flown: &Flown,
    forces: &Forces,
    path: &SetpointPath,
    estimated: Option<&Estimated>,
) -> Result<LawBeside, String> {
    let found = &path.scenario;
    let period = found.timing.period();
    if (period - PERIOD_S).abs() > 1e-9 {
        return Err(format!("control.rate: must be {} Hz, as the samples are", 1.0 / PERIOD_S));
    }
    let certified = path.verdict.certified();
    let law = || match certified {
        Some(certified) => Law::new(certified, period as f32),
        None => Law::uncertified(&found.configuration, period as f32),
    };
    let law = || law().map_err(|error| error.to_string());
    let samples = flown.samples.get(path.samples.clone()).ok_or("is empty")?;
    let acting = lagged(&flown.samples, forces.lag_values());
    let day = Day {
        samples,
        acting: acting.get(path.samples.clone()).ok_or("is empty")?,
        errors: estimated.and_then(|estimated| estimated.errors.get(path.samples.clone())),
    };
    let (thrust, degrees) = beside_it(&day, forces, path, law()?);
    let (ours, clipped) = instead(&day, forces, path, law()?)?;
    let was: Vec<Vector3<f64>> = samples.iter().map(|sample| sample.position).collect();
    let asked: Vec<Vector3<f64>> =
        (0..samples.len()).map(|sample| path.reference(sample + path.lead_in).position.map(f64::from)).collect();
    Ok(LawBeside {
        certified: path.verdict.refusal().is_none(),
        flown: tracking(&path.smoothed, &was),
        reference: tracking(&path.smoothed, &asked),
        ours: tracking(&path.smoothed, &ours),
        thrust,
        degrees,
        clipped,
        ticks: ours.len() + path.lead_in,
        track: path.smoothed.iter().zip(&was).zip(&ours).map(|((wanted, was), ours)| [*wanted, *was, *ours]).collect(),
    })
}

/// What there was on that day, sample by sample: with thrusts behind their lag, N, and what our estimator was off.
struct Day<'a> {
    samples: &'a [Sample],
    acting: &'a [Vec<f64>],
    errors: Option<&'a [Option<[Vector3<f64>; 4]>]>,
}

/// What the law commands on the recorded states: thrusts over weight, and degrees, as [`LawBeside`] has them.
fn beside_it(day: &Day, forces: &Forces, path: &SetpointPath, mut law: Law) -> ([f64; 3], f64) {
    let vehicle = path.scenario.configuration.vehicle();
    let (mass, gravity) = (f64::from(vehicle.mass), f64::from(vehicle.gravity));
    let mut sums = [0.0; 4];
    let mut count = 0.0;
    for (number, (sample, thrusts)) in day.samples.iter().zip(day.acting).enumerate() {
        let state = BodyState {
            position: sample.position,
            velocity: sample.velocity,
            attitude: sample.attitude.into_inner(),
            angular_velocity: sample.rates,
        };
        let Ok((wrench, diagnostics)) = law.step(&state.measured(), &path.reference(number + path.lead_in)) else {
            continue;
        };
        let was = forces.strength.value * thrusts.iter().sum::<f64>() / gravity;
        let ours = f64::from(wrench.thrust) / (mass * gravity);
        let wanted = UnitQuaternion::new_normalize(diagnostics.desired_attitude.cast::<f64>());
        let angle = (wanted * Vector3::z()).angle(&(sample.attitude * Vector3::z()));
        for (sum, number) in sums.iter_mut().zip([was, ours, (was - ours).powi(2), angle.powi(2)]) {
            *sum += number;
        }
        count += 1.0;
    }
    let [was, ours, apart, angle] = sums.map(|sum| sum / f64::max(count, 1.0));
    ([was, ours, apart.sqrt()], angle.sqrt().to_degrees())
}

/// Where our law would have been at each sample, and how often a command was cut.
fn instead(
    day: &Day,
    forces: &Forces,
    path: &SetpointPath,
    mut law: Law,
) -> Result<(Vec<Vector3<f64>>, usize), String> {
    let found = &path.scenario;
    let (vehicle, rotors) = (found.configuration.vehicle(), found.configuration.rotors().ok_or("rotors: is missing")?);
    let (mass, inertia) = (f64::from(vehicle.mass), vehicle.inertia.map(f64::from));
    let torques = unexplained_torques(day, |thrusts| torque(thrusts, rotors) * forces.strength.value * mass, &inertia);
    let mut real = RealVehicle::new(found, &found.configuration);
    let (mut places, mut clipped) = (Vec::with_capacity(day.samples.len()), 0);
    let mut before = real.state().velocity;
    for tick in 0..day.samples.len() + path.lead_in {
        // On the way to the first setpoint it is as it was there.
        let number = tick.saturating_sub(path.lead_in);
        let state = *real.state();
        if tick >= path.lead_in {
            places.push(state.position);
        }
        let force = unexplained_force(&day.samples[number], &day.acting[number], forces);
        real.push(force * mass, torques[number]);
        let off = day.errors.and_then(|errors| errors.get(number).copied().flatten()).unwrap_or_default();
        let acceleration = ((state.velocity - before) / PERIOD_S).map(|number| number as f32);
        before = state.velocity;
        law.measured(&Measured { acceleration: (tick > 0).then_some(acceleration), wrench: None, lost: None });
        let (wrench, _) = law.step(&known(&state, &off), &path.reference(tick)).map_err(|error| error.to_string())?;
        let demand = match law.commands() {
            Some(thrusts) => ActuatorDemand::Thrusts(thrusts.clone()),
            None => ActuatorDemand::Wrench(wrench.scaled(1.0 / law.thrust_scale())),
        };
        let held = real.hold(&demand, found.timing.steps_per_tick);
        let time = tick as f64 * PERIOD_S;
        let (cut, _) = held.map_err(|error| format!("our law's flight ends after {time:.2} s: {error}"))?;
        if cut {
            clipped += 1;
            law.hold_estimates();
        }
    }
    Ok((places, clipped))
}

/// What the model does not explain of the acceleration, m/s^2, world.
fn unexplained_force(sample: &Sample, thrusts: &[f64], forces: &Forces) -> Vector3<f64> {
    let velocity = sample.attitude.inverse_transform_vector(&sample.velocity);
    let drag = Vector3::from_fn(|axis, _| forces.drag[axis].value.max(0.0) * velocity[axis]);
    let model = Vector3::z() * (forces.strength.value * thrusts.iter().sum::<f64>()) - drag;
    sample.force.map_or_else(Vector3::zeros, |force| sample.attitude * (force / forces.accelerometer_scale - model))
}

/// The state as an estimator knows it that is so far off.
fn known(state: &BodyState, [position, velocity, turn, rates]: &[Vector3<f64>; 4]) -> State {
    let attitude = UnitQuaternion::new_normalize(state.attitude) * UnitQuaternion::from_scaled_axis(*turn);
    let known = BodyState {
        position: state.position + position,
        velocity: state.velocity + velocity,
        attitude: attitude.into_inner(),
        angular_velocity: state.angular_velocity + rates,
    };
    known.measured()
}

/// J omega' + omega x J omega - tau, N m, its mean about each sample.
fn unexplained_torques(
    day: &Day,
    torque: impl Fn(&[f64]) -> Vector3<f64>,
    inertia: &Vector3<f64>,
) -> Vec<Vector3<f64>> {
    let samples = day.samples;
    let torques: Vec<Vector3<f64>> = day.acting.iter().map(|thrusts| torque(thrusts)).collect();
    let mean = |index: usize| {
        let (begin, end) = (index.saturating_sub(TORQUE_SAMPLES), (index + TORQUE_SAMPLES).min(samples.len() - 1));
        let gained = (samples[end].rates - samples[begin].rates) / ((end - begin) as f64 * PERIOD_S);
        let rates = samples[index].rates;
        let acted = torques[begin..end].iter().sum::<Vector3<f64>>() / (end - begin) as f64;
        inertia.component_mul(&gained) + rates.cross(&inertia.component_mul(&rates)) - acted
    };
    (0..samples.len()).map(mean).collect()
}

/// How far `places` are from `setpoints`.
fn tracking(setpoints: &[Vector3<f64>], places: &[Vector3<f64>]) -> Tracking {
    let rms = |late: usize| {
        let squares =
            places.iter().skip(late).zip(setpoints).map(|(place, setpoint)| (place - setpoint).norm_squared());
        (squares.sum::<f64>() / (places.len() - late) as f64).sqrt()
    };
    let most = ((2.0 / PERIOD_S) as usize).min(places.len().saturating_sub(1));
    let late = (0..=most).min_by(|a, b| rms(*a).total_cmp(&rms(*b))).unwrap_or(0);
    let greatest = places.iter().zip(setpoints).map(|(place, setpoint)| (place - setpoint).norm()).fold(0.0, f64::max);
    Tracking { rms: rms(0), greatest, late: late as f64 * PERIOD_S, rms_late: rms(late) }
}
