//! The accelerometer's offsets and scales from six standstills, each axis up once and down once.
//!
//! At rest the force is one gravity long, whichever way it points:
//!
//! ```text
//! sum_i s_i^2 (f_ij - o_i)^2 = g^2,   j = 1 … 6
//! ```
//!
//! Six equations for three scales and three offsets, solved by Newton's method in double precision from s = 1 and the
//! means of opposite faces. Only lengths count, so the faces need not be level: 10 degrees off are as good as none.
//! Calibration time, on the ground; a few thousand instructions.

use super::standstill::StandstillMeans;
use core::fmt;
use nalgebra::{Matrix6, Vector3, Vector6};

/// How much of gravity the upper axis must feel: within 30 degrees.
const FACE_COSINE_MIN: f64 = 0.866;

/// The greatest offset, m/s^2, and the greatest error of scale, that are an accelerometer's and no mistake: BMI088, 20
/// mg and 1 % at most, times four.
const OFFSET_MAX_M_PER_S2: f64 = 0.8;
const SCALE_ERROR_MAX: f64 = 0.04;

/// Newton's steps: four suffice from anywhere within those.
const NEWTON_STEPS: usize = 6;

/// Why a calibration failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SixPointError {
    /// This pose has no axis up or down within 30 degrees.
    NoFace,
    /// This face was there before.
    FaceTwice,
    /// Not all six faces yet.
    FaceMissing,
    /// Offsets or scales that no accelerometer of this kind has.
    Implausible,
}

impl fmt::Display for SixPointError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoFace => "Calibration: put one side straight down",
            Self::FaceTwice => "Calibration: this side was down before",
            Self::FaceMissing => "Calibration: not all six sides yet",
            Self::Implausible => "Calibration: accelerometer out of its data sheet",
        })
    }
}

/// Up to six standstills: x, y, z up, then x, y, z down.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SixPoint {
    faces: [Option<Vector3<f32>>; 6],
}

impl SixPoint {
    /// Adds a standstill, in any order of the faces, under `gravity`, m/s^2.
    ///
    /// # Errors
    /// If no axis points up or down, or this one did before.
    pub fn add(&mut self, rest: &StandstillMeans, gravity: f32) -> Result<(), SixPointError> {
        let force = &rest.specific_force;
        let min = FACE_COSINE_MIN as f32 * gravity;
        let wanted = [force.x, force.y, force.z, -force.x, -force.y, -force.z];
        let up = self.faces.iter_mut().zip(wanted).find(|(_, along)| *along >= min);
        let (face, _) = up.ok_or(SixPointError::NoFace)?;
        if face.is_some() {
            return Err(SixPointError::FaceTwice);
        }
        *face = Some(*force);
        Ok(())
    }

    /// Offset (m/s^2) and scale on each axis.
    ///
    /// # Errors
    /// If a face is missing, or no accelerometer of this kind has the result.
    pub fn solve(&self, gravity: f32) -> Result<(Vector3<f32>, Vector3<f32>), SixPointError> {
        let [Some(a), Some(b), Some(c), Some(d), Some(e), Some(f)] = self.faces else {
            return Err(SixPointError::FaceMissing);
        };
        let points = [a, b, c, d, e, f].map(|point| point.cast::<f64>());
        let gravity = f64::from(gravity);
        let middle = |up: f32, down: f32| 0.5 * (f64::from(up) + f64::from(down));
        let mut offset = Vector3::new(middle(a.x, d.x), middle(b.y, e.y), middle(c.z, f.z));
        let mut scale = Vector3::repeat(1.0_f64);
        for _ in 0..NEWTON_STEPS {
            // Residuals and their slopes by scale and offset, in parts of g^2.
            let rows = points.map(|point| {
                let apart = point - offset;
                let scaled = apart.component_mul(&scale);
                let by_scale = scaled.component_mul(&apart) * 2.0;
                let by_offset = -scaled.component_mul(&scale) * 2.0;
                let row = [by_scale.x, by_scale.y, by_scale.z, by_offset.x, by_offset.y, by_offset.z];
                (row, gravity * gravity - scaled.norm_squared())
            });
            let slopes = Matrix6::from_row_iterator(rows.iter().flat_map(|(row, _)| row.iter().copied()));
            let rest = Vector6::from_iterator(rows.iter().map(|(_, rest)| *rest));
            let step = slopes.lu().solve(&rest).ok_or(SixPointError::Implausible)?;
            scale += Vector3::new(step.x, step.y, step.z);
            offset += Vector3::new(step.w, step.a, step.b);
        }
        let plausible = offset.iter().all(|value| value.abs() <= OFFSET_MAX_M_PER_S2)
            && scale.iter().all(|value| (value - 1.0).abs() <= SCALE_ERROR_MAX);
        if plausible {
            Ok((offset.map(|value| value as f32), scale.map(|value| value as f32)))
        } else {
            Err(SixPointError::Implausible)
        }
    }
}

#[cfg(test)]
mod tests;
