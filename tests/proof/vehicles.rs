//! The vehicles of `vehicles/` under the paper's law, with their rotors turning: certified to the last rotor, and flown
//! without one that saturates. The boards' allocation clips no wrench that their certificates allow.
//! `cargo test -p host-sim vehicles -- --nocapture` prints what each flight showed.

use crate::support::extended::vehicle;
use crate::support::random;
use crate::support::random::ChaCha8Rng;
use controller_core::allocation::support::TICK_ROUNDING_SHARE;
use controller_core::allocation::{MinimumNorm, Mixer, Rotors};
use controller_core::certificate::Certificate;
use controller_core::certificate::form::ARITHMETIC_ALLOWANCE;
use controller_core::gains::{GainParameters, Gains};
use controller_core::state::Wrench;
use host_sim::flight::Flight;
use host_sim::flight::tasks::recovery;
use nalgebra::{Matrix3, Vector3};
use rand::RngExt;
use scenario::Scenario;
use scenario::body::attitude_from_euler;

const VEHICLES: [&str; 2] = ["hummingbird-paper-law", "study-paper-law"];

/// Of every inequality, but for the least thrusts of the Hummingbird's rotors: its gains were found for rotors that may
/// stand still, and its motors idle at 0.059 N.
const MARGIN_MIN: f64 = 0.05;
const IDLE_MARGIN_MIN: f64 = 0.003;

/// Greatest position error on the circle, m.
const CIRCLE_ERROR: f64 = 0.01;

/// Thrust (length of u, mass, share of a rotor, its speed, squared) and its direction (the measured attitude) carry
/// some sixteen roundings of single precision, half an EPSILON of gravity each, m/s^2.
const ROUNDED_ACCELERATION: f64 = 16.0 * 0.5 * f32::EPSILON as f64 * 9.81;

/// How long a recovery from upside down is watched: the slowest is back after a minute.
const RECOVERY_S: f64 = 120.0;

/// The greatest errors in one stretch of five seconds.
#[derive(Debug, Clone, Copy, Default)]
struct Errors {
    /// m.
    position: f64,
    /// Norm of the modified Rodrigues parameters.
    mrp: f64,
}

/// What a flight showed.
struct Shown {
    /// Stretch by stretch, the last one complete.
    errors: Vec<Errors>,
    height_lost: f64,
    saturated: u64,
    /// The greatest share of a rotor's certified demand, from the middle of its interval; beyond one is outside it.
    demand_used: f64,
}

impl Shown {
    /// The errors of the last five seconds and of the five before.
    fn end(&self) -> (Errors, Errors) {
        let [.., before, last] = self.errors[..] else { panic!("too short a flight") };
        (before, last)
    }
}

fn flown(scenario: &Scenario) -> Shown {
    let certificate = Certificate::new(&scenario.configuration).unwrap();
    let rotors = &certificate.paper().unwrap().rotors;
    assert_eq!(rotors.len(), 4, "{} has no rotors", scenario.name);
    let mut flight = Flight::new(scenario).unwrap();
    let stretch = (5e6 / scenario.timing.period_us as f64) as u64;
    let start = scenario.initial.position.z;
    let mut shown = Shown { errors: Vec::new(), height_lost: 0.0, saturated: 0, demand_used: 0.0 };
    let mut errors = Errors::default();
    // Stretches are counted from the end, so that the last one is complete.
    for left in (0..scenario.timing.ticks).rev() {
        let tick = flight.tick().unwrap();
        shown.saturated += u64::from(tick.clipped);
        shown.height_lost = shown.height_lost.max(start - tick.state.position.z);
        for (thrust, report) in tick.rotor_thrusts.iter().zip(rotors) {
            let middle = 0.5 * (report.demand.min + report.demand.max);
            let half = 0.5 * (report.demand.max - report.demand.min);
            shown.demand_used = shown.demand_used.max((f64::from(*thrust) - middle).abs() / half);
        }
        let error = (tick.state.position - tick.reference.position.cast::<f64>()).norm();
        errors.position = errors.position.max(error);
        errors.mrp = errors.mrp.max(f64::from(tick.diagnostics.mrp.norm()));
        if left.is_multiple_of(stretch) {
            shown.errors.push(std::mem::take(&mut errors));
        }
    }
    let (_, last) = shown.end();
    println!(
        "{:18} last 5 s: {:.1e} m, MRP {:.1e}; height lost {:6.1} m; {:4.1} % of the certified rotor demand used",
        scenario.name,
        last.position,
        last.mrp,
        shown.height_lost,
        100.0 * shown.demand_used
    );
    shown
}

