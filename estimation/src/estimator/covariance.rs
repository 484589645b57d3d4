//! How far off the nominal state may be: the covariance of the error, 15 by 15, written out in blocks of 3 by 3.
//!
//! The error is (dp, dv, theta, db_g, db_a): true less nominal, and for the attitude q_true = exp(theta) * q, in world
//! axes. Over an increment of h seconds it moves as
//!
//! ```text
//! dp' = dv      dv' = -[f]x theta - R db_a      theta' = -R db_g       f = R (f_m - b_a), world
//! ```
//!
//! With the attitude's error in world axes, theta does not turn with the body and nothing is singular. The transition
//! is made as a product of shears, each of which adds a multiple of one part of the error to another, in an order that
//! reads the same from both ends, so that it is right to second order in h:
//!
//! ```text
//! dp += h/2 dv;   theta += G db_g;   dv += S theta + A db_a;   theta += G db_g;   dp += h/2 dv
//! G = -h/2 R,   S = -[R d]x,   A = -h R
//! ```
//!
//! A shear costs as many products as it has blocks, keeps every symmetry and keeps P positive definite, rounding apart.
//! R is that of the increment's middle. Then the noise of h seconds is added; and where a sensor was at full scale,
//! what that may have left out of the velocity (`CLIPPED_VELOCITY_M_PER_S`) or of the turn (`CLIPPED_ANGLE_RAD`).
//!
//! A measured part x (position, velocity or attitude) with noise covariance V and residual r is fused with
//!
//! ```text
//! S = P_xx + V,   K_j = P_jx S^-1,   error += K r,   P_ij -= K_i P_xj,   P_xj = V S^-1 P_xj
//! ```
//!
//! where the last form of the measured rows, the same in exact arithmetic, subtracts nothing: a position known to 10 m
//! before and to 1 mm after stays positive in single precision. Source of the equations: J. Sola, *Quaternion
//! kinematics for the error-state Kalman filter*, 2017, chapters 5 to 7 (global angular error).

use super::history::Clipped;
use super::nominal::IncrementEffect;
use super::settings::EstimatorParameters;
use controller_core::math;
use nalgebra::{Matrix3, Vector3};

/// The deviation of what the accelerometer may have missed of a change of velocity within an increment, in any
/// direction, m/s: in a touchdown at a few metres a second, nearly all of it.
const CLIPPED_VELOCITY_M_PER_S: f32 = 1.0;

/// The deviation of what the gyro may have missed of a turn within an increment, about any axis, rad: 5 ms at twice the
/// range of 2000 deg/s, of which it showed one half, are 0.17.
const CLIPPED_ANGLE_RAD: f32 = 0.1;

/// The upper blocks of P; p, v, t(heta), g(yro's bias), a(ccelerometer's bias). SI units, radians.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs)] // each is what its name says
pub struct Covariance {
    pub pp: Matrix3<f32>,
    pub pv: Matrix3<f32>,
    pub pt: Matrix3<f32>,
    pub pg: Matrix3<f32>,
    pub pa: Matrix3<f32>,
    pub vv: Matrix3<f32>,
    pub vt: Matrix3<f32>,
    pub vg: Matrix3<f32>,
    pub va: Matrix3<f32>,
    pub tt: Matrix3<f32>,
    pub tg: Matrix3<f32>,
    pub ta: Matrix3<f32>,
    pub gg: Matrix3<f32>,
    pub ga: Matrix3<f32>,
    pub aa: Matrix3<f32>,
}

/// A part of the state that can be measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Position,
    Velocity,
    Attitude,
}

/// What to add to the nominal state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Correction {
    pub position: Vector3<f32>,
    pub velocity: Vector3<f32>,
    pub attitude: Vector3<f32>,
    pub gyro_bias: Vector3<f32>,
    pub accelerometer_bias: Vector3<f32>,
}

impl Covariance {
    /// Independent errors with these deviations, in the order of the error.
    pub(super) fn diagonal(deviations: [f32; 5]) -> Self {
        let [pp, vv, tt, gg, aa] = deviations.map(|deviation| Matrix3::from_diagonal_element(deviation * deviation));
        let zero = Matrix3::zeros();
        Self {
            pp,
            pv: zero,
            pt: zero,
            pg: zero,
            pa: zero,
            vv,
            vt: zero,
            vg: zero,
            va: zero,
            tt,
            tg: zero,
            ta: zero,
            gg,
            ga: zero,
            aa,
        }
    }

