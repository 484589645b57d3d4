//! A vehicle whose law flies on without one of its rotors: what can be said of it beforehand.
//!
//! | module | what it holds |
//! |---|---|
//! | [`relaxed_hover`] | the turning in which everything balances: its rate, its axis, the thrusts |
//! | [`turning_loop`] | small motions about that, in samples, with lag and delay |
//!
//! Both ask [the law](controller_core::extended::rotor_loss::spinning) itself, so they are about the one that flies.

pub mod relaxed_hover;
pub mod turning_loop;

use controller_core::allocation::remaining::LostRotor;
use controller_core::configuration::{Configuration, LawParameters};
use controller_core::extended::memory::Estimates;
use controller_core::extended::rotor_loss::spinning::RotorLossLaw;
use controller_core::heading::Heading;
use controller_core::reference::Reference;
use controller_core::state::State;
use nalgebra::{Quaternion, Vector3, Vector4};

/// How near its place a vehicle without a rotor must stay not to count as lost, m.
pub const PLACE_HELD_DISTANCE_M: f64 = 3.0;

/// The greatest speed of its soft landing, m/s.
pub const SOFT_LANDING_SPEED_M_PER_S: f64 = 1.0;

/// The law of a vehicle without one of its rotors, before its first tick.
#[derive(Debug, Clone)]
pub struct WithoutARotor {
    law: RotorLossLaw,
    period: f32,
}

impl WithoutARotor {
    /// The extended law of `configuration` with ticks `period` seconds apart, the rotor of this index gone, and nothing
    /// else unknown; none without rotors, or under the paper's law.
    #[must_use]
    pub fn new(configuration: &Configuration, rotor: usize, period: f32) -> Option<Self> {
        let (LawParameters::Extended(law), Some(rotors)) = (configuration.law(), configuration.rotors()) else {
            return None;
        };
        let lost = LostRotor { rotor, left: 0.0 };
        let times = [law.actuators.lag + law.actuators.delay, period];
        let (vehicle, limits) = (configuration.vehicle(), configuration.limits());
        Some(Self { law: RotorLossLaw::new(vehicle, limits, rotors, &lost, times, &Estimates::NONE), period })
    }

    /// The axis, in the body, about which it turns: at rest and level, the tilt's error is the one from it to z.
    #[must_use]
    pub fn axis(&self) -> Vector3<f64> {
        let mrp = self.clone().stepped(Quaternion::identity(), Vector3::zeros(), &Vector4::zeros()).1.map(f64::from);
        // tan(phi / 4) long, along z x n.
        let size = mrp.norm();
        let angle = 4.0 * size.atan();
        let along = if size > 0.0 { angle.sin() / size } else { 0.0 };
        Vector3::new(mrp.y * along, -mrp.x * along, angle.cos())
    }

    /// Of a tick at its place, at rest: the torque that the rotors are to deliver, N m, and the tilt's error as
    /// modified Rodrigues parameters. `pending` is what past commands will still deliver, N s and N m s.
    fn stepped(
        mut self,
        attitude: Quaternion<f32>,
        angular_velocity: Vector3<f32>,
        pending: &Vector4<f32>,
    ) -> (Vector3<f32>, Vector3<f32>) {
        let state = State { position: Vector3::zeros(), velocity: Vector3::zeros(), attitude, angular_velocity };
        let reference = Reference::resting(Vector3::zeros(), Heading::FORWARD);
        let spinning = self.law.step(&state, &reference, pending, self.period);
        (self.law.delivered().torque, spinning.mrp)
    }
}
