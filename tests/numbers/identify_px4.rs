//! Identification from a log of PX4: a simulated flight, written in PX4's topics, frames, motor order and rates.

use controller_core::allocation::{Mixer, Rotors};
use host_sim::identification::identify::flight_log::{FlightLog, Source};
use host_sim::identification::identify::{identify, observability, ulog};
use host_sim::identification::ulog::writer::{Topic, Writer};
use nalgebra::Vector3;
use scenario::Scenario;
use verification::identify_trials::{Drag, Trial};

const HUMMINGBIRD: &str = include_str!("../../vehicles/hummingbird.toml");

const TOPICS_WRITTEN: [Topic; 5] = [
    Topic { name: "actuator_motors", fields: "uint64_t timestamp;float[12] control;" },
    Topic { name: "sensor_combined", fields: "uint64_t timestamp;float[3] gyro_rad;uint32_t gyro_integral_dt;" },
    Topic { name: "vehicle_attitude", fields: "uint64_t timestamp;float[4] q;" },
    Topic { name: "vehicle_local_position", fields: "uint64_t timestamp;float vx;float vy;float vz;" },
    Topic { name: "trajectory_setpoint", fields: "uint64_t timestamp;float[3] position;float[3] velocity;" },
];

/// Which rotor of the Hummingbird's file each of PX4's motors is: front right, rear left, front left, rear right.
const ROTOR_ORDER: [usize; 4] = [1, 3, 0, 2];

/// How it is logged.
#[derive(Clone, Copy)]
struct Logged {
    /// With CA_ROTOR… parameters, and then with this rotor's sense of rotation the other way.
    geometry: Option<Option<usize>>,
    /// One of so many ticks has motors in the log.
    motors_every: usize,
    /// The second in which records are lost.
    lost: Option<usize>,
}

const WHOLE_LOG: Logged = Logged { geometry: None, motors_every: 1, lost: None };

fn floats(numbers: &[f64]) -> Vec<u8> {
    numbers.iter().flat_map(|number| (*number as f32).to_le_bytes()).collect()
}

/// North, east, down; forward, right, down.
fn turned(vector: &Vector3<f64>) -> [f64; 3] {
    [vector.x, -vector.y, -vector.z]
}

/// A flight as PX4 logs it.
fn written(log: &FlightLog, rotors: &Rotors, how: Logged) -> Vec<u8> {
    let mut parameters = vec![];
    for (motor, rotor) in ROTOR_ORDER.iter().enumerate().filter(|_| how.geometry.is_some()) {
        let [x, y] = [rotors[*rotor].position.x, rotors[*rotor].position.y].map(f64::from);
        let km = -0.05 * f64::from(rotors[*rotor].spin.sign());
        let km = if how.geometry == Some(Some(motor)) { -km } else { km };
        parameters.extend([
            (format!("CA_ROTOR{motor}_PX"), x),
            (format!("CA_ROTOR{motor}_PY"), -y),
            (format!("CA_ROTOR{motor}_KM"), km),
        ]);
    }
    let parameters: Vec<(&str, f64)> = parameters.iter().map(|(name, value)| (name.as_str(), *value)).collect();
    let mut writer = Writer::new(0, &TOPICS_WRITTEN, &[], &parameters);
    let mixer = Mixer::new(rotors);
    for (tick, moment) in log.moments.iter().enumerate() {
        // On a clock that began long before.
        let time = 50_000_123 + (1e6 * moment.time).round() as u64;
        if how.lost == Some(tick / 100) {
            continue;
        }
        if tick % how.motors_every == 0 {
            let thrusts = mixer.allocate(&moment.commanded).unwrap().thrusts;
            let level = |rotor: &usize| f64::from(thrusts[*rotor] / rotors[*rotor].thrust_max).sqrt();
            let mut levels: Vec<f64> = ROTOR_ORDER.iter().map(level).collect();
            levels.resize(12, f64::NAN);
            writer.record(0, time, &floats(&levels));
        }
        let still = 0_u32.to_le_bytes();
        writer.record(1, time, &[floats(&turned(&moment.angular_velocity)), still.to_vec()].concat());
        let q = moment.attitude.into_inner();
        // Either sign is the same attitude.
        let sign = if tick % 3 == 0 { -1.0 } else { 1.0 };
        writer.record(2, time, &floats(&[q.w, q.i, -q.j, -q.k].map(|number| sign * number)));
        if tick % 10 == 0 {
            writer.record(3, time, &floats(&turned(&moment.velocity)));
            writer.record(4, time, &floats(&[&[f64::NAN; 3][..], &turned(&moment.reference_velocity)].concat()));
        }
    }
    writer.finish()
}

#[test]
fn a_vehicle_is_found_in_px4s_log_as_in_our_own() {
    let scenario = Scenario::parse(HUMMINGBIRD, "f").unwrap();
    let rotors = scenario.configuration.rotors().unwrap();
    let trial = Trial::flown(HUMMINGBIRD, 3, Drag::Whole, None).unwrap();
    let flown = FlightLog::from_csv(&trial.log).unwrap();
    let read = |how: Logged| ulog::read(&written(&flown, rotors, how), rotors, None);
    let log = read(WHOLE_LOG).unwrap();
    assert_eq!((log.source, observability::unexcited(&log)), (Source::Px4, vec![]));
    let identified = identify(&log, &scenario, &trial.bench).unwrap();
    assert_eq!(observability::unobservable(&identified), Vec::<String>::new());
    for (name, quantity, truth) in trial.truths(&identified) {
        match name {
            // The low-passes of the rates that were written count as delay and lag here: 5.7 ms, and 1 ms that trials
            // count off.
            "lag" | "delay" => {}
            "lag and delay" => assert!((0.005..0.008).contains(&(quantity.value - truth)), "{quantity:?}, {truth}"),
            _ => assert!(quantity.holds(truth), "{name}: {quantity:?}, truly {truth}"),
        }
    }
    // Parameters that say the same of the motors change nothing, and others are refused by name.
    assert_eq!(read(Logged { geometry: Some(None), ..WHOLE_LOG }).unwrap().moments[100], log.moments[100]);
    let refused = read(Logged { geometry: Some(Some(2)), ..WHOLE_LOG }).unwrap_err();
    assert!(refused.starts_with("CA_ROTOR2_PX, _PY, _KM: no rotor of the scenario stands there"), "{refused}");
    // Default logging has motors ten times a second.
    let slow = read(Logged { motors_every: 10, ..WHOLE_LOG }).unwrap_err();
    assert!(slow.starts_with("actuator_motors: a record every 0.100 s") && slow.contains("SDLOG_PROFILE"), "{slow}");
    // The longer part without a gap is kept.
    let cut = read(Logged { lost: Some(30), ..WHOLE_LOG }).unwrap();
    assert!((cut.seconds() - 49.0).abs() < 0.3, "{}", cut.seconds());
}
