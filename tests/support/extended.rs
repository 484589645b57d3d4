//! What the suites about the extended law share: the configurations it is tried on.

pub mod oracle;
pub mod rounding;

use crate::support::random::{self, ChaCha8Rng};
use controller_core::allocation::geometry::{Rotor, Spin};
use controller_core::allocation::{QuadX, Rotors};
use controller_core::certificate::Certificate;
use controller_core::certificate::extended::ExtendedBounds;
use controller_core::configuration::{Configuration, ExtendedLaw, LawParameters};
use controller_core::extended::actuators::ActuatorParameters;
use controller_core::extended::defaults::{self, Airframe, NOTHING_GIVEN};
use controller_core::extended::parameters::{Extended, ExtendedParameters};
use controller_core::vehicle::{LimitParameters, Limits, Vehicle, VehicleParameters};
use nalgebra::Vector3;
use rand::RngExt;
use scenario::Scenario;
use std::path::Path;

/// A vehicle of `vehicles/`, by its file's name.
pub fn vehicle(name: &str) -> Scenario {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../vehicles");
    Scenario::load(&folder.join(format!("{name}.toml"))).unwrap()
}

/// The vehicles of `vehicles/published/`, in the order of their names.
pub fn published() -> Vec<Scenario> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../vehicles/published");
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files.iter().map(|file| Scenario::load(file).unwrap()).collect()
}

/// The paper's vehicle and flight under the extended law, without rotors.
pub fn paper_vehicle() -> Scenario {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios");
    Scenario::load(&folder.join("paper-extended.toml")).unwrap()
}

/// Constants within a factor of four of `formulas` wherever the law allows, with any hysteresis that leaves the side to
/// the region beyond a quarter turn.
pub fn random_parameters(rng: &mut ChaCha8Rng, formulas: &ExtendedParameters, vehicle: &Vehicle) -> Extended {
    let mut values = formulas.values();
    for (value, constant) in values.iter_mut().zip(&ExtendedParameters::TABLE) {
        let around = *value * random::log_uniform(rng, 0.25, 4.0);
        *value = around.clamp(constant.range.min, constant.range.max);
    }
    let p = ExtendedParameters::from_values(values);
    let a_down = p.a_down.min(0.9 * vehicle.gravity);
    let p = ExtendedParameters {
        delta: random::log_uniform(rng, 0.005, 0.4),
        alpha: formulas.alpha,
        a_down,
        c_1: p.c_1.min(8.0 * p.c_2),
        force_up: p.force_up.min(0.9 * a_down),
        force_across: p.force_across.min(0.9 * p.a_across),
        drag_across: if rng.random_bool(0.3) { 0.0 } else { random::log_uniform(rng, 0.1, 1.0) },
        scale_least: rng.random_range(0.7..1.0),
        scale_greatest: rng.random_range(1.0..1.4),
        ..p
    };
    Extended::new(p, vehicle).unwrap()
}

/// A body of about half a kilogram.
pub fn random_vehicle(rng: &mut ChaCha8Rng) -> Vehicle {
    let mut around = |value: f32| value * random::log_uniform(rng, 0.5, 2.0);
    // Sums of two of three positive numbers satisfy the triangle inequality of a rigid body.
    let [mass, a, b, c] = [around(0.5), around(3.5e-3), around(3.5e-3), around(1e-3)];
    Vehicle::new(VehicleParameters { mass, inertia: Vector3::new(b + c, c + a, a + b), gravity: 9.81 }).unwrap()
}

/// A vehicle near the Hummingbird with its rotors idling anywhere, lagging and late or not at all, within any limits,
/// and the constants that follow from its numbers, if they do: rotors may idle too fast for it.
pub fn random_configuration(rng: &mut ChaCha8Rng) -> Configuration {
    loop {
        if let Some(configuration) = configured(rng) {
            return configuration;
        }
    }
}

fn configured(rng: &mut ChaCha8Rng) -> Option<Configuration> {
    let [arm, slowest] = [random::log_uniform(rng, 0.08, 0.3), rng.random_range(0.0..300.0)];
    let quad =
        QuadX { arm, thrust_coefficient: 5.57e-6, drag_coefficient: 1.36e-7, speed_min: slowest, speed_max: 1500.0 };
    with_rotors(Rotors::quad_x(quad).unwrap(), rng)
}

