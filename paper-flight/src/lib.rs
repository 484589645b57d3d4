//! The paper's 40 s flight as one number: the same on every machine that computes the law to the same bits.
//!
//! The vehicle's states are given, recorded from host-sim's plant as single-precision bits. That is as good as flying
//! the plant live, by induction: the first state is the same for all machines; as long as a machine's wrenches have had
//! the same bits as those the plant was flown with, its next state would have had the same bits as the recorded one;
//! and the first wrench that differs changes the number. The reference is not given: it is computed here, from integer
//! time.
//!
//! What goes into the number, per tick, as little-endian single precision: thrust, torque, u_f, u_s, q_hat (scalar
//! first) and m* as the controller keeps them after the tick, theta~, omega_d, omega_d'. The number is their SHA-256.
//!
//! Table I flies here and in no firmware: it does not survive a late sample.

#![no_std]
#![forbid(unsafe_code)]

use controller_core::certificate::certified::Certified;
use controller_core::configuration::Configuration;
use controller_core::controller::Controller;
use controller_core::error::{InputError, ParameterError};
use controller_core::gains::{GainParameters, Gains};
use controller_core::reference::Trajectory;
use controller_core::reference::harmonic::{Harmonic, HarmonicParameters, HeadingParameters};
use controller_core::state::{State, Wrench};
use controller_core::vehicle::{LimitParameters, Limits, Vehicle, VehicleParameters};
use nalgebra::{Quaternion, Vector3};
use sha2::{Digest, Sha256};

/// Control ticks of the flight.
pub const FLIGHT_TICKS: u64 = 4000;

/// Time between two of them.
pub const PERIOD_US: u64 = 10_000;

/// Single-precision numbers of one recorded state: p, v (world), q (scalar first), omega (body).
pub const STATE_NUMBERS: usize = 13;

/// Bytes of one recorded state.
pub const STATE_BYTES: usize = 4 * STATE_NUMBERS;

/// The numbers of the paper's Table I and Section VI; `scenarios/paper.toml` has the same numbers.
const VEHICLE: VehicleParameters =
    VehicleParameters { mass: 0.46, inertia: Vector3::new(2.24e-3, 2.9e-3, 5.3e-3), gravity: 9.81 };
const LIMITS: LimitParameters = LimitParameters { thrust_max: 7.0, torque_max: Vector3::new(0.5, 0.5, 0.5) };
const TURN_RATE_RAD_PER_S: f64 = 0.418_879_02;
#[expect(clippy::approx_constant, reason = "the digits of scenarios/paper.toml")]
const REFERENCE: HarmonicParameters = HarmonicParameters {
    center: [-3.0, 1.0, 4.5],
    amplitude: [1.0; 3],
    frequency: [TURN_RATE_RAD_PER_S; 3],
    phase: [0.0, -1.570_796_33, 0.0],
    heading: HeadingParameters { offset: 0.0, rate: 0.0, amplitude: 3.141_592_65, frequency: TURN_RATE_RAD_PER_S },
};

/// The paper's vehicle, limits and Table I, for its own reference.
/// Never fails: a machine that computes right.
pub fn papers() -> Result<Configuration, ParameterError> {
    let vehicle = Vehicle::new(VEHICLE)?;
    let limits = Limits::new(LIMITS, &vehicle)?;
    let gains = Gains::new(GainParameters::TABLE_1, &vehicle)?;
    Configuration::new(vehicle, limits, gains, Harmonic::new(REFERENCE)?.bounds())
}

/// The flight, as far as it has been replayed.
pub struct Replay {
    controller: Controller,
    reference: Harmonic,
    hash: Hash,
    tick: u64,
}

impl Replay {
    /// At the start; certifies Table I. None if that fails, which no machine that computes right sees.
    pub fn new() -> Option<Self> {
        let certified = Certified::new(papers().ok()?).ok()?;
        let reference = Harmonic::new(REFERENCE).ok()?;
        let controller = Controller::new(&certified, PERIOD_US as f32 * 1e-6).ok()?;
        Some(Self { controller, reference, hash: Hash::default(), tick: 0 })
    }

    /// One tick at a recorded state. Returns the wrench.
    /// Errors: the law's own, for a state that it cannot use.
    pub fn tick(&mut self, record: &[u8; STATE_BYTES]) -> Result<Wrench, InputError> {
        let (wrench, diagnostics) = self.controller.step(&state(record), &self.reference.at(self.tick * PERIOD_US))?;
        self.tick += 1;
        let memory = self.controller.memory();
        self.hash.add(&[wrench.thrust]);
        self.hash.add(wrench.torque.as_slice());
        self.hash.add(memory.filter.filtered.as_slice());
        self.hash.add(memory.filter.intermediate.as_slice());
        if let Some(lift) = memory.lift {
            let Quaternion { coords } = lift.memory;
            self.hash.add(&[coords.w, coords.x, coords.y, coords.z, lift.sign]);
        }
        self.hash.add(diagnostics.mrp.as_slice());
        self.hash.add(diagnostics.desired_angular_velocity.as_slice());
        self.hash.add(diagnostics.desired_angular_acceleration.as_slice());
        Ok(wrench)
    }

    /// The number, as 64 hexadecimal digits.
    pub fn digest(self) -> heapless::String<64> {
        self.hash.digest()
    }
}

/// The hash of a flight's numbers.
#[derive(Default)]
pub struct Hash(Sha256);

impl Hash {
    /// Takes numbers, as little-endian single precision.
    pub fn add(&mut self, numbers: &[f32]) {
        numbers.iter().for_each(|number| self.0.update(number.to_le_bytes()));
    }

    /// Takes a byte.
    pub fn add_byte(&mut self, byte: u8) {
        self.0.update([byte]);
    }

    /// As 64 hexadecimal digits.
    pub fn digest(self) -> heapless::String<64> {
        let nibbles = self.0.finalize().into_iter().flat_map(|byte| [byte >> 4, byte & 15]);
        nibbles.filter_map(|nibble| char::from_digit(nibble.into(), 16)).collect()
    }
}

/// A state as it is recorded.
pub fn record(state: &State) -> [u8; STATE_BYTES] {
    let State { position: p, velocity: v, attitude: q, angular_velocity: w } = state;
    let numbers: [f32; STATE_NUMBERS] = [p.x, p.y, p.z, v.x, v.y, v.z, q.w, q.i, q.j, q.k, w.x, w.y, w.z];
    let mut bytes = [0; STATE_BYTES];
    for (place, number) in bytes.chunks_exact_mut(4).zip(numbers) {
        place.copy_from_slice(&number.to_le_bytes());
    }
    bytes
}

/// The state that `record` holds.
pub fn state(record: &[u8; STATE_BYTES]) -> State {
    let mut numbers = [0.0; STATE_NUMBERS];
    for (number, bytes) in numbers.iter_mut().zip(record.chunks_exact(4)) {
        *number = f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    }
    let [px, py, pz, vx, vy, vz, qw, qx, qy, qz, wx, wy, wz] = numbers;
    State {
        position: Vector3::new(px, py, pz),
        velocity: Vector3::new(vx, vy, vz),
        attitude: Quaternion::new(qw, qx, qy, qz),
        angular_velocity: Vector3::new(wx, wy, wz),
    }
}