    /// The block of a measured part alone.
    pub(super) fn block(&self, part: Part) -> &Matrix3<f32> {
        match part {
            Part::Position => &self.pp,
            Part::Velocity => &self.vv,
            Part::Attitude => &self.tt,
        }
    }

    /// Whether every variance is a positive number.
    pub(super) fn is_positive(&self) -> bool {
        let diagonals = [&self.pp, &self.vv, &self.tt, &self.gg, &self.aa];
        diagonals.iter().all(|block| {
            let Vector3 { data, .. } = block.diagonal();
            data.0.iter().flatten().all(|&variance| variance > 0.0 && variance < f32::MAX)
        })
    }

    /// Carries P through what the nominal state went through.
    pub(super) fn advance(&mut self, motion: &IncrementEffect, noise: &EstimatorParameters) {
        let h = motion.seconds;
        let turned_bias = motion.rotation * (-0.5 * h);
        self.shear_position(0.5 * h);
        self.shear_attitude(&turned_bias);
        self.shear_velocity(&-motion.velocity_change.cross_matrix(), &(turned_bias * 2.0));
        self.shear_attitude(&turned_bias);
        self.shear_position(0.5 * h);
        for (block, density) in [
            (&mut self.vv, noise.accelerometer_noise),
            (&mut self.tt, noise.gyro_noise),
            (&mut self.gg, noise.gyro_walk),
            (&mut self.aa, noise.accelerometer_walk),
        ] {
            let variance = density * density * h;
            block.m11 += variance;
            block.m22 += variance;
            block.m33 += variance;
        }
        let Clipped { gyro, accelerometer } = motion.clipped;
        for (block, missed, deviation) in
            [(&mut self.vv, accelerometer, CLIPPED_VELOCITY_M_PER_S), (&mut self.tt, gyro, CLIPPED_ANGLE_RAD)]
        {
            if missed {
                // Alike in every direction: a narrow doubt would not survive single precision.
                *block += Matrix3::from_diagonal_element(deviation * deviation);
            }
        }
    }

    /// dp += h dv.
    fn shear_position(&mut self, h: f32) {
        let mixed = self.pv + self.vv * h;
        self.pp += (self.pv.transpose() + mixed) * h;
        self.pp = symmetric(&self.pp);
        self.pv = mixed;
        self.pt += self.vt * h;
        self.pg += self.vg * h;
        self.pa += self.va * h;
    }

    /// theta += G db_g.
    fn shear_attitude(&mut self, g: &Matrix3<f32>) {
        let gt = g.transpose();
        let before = self.tg.transpose();
        self.pt += self.pg * gt;
        self.vt += self.vg * gt;
        self.tg += g * self.gg;
        self.ta += g * self.ga;
        self.tt += self.tg * gt + g * before;
        self.tt = symmetric(&self.tt);
    }

    /// dv += S theta + A db_a.
    fn shear_velocity(&mut self, s: &Matrix3<f32>, a: &Matrix3<f32>) {
        let (st, at) = (s.transpose(), a.transpose());
        let before = s * self.vt.transpose() + a * self.va.transpose();
        self.pv += self.pt * st + self.pa * at;
        self.vt += s * self.tt + a * self.ta.transpose();
        self.vg += s * self.tg + a * self.ga.transpose();
        self.va += s * self.ta + a * self.aa;
        self.vv += self.vt * st + self.va * at + before;
        self.vv = symmetric(&self.vv);
    }

    /// Takes a measurement of `part` into account: `residual` is measured less nominal, `noise` its covariance,
    /// `weight` the inverse of P_xx + noise.
    pub(super) fn fuse(
        &mut self,
        part: Part,
        residual: &Vector3<f32>,
        noise: &Matrix3<f32>,
        weight: &Matrix3<f32>,
    ) -> Correction {
        let [p, v, t, g, a] = self.row(part);
        let [kp, kv, kt, kg, ka] = [p, v, t, g, a].map(|block| block.transpose() * weight);
        self.pp = symmetric(&(self.pp - kp * p));
        self.pv -= kp * v;
        self.pt -= kp * t;
        self.pg -= kp * g;
        self.pa -= kp * a;
        self.vv = symmetric(&(self.vv - kv * v));
        self.vt -= kv * t;
        self.vg -= kv * g;
        self.va -= kv * a;
        self.tt = symmetric(&(self.tt - kt * t));
        self.tg -= kt * g;
        self.ta -= kt * a;
        self.gg = symmetric(&(self.gg - kg * g));
        self.ga -= kg * a;
        self.aa = symmetric(&(self.aa - ka * a));
        let rest = noise * weight;
        self.set_row(part, &[p, v, t, g, a].map(|block| rest * block));
        Correction {
            position: kp * residual,
            velocity: kv * residual,
            attitude: kt * residual,
            gyro_bias: kg * residual,
            accelerometer_bias: ka * residual,
        }
    }

