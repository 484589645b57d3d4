//! The paper's rigid body, eq. (FullDynamics), in f64: just enough of a vehicle to close the loop in a test.

use controller_core::state::{State, Wrench};
use controller_core::vehicle::Vehicle;
use nalgebra::{Quaternion, SVector, Vector3};

/// Position, velocity (world), attitude (body to world) and body rates of a rigid body.
#[derive(Debug, Clone, Copy)]
pub struct Body {
    pub position: Vector3<f64>,
    pub velocity: Vector3<f64>,
    pub attitude: Quaternion<f64>,
    pub angular_velocity: Vector3<f64>,
}

impl Body {
    /// At rest at `position`.
    pub fn resting(position: Vector3<f64>, attitude: Quaternion<f64>) -> Self {
        Self { position, velocity: Vector3::zeros(), attitude, angular_velocity: Vector3::zeros() }
    }

    /// What perfect sensors report.
    pub fn state(&self) -> State {
        State {
            position: self.position.cast(),
            velocity: self.velocity.cast(),
            attitude: self.attitude.cast(),
            angular_velocity: self.angular_velocity.cast(),
        }
    }

    /// Flies `duration` seconds under a held wrench, in `steps` steps of classical Runge-Kutta.
    pub fn advance(&mut self, vehicle: &Vehicle, wrench: &Wrench, duration: f64, steps: usize) {
        let (mass, gravity) = (f64::from(vehicle.mass), f64::from(vehicle.gravity));
        let inertia: Vector3<f64> = vehicle.inertia.cast();
        let (thrust, torque) = (f64::from(wrench.thrust), wrench.torque.cast::<f64>());
        let h = duration / steps as f64;
        for _ in 0..steps {
            let x = self.packed();
            let flow = |x: &SVector<f64, 13>| {
                let body = Self::unpacked(x);
                let (q, omega) = (body.attitude, body.angular_velocity);
                let axis = Vector3::new(
                    2.0 * (q.i * q.k + q.w * q.j),
                    2.0 * (q.j * q.k - q.w * q.i),
                    1.0 - 2.0 * (q.i * q.i + q.j * q.j),
                );
                Self {
                    position: body.velocity,
                    velocity: axis * (thrust / mass) - Vector3::new(0.0, 0.0, gravity),
                    attitude: q * Quaternion::from_imag(omega) * 0.5,
                    angular_velocity: (inertia.component_mul(&omega).cross(&omega) + torque).component_div(&inertia),
                }
                .packed()
            };
            let k1 = flow(&x);
            let k2 = flow(&(x + k1 * (h / 2.0)));
            let k3 = flow(&(x + k2 * (h / 2.0)));
            let k4 = flow(&(x + k3 * h));
            *self = Self::unpacked(&(x + (k1 + 2.0 * k2 + 2.0 * k3 + k4) * (h / 6.0)));
            self.attitude = self.attitude.normalize();
        }
    }

    fn packed(&self) -> SVector<f64, 13> {
        let parts = [self.position.as_slice(), self.velocity.as_slice(), self.attitude.coords.as_slice()];
        SVector::from_iterator(parts.into_iter().flatten().chain(self.angular_velocity.iter()).copied())
    }

    fn unpacked(x: &SVector<f64, 13>) -> Self {
        Self {
            position: x.fixed_rows::<3>(0).into(),
            velocity: x.fixed_rows::<3>(3).into(),
            attitude: Quaternion { coords: x.fixed_rows::<4>(6).into() },
            angular_velocity: x.fixed_rows::<3>(10).into(),
        }
    }
}
