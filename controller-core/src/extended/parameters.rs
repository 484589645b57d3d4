//! The constants of the extended law, declared once and validated. Every one has a default from the vehicle's numbers:
//! [`super::defaults`].

use crate::allocation::Rotors;
use crate::constants::{Range, constants};
use crate::error::{ParameterError, Reason, require};
use crate::math;
use crate::vehicle::Vehicle;
use core::ops::Deref;
use nalgebra::Vector4;

constants! {
    /// All constants of the extended law; see [`Extended`] for the validated form. "Across" is both horizontal axes
    /// together.
    pub struct ExtendedParameters {
        /// k_p across, 1/s^2: position gain.
        gains.k_p_across: Range::POSITIVE, SEARCHED;
        /// k_p along the vertical, 1/s^2.
        gains.k_p_vertical: Range::POSITIVE, FIXED;
        /// k_v across, 1/s: velocity gain.
        gains.k_v_across: Range::POSITIVE, SEARCHED;
        /// k_v along the vertical, 1/s.
        gains.k_v_vertical: Range::POSITIVE, SEARCHED;
        /// k_f, 1/s: bandwidth of the filter that makes c.
        gains.k_f: Range::BANDWIDTH, SEARCHED;
        /// k_s, 1/s: bandwidth of the filter before it.
        gains.k_s: Range::BANDWIDTH, FIXED;
        /// k_d, 1/s: bandwidth of the filter before that, which takes noise out.
        gains.k_d: Range::BANDWIDTH, FIXED;
        /// A_h, m/s^2: greatest acceleration across.
        gains.a_across: Range::POSITIVE, FIXED;
        /// A_-, m/s^2: greatest acceleration downwards.
        gains.a_down: Range::POSITIVE, SEARCHED;
        /// gamma, rad: greatest tilt of the thrust direction.
        gains.tilt_max: Range::between(0.1, 1.5), FIXED;
        /// v_c across, m/s: greatest speed of the approach.
        gains.v_across: Range::POSITIVE, SEARCHED;
        /// v_c upwards, m/s.
        gains.v_up: Range::POSITIVE, SEARCHED;
        /// v_c downwards, m/s.
        gains.v_down: Range::POSITIVE, FIXED;
        /// The share of the level across that the approach counts to brake with.
        gains.braking_across: Range::SHARE, SEARCHED;
        /// Likewise along the vertical.
        gains.braking_vertical: Range::SHARE, FIXED;
        /// Omega, rad/s: greatest rate of the thrust direction.
        gains.turn_rate: Range::POSITIVE, SEARCHED;
        /// alpha_0, rad/s^2: the acceleration of the thrust direction that is always there.
        gains.turn_reserve: Range::POSITIVE, FIXED;
        /// k_theta, N m: gain of the tilt's modified Rodrigues parameters; a quarter of it is the stiffness.
        gains.k_tilt: Range::POSITIVE, SEARCHED;
        /// M_theta, N m: greatest torque by which the tilt's error pulls.
        gains.m_tilt: Range::POSITIVE, SEARCHED;
        /// k_omega_t, N m s: damping of the tilt.
        gains.k_omega_t: Range::POSITIVE, SEARCHED;
        /// r_0: sine of half the tilt error beyond which its damping eases.
        gains.r_0: Range::between(1e-3, 1e3), FIXED;
        /// delta: hysteresis of the path lifting; beyond 0.73 the target itself would count as half a turn.
        gains.delta: Range::between(1e-7, 0.7), FIXED;
        /// alpha: distance at which the path lifting's memory follows.
        gains.alpha: Range::between(1e-7, 0.999), FIXED;
        /// A, rad/s^2: the acceleration about the thrust axis that is always there near the target.
        gains.yaw_acceleration: Range::POSITIVE, FIXED;
        /// W_max, rad/s: greatest rate at which a heading error comes to zero.
        gains.yaw_rate: Range::POSITIVE, FIXED;
        /// c_1, 1/s^2: stiffness of the heading.
        gains.c_1: Range::POSITIVE, FIXED;
        /// c_2, 1/s: damping of the heading.
        gains.c_2: Range::POSITIVE, FIXED;
        /// mu_N, N: distance of all rotors together from their least thrust; without rotors the least thrust.
        gains.floor_margin: Range::POSITIVE, FIXED;
        /// D_h, m/s^2: greatest estimate of the force per mass across.
        estimates.force_across: Range::LEVEL, FIXED;
        /// F_h, m/s^2: force across in which the heading is proven to arrive.
        estimates.force_heading: Range::LEVEL, FIXED;
        /// D_z+, m/s^2: greatest estimate upwards.
        estimates.force_up: Range::LEVEL, SEARCHED;
        /// D_z-, m/s^2: greatest estimate downwards.
        estimates.force_down: Range::LEVEL, FIXED;
        /// L across, 1/s: how fast the force is followed.
        estimates.force_bandwidth_across: Range::BANDWIDTH, SEARCHED;
        /// L along the vertical, 1/s.
        estimates.force_bandwidth_vertical: Range::BANDWIDTH, FIXED;
        /// kappa, 1/s: drag across per velocity and mass, known beforehand.
        estimates.drag_across: Range::LEVEL, FIXED;
        /// D_t, N m: greatest torque bias about x and y.
        estimates.torque_tilt: Range::LEVEL, SEARCHED;
        /// D_y, N m: greatest torque bias about z.
        estimates.torque_yaw: Range::LEVEL, FIXED;
        /// L_tau, 1/s: how fast the torque bias is followed.
        estimates.torque_bandwidth: Range::BANDWIDTH, FIXED;
        /// s_lo: least thrust scale.
        estimates.scale_least: Range::between(0.1, 1.0), FIXED;
        /// s_hi: greatest thrust scale.
        estimates.scale_greatest: Range::between(1.0, 10.0), FIXED;
        /// gamma_s, 1/s: how fast the scale is learnt while thrust varies; zero turns it off.
        estimates.scale_rate: Range::between(0.0, 10.0), FIXED;
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