/// How far a constant acceleration that the law does not know of takes the position, m per m/s^2, once z_1 and z_2 are
/// at rest: 1 / k_p + 1 / (k_f k_s) + (k_v / k_p) (1 / k_f + 1 / k_s).
fn compliance(scenario: &Scenario) -> f64 {
    let gains = scenario.configuration.gains().unwrap();
    let [k_p, k_v, k_f, k_s] = [gains.k_p, gains.k_v, gains.k_f, gains.k_s].map(f64::from);
    1.0 / k_p + 1.0 / (k_f * k_s) + k_v / k_p * (1.0 / k_f + 1.0 / k_s)
}

/// Every command of a flight fits every rotor, and keeps to what was certified.
fn assert_within_the_certificate(name: &str, shown: &Shown) {
    assert_eq!(shown.saturated, 0, "{name}: saturated ticks");
    assert!(shown.demand_used <= 1.0, "{name}: {} of the certified demand", shown.demand_used);
}

#[test]
fn both_are_certified_down_to_the_rotors_with_five_per_cent_to_spare() {
    for name in VEHICLES {
        let certificate = Certificate::new(&vehicle(name).configuration).unwrap();
        let tightest = certificate.tightest().unwrap();
        println!("{name}: tightest {tightest}, margin {:.2} %", 100.0 * tightest.margin());
        for inequality in certificate.inequalities() {
            let is_of_idle = name == "hummingbird-paper-law" && inequality.name.ends_with(" least");
            let margin = if is_of_idle { IDLE_MARGIN_MIN } else { MARGIN_MIN };
            assert!(inequality.holds() && inequality.margin() >= margin, "{name}: {inequality}");
        }
        assert_eq!(certificate.paper().unwrap().rotors.len(), 4);
    }
}

#[test]
fn they_are_the_vehicles_they_are_said_to_be() {
    for (name, mass, inertia, lag, delay) in [
        ("hummingbird-paper-law", 0.5, [3.65e-3, 3.68e-3, 7.03e-3], 0.005, 0.0),
        ("study-paper-law", 0.46, [2.24e-3, 2.9e-3, 5.3e-3], 0.030, 0.010),
    ] {
        let scenario = vehicle(name);
        let body = scenario.configuration.vehicle();
        assert_eq!((body.mass, [body.inertia.x, body.inertia.y, body.inertia.z]), (mass, inertia), "{name}");
        assert_eq!((scenario.rotor_lag, scenario.delay()), (lag, delay), "{name}");
        for rotor in scenario.configuration.rotors().unwrap().iter() {
            assert_eq!((rotor.thrust_coefficient, rotor.drag_coefficient), (5.57e-6, 1.36e-7), "{name}");
            assert!((rotor.position.norm() - 0.17).abs() < 1e-5, "{name}");
        }
    }
    let fastest = vehicle("hummingbird").configuration.rotors().unwrap()[0].thrust_max;
    assert!((fastest - 5.57e-6 * 1500.0 * 1500.0).abs() < 1e-4);
}

