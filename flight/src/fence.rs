//! The fence: a cylinder about the place where the vehicle was armed.

use super::settings::FlightSettings;
use super::tilt::heading;
use controller_core::governor::{Motion, Setpoint};
use controller_core::state::State;
use nalgebra::{Vector2, Vector3};

/// `v` turned about the vertical as the unit vector `from` is to `to`.
fn turned(v: &Vector3<f32>, from: &Vector2<f32>, to: &Vector2<f32>) -> Vector3<f32> {
    let (cos, sin) = (from.dot(to), from.x * to.y - from.y * to.x);
    Vector3::new(v.x * cos - v.y * sin, v.x * sin + v.y * cos, v.z)
}

/// The place and its limits, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Fence {
    home: Vector3<f32>,
    radius: f32,
    height: f32,
}

impl Fence {
    pub fn new(settings: &FlightSettings) -> Self {
        Self { home: Vector3::zeros(), radius: settings.fence_radius, height: settings.fence_height }
    }

    /// Takes radius and height from other settings, about the same place.
    pub fn resize(&mut self, settings: &FlightSettings) {
        *self = Self { home: self.home, ..Self::new(settings) };
    }

    /// Puts it about `home`, m, world.
    pub fn place(&mut self, home: &Vector3<f32>) {
        self.home = *home;
    }

    /// Where it is about, m, world.
    pub fn home(&self) -> Vector3<f32> {
        self.home
    }

    /// The frame has moved and turned about the vertical: a vehicle that was in `before` is found in `after`, at the
    /// same instant.
    pub fn displace(&mut self, before: &State, after: &State) {
        let home = self.home - before.position;
        let turned = match (heading(&before.attitude), heading(&after.attitude)) {
            (Some(before), Some(after)) => turned(&home, &before.direction(), &after.direction()),
            _ => home,
        };
        self.home = after.position + turned;
    }

    /// Whether `position`, m, world, is inside. A NaN is not.
    pub fn contains(&self, position: &Vector3<f32>) -> bool {
        let away = position - self.home;
        away.xy().norm_squared() <= self.radius * self.radius && away.z <= self.height
    }

    /// Whether a setpoint leads to a place inside, as far as it names one.
    pub fn allows(&self, setpoint: &Setpoint) -> bool {
        match &setpoint.motion {
            Motion::Position(position) | Motion::PositionVelocityAcceleration { position, .. } => {
                self.contains(position)
            }
            Motion::Velocity(_) => true,
            Motion::Mixed { position: [x, y, z], .. } => {
                let Self { home, .. } = self;
                self.contains(&Vector3::new(x.unwrap_or(home.x), y.unwrap_or(home.y), z.unwrap_or(home.z)))
            }
        }
    }
}

#[cfg(test)]
mod tests;
