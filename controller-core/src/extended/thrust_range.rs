//! A least and a greatest thrust that follow the torque, and the yaw torque that is left: every rotor stays within its
//! range by construction. Section 8 of `docs/extended-law.md`.
//!
//! The thrust command of rotor i is f_i = b_T,i (T + beta_i . tau), with beta = b_tau / b_T and (b_T, b_tau) its row of
//! the inverse allocation. So it is within its range as long as T is between
//!
//! ```text
//! N(tau) = max_i (s f_min,i / b_T,i - beta_i . tau) + margin,
//! C(tau) = min_i (s f_max,i / b_T,i - beta_i . tau) - margin.
//! ```
//!
//! Tilt comes first, then thrust, then yaw. With y what yaw [brakes](super::heading) with,
//!
//! T = max(N(tau_12), min(C(tau_12), C(tau_12, y), T_max, m u . R e3)),
//!
//! where [the budget](super::budget) keeps N(tau_12) <= C(tau_12); and tau_3 is the nearest to the wanted one with
//! which every rotor stays in its range at this thrust. So yaw never raises the thrust that tilting needs, and only a
//! turn that has to be braked cuts the thrust that is wanted. A rotor commanded f / s turns at its least or greatest
//! speed when f is s f_min,i or s f_max,i. A vehicle without rotors has a constant range, from the margin to T_max.

use crate::allocation::Rotors;
use crate::allocation::geometry::ROTORS_MAX;
use crate::math;
use crate::state::Wrench;
use core::hint::cold_path;
use heapless::Vec;
use nalgebra::{Vector2, Vector3};

/// One rotor's part: f_min,i / b_T,i, f_max,i / b_T,i and beta_i.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Part {
    min: f32,
    max: f32,
    per_torque: Vector3<f32>,
}

/// N and C.
#[derive(Debug, Clone, PartialEq)]
pub struct ThrustRange {
    rotors: Vec<Part, ROTORS_MAX>,
    margin: f32,
    thrust_max: f32,
    /// The limit of yaw, N m.
    yaw_max: f32,
}

impl ThrustRange {
    /// For `rotors`, if there are any, a margin and a greatest thrust in N, and the limit of yaw in N m.
    pub fn new(rotors: Option<&Rotors>, margin: f32, thrust_max: f32, yaw_max: f32) -> Self {
        let mut parts = Vec::new();
        for (rotor, row) in rotors.into_iter().flat_map(|rotors| rotors.iter().zip(rotors.pseudo_inverse())) {
            let per_torque = Vector3::new(row.y / row.x, row.z / row.x, row.w / row.x).map(|x| x as f32);
            let [min, max] = [rotor.thrust_min, rotor.thrust_max].map(|thrust| (f64::from(thrust) / row.x) as f32);
            // As many as there are rotors: it fits.
            let _ = parts.push(Part { min, max, per_torque });
        }
        Self { rotors: parts, margin, thrust_max, yaw_max }
    }

    /// T nearest to `thrust`, N, and tau_3 nearest to `yaw`, N m, of which `braking` comes before thrust, for a torque
    /// about the tilt's axes that the budget allows and the thrust scale s; and how much of tau_3 either way there is.
    #[inline(always)] // into the law's step
    pub fn limited(&self, thrust: f32, tilt: &Vector2<f32>, [yaw, braking]: [f32; 2], scale: f32) -> (Wrench, f32) {
        let (mut min, mut max) = (self.margin, self.thrust_max);
        for part in &self.rotors {
            let tilted = part.per_torque.xy().dot(tilt);
            min = math::max(min, scale * part.min + (self.margin - tilted));
            // Of the rotor's greatest, what tilting takes, or tilting and braking together if that is more.
            let taken = math::max(tilted, tilted + part.per_torque.z * braking);
            max = math::min(max, scale * part.max - (taken + self.margin));
        }
        // A thrust or a yaw torque that is not a number becomes the least one.
        let thrust = math::min(math::max(min, max), math::max(min, thrust));
        let [min, max] = self.yaw(thrust, tilt, scale);
        let torque = Vector3::new(tilt.x, tilt.y, math::min(max, math::max(min, yaw)));
        (Wrench { thrust, torque }, math::min(max, -min))
    }

    /// The greatest share of a further torque about the tilt's axes, N m, beside the one that is spent, with which N is
    /// at most `thrust`, N, or what it is already.
    #[inline(always)]
    pub fn share(&self, spent: &Vector2<f32>, wanted: &Vector2<f32>, thrust: f32, scale: f32) -> f32 {
        let min = |part: &Part| scale * part.min + (self.margin - part.per_torque.xy().dot(spent));
        let raised = |part: &Part| -part.per_torque.xy().dot(wanted);
        let (mut floor, mut whole) = (self.margin, self.margin);
        for part in &self.rotors {
            let min = min(part);
            floor = math::max(floor, min);
            whole = math::max(whole, min + raised(part));
        }
        let max = math::max(thrust, floor);
        if whole <= max {
            return 1.0;
        }
        cold_path();
        let mut share = 1.0;
        for part in &self.rotors {
            let (min, raised) = (min(part), raised(part));
            if min + raised > max {
                share = math::min(share, (max - min) / raised);
            }
        }
        share
    }

    /// The interval of tau_3, N m, with which no rotor leaves its range; zero is inside.
    #[inline(always)]
    fn yaw(&self, thrust: f32, tilt: &Vector2<f32>, scale: f32) -> [f32; 2] {
        let (mut min, mut max) = (-self.yaw_max, self.yaw_max);
        for part in &self.rotors {
            let share = thrust + part.per_torque.xy().dot(tilt);
            let per_torque = part.per_torque.z;
            if per_torque == 0.0 {
                cold_path();
                continue;
            }
            let [a, b] = [scale * part.min + self.margin - share, scale * part.max - self.margin - share]
                .map(|left| left / per_torque);
            let (low, high) = if per_torque > 0.0 { (a, b) } else { (b, a) };
            min = math::max(min, low);
            max = math::min(max, high);
        }
        [math::min(min, 0.0), math::max(max, 0.0)]
    }

    /// N(tau), N, for a torque in N m and the thrust scale s.
    #[inline(always)]
    pub fn min_thrust(&self, torque: &Vector3<f32>, scale: f32) -> f32 {
        let min = self.rotors.iter().map(|part| scale * part.min + (self.margin - part.per_torque.dot(torque)));
        min.fold(self.margin, math::max)
    }

    /// C(tau), N, likewise; at most T_max.
    #[inline(always)]
    pub fn max_thrust(&self, torque: &Vector3<f32>, scale: f32) -> f32 {
        let max = self.rotors.iter().map(|part| scale * part.max - (part.per_torque.dot(torque) + self.margin));
        max.fold(self.thrust_max, math::min)
    }
}
