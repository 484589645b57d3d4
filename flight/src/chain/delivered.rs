//! Delivered against commanded thrust, by the law's estimates.

use super::{Chain, Flown};
use crate::tilt::tilt_cosine;
use estimation::estimator::EstimatedState;
use nalgebra::{UnitQuaternion, Vector3};

impl Chain<'_> {
    /// The law's estimate of the vertical force per mass, m/s^2: mostly a lack of thrust.
    fn vertical_force(&self) -> f32 {
        self.law.estimates().map_or(0.0, |estimates| estimates.force.z)
    }

    /// Delivered over commanded thrust, by the law's estimates in steady flight; 1 without estimates, and of a
    /// vehicle that has lost a rotor.
    ///
    /// A hover commands (g - d_z) m / s and delivers m g. The thrust scale s alone is not enough: the vertical force
    /// d_z takes up a steady lack of thrust.
    pub fn delivered_share(&self) -> f32 {
        if self.lost.is_some() {
            return 1.0;
        }
        self.law.thrust_scale() * self.gravity / (self.gravity - self.vertical_force())
    }

    /// The acceleration that neither the commanded thrust nor the estimated force explains, m/s^2, world.
    pub fn unexpected(&self, flown: &Flown, estimated: &EstimatedState) -> Vector3<f32> {
        let attitude = UnitQuaternion::new_unchecked(flown.state.attitude);
        let commanded = attitude * Vector3::z() * (flown.wrench.thrust / self.mass);
        estimated.acceleration + Vector3::z() * (self.gravity - self.vertical_force()) - commanded
    }

    /// The vertical acceleration of the commanded thrust and the estimated force, m/s^2.
    pub fn commanded_acceleration(&self, flown: &Flown) -> f32 {
        flown.wrench.thrust / self.mass * tilt_cosine(&flown.state.attitude) - self.gravity + self.vertical_force()
    }
}