/// The same with four to eight rotors that differ from each other, about a centre of mass that is not their middle, if
/// the law has constants for them.
pub fn uneven(rng: &mut ChaCha8Rng) -> Option<Configuration> {
    let number = rng.random_range(4..=8);
    let rotors: Vec<Rotor> = (0..number)
        .map(|place| {
            let mut around = |value: f32, by: f32| value * random::log_uniform(rng, 1.0 / by, by);
            let angle = (place as f32 + 0.5) / number as f32 * std::f32::consts::TAU * around(1.0, 1.05);
            let [arm, coefficient, greatest] = [around(0.17, 1.3), around(5.57e-6, 1.2), around(12.0, 1.4)];
            Rotor {
                position: Vector3::new(angle.cos(), angle.sin(), 0.0) * arm,
                spin: if place % 2 == 0 { Spin::Clockwise } else { Spin::CounterClockwise },
                thrust_coefficient: coefficient,
                drag_coefficient: around(1.36e-7, 2.0),
                thrust_min: around(0.03, 2.0),
                thrust_max: greatest,
            }
        })
        .collect();
    with_rotors(Rotors::new(&rotors).ok()?, rng)
}

fn with_rotors(rotors: Rotors, rng: &mut ChaCha8Rng) -> Option<Configuration> {
    let vehicle = random_vehicle(rng);
    let thrust_max = vehicle.mass * vehicle.gravity * random::log_uniform(rng, 1.5, 12.0);
    let torque_max = Vector3::from_fn(|_, _| random::log_uniform(rng, 0.1, 3.0));
    let limits = Limits::new(LimitParameters { thrust_max, torque_max }, &vehicle).unwrap();
    let mut time = |most: f32| if rng.random_bool(0.3) { 0.0 } else { rng.random_range(0.001..most) };
    let actuators = ActuatorParameters { lag: time(0.06), delay: time(0.028) };
    let airframe = Airframe {
        vehicle: &vehicle,
        limits: &limits,
        rotors: Some(&rotors),
        actuators,
        period: 0.01,
        drag: random::log_uniform(rng, 0.01, 0.5),
    };
    let parameters = defaults::constants(&airframe, &NOTHING_GIVEN);
    let bounds = defaults::reference_bounds(&airframe, &parameters);
    let law = ExtendedLaw { parameters: Extended::new(parameters, &vehicle).ok()?, actuators };
    Configuration::extended(vehicle, limits, law, bounds).ok()?.with_rotors(rotors).ok()
}

/// The same with constants anywhere near the formulas': nothing is certified. In one case of five it has no rotors.
pub fn around_the_formulas(rng: &mut ChaCha8Rng) -> Configuration {
    let base = random_configuration(rng);
    let ExtendedLaw { parameters, actuators } = law(&base);
    let parameters = random_parameters(rng, &parameters, base.vehicle());
    let law = ExtendedLaw { parameters, actuators };
    let all = Configuration::extended(*base.vehicle(), *base.limits(), law, *base.bounds()).unwrap();
    if rng.random_bool(0.2) { all } else { all.with_rotors(base.rotors().unwrap().clone()).unwrap() }
}

/// A configuration with other constants.
pub fn with_constants(configuration: &Configuration, change: impl FnOnce(&mut ExtendedParameters)) -> Configuration {
    let ExtendedLaw { parameters, actuators } = law(configuration);
    let mut changed = *parameters;
    change(&mut changed);
    let parameters = Extended::new(changed, configuration.vehicle()).unwrap();
    with_law(configuration, ExtendedLaw { parameters, actuators })
}

/// A configuration whose rotors deliver at once.
pub fn with_ideal_actuators(configuration: &Configuration) -> Configuration {
    let ExtendedLaw { parameters, .. } = law(configuration);
    let law = ExtendedLaw { parameters, actuators: ActuatorParameters { lag: 0.0, delay: 0.0 } };
    with_law(configuration, law)
}

/// A configuration with another law.
fn with_law(configuration: &Configuration, law: ExtendedLaw) -> Configuration {
    let (vehicle, limits) = (*configuration.vehicle(), *configuration.limits());
    let changed = Configuration::extended(vehicle, limits, law, *configuration.bounds()).unwrap();
    match configuration.rotors() {
        Some(rotors) => changed.with_rotors(rotors.clone()).unwrap(),
        None => changed,
    }
}

/// A configuration with the same constants and nothing estimated.
pub fn without_estimates(configuration: &Configuration) -> Configuration {
    with_constants(configuration, |p| {
        (p.force_across, p.force_up, p.force_down) = (0.0, 0.0, 0.0);
        (p.torque_tilt, p.torque_yaw, p.scale_rate) = (0.0, 0.0, 0.0);
    })
}

/// The law of a configuration of the extended law.
pub fn law(configuration: &Configuration) -> ExtendedLaw {
    match configuration.law() {
        LawParameters::Extended(law) => *law,
        LawParameters::Paper(_) => panic!("a configuration of the paper's law"),
    }
}

/// What the certificate says the extended law can command under a configuration of it.
pub fn bounds(configuration: &Configuration) -> ExtendedBounds {
    match Certificate::new(configuration).unwrap() {
        Certificate::Extended(certificate) => certificate.bounds,
        Certificate::Paper(_) => panic!("a certificate of the paper's law"),
    }
}