    /// Turns the world frame's part of the error that stays (dv) by `rotation`, and makes position and attitude as
    /// certain as a pose that says all there is to know of them.
    pub(super) fn rebase(
        &mut self,
        rotation: &Matrix3<f32>,
        position: &Matrix3<f32>,
        attitude: &Matrix3<f32>,
        speed_squared: f32,
    ) {
        let zero = Matrix3::zeros();
        // The velocity is turned by an angle that is as uncertain as both attitudes.
        let turned = (self.tt + attitude) * speed_squared;
        self.vv = symmetric(&(rotation * self.vv * rotation.transpose())) + Matrix3::identity() * turned.trace();
        self.vg = rotation * self.vg;
        self.va = rotation * self.va;
        (self.pp, self.tt) = (*position, *attitude);
        (self.pv, self.pt, self.pg, self.pa) = (zero, zero, zero, zero);
        (self.vt, self.tg, self.ta) = (zero, zero, zero);
    }

    /// The blocks P_xj of a measured part x.
    fn row(&self, part: Part) -> [Matrix3<f32>; 5] {
        match part {
            Part::Position => [self.pp, self.pv, self.pt, self.pg, self.pa],
            Part::Velocity => [self.pv.transpose(), self.vv, self.vt, self.vg, self.va],
            Part::Attitude => [self.pt.transpose(), self.vt.transpose(), self.tt, self.tg, self.ta],
        }
    }

    fn set_row(&mut self, part: Part, [p, v, t, g, a]: &[Matrix3<f32>; 5]) {
        match part {
            Part::Position => (self.pp, self.pv, self.pt, self.pg, self.pa) = (symmetric(p), *v, *t, *g, *a),
            Part::Velocity => (self.pv, self.vv, self.vt, self.vg, self.va) = (p.transpose(), symmetric(v), *t, *g, *a),
            Part::Attitude => {
                (self.pt, self.vt, self.tt, self.tg, self.ta) = (p.transpose(), v.transpose(), symmetric(t), *g, *a);
            }
        }
    }
}

/// The symmetric part of `m`.
fn symmetric(m: &Matrix3<f32>) -> Matrix3<f32> {
    let (xy, xz, yz) = (0.5 * (m.m12 + m.m21), 0.5 * (m.m13 + m.m31), 0.5 * (m.m23 + m.m32));
    Matrix3::new(m.m11, xy, xz, xy, m.m22, yz, xz, yz, m.m33)
}

/// The inverse of a symmetric positive definite matrix by its Cholesky factor; none if it is not positive definite.
pub(super) fn inverse(m: &Matrix3<f32>) -> Option<Matrix3<f32>> {
    let l11 = positive_root(m.m11)?;
    let (l21, l31) = (m.m21 / l11, m.m31 / l11);
    let l22 = positive_root(m.m22 - l21 * l21)?;
    let l32 = (m.m32 - l31 * l21) / l22;
    let l33 = positive_root(m.m33 - l31 * l31 - l32 * l32)?;
    // The inverse of the factor, and its square.
    let (i11, i22, i33) = (1.0 / l11, 1.0 / l22, 1.0 / l33);
    let i21 = -l21 * i11 * i22;
    let i32 = -l32 * i22 * i33;
    let i31 = -(l31 * i11 + l32 * i21) * i33;
    let (xy, xz, yz) = (i21 * i22 + i31 * i32, i31 * i33, i32 * i33);
    let (xx, yy, zz) = (i11 * i11 + i21 * i21 + i31 * i31, i22 * i22 + i32 * i32, i33 * i33);
    Some(Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz))
}

fn positive_root(x: f32) -> Option<f32> {
    if x > 0.0 && x < f32::MAX { Some(math::sqrt(x)) } else { None }
}

#[cfg(test)]
mod tests;
