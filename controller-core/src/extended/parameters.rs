//! The constants of the extended law, validated.

use crate::error::{ParameterError, Reason, require, require_finite, require_positive};
use crate::vehicle::Vehicle;
use core::ops::Deref;

/// The position law: [`super::position`]. "Across" is both horizontal axes together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PositionParameters {
    /// Position gain across, 1/s^2.
    pub k_p_across: f32,
    /// Position gain along the vertical, 1/s^2.
    pub k_p_vertical: f32,
    /// Velocity gain across, 1/s.
    pub k_v_across: f32,
    /// Velocity gain along the vertical, 1/s.
    pub k_v_vertical: f32,
    /// Bandwidth of the second filter (u_f) across, 1/s.
    pub k_f_across: f32,
    /// Bandwidth of the second filter along the vertical, 1/s.
    pub k_f_vertical: f32,
    /// Bandwidth of the first filter (u_s) across, 1/s.
    pub k_s_across: f32,
    /// Bandwidth of the first filter along the vertical, 1/s.
    pub k_s_vertical: f32,
    /// M_h: greatest feedback across, m/s^2.
    pub m_across: f32,
    /// M_z+: greatest feedback upwards, m/s^2.
    pub m_up: f32,
    /// M_z-: greatest feedback downwards, m/s^2.
    pub m_down: f32,
    /// Speed of the approach across, m/s.
    pub v_across: f32,
    /// Speed of the approach upwards, m/s.
    pub v_up: f32,
    /// Speed of the approach downwards, m/s.
    pub v_down: f32,
}

/// The attitude law: [`super::attitude`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttitudeParameters {
    /// w: weight of the potential that knows no axis, N m.
    pub w: f32,
    /// eta: the share of w that turns about the thrust axis, in (0, 1).
    pub eta: f32,
    /// k_t: gain of the tilt's own potential, N m.
    pub k_t: f32,
    /// M_t: its level, N m.
    pub m_t: f32,
    /// eta_t: how far from a half turn it eases, in (0, 1].
    pub eta_t: f32,
    /// Damping of the tilt, N m s.
    pub k_omega_t: f32,
    /// Its level, N m.
    pub m_omega_t: f32,
    /// Damping about the thrust axis, N m s.
    pub k_omega_z: f32,
    /// Its level, N m.
    pub m_omega_z: f32,
    /// By how much the tilt's damping eases towards a half turn, in [0, 1).
    pub ease: f32,
    /// Hysteresis of the path lifting, in (0, 1].
    pub delta: f32,
    /// Distance at which the path lifting's memory follows, in (0, 1).
    pub alpha: f32,
}

/// The heading generator: [`super::heading`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeadingParameters {
    /// A: greatest |W'|, rad/s^2.
    pub acceleration: f32,
    /// Greatest |W|, rad/s.
    pub rate: f32,
    /// c_1, 1/s^2.
    pub c_1: f32,
    /// c_2, 1/s.
    pub c_2: f32,
}

/// The estimates: [`super::force`], [`super::torque_bias`], [`super::thrust_scale`]. A level of zero turns one off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EstimateParameters {
    /// Greatest estimate along each horizontal axis, m/s^2.
    pub force_across: f32,
    /// Greatest estimate along the vertical, m/s^2.
    pub force_vertical: f32,
    /// k_d across: how fast small changes are followed, 1/s.
    pub force_bandwidth_across: f32,
    /// k_d along the vertical, 1/s.
    pub force_bandwidth_vertical: f32,
    /// Greatest second derivative along each horizontal axis, m/s^4.
    pub force_snap_across: f32,
    /// Greatest second derivative along the vertical, m/s^4.
    pub force_snap_vertical: f32,
    /// L across: how fast accelerations are averaged, 1/s.
    pub force_smoothing_across: f32,
    /// L along the vertical, 1/s.
    pub force_smoothing_vertical: f32,
    /// kappa: drag across per velocity and mass, known beforehand, 1/s.
    pub drag_across: f32,
    /// Greatest torque bias about x and y, N m.
    pub torque_tilt: f32,
    /// Greatest torque bias about z, N m.
    pub torque_yaw: f32,
    /// How fast torques are averaged, 1/s.
    pub torque_smoothing: f32,
    /// Least thrust scale, in (0, 1].
    pub scale_least: f32,
    /// Greatest thrust scale, at least 1.
    pub scale_greatest: f32,
    /// How fast the scale is learnt, 1/s.
    pub scale_rate: f32,
}

