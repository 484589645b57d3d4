//! A recovery from upside down under the law of the embedded scenario, replayed: the same states, hence the same bits,
//! of the wrench and of everything the law remembers, its estimates among it.

use super::{STATE_BYTES, digest, embedded_at, state};
use controller_core::certificate::certified::Certified;
use controller_core::error::InputError;
use controller_core::heading::Heading;
use controller_core::law::Law;
use controller_core::reference::Trajectory;
use controller_core::reference::hover::Hover;
use controller_core::state::Wrench;
use nalgebra::{Quaternion, Vector3};
use sha2::{Digest, Sha256};

/// How long the flight takes.
pub const RECOVERY_DURATION_US: u64 = 20_000_000;

/// The flight, as far as it has been replayed.
pub struct Recovery {
    law: Law,
    reference: Hover,
    hash: Sha256,
}

impl Recovery {
    /// At the start, to hover at the origin, in ticks of `period` us; certifies the embedded scenario. None if that
    /// fails.
    #[must_use]
    pub fn new(period: u64) -> Option<Self> {
        let certified = Certified::new(embedded_at(period)?).ok()?;
        let law = Law::new(&certified, period as f32 * 1e-6).ok()?;
        let reference = Hover::new(Vector3::zeros(), Heading::FORWARD).ok()?;
        Some(Self { law, reference, hash: Sha256::new() })
    }

    /// One tick at a recorded state. Returns the wrench.
    ///
    /// # Errors
    /// The law's own, for a state that it cannot use.
    pub fn tick(&mut self, record: &[u8; STATE_BYTES]) -> Result<Wrench, InputError> {
        let (wrench, diagnostics) = self.law.step(&state(record), &self.reference.at(0))?;
        self.add(&[wrench.thrust, self.law.thrust_scale()]);
        self.add(wrench.torque.as_slice());
        self.add(diagnostics.filtered.as_slice());
        self.add(diagnostics.mrp.as_slice());
        self.add(diagnostics.desired_angular_velocity.as_slice());
        self.add(diagnostics.desired_angular_acceleration.as_slice());
        let Quaternion { coords } = diagnostics.attitude_error;
        self.add(coords.as_slice());
        if let Some(estimates) = self.law.estimates() {
            self.add(estimates.force.as_slice());
            self.add(estimates.torque.as_slice());
        }
        Ok(wrench)
    }

    fn add(&mut self, numbers: &[f32]) {
        numbers.iter().for_each(|number| self.hash.update(number.to_le_bytes()));
    }

    /// The number, as 64 hexadecimal digits.
    #[must_use]
    pub fn digest(self) -> heapless::String<64> {
        digest(self.hash)
    }
}
