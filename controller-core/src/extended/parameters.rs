//! The constants of the extended law, declared once, each with its default, and validated. A default is a formula of
//! the vehicle's numbers, of what follows from them ([`super::quantities`]) and of other constants, d. Section 14 of
//! `docs/extended-law.md` derives each; `docs/scenario-file.md` shows them.

use super::quantities::Quantities;
use crate::allocation::Rotors;
use crate::constants::{Range, constants};
use crate::error::{ParameterError, Reason, require};
use crate::math::{self, atan, max_f64 as max, min_f64 as min, sqrt_f64 as sqrt};
use crate::vehicle::Vehicle;
use core::ops::Deref;
use nalgebra::Vector4;

constants! {
    /// All constants of the extended law; see [`Extended`] for the validated form. "Across" is both horizontal axes
    /// together.
    pub struct ExtendedParameters by Quantities |d| {
        /// k_p across, 1/s^2: position gain.
        gains.k_p_across: Range::POSITIVE, SEARCHED, 0.55 * d.k_v_across() * d.k_v_across();
        /// k_p along the vertical, 1/s^2.
        gains.k_p_vertical: Range::POSITIVE, FIXED, d.stiffer() * d.stiffer() * (0.55 * d.k_v_across() * d.k_v_across());
        /// k_v across, 1/s: velocity gain.
        gains.k_v_across: Range::POSITIVE, SEARCHED, 0.54 * d.w_a();
        /// k_v along the vertical, 1/s.
        gains.k_v_vertical: Range::POSITIVE, SEARCHED, d.stiffer() * d.k_v_across();
        /// k_f, 1/s: bandwidth of the filter that makes c.
        gains.k_f: Range::BANDWIDTH, SEARCHED, 1.12 * d.w_a();
        /// k_s, 1/s: bandwidth of the filter before it.
        gains.k_s: Range::BANDWIDTH, FIXED, 3.1 * d.k_f();
        /// k_d, 1/s: bandwidth of the filter before that, which takes noise out.
        gains.k_d: Range::BANDWIDTH, FIXED, 1.5 * d.w_a();
        /// A_h, m/s^2: greatest acceleration across.
        gains.a_across: Range::POSITIVE, FIXED, min(max(sqrt(max(d.U() * d.U() - 0.49 * d.g * d.g, 0.0)), 0.5), d.g * d.steepest());
        /// A_-, m/s^2: greatest acceleration downwards.
        gains.a_down: Range::POSITIVE, SEARCHED, 0.63 * d.g;
        /// gamma, rad: greatest tilt of the thrust direction.
        gains.tilt_max: Range::between(0.1, 1.5), FIXED, atan(d.steepest());
        /// v_c across, m/s: greatest speed of the approach.
        gains.v_across: Range::POSITIVE, SEARCHED, 15.0;
        /// v_c upwards, m/s.
        gains.v_up: Range::POSITIVE, SEARCHED, 15.0;
        /// v_c downwards, m/s.
        gains.v_down: Range::POSITIVE, FIXED, 8.0;
        /// The share of the level across that the approach counts to brake with.
        gains.braking_across: Range::SHARE, SEARCHED, 0.7;
        /// Likewise along the vertical.
        gains.braking_vertical: Range::SHARE, FIXED, 0.7;
        /// Omega, rad/s: greatest rate of the thrust direction.
        gains.turn_rate: Range::POSITIVE, SEARCHED, 0.5 * sqrt(d.tilt_torque() / d.J_max());
        /// alpha_0, rad/s^2: the acceleration of the thrust direction that is always there.
        gains.turn_reserve: Range::POSITIVE, FIXED, min(0.13 * d.tilt_torque() / d.J_max(), d.lifted());
        /// k_theta, N m: gain of the tilt's modified Rodrigues parameters; a quarter of it is the stiffness.
        gains.k_tilt: Range::POSITIVE, SEARCHED, 4.0 * d.J() * d.w_a() * d.w_a();
        /// M_theta, N m: greatest torque by which the tilt's error pulls.
        gains.m_tilt: Range::POSITIVE, SEARCHED, 0.95 * (d.tilt_torque() - d.J_max() * d.turn_reserve());
        /// k_omega_t, N m s: damping of the tilt.
        gains.k_omega_t: Range::POSITIVE, SEARCHED, 1.7 * d.w_a() * d.J();
        /// r_0: sine of half the tilt error beyond which its damping eases.
        gains.r_0: Range::between(1e-3, 1e3), FIXED, d.m_tilt() * d.m_tilt() / (8.0 * d.J() * d.w_a() * d.w_a() * d.tilt_torque());
        /// delta: hysteresis of the path lifting; beyond 0.73 the target itself would count as half a turn.
        gains.delta: Range::between(1e-7, 0.7), FIXED, 0.01;
        /// alpha: distance at which the path lifting's memory follows.
        gains.alpha: Range::between(1e-7, 0.999), FIXED, 0.25;
        /// A, rad/s^2: the acceleration about the thrust axis that is always there near the target.
        gains.yaw_acceleration: Range::POSITIVE, FIXED, min(0.5 * d.yaw_torque() / d.J_33, 20.0);
        /// W_max, rad/s: greatest rate at which a heading error comes to zero.
        gains.yaw_rate: Range::POSITIVE, FIXED, min(3.2 * sqrt(d.yaw_acceleration()), 0.4 * d.w_a());
        /// c_1, 1/s^2: stiffness of the heading.
        gains.c_1: Range::POSITIVE, FIXED, d.w_y() * d.w_y();
        /// c_2, 1/s: damping of the heading.
        gains.c_2: Range::POSITIVE, FIXED, 1.5 * d.w_y();
        /// mu_N, N: distance of all rotors together from their least thrust; without rotors the least thrust.
        gains.floor_margin: Range::POSITIVE, FIXED, 0.001 * d.mass * d.g;
        /// D_h, m/s^2: greatest estimate of the force per mass across.
        estimates.force_across: Range::LEVEL, FIXED, 0.98 * d.a_across();
        /// F_h, m/s^2: force across in which the heading is proven to arrive.
        estimates.force_heading: Range::LEVEL, FIXED, min(d.force_across(), 2.5);
        /// D_z+, m/s^2: greatest estimate upwards.
        estimates.force_up: Range::LEVEL, SEARCHED, 0.36 * d.a_down();
        /// D_z-, m/s^2: greatest estimate downwards.
        estimates.force_down: Range::LEVEL, FIXED, max(0.95 * (d.U() - d.g), 0.0);
        /// L across, 1/s: how fast the force is followed.
        estimates.force_bandwidth_across: Range::BANDWIDTH, SEARCHED, 1.5 * d.w_a();
        /// L along the vertical, 1/s.
        estimates.force_bandwidth_vertical: Range::BANDWIDTH, FIXED, min(1.33, 0.95 * d.stiffer()) * (1.5 * d.w_a());
        /// kappa, 1/s: drag across per velocity and mass, known beforehand.
        estimates.drag_across: Range::LEVEL, FIXED, d.drag;
        /// D_t, N m: greatest torque bias about x and y.
        estimates.torque_tilt: Range::LEVEL, SEARCHED, 0.4 * d.tilt_torque();
        /// D_y, N m: greatest torque bias about z.
        estimates.torque_yaw: Range::LEVEL, FIXED, 0.5 * d.torque_max_z;
        /// L_tau, 1/s: how fast the torque bias is followed.
        estimates.torque_bandwidth: Range::BANDWIDTH, FIXED, 2.0;
        /// s_lo: least thrust scale.
        estimates.scale_least: Range::between(0.1, 1.0), FIXED, 1.0 - d.thrust_loss;
        /// s_hi: greatest thrust scale.
        estimates.scale_greatest: Range::between(1.0, 10.0), FIXED, 1.0 + d.thrust_gain;
        /// gamma_s, 1/s: how fast the scale is learnt while thrust varies; zero turns it off.
        estimates.scale_rate: Range::between(0.0, 10.0), FIXED, 0.3;
    }
}

