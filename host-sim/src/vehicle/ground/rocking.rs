//! A vehicle that leans on one foot and falls back onto all of them.
//!
//! The vehicle turns in the vertical plane it leans in, about a foot that stays where it is or slides. With w =
//! [`FEET_RADIUS_M`] the distance of the feet from its axis and h = [`LEG_LENGTH_M`] that of its origin above them,
//! leaning by theta towards d (horizontal; z is up, and a = z x d is the axis),
//!
//! ```text
//! r = d (h sin theta - w cos theta) + z (h cos theta + w sin theta)      from the foot to the origin, m
//! I theta'' = a . (r x F + tau),     I = J_a + m (w^2 + h^2)             F: all forces, the weight among them, N
//! r'' = a x r theta'' - r theta'^2
//! K = m r'' - F                                                          the ground's force on the foot, N
//! ```
//!
//! Where the foot would have to pull, K . z < 0, it lets go. Where K leans further than friction ([`super::friction`])
//! holds, or the foot slides already, with s' along the ground, the ground's force is N c, c = z + mu t, t against the
//! motion or where K points:
//!
//! ```text
//! J_a theta'' = a . (tau - r x c N),    N = m (z . (a x r) theta'' - r_z theta'^2) - F_z
//! m s'' = (F + N c - m r'') across
//! ```
//!
//! Where these have hardly a solution, the foot, pushed ahead of a vehicle of little inertia, digs in. What stops a
//! foot keeps the angular momentum about it.
//!
//! Upright again, the other feet take all motion from it, but what they slide on with; beyond [`TILT_MAX_RAD`] it has
//! fallen over, and lies there. Within a step theta'' stays what it is at its start: without rotors it pulls more the
//! nearer it is to upright, so that no energy comes from that.
//!
//! Source: G. W. Housner, *The behavior of inverted pendulum structures during earthquakes*, 1963: a block that rocks;
//! here with rotors, and at rest after each impact.

use super::friction::{FRICTION_COEFFICIENT, across, slowed};
use nalgebra::{UnitQuaternion, UnitVector3, Vector3};
use scenario::body::BodyState;

/// Of the feet from the vehicle's axis.
const FEET_RADIUS_M: f64 = 0.1;

/// Of the origin above the feet.
const LEG_LENGTH_M: f64 = 0.1;

/// How far a vehicle may lean and still fall back onto its feet: 30 degrees.
pub const TILT_MAX_RAD: f64 = 0.52;

