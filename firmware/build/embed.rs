//! From a scenario file to Rust source: the vehicle, gains, rotors and reference bounds that the firmware flies.
//!
//! `SCENARIO=file.toml cargo build -p firmware …` chooses the file, relative to the top of the repository. The numbers are
//! written with all their digits and read back bit for bit. Nothing that is worked out from them is carried over: the board
//! works out the rotors' inverse and the certificate again at boot.

use controller_core::allocation::{Rotor, Rotors, Spin};
use controller_core::certificate::configuration::{Certified, Configuration, Refused};
use nalgebra::Vector3;
use scenario::Scenario;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// What flies if nobody chooses: tuned for 30 ms of rotor lag and a whole sample of delay, certified to the rotors.
const DEFAULT: &str = "vehicles/study.toml";

/// The rate of the firmware's control task, Hz.
const RATE: f64 = 100.0;

/// Rotors that the boards have outputs for.
const ROTORS: usize = 4;

/// Reads the chosen file and writes the source of `fn configuration()` and a few constants to `target`.
pub fn scenario(target: &Path) -> Result<(), String> {
    println!("cargo::rerun-if-env-changed=SCENARIO");
    println!("cargo::rerun-if-changed=build/embed.rs");
    let top = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR")).join("..");
    let name = env::var("SCENARIO").unwrap_or_else(|_| DEFAULT.to_owned());
    let file = top.join(&name);
    println!("cargo::rerun-if-changed={}", file.display());
    let text = fs::read_to_string(&file)
        .map_err(|error| format!("SCENARIO {name}: cannot be read from the top of the repository: {error}"))?;
    let scenario = Scenario::parse(&text, &name).map_err(|error| error.to_string())?;
    let rate = 1.0 / scenario.timing.period();
    if (rate - RATE).abs() > 1e-9 {
        return Err(format!("{name}: control.rate: the firmware flies at {RATE} Hz, found {rate}"));
    }
    let Some(rotors) = scenario.configuration.rotors() else {
        return Err(format!("{name}: rotors: missing; a board needs to know what its {ROTORS} motors turn"));
    };
    if rotors.len() != ROTORS {
        return Err(format!("{name}: rotors.position: the boards drive {ROTORS} motors, found {}", rotors.len()));
    }
    warn(&name, &scenario.configuration);
    fs::write(target, source(&scenario, rotors)).map_err(|error| format!("{}: {error}", target.display()))
}

/// Says at build time what the board will say at boot.
fn warn(name: &str, configuration: &Configuration) {
    if let Err(Refused::Fails(certificate)) = Certified::new(configuration.clone()) {
        let failed = certificate.inequalities().find(|inequality| !inequality.holds());
        let failed = failed.map_or("an inequality", |inequality| inequality.name);
        println!("cargo::warning={name} is not certified ({failed} fails): this firmware will refuse to arm");
    }
}

fn source(scenario: &Scenario, rotors: &Rotors) -> String {
    let configuration = &scenario.configuration;
    let (vehicle, limits) = (configuration.vehicle(), configuration.limits());
    let (gains, bounds) = (configuration.gains(), configuration.bounds());
    let rotors: String = rotors.iter().map(|rotor| format!("        {},\n", rotor_source(rotor))).collect();
    let floor = configuration.thrust_floor();
    let floor = floor.map_or(String::new(), |floor| format!("?.with_thrust_floor({floor:?})"));
    format!(
        "/// The scenario's name.
pub const NAME: &str = {name:?};

fn built() -> Result<Configuration, ParameterError> {{
    let vehicle = VehicleParameters {{ mass: {mass:?}, inertia: {inertia}, gravity: {gravity:?} }};
    let vehicle = Vehicle::new(vehicle)?;
    let limits = LimitParameters {{ thrust_max: {thrust_max:?}, torque_max: {torque_max} }};
    let limits = Limits::new(limits, &vehicle)?;
    let gains = Gains::new({gains:?}, &vehicle)?;
    let bounds = {bounds:?};
    let rotors = Rotors::new(&[
{rotors}    ])?;
    Configuration::new(vehicle, limits, gains, bounds)?.with_rotors(rotors){floor}
}}
",
        name = scenario.name,
        mass = vehicle.mass,
        inertia = vector(&vehicle.inertia),
        gravity = vehicle.gravity,
        thrust_max = limits.thrust_max,
        torque_max = vector(&limits.torque_max),
        gains = **gains,
    )
}

fn rotor_source(rotor: &Rotor) -> String {
    let position = vector(&rotor.position);
    let spin = match rotor.spin {
        Spin::Clockwise => "Clockwise",
        Spin::CounterClockwise => "CounterClockwise",
    };
    let Rotor { thrust_coefficient, drag_coefficient, thrust_min, thrust_max, .. } = rotor;
    format!(
        "Rotor {{ position: {position}, spin: Spin::{spin}, thrust_coefficient: {thrust_coefficient:?}, \
         drag_coefficient: {drag_coefficient:?}, thrust_min: {thrust_min:?}, thrust_max: {thrust_max:?} }}"
    )
}

fn vector(v: &Vector3<f32>) -> String {
    format!("Vector3::new({:?}, {:?}, {:?})", v.x, v.y, v.z)
}
