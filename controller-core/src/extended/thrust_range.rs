//! A least and a greatest thrust that follow the torque: every rotor stays within its range by construction. Section 8
//! of `docs/extended-law.md`.
//!
//! The thrust command of rotor i is f_i = b_T,i T + b_tau,i . tau, with (b_T,i, b_tau,i) its row of B+. So it is within
//! its range as long as T is between
//!
//! ```text
//! N(tau) = max_i ((s f_min,i - b_tau,i . tau) / b_T,i) + margin,
//! C(tau) = min_i ((s f_max,i - b_tau,i . tau) / b_T,i) - margin,
//! ```
//!
//! and T = min(C(tau), max(N(tau), m u . R e3)), at most T_max. The certificate's row (R) proves N <= C for every
//! torque that the law can command. A rotor commanded f / s turns at its least or greatest speed when f is s f_min,i or
//! s f_max,i. A vehicle without rotors has a constant range, from the margin to T_max.
//!
//! The command is nearly always far inside. One comparison on each side for all rotors shows that: the same
//! formulas with the worst of each constant among the rotors and the magnitude of each component of tau. Rounding is
//! monotone, so that the bound is on the safe side of any rotor's part, to the last bit.

use crate::allocation::Rotors;
use crate::allocation::geometry::ROTORS_MAX;
use crate::math;
use core::hint::cold_path;
use heapless::Vec;
use nalgebra::Vector3;

/// One rotor's part: f_min,i / b_T,i, f_max,i / b_T,i and b_tau,i / b_T,i.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Part {
    least: f32,
    greatest: f32,
    per_torque: Vector3<f32>,
}

/// N and C.
#[derive(Debug, Clone, PartialEq)]
pub struct ThrustRange {
    rotors: Vec<Part, ROTORS_MAX>,
    /// The greatest least thrust, the least greatest one, the greatest magnitudes per torque.
    worst: Part,
    margin: f32,
    thrust_max: f32,
}

impl ThrustRange {
    /// For `rotors`, if there are any, a margin and a greatest thrust in N.
    #[must_use]
    pub fn new(rotors: Option<&Rotors>, margin: f32, thrust_max: f32) -> Self {
        let mut parts = Vec::new();
        for (rotor, row) in rotors.into_iter().flat_map(|rotors| rotors.iter().zip(rotors.pseudo_inverse())) {
            let per_torque = Vector3::new(row.y / row.x, row.z / row.x, row.w / row.x).map(|x| x as f32);
            let [least, greatest] =
                [rotor.thrust_min, rotor.thrust_max].map(|thrust| (f64::from(thrust) / row.x) as f32);
            // As many as there are rotors: it fits.
            let _ = parts.push(Part { least, greatest, per_torque });
        }
        let mut worst = Part { least: 0.0, greatest: f32::MAX, per_torque: Vector3::zeros() };
        for part in &parts {
            worst.least = math::greater(worst.least, part.least);
            worst.greatest = math::lesser(worst.greatest, part.greatest);
            worst.per_torque = worst.per_torque.zip_map(&part.per_torque.abs(), math::greater);
        }
        Self { rotors: parts, worst, margin, thrust_max }
    }

    /// The thrust nearest to `thrust` that every rotor can take part in, N, for a torque in N m and the thrust scale s.
    #[must_use]
    #[inline(always)] // see position.rs
    pub fn admitted(&self, thrust: f32, torque: &Vector3<f32>, scale: f32) -> f32 {
        let differences = self.worst.per_torque.dot(&torque.abs()) + self.margin;
        let most = math::lesser(scale * self.worst.greatest - differences, self.thrust_max);
        if thrust >= scale * self.worst.least + differences && thrust <= most {
            thrust
        } else {
            cold_path();
            math::lesser(math::greater(thrust, self.least(torque, scale)), self.greatest(torque, scale))
        }
    }

    /// N(tau), N, for a torque in N m and the thrust scale s.
    #[must_use]
    #[inline(always)] // see position.rs
    pub fn least(&self, torque: &Vector3<f32>, scale: f32) -> f32 {
        let least = self.rotors.iter().map(|part| scale * part.least + (self.margin - part.per_torque.dot(torque)));
        least.fold(self.margin, math::greater)
    }

    /// C(tau), N, likewise; at most T_max.
    #[must_use]
    #[inline(always)] // see position.rs
    pub fn greatest(&self, torque: &Vector3<f32>, scale: f32) -> f32 {
        let greatest =
            self.rotors.iter().map(|part| scale * part.greatest - (part.per_torque.dot(torque) + self.margin));
        greatest.fold(self.thrust_max, math::lesser)
    }
}
