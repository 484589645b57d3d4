//! A recovery from upside down under the law of the embedded scenario, replayed: the same states, hence the same bits,
//! of the wrench and of everything the law remembers, its estimates among it.

use super::{Hash, STATE_BYTES, embedded_at, state};
use controller_core::certificate::certified::Certified;
use controller_core::error::InputError;
use controller_core::heading::Heading;
use controller_core::law::Law;
use controller_core::reference::Trajectory;
use controller_core::reference::hover::Hover;
use controller_core::state::Wrench;
use nalgebra::{Quaternion, Vector3};

/// How long the flight takes.
pub const RECOVERY_DURATION_US: u64 = 20_000_000;

/// The flight, as far as it has been replayed.
pub struct Recovery {
    law: Law,
    reference: Hover,
    hash: Hash,
}

impl Recovery {
    /// At the start, to hover at the origin, in ticks of `period` us; certifies the embedded scenario. None if that
    /// fails.
    pub fn new(period: u64) -> Option<Self> {
        let certified = Certified::new(embedded_at(period)?).ok()?;
        let law = Law::new(&certified, period as f32 * 1e-6).ok()?;
        let reference = Hover::new(Vector3::zeros(), Heading::FORWARD).ok()?;
        Some(Self { law, reference, hash: Hash::default() })
    }

    /// One tick at a recorded state. Returns the wrench.
    /// Errors: the law's own, for a state that it cannot use.
    pub fn tick(&mut self, record: &[u8; STATE_BYTES]) -> Result<Wrench, InputError> {
        let (wrench, diagnostics) = self.law.step(&state(record), &self.reference.at(0))?;
        self.hash.add(&[wrench.thrust, self.law.thrust_scale()]);
        self.hash.add(wrench.torque.as_slice());
        self.hash.add(diagnostics.filtered.as_slice());
        self.hash.add(diagnostics.mrp.as_slice());
        self.hash.add(diagnostics.desired_angular_velocity.as_slice());
        self.hash.add(diagnostics.desired_angular_acceleration.as_slice());
        let Quaternion { coords } = diagnostics.attitude_error;
        self.hash.add(coords.as_slice());
        if let Some(estimates) = self.law.estimates() {
            self.hash.add(estimates.force.as_slice());
            self.hash.add(estimates.torque.as_slice());
        }
        Ok(wrench)
    }

    /// The number, as 64 hexadecimal digits.
    pub fn digest(self) -> heapless::String<64> {
        self.hash.digest()
    }
}