#[test]
fn they_are_the_vehicles_that_fly_the_extended_law() {
    for (name, other) in VEHICLES.into_iter().zip(["hummingbird", "study"]) {
        let (own, other) = (vehicle(name), vehicle(other));
        let (a, b) = (&own.configuration, &other.configuration);
        assert_eq!((a.vehicle(), a.rotors()), (b.vehicle(), b.rotors()), "{name}");
        assert_eq!((own.rotor_lag, own.delay_steps), (other.rotor_lag, other.delay_steps), "{name}");
        assert!(a.paper().is_some() && b.paper().is_none());
    }
}

#[test]
fn they_fly_a_circle_of_one_metre_without_a_saturated_rotor() {
    for name in VEHICLES {
        let scenario = vehicle(name);
        let shown = flown(&scenario);
        assert_within_the_certificate(name, &shown);
        let at = |t_us| scenario.trajectory.at(t_us).position;
        assert!((at(0) - at(2_000_000)).norm() > 1.999 && (at(0) - at(4_000_000)).norm() < 1e-3, "a circle in 4 s");
        let (_, last) = shown.end();
        assert!(last.position < CIRCLE_ERROR, "{name}: {last:?}");
    }
}

#[test]
fn they_recover_from_upside_down_and_then_hold_still() {
    for name in VEHICLES {
        let mut scenario = recovery(&vehicle(name), RECOVERY_S).unwrap();
        let attitudes = [[-179.0, 0.0, 100.0], [-179.0, 0.0, 0.0], [0.0, 178.0, 0.0], [-180.0, 0.0, 0.0]];
        for angles in attitudes.map(|angles| angles.map(f64::to_radians)) {
            let [roll, pitch, yaw] = angles;
            scenario.initial.attitude = attitude_from_euler(roll, pitch, yaw);
            let shown = flown(&scenario);
            assert_within_the_certificate(name, &shown);
            let (before, last) = shown.end();
            assert!(last.position < 1e-4 && last.mrp < 1e-5, "{name} {angles:?}: {last:?}");
            // Not growing, or no more than single precision explains.
            let rounding = ROUNDED_ACCELERATION * compliance(&scenario);
            assert!(rounding < 1e-4, "{rounding}");
            assert!(last.position <= before.position.max(rounding), "{name} {angles:?}: {before:?} {last:?}");
            assert!(last.mrp <= before.mrp.max(1e-6), "{name} {angles:?}: {before:?} {last:?}");
        }
    }
}

#[test]
fn with_ten_times_table_ones_attitude_feedback_the_same_rotors_saturate() {
    let table_1 = **Scenario::paper().unwrap().configuration.gains().unwrap();
    for name in VEHICLES {
        let mut scenario = recovery(&vehicle(name), 10.0).unwrap();
        let gains = GainParameters { m_theta: 10.0 * table_1.m_theta, ..table_1 };
        let gains = Gains::new(gains, scenario.configuration.vehicle()).unwrap();
        scenario.configuration = scenario.configuration.with_gains(gains).unwrap();
        assert!(!Certificate::new(&scenario.configuration).unwrap().holds());
        assert!(flown(&scenario).saturated > 0, "{name}");
    }
}

/// The direction of omega in which row . (omega x J omega) is greatest: an eigenvector of that form.
fn most_gyroscopic(inertia: &Vector3<f64>, row: &Vector3<f64>) -> Vector3<f64> {
    let differences = Vector3::new(inertia.z - inertia.y, inertia.x - inertia.z, inertia.y - inertia.x);
    let form = differences.component_mul(row);
    let eigen = Matrix3::new(0.0, form.z, form.y, form.z, 0.0, form.x, form.y, form.x, 0.0).symmetric_eigen();
    eigen.eigenvectors.column(eigen.eigenvalues.imax()).into()
}