/// The share of I that resists turning, at most, of a vehicle whose foot digs in.
const FOOT_RESISTANCE_SHARE: f64 = 0.01;

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

    /// Where a vehicle at `state` on all its feet is after `step`, s, under `force`, N, world, without the weight.
    pub fn slide(&self, state: &BodyState, force: &Vector3<f64>, step: f64) -> BodyState {
        let carried = self.newtons() - force.z;
        let pushed = across(&state.velocity) + across(force) * (step / self.mass);
        let velocity = slowed(&pushed, FRICTION_COEFFICIENT * carried * step / self.mass);
        let position = state.position + across(&(state.velocity + velocity)) * (0.5 * step);
        BodyState { position, velocity, ..*state }
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
    pub fn measure(state: &BodyState) -> Option<Self> {
        let up = up(state);
        let toward = Vector3::new(up.x, up.y, 0.0).try_normalize(1e-9)?;
        let axis = UnitVector3::new_normalize(Vector3::z().cross(&toward));
        let rate = axis.dot(&(UnitQuaternion::new_normalize(state.attitude) * state.angular_velocity));
        let angle = tilt(state);
        (angle <= TILT_MAX_RAD).then_some(Self { toward, axis, angle, rate })
    }

    /// How much higher than upright the origin is, m, with a foot on the ground; and how fast that rises, m/s.
    pub fn rise(&self) -> (f64, f64) {
        let (sin, cos) = self.angle.sin_cos();
        (FEET_RADIUS_M * sin - LEG_LENGTH_M * (1.0 - cos), (FEET_RADIUS_M * cos - LEG_LENGTH_M * sin) * self.rate)
    }

    /// r, from the foot to the origin, m.
    pub fn arm(&self) -> Vector3<f64> {
        let (sin, cos) = self.angle.sin_cos();
        self.toward * (LEG_LENGTH_M * sin - FEET_RADIUS_M * cos)
            + Vector3::z() * (LEG_LENGTH_M * cos + FEET_RADIUS_M * sin)
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
    /// s', m/s, world.
    sliding: Vector3<f64>,
    /// Body to world, of the vehicle upright.
    upright: UnitQuaternion<f64>,
    /// I, kg m^2.
    inertia: f64,
    lean: Lean,
}

impl Rocking {
    /// A vehicle on its lowest foot where `state` is, which leans so and slides as it moves.
    pub fn begin(state: &BodyState, lean: Lean, weight: &Weight) -> Self {
        let attitude = UnitQuaternion::new_normalize(state.attitude);
        let upright = UnitQuaternion::from_axis_angle(&lean.axis, -lean.angle) * attitude;
        let axis = upright.inverse() * lean.axis.into_inner();
        let own = axis.component_mul(&axis).dot(&weight.inertia);
        let inertia = own + weight.mass * (FEET_RADIUS_M * FEET_RADIUS_M + LEG_LENGTH_M * LEG_LENGTH_M);
        let (foot, sliding) = (state.position - lean.arm(), state.velocity);
        Self { foot, sliding, upright, inertia, lean: Lean { rate: 0.0, ..lean } }
    }

    /// `step`, s, under `force`, N, world, without the weight, and `torque`, N m, body.
    pub fn advance(&mut self, weight: &Weight, force: &Vector3<f64>, torque: &Vector3<f64>, step: f64) -> Rocked {
        let all = force - Vector3::z() * weight.newtons();
        let torque = self.lean.axis.dot(&(self.attitude() * torque));
        let Some(turning) = self.turning(weight.mass, &all, torque, step) else { return Rocked::Off };
        let Lean { angle, rate, .. } = &mut self.lean;
        *angle += (*rate + 0.5 * turning * step) * step;
        *rate += turning * step;
        if *angle > 0.0 && *angle <= TILT_MAX_RAD {
            return Rocked::Leaning(self.state());
        }
        if *angle <= 0.0 {
            *angle = 0.0;
        }
        let moved = self.state().velocity;
        self.lean.rate = 0.0;
        let slides = self.sliding != Vector3::zeros() && self.lean.angle <= TILT_MAX_RAD;
        let velocity = if slides { slowed(&moved, FRICTION_COEFFICIENT * moved.z.abs()) } else { Vector3::zeros() };
        Rocked::Ended(BodyState { velocity, ..self.state() })
    }

    /// theta'', rad/s^2, of a vehicle of `mass`, kg, under `all` forces but the ground's, N, world, and `torque`, N m,
    /// about a; none where the foot lets go. The foot slides for `step`, s.
    fn turning(&mut self, mass: f64, all: &Vector3<f64>, torque: f64, step: f64) -> Option<f64> {
        let (r, axis, rate) = (self.lean.arm(), self.lean.axis, self.lean.rate);
        let bent = |turning: f64| axis.cross(&r) * turning - r * (rate * rate);
        let stuck = (axis.dot(&r.cross(all)) + torque) / self.inertia;
        let needed = bent(stuck) * mass - all;
        let slides = self.sliding != Vector3::zeros();
        if !slides && across(&needed).norm() <= FRICTION_COEFFICIENT * needed.z {
            return Some(stuck);
        }
        let along = if slides { -self.sliding } else { across(&needed) };
        let contact = Vector3::z() + along.try_normalize(0.0).unwrap_or_default() * FRICTION_COEFFICIENT;
        let lever = axis.dot(&r.cross(&contact));
        let left = self.inertia - mass * r.norm_squared() + mass * lever * axis.cross(&r).z;
        let digs_in = left <= FOOT_RESISTANCE_SHARE * self.inertia;
        if digs_in && !slides {
            return (needed.z >= 0.0).then_some(stuck);
        }
        let turning = (torque + lever * (mass * r.z * rate * rate + all.z)) / left;
        let carried = mass * bent(turning).z - all.z;
        let faster = across(&((all + contact * carried) / mass - bent(turning))) * step;
        if digs_in || slides && carried >= 0.0 && (self.sliding + faster).dot(&self.sliding) <= 0.0 {
            self.lean.rate += mass * axis.dot(&r.cross(&self.sliding)) / self.inertia;
            self.sliding = Vector3::zeros();
            return self.turning(mass, all, torque, step);
        }
        if carried < 0.0 {
            return None;
        }
        self.foot += (self.sliding + faster * 0.5) * step;
        self.sliding += faster;
        Some(turning)
    }

    fn attitude(&self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_axis_angle(&self.lean.axis, self.lean.angle) * self.upright
    }

    fn state(&self) -> BodyState {
        let (r, attitude) = (self.lean.arm(), self.attitude());
        let turning = self.lean.axis.into_inner() * self.lean.rate;
        BodyState {
            position: self.foot + r,
            velocity: self.sliding + turning.cross(&r),
            attitude: attitude.into_inner(),
            angular_velocity: attitude.inverse() * turning,
        }
    }
}

#[cfg(test)]
mod tests;