impl EstimateParameters {
    /// No estimate at all.
    pub const OFF: Self = Self {
        force_across: 0.0,
        force_vertical: 0.0,
        force_bandwidth_across: 1.0,
        force_bandwidth_vertical: 1.0,
        force_snap_across: 0.0,
        force_snap_vertical: 0.0,
        force_smoothing_across: 1.0,
        force_smoothing_vertical: 1.0,
        drag_across: 0.0,
        torque_tilt: 0.0,
        torque_yaw: 0.0,
        torque_smoothing: 1.0,
        scale_least: 1.0,
        scale_greatest: 1.0,
        scale_rate: 0.0,
    };
}

/// All constants of the extended law; see [`Extended`] for the validated form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExtendedParameters {
    /// The position law.
    pub position: PositionParameters,
    /// The attitude law.
    pub attitude: AttitudeParameters,
    /// The heading generator.
    pub heading: HeadingParameters,
    /// The estimates.
    pub estimates: EstimateParameters,
    /// How far above its least thrust each rotor is kept, N for all rotors together; without rotors the least thrust itself.
    pub floor_margin: f32,
}

/// Constants for which the extended law is defined and the certificate's allowance for arithmetic holds. Reads like its
/// [`ExtendedParameters`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extended(ExtendedParameters);

impl Extended {
    /// The least bandwidth of a filter, 1/s: slower ones add up more rounding than the certificate allows for.
    pub const BANDWIDTH_LEAST: f32 = 0.2;

    /// The greatest bandwidth of a filter, 1/s.
    pub const BANDWIDTH_GREATEST: f32 = 100.0;

    /// The greatest of all other gains and levels: products with the largest accepted states stay finite.
    pub const GREATEST: f32 = 1e3;

    /// The least of all gains and levels that must not be zero: their squares stay above zero, so that no saturation divides by it.
    pub const LEAST: f32 = 1e-7;

    /// The least margin of the thrust floor, in weights: rounding in single precision moves a rotor's thrust by a tenth of it at most, up to
    /// ten times the thrust that hovers.
    pub const FLOOR_MARGIN_LEAST: f32 = 1e-5;