/// A wrench of `used` times what the certificate allows, where a rotor's thrust is nearly at an end of its range.
fn allowed(scenario: &Scenario, certificate: &Certificate, used: f64, rng: &mut ChaCha8Rng) -> Wrench {
    let form = &certificate.paper().unwrap().sharp;
    let inertia = scenario.configuration.vehicle().inertia.cast::<f64>();
    let rows = scenario.configuration.rotors().unwrap().pseudo_inverse();
    let up = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
    let row = rows[rng.random_range(0..rows.len())].fixed_rows::<3>(1) * up;
    let raised = used * (1.0 + ARITHMETIC_ALLOWANCE);
    // Along the row, more or less, which is where the ball's support function is taken.
    let spread = random::log_uniform(rng, 1e-6, 1.0);
    let mut ball = |radius: f64, row: Vector3<f64>| {
        let direction = row.normalize() + random::vector(rng, spread).cast();
        direction.normalize() * radius
    };
    let feedback = ball(form.feedback_torque * raised, row);
    let acceleration = ball(form.rates.angular_acceleration * raised, inertia.component_mul(&row));
    let velocity = ball(form.rates.angular_velocity * raised, most_gyroscopic(&inertia, &row));
    let torque = feedback + inertia.component_mul(&acceleration) + velocity.cross(&inertia.component_mul(&velocity));
    let middle = 0.5 * (form.thrust.min + form.thrust.max);
    let thrust = middle + used * 0.5 * up * (form.thrust.max - form.thrust.min);
    Wrench { thrust: thrust as f32, torque: torque.cast() }
}

/// The mixer gives up no part of a certified wrench.
#[test]
fn every_allowed_wrench_is_within_the_rotors_and_what_flies_agrees_with_the_mixer_to_the_bit() {
    let mut rng = random::generator(52);
    for name in VEHICLES {
        let scenario = vehicle(name);
        let certificate = Certificate::new(&scenario.configuration).unwrap();
        let rotors = scenario.configuration.rotors().unwrap();
        let (flown, mixer) = (MinimumNorm::new(rotors), Mixer::new(rotors));
        for _ in 0..100_000 {
            let wrench = allowed(&scenario, &certificate, 1.0, &mut rng);
            let (ours, mixed) = (flown.allocate(&wrench).unwrap(), mixer.allocate(&wrench).unwrap());
            assert!(!ours.clipped && mixed.is_exact(), "{name}: {wrench:?} {ours:?}");
            let same = ours.thrusts.iter().zip(&mixed.thrusts).all(|(a, b)| a.to_bits() == b.to_bits());
            assert!(same, "{name}: {wrench:?} {ours:?} {mixed:?}");
        }
        // A tenth more than the tightest rotor has to spare is too much: the search does come to the ends.
        let beyond = 1.1 / (1.0 - certificate.tightest().unwrap().margin());
        let clips = |_| flown.allocate(&allowed(&scenario, &certificate, beyond, &mut rng)).unwrap().clipped;
        assert!((0..100_000).any(clips), "{name}");
    }
}

/// Rotors with exactly the range that is asked of them, in single precision: what is clipped is rounding, if anything
/// is.
#[test]
fn without_any_margin_clipping_takes_no_more_than_rounding() {
    let mut rng = random::generator(53);
    for name in VEHICLES {
        let scenario = vehicle(name);
        let certificate = Certificate::new(&scenario.configuration).unwrap();
        let mut rotors = scenario.configuration.rotors().unwrap().to_vec();
        for (rotor, report) in rotors.iter_mut().zip(&certificate.paper().unwrap().rotors) {
            (rotor.thrust_min, rotor.thrust_max) = (report.demand.min as f32, report.demand.max as f32);
        }
        let flown = MinimumNorm::new(&Rotors::new(&rotors).unwrap());
        for _ in 0..100_000 {
            let wrench = allowed(&scenario, &certificate, 1.0, &mut rng);
            let achieved = flown.wrench(&flown.allocate(&wrench).unwrap().thrusts);
            let thrust = f64::from((achieved.thrust - wrench.thrust).abs());
            let torque = f64::from((achieved.torque - wrench.torque).norm());
            let rounding = TICK_ROUNDING_SHARE * certificate.thrust().max;
            assert!(thrust < rounding && torque < rounding, "{name}: {wrench:?} {achieved:?}");
        }
    }
}
