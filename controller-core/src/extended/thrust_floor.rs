//! A least thrust that follows the torque: every rotor stays above its least thrust by construction. Section 6 of
//! `docs/extended-law.md`.
//!
//! Rotor i is asked for f_i = b_T,i T + b_tau,i . tau, with (b_T,i, b_tau,i) its row of B+. So it is above its least thrust
//! f_min,i as long as T is above
//!
//! N(tau) = max_i ((s f_min,i - b_tau,i . tau) / b_T,i) + margin,
//!
//! and T = max(m u . R e3, N(tau)). A rotor commanded f / s turns at its least speed when f is s f_min,i. A vehicle without
//! rotors has a constant floor, the margin.
//!
//! The command is nearly always far above N. A bound on N says so with one comparison for all rotors: the same formula with the
//! greatest magnitude of each constant among the rotors and of each component of tau. Rounding is monotone, so that the bound is
//! not below any rotor's part, to the last bit.

use crate::allocation::Rotors;
use crate::allocation::geometry::ROTORS_MAX;
use crate::math;
use core::hint::cold_path;
use heapless::Vec;
use nalgebra::Vector3;

/// One rotor's part of N: f_min,i / b_T,i and -b_tau,i / b_T,i.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Floor {
    least: f32,
    per_torque: Vector3<f32>,
}

impl Floor {
    fn at(&self, torque: &Vector3<f32>, scale: f32) -> f32 {
        scale * self.least + self.per_torque.dot(torque)
    }
}

/// N.
#[derive(Debug, Clone, PartialEq)]
pub struct ThrustFloor {
    rotors: Vec<Floor, ROTORS_MAX>,
    /// The greatest magnitudes among the rotors' constants.
    greatest: Floor,
    margin: f32,
}

impl ThrustFloor {
    /// For `rotors`, if there are any, and a margin in N.
    #[must_use]
    pub fn new(rotors: Option<&Rotors>, margin: f32) -> Self {
        let mut floors = Vec::new();
        for (rotor, row) in rotors.into_iter().flat_map(|rotors| rotors.iter().zip(rotors.pseudo_inverse())) {
            let per_torque = Vector3::new(-row.y / row.x, -row.z / row.x, -row.w / row.x).map(|x| x as f32);
            // As many as there are rotors: it fits.
            let _ = floors.push(Floor { least: (f64::from(rotor.thrust_min) / row.x) as f32, per_torque });
        }
        let mut greatest = Floor { least: 0.0, per_torque: Vector3::zeros() };
        for floor in &floors {
            greatest.least = math::greater(greatest.least, floor.least);
            greatest.per_torque = greatest.per_torque.zip_map(&floor.per_torque.abs(), math::greater);
        }
        Self { rotors: floors, greatest, margin }
    }

    /// max(`thrust`, N(tau)), N, for a torque in N m and the thrust scale s.
    #[must_use]
    pub fn raised(&self, thrust: f32, torque: &Vector3<f32>, scale: f32) -> f32 {
        if thrust >= self.greatest.at(&torque.abs(), scale) + self.margin {
            thrust
        } else {
            cold_path();
            math::greater(thrust, self.least(torque, scale))
        }
    }

    /// N(tau), N, for a torque in N m and the thrust scale s.
    #[must_use]
    pub fn least(&self, torque: &Vector3<f32>, scale: f32) -> f32 {
        let floor = self.rotors.iter().map(|floor| floor.at(torque, scale));
        floor.fold(0.0, math::greater) + self.margin
    }
}
