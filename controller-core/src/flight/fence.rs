//! The fence: a cylinder about the place where the vehicle was armed.

use super::leaning::heading;
use super::settings::FlightSettings;
use crate::governor::{Motion, Setpoint};
use crate::state::State;
use nalgebra::{Vector2, Vector3};

/// `v` turned about the vertical as the unit vector `from` is to `to`.
fn turned(v: &Vector3<f32>, from: &Vector2<f32>, to: &Vector2<f32>) -> Vector3<f32> {
    let (cos, sin) = (from.dot(to), from.x * to.y - from.y * to.x);
    Vector3::new(v.x * cos - v.y * sin, v.x * sin + v.y * cos, v.z)
}

/// How far one may go from where, m.
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

    /// As wide and as high as other settings say, about the same place.
    pub fn choose(&mut self, settings: &FlightSettings) {
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

    /// The frame has moved and turned about the vertical: a vehicle that was in `before` is found in `after`, at the same instant.
    pub fn displace(&mut self, before: &State, after: &State) {
        let home = self.home - before.position;
        let turned = match (heading(&before.attitude), heading(&after.attitude)) {
            (Some(before), Some(after)) => turned(&home, &before.direction(), &after.direction()),
            _ => home,
        };
        self.home = after.position + turned;
    }

    /// Whether `position`, m, world, is inside. One that is made of no numbers is not.
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
mod tests {
    use super::*;
    use crate::governor::Turn;
    use nalgebra::UnitQuaternion;

    #[test]
    fn it_is_a_cylinder_about_home_without_a_floor() {
        let mut fence = Fence::new(&FlightSettings { fence_radius: 5.0, fence_height: 3.0, ..FlightSettings::DEFAULT });
        fence.place(&Vector3::new(10.0, 0.0, 1.0));
        for (x, y, z, inside) in [
            (10.0, 0.0, 1.0, true),
            (13.0, 4.0, 4.0, true),
            (13.0, 4.1, 1.0, false),
            (10.0, 0.0, 4.1, false),
            (10.0, 0.0, -9.0, true),
            (f32::NAN, 0.0, 1.0, false),
            (10.0, 0.0, f32::NAN, false),
        ] {
            let position = Vector3::new(x, y, z);
            assert_eq!(fence.contains(&position), inside, "{position}");
            let setpoint = Setpoint { motion: Motion::Position(position), turn: Turn::Keep };
            assert_eq!(fence.allows(&setpoint), inside);
        }
        assert!(fence.allows(&Setpoint { motion: Motion::Velocity(Vector3::repeat(9.0)), turn: Turn::Keep }));
        for (position, inside) in [
            ([None, None, Some(4.0)], true),
            ([None, None, Some(4.1)], false),
            ([Some(13.0), Some(4.0), None], true),
            ([Some(13.0), Some(4.1), None], false),
            ([Some(15.1), None, None], false),
        ] {
            let motion = Motion::Mixed { position, velocity: Vector3::repeat(9.0) };
            assert_eq!(fence.allows(&Setpoint { motion, turn: Turn::Keep }), inside, "{position:?}");
        }
    }

    fn state(position: [f32; 3], roll: f32, pitch: f32, yaw: f32) -> State {
        State {
            position: position.into(),
            velocity: Vector3::zeros(),
            attitude: UnitQuaternion::from_euler_angles(roll, pitch, yaw).into_inner(),
            angular_velocity: Vector3::zeros(),
        }
    }

    #[test]
    fn it_goes_along_with_a_frame_that_moves_and_turns() {
        let mut fence = Fence::new(&FlightSettings::DEFAULT);
        fence.place(&Vector3::new(1.0, 2.0, 0.5));
        // Three metres ahead of home and two up; then the frame is turned by a quarter to the right and shifted.
        fence.displace(
            &state([4.0, 2.0, 2.5], 0.1, 0.2, 0.3),
            &state([10.0, -7.0, 3.0], 0.1, 0.2, 0.3 + core::f32::consts::FRAC_PI_2),
        );
        assert!((fence.home() - Vector3::new(10.0, -10.0, 1.0)).norm() < 1e-4, "{}", fence.home());
    }
}
