//! A vehicle that leans on one foot and falls back onto all of them.
//!
//! The foot stays where it is, so the vehicle turns in the vertical plane it leans in. With w = [`SPREAD`] the distance
//! of the feet from its axis and h = [`LENGTH`] that of its origin above them, leaning by theta towards d (horizontal;
//! z is up, and a = z x d is the axis),
//!
//! ```text
//! r = d (h sin theta - w cos theta) + z (h cos theta + w sin theta)      from the foot to the origin, m
//! I theta'' = a . (r x F + tau),     I = J_a + m (w^2 + h^2)             F: all forces, the weight among them, N
//! r'' = a x r theta'' - r theta'^2
//! ```
//!
//! The foot carries m r'' . z - F . z. Where it would have to pull, it lets go. Upright again, the other feet take all
//! motion from it; beyond [`TILT_MAX`] it has fallen over, and lies there. Within a step theta'' stays what it is at
//! its start: without rotors it pulls more the nearer it is to upright, so that no energy comes from that.
//!
//! Source: G. W. Housner, *The behavior of inverted pendulum structures during earthquakes*, 1963: a block that rocks;
//! here with rotors, and at rest after each impact.

use nalgebra::{UnitQuaternion, UnitVector3, Vector3};
use scenario::body::BodyState;

/// Of the feet from the vehicle's axis, m.
const SPREAD: f64 = 0.1;

/// Of the legs, m: of the origin above the feet.
const LENGTH: f64 = 0.1;

/// How far a vehicle may lean and still fall back onto its feet, rad: 30 degrees.
pub const TILT_MAX: f64 = 0.52;

/// The vehicle's mass, inertia and gravity.
#[derive(Debug, Clone)]
pub struct Weight {
    /// kg.
    pub mass: f64,
    /// Diagonal, kg m^2.
    pub inertia: Vector3<f64>,
    /// m/s^2.
    pub gravity: f64,
}

impl Weight {
    pub fn newtons(&self) -> f64 {
        self.mass * self.gravity
    }
}

/// R(q) e3.
pub fn up(state: &BodyState) -> Vector3<f64> {
    UnitQuaternion::new_unchecked(state.attitude) * Vector3::z()
}

/// How far it leans, rad.
pub fn tilt(state: &BodyState) -> f64 {
    up(state).z.clamp(-1.0, 1.0).acos()
}

/// How a vehicle leans.
#[derive(Debug, Clone)]
pub struct Lean {
    /// d.
    toward: Vector3<f64>,
    /// a.
    axis: UnitVector3<f64>,
    /// theta, rad.
    angle: f64,
    /// theta', rad/s.
    rate: f64,
}

impl Lean {
    /// None of one that is upright, or leans too far to stand on a foot.
    pub fn of(state: &BodyState) -> Option<Self> {
        let up = up(state);
        let toward = Vector3::new(up.x, up.y, 0.0).try_normalize(1e-9)?;
        let axis = UnitVector3::new_normalize(Vector3::z().cross(&toward));
        let rate = axis.dot(&(UnitQuaternion::new_normalize(state.attitude) * state.angular_velocity));
        let angle = tilt(state);
        (angle <= TILT_MAX).then_some(Self { toward, axis, angle, rate })
    }

    /// How much higher than upright the origin is, m, with a foot on the ground; and how fast that rises, m/s.
    pub fn rise(&self) -> (f64, f64) {
        let (sin, cos) = self.angle.sin_cos();
        (SPREAD * sin - LENGTH * (1.0 - cos), (SPREAD * cos - LENGTH * sin) * self.rate)
    }

    /// r.
    fn arm(&self) -> Vector3<f64> {
        let (sin, cos) = self.angle.sin_cos();
        self.toward * (LENGTH * sin - SPREAD * cos) + Vector3::z() * (LENGTH * cos + SPREAD * sin)
    }
}

/// Its motion after a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rocked {
    /// It is still on its foot.
    Leaning(BodyState),
    /// It stands or lies, at rest.
    Ended(BodyState),
    /// It is in the air.
    Off,
}

/// A vehicle on one foot.
#[derive(Debug, Clone)]
pub struct Rocking {
    /// World, m.
    foot: Vector3<f64>,
    /// Body to world, of the vehicle upright.
    upright: UnitQuaternion<f64>,
    /// I, kg m^2.
    inertia: f64,
    lean: Lean,
}

impl Rocking {
    /// A vehicle at rest on its lowest foot where `state` is, which leans so.
    pub fn begin(state: &BodyState, lean: Lean, weight: &Weight) -> Self {
        let attitude = UnitQuaternion::new_normalize(state.attitude);
        let upright = UnitQuaternion::from_axis_angle(&lean.axis, -lean.angle) * attitude;
        let axis = upright.inverse() * lean.axis.into_inner();
        let own = axis.component_mul(&axis).dot(&weight.inertia);
        let inertia = own + weight.mass * (SPREAD * SPREAD + LENGTH * LENGTH);
        Self { foot: state.position - lean.arm(), upright, inertia, lean: Lean { rate: 0.0, ..lean } }
    }

    /// `step`, s, under `force`, N, world, without the weight, and `torque`, N m, body.
    pub fn advance(&mut self, weight: &Weight, force: &Vector3<f64>, torque: &Vector3<f64>, step: f64) -> Rocked {
        let (r, attitude) = (self.lean.arm(), self.attitude());
        let Lean { axis, angle, rate, .. } = &mut self.lean;
        let all = force - Vector3::z() * weight.newtons();
        let turning = axis.dot(&(r.cross(&all) + attitude * torque)) / self.inertia;
        if weight.mass * (axis.cross(&r) * turning - r * (*rate * *rate)).z < all.z {
            return Rocked::Off;
        }
        *angle += (*rate + 0.5 * turning * step) * step;
        *rate += turning * step;
        if *angle > 0.0 && *angle <= TILT_MAX {
            return Rocked::Leaning(self.state());
        }
        if *angle <= 0.0 {
            *angle = 0.0;
        }
        *rate = 0.0;
        Rocked::Ended(self.state())
    }

    fn attitude(&self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_axis_angle(&self.lean.axis, self.lean.angle) * self.upright
    }

    fn state(&self) -> BodyState {
        let (r, attitude) = (self.lean.arm(), self.attitude());
        let turning = self.lean.axis.into_inner() * self.lean.rate;
        BodyState {
            position: self.foot + r,
            velocity: turning.cross(&r),
            attitude: attitude.into_inner(),
            angular_velocity: attitude.inverse() * turning,
        }
    }
}

#[cfg(test)]
mod tests;