/// Constants for which the extended law is defined and the certificate's allowance for arithmetic holds. Reads like its
/// [`ExtendedParameters`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extended(ExtendedParameters);

impl Extended {
    /// The least margin of the thrust floor, as a share of the greatest thrust: rounding in single precision takes less
    /// of it on the way from a wanted thrust and yaw torque to a rotor's command (`proofs/Rounding.v`).
    pub const FLOOR_MARGIN_SHARE_MIN: f32 = 4e-6;

    /// What a number of the thrust range's constants is at least, in SI units, and its inverse at most
    /// (`proofs/Rounding.v`).
    const SIZE_MIN: f64 = 1e-4;

    /// Checks every constant, and that the command never pushes down.
    ///
    /// # Errors
    /// Names the first field that is out of its range.
    pub fn new(parameters: ExtendedParameters, vehicle: &Vehicle) -> Result<Self, ParameterError> {
        parameters.check()?;
        for (value, bound, field) in [
            (parameters.a_down, vehicle.gravity, "gains.a_down"),
            (parameters.force_up, parameters.a_down, "estimates.force_up"),
            (parameters.force_across, parameters.a_across, "estimates.force_across"),
        ] {
            require(value < bound, field, Reason::NotBelow(bound))?;
        }
        Ok(Self(parameters))
    }

    /// Checks that thrust lifts every one of `rotors`, and that the margin of the thrust floor covers the rounding of
    /// their commands. Sizes are those of the proof: a rotor's share of the thrust is at least 1e-4, and no torque per
    /// thrust beyond 1e4.
    ///
    /// # Errors
    /// Names `rotors.position` or `gains.floor_margin`.
    pub fn check_rotors(&self, rotors: &Rotors) -> Result<(), ParameterError> {
        let lifted = rotors.pseudo_inverse().iter().all(|row| {
            let most = row.y.abs() + row.z.abs() + row.w.abs();
            row.x >= Self::SIZE_MIN && Self::SIZE_MIN * most <= row.x
        });
        require(lifted, "rotors.position", Reason::DoesNotSpan)?;
        // All rotors' torques together, which are more than what the tilt may get.
        let most = |arm: fn(&Vector4<f64>) -> f64| -> f64 {
            let all = rotors.iter().zip(rotors.effectiveness());
            all.map(|(rotor, column)| f64::from(rotor.thrust_max) * arm(column).abs()).sum()
        };
        let [roll, pitch] = [most(|column| column.y), most(|column| column.z)];
        let all = rotors.iter().zip(rotors.pseudo_inverse());
        let sizes = all.map(|(rotor, row)| {
            let parts = (row.y.abs() * roll + row.z.abs() * pitch) / row.x;
            math::max_f64(f64::from(rotor.thrust_max) / row.x, 0.5 * parts)
        });
        let greatest = sizes.fold(0.0, math::max_f64);
        let least = Self::FLOOR_MARGIN_SHARE_MIN * self.scale_greatest * greatest as f32;
        require(self.floor_margin >= least, "gains.floor_margin", Reason::Below(least))
    }
}

impl Deref for Extended {
    type Target = ExtendedParameters;

    fn deref(&self) -> &ExtendedParameters {
        &self.0
    }
}
