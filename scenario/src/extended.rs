//! `[gains]` and `[estimates]` of the extended law, `[control] law = "extended"`.
//!
//! ```toml
//! [control]
//! law = "extended"
//!
//! [estimates]                # may be left out: then nothing is estimated
//! force_across = 3.4         # m/s^2, level of the estimate along each horizontal axis
//! …
//! ```
//!
//! Every key is a field of [`ExtendedParameters`] under the same name; `docs/scenario-file.md` lists them.

use crate::section::{FieldError, Section};
use controller_core::certificate::configuration::ExtendedLaw;
use controller_core::extended::actuators::{ActuatorModel, ActuatorParameters, DELAY_MAX};
use controller_core::extended::controller::Controller;
use controller_core::extended::parameters::{
    AttitudeParameters, EstimateParameters, Extended, ExtendedParameters, HeadingParameters, PositionParameters,
};
use controller_core::vehicle::Vehicle;

/// The keys of `[gains]`.
pub const GAINS: [&str; 31] = [
    "k_p_across",
    "k_p_vertical",
    "k_v_across",
    "k_v_vertical",
    "k_f_across",
    "k_f_vertical",
    "k_s_across",
    "k_s_vertical",
    "m_across",
    "m_up",
    "m_down",
    "v_across",
    "v_up",
    "v_down",
    "w",
    "eta",
    "k_t",
    "m_t",
    "eta_t",
    "k_omega_t",
    "m_omega_t",
    "k_omega_z",
    "m_omega_z",
    "ease",
    "delta",
    "alpha",
    "yaw_acceleration",
    "yaw_rate",
    "c_1",
    "c_2",
    "floor_margin",
];

/// The keys of `[estimates]`.
pub const ESTIMATES: [&str; 15] = [
    "force_across",
    "force_vertical",
    "force_bandwidth_across",
    "force_bandwidth_vertical",
    "force_snap_across",
    "force_snap_vertical",
    "force_smoothing_across",
    "force_smoothing_vertical",
    "drag_across",
    "torque_tilt",
    "torque_yaw",
    "torque_smoothing",
    "scale_least",
    "scale_greatest",
    "scale_rate",
];

/// Reads both sections for `vehicle`, rotors that respond as `actuators` says, and ticks `period` seconds apart.
///
/// # Errors
/// Names the field that is missing, unknown or refused.
pub fn read_extended(
    root: &Section,
    vehicle: &Vehicle,
    actuators: ActuatorParameters,
    period: f64,
) -> Result<ExtendedLaw, FieldError> {
    let parameters = read_gains(&root.section("gains")?, read_estimates(root)?)?;
    let parameters = Extended::new(parameters, vehicle).map_err(|error| root.refused(&error))?;
    Controller::check_period(&parameters, period as f32).map_err(|error| root.refused(&error))?;
    check_delay(root, &actuators, period)?;
    Ok(ExtendedLaw { parameters, actuators })
}

/// Refuses a delay that the law's model of its actuators has no memory for.
fn check_delay(root: &Section, actuators: &ActuatorParameters, period: f64) -> Result<(), FieldError> {
    const MOST: usize = DELAY_MAX - 1;
    ActuatorModel::new(actuators, period as f32).map(|_| ()).map_err(|_| {
        let field = if root.has("sampling") { "sampling.delay" } else { "sensors.delay" };
        let longest = MOST as f64 * period;
        let problem = format!(
            "under the extended law must be, both delays together, at most {MOST} control periods, {longest} s, found {} s",
            actuators.delay
        );
        FieldError::new(field, problem)
    })
}

fn read_gains(section: &Section, estimates: EstimateParameters) -> Result<ExtendedParameters, FieldError> {
    section.allow(&GAINS)?;
    let gain = |key: &str| section.number(key).map(|value| value as f32);
    Ok(ExtendedParameters {
        position: PositionParameters {
            k_p_across: gain("k_p_across")?,
            k_p_vertical: gain("k_p_vertical")?,
            k_v_across: gain("k_v_across")?,
            k_v_vertical: gain("k_v_vertical")?,
            k_f_across: gain("k_f_across")?,
            k_f_vertical: gain("k_f_vertical")?,
            k_s_across: gain("k_s_across")?,
            k_s_vertical: gain("k_s_vertical")?,
            m_across: gain("m_across")?,
            m_up: gain("m_up")?,
            m_down: gain("m_down")?,
            v_across: gain("v_across")?,
            v_up: gain("v_up")?,
            v_down: gain("v_down")?,
        },
        attitude: AttitudeParameters {
            w: gain("w")?,
            eta: gain("eta")?,
            k_t: gain("k_t")?,
            m_t: gain("m_t")?,
            eta_t: gain("eta_t")?,
            k_omega_t: gain("k_omega_t")?,
            m_omega_t: gain("m_omega_t")?,
            k_omega_z: gain("k_omega_z")?,
            m_omega_z: gain("m_omega_z")?,
            ease: gain("ease")?,
            delta: gain("delta")?,
            alpha: gain("alpha")?,
        },
        heading: HeadingParameters {
            acceleration: gain("yaw_acceleration")?,
            rate: gain("yaw_rate")?,
            c_1: gain("c_1")?,
            c_2: gain("c_2")?,
        },
        estimates,
        floor_margin: gain("floor_margin")?,
    })
}

/// Reads `[estimates]`; what is left out is off.
fn read_estimates(root: &Section) -> Result<EstimateParameters, FieldError> {
    let off = EstimateParameters::OFF;
    let Some(section) = root.optional_section("estimates")? else {
        return Ok(off);
    };
    section.allow(&ESTIMATES)?;
    let value = |key: &str, off: f32| section.number_or(key, f64::from(off)).map(|value| value as f32);
    Ok(EstimateParameters {
        force_across: value("force_across", off.force_across)?,
        force_vertical: value("force_vertical", off.force_vertical)?,
        force_bandwidth_across: value("force_bandwidth_across", off.force_bandwidth_across)?,
        force_bandwidth_vertical: value("force_bandwidth_vertical", off.force_bandwidth_vertical)?,
        force_snap_across: value("force_snap_across", off.force_snap_across)?,
        force_snap_vertical: value("force_snap_vertical", off.force_snap_vertical)?,
        force_smoothing_across: value("force_smoothing_across", off.force_smoothing_across)?,
        force_smoothing_vertical: value("force_smoothing_vertical", off.force_smoothing_vertical)?,
        drag_across: value("drag_across", off.drag_across)?,
        torque_tilt: value("torque_tilt", off.torque_tilt)?,
        torque_yaw: value("torque_yaw", off.torque_yaw)?,
        torque_smoothing: value("torque_smoothing", off.torque_smoothing)?,
        scale_least: value("scale_least", off.scale_least)?,
        scale_greatest: value("scale_greatest", off.scale_greatest)?,
        scale_rate: value("scale_rate", off.scale_rate)?,
    })
}