    /// Checks every constant, and that the vehicle can never be asked to push down.
    ///
    /// # Errors
    /// Names the first field that is out of its range.
    pub fn new(parameters: ExtendedParameters, vehicle: &Vehicle) -> Result<Self, ParameterError> {
        let ExtendedParameters { position: p, attitude: a, heading: h, estimates: e, floor_margin } = &parameters;
        for (value, field) in [
            (p.k_f_across, "gains.k_f_across"),
            (p.k_f_vertical, "gains.k_f_vertical"),
            (p.k_s_across, "gains.k_s_across"),
            (p.k_s_vertical, "gains.k_s_vertical"),
            (e.force_bandwidth_across, "estimates.force_bandwidth_across"),
            (e.force_bandwidth_vertical, "estimates.force_bandwidth_vertical"),
            (e.force_smoothing_across, "estimates.force_smoothing_across"),
            (e.force_smoothing_vertical, "estimates.force_smoothing_vertical"),
            (e.torque_smoothing, "estimates.torque_smoothing"),
        ] {
            require_finite(value, field)?;
            require(value >= Self::BANDWIDTH_LEAST, field, Reason::Below(Self::BANDWIDTH_LEAST))?;
            require(value <= Self::BANDWIDTH_GREATEST, field, Reason::Above(Self::BANDWIDTH_GREATEST))?;
        }
        for (value, field) in [
            (p.k_p_across, "gains.k_p_across"),
            (p.k_p_vertical, "gains.k_p_vertical"),
            (p.k_v_across, "gains.k_v_across"),
            (p.k_v_vertical, "gains.k_v_vertical"),
            (p.m_across, "gains.m_across"),
            (p.m_up, "gains.m_up"),
            (p.m_down, "gains.m_down"),
            (p.v_across, "gains.v_across"),
            (p.v_up, "gains.v_up"),
            (p.v_down, "gains.v_down"),
            (a.w, "gains.w"),
            (a.k_t, "gains.k_t"),
            (a.m_t, "gains.m_t"),
            (a.k_omega_t, "gains.k_omega_t"),
            (a.m_omega_t, "gains.m_omega_t"),
            (a.k_omega_z, "gains.k_omega_z"),
            (a.m_omega_z, "gains.m_omega_z"),
            (h.acceleration, "gains.yaw_acceleration"),
            (h.rate, "gains.yaw_rate"),
            (h.c_1, "gains.c_1"),
            (h.c_2, "gains.c_2"),
        ] {
            require_positive(value, field)?;
            require(value > Self::LEAST, field, Reason::NotAbove(Self::LEAST))?;
            require(value < Self::GREATEST, field, Reason::NotBelow(Self::GREATEST))?;
        }
        for (value, field) in [
            (e.force_across, "estimates.force_across"),
            (e.force_vertical, "estimates.force_vertical"),
            (e.force_snap_across, "estimates.force_snap_across"),
            (e.force_snap_vertical, "estimates.force_snap_vertical"),
            (e.drag_across, "estimates.drag_across"),
            (e.torque_tilt, "estimates.torque_tilt"),
            (e.torque_yaw, "estimates.torque_yaw"),
            (e.scale_rate, "estimates.scale_rate"),
        ] {
            require_finite(value, field)?;
            require(value >= 0.0, field, Reason::Negative)?;
            require(value < Self::GREATEST, field, Reason::NotBelow(Self::GREATEST))?;
        }
        for (value, most, field) in [
            (a.eta, 1.0, "gains.eta"),
            (a.eta_t, 1.0, "gains.eta_t"),
            (a.delta, 1.0, "gains.delta"),
            (a.alpha, 1.0, "gains.alpha"),
        ] {
            require_positive(value, field)?;
            require(value > Self::LEAST, field, Reason::NotAbove(Self::LEAST))?;
            require(value <= most, field, Reason::Above(most))?;
        }
        require_positive(*floor_margin, "gains.floor_margin")?;
        let least = Self::FLOOR_MARGIN_LEAST * vehicle.mass * vehicle.gravity;
        require(*floor_margin >= least, "gains.floor_margin", Reason::Below(least))?;
        require(*floor_margin < Self::GREATEST, "gains.floor_margin", Reason::NotBelow(Self::GREATEST))?;
        require(a.alpha < 1.0, "gains.alpha", Reason::NotBelow(1.0))?;
        require(a.ease >= 0.0, "gains.ease", Reason::Negative)?;
        require(a.ease < 1.0, "gains.ease", Reason::NotBelow(1.0))?;
        require(e.scale_least > 0.1, "estimates.scale_least", Reason::NotAbove(0.1))?;
        require(e.scale_least <= 1.0, "estimates.scale_least", Reason::Above(1.0))?;
        require(e.scale_greatest >= 1.0, "estimates.scale_greatest", Reason::Below(1.0))?;
        require(e.scale_greatest < 10.0, "estimates.scale_greatest", Reason::NotBelow(10.0))?;
        let extended = Self(parameters);
        require(extended.greatest_fall() < vehicle.gravity, "gains.m_down", Reason::NotBelow(vehicle.gravity))?;
        Ok(extended)
    }

    /// M_z- + D_z, m/s^2: how far below g + p_d'' the vertical command may be.
    #[must_use]
    pub fn greatest_fall(&self) -> f32 {
        self.position.m_down + self.estimates.force_vertical
    }
}

impl Deref for Extended {
    type Target = ExtendedParameters;

    fn deref(&self) -> &ExtendedParameters {
        &self.0
    }
}
