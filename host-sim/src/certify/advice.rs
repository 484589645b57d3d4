//! The limits of a vehicle under the extended law, in plain words: the meaning of each inequality and each loop, and
//! which number to change.

use scenario::sampled_loop::Axis;
use scenario::stability::{Lack, Shortfall};

/// The meaning of an inequality, and which number to change in which direction; empty for a name that the extended
/// law's certificate does not have.
#[must_use]
pub fn of_inequality(name: &str) -> &'static str {
    match name {
        "T1 fall A_- < g - K_a3" => {
            "falling. The law may fall with gains.a_down while the reference falls with \
             reference_bounds.vertical_acceleration: both at once must leave some of gravity to push against. Lower \
             one of them."
        }
        "A1 thrust against force across" => {
            "thrust, against a force across. Weight, the reference and a force of estimates.force_across must be \
             held at once, by rotors that deliver only estimates.scale_least. Lower force_across (less wind is \
             held), or reference_bounds.horizontal_acceleration; or fly lighter."
        }
        "A1 thrust against force down" => {
            "thrust, against a force down. Weight, the reference and a force of estimates.force_down must be held at \
             once, by rotors that deliver only estimates.scale_least. Lower force_down (less load is held), or \
             reference_bounds.vertical_acceleration; or fly lighter."
        }
        "A1 turning rate for the reference" => {
            "how fast the vehicle tilts. The reference's jerk wants the thrust to turn faster than gains.turn_rate. \
             Lower reference_bounds.jerk, or raise turn_rate."
        }
        "A1 turning acceleration" => {
            "how quickly the vehicle begins to tilt. The reference needs more than gains.turn_reserve, the \
             acceleration that is always available. Lower reference_bounds.snap or jerk, or gains.k_f; or raise \
             turn_reserve, which takes torque from gains.m_all."
        }
        "G floor at the target < thrust" => {
            "how low the thrust can go. A rotor at its least thrust gives no torque, so turning needs some thrust, \
             and hovering leaves too little of it. Lower gains.turn_reserve, gains.yaw_acceleration or the bias \
             estimates.torque_tilt and torque_yaw; or let the rotors idle slower."
        }
        "A1 heading rate for the reference" => {
            "how fast the heading turns. A tilted vehicle must turn faster than the heading does. Lower \
             reference_bounds.heading_rate, or estimates.force_heading (the wind in which it is followed exactly); \
             or raise gains.yaw_rate."
        }
        "A1 heading acceleration" => {
            "how quickly the heading begins to turn. Lower reference_bounds.heading_second_derivative, or \
             estimates.force_heading (the wind in which it is followed exactly); or raise gains.yaw_acceleration, \
             which takes from the rotors' range."
        }
        "E switch qbar < eta" => {
            "the choice of which way to turn: its hysteresis is too wide for yaw's share of the potential. Lower \
             gains.delta or raise gains.eta."
        }
        "E tilt 2 qbar M_t < w eta_t sqrt(1 - qbar^2)" => {
            "the choice of which way to turn: the tilt's own potential pulls against the common one. Lower gains.m_t \
             or gains.delta, or raise gains.w."
        }
        "D potential |P| < M_all" => {
            "damping. The potential alone may use up gains.m_all, and no torque is left to brake a turn. Lower \
             gains.w or gains.m_t, or raise m_all."
        }
        "T2 roll and pitch torque" => {
            "torque about roll and pitch, limits.torque_max or the torque of two rotors: gains.m_all and \
             gains.turn_reserve use it up, as the formulas intend. For more torque, raise limits.torque_max if the \
             rotors can deliver it; if this row fails, lower m_all."
        }
        "T2 yaw torque" => {
            "torque about yaw, limits.torque_max. Lower gains.yaw_acceleration, gains.m_omega_z, gains.eta or \
             estimates.torque_yaw."
        }
        "T1 thrust floor at the greatest torque" => {
            "the greatest thrust. With gains.m_all, the reserve and yaw all in use, no rotor may fall below its \
             least thrust: that takes a thrust near limits.thrust_max. Raise limits.thrust_max if the rotors can \
             deliver it, or lower m_all."
        }
        "R rotors' range" => {
            "the rotors. With one at its greatest thrust and another at its least, gains.m_all, the reserve and yaw \
             use up the whole range between them, as the formulas intend. More torque needs stronger rotors; yaw \
             costs them most: a lower gains.yaw_acceleration or gains.m_omega_z leaves more to gains.m_all. If this \
             row fails, lower m_all."
        }
        _ => "",
    }
}

/// The change for a loop with too little margin.
#[must_use]
pub fn of_loop(lack: &Lack) -> String {
    let gains = match lack.axis {
        Axis::Roll | Axis::Pitch => "gains.k_omega_t, gains.w and gains.k_t",
        Axis::Yaw => "gains.k_omega_z and gains.eta",
        Axis::LateralX | Axis::LateralY => {
            "gains.k_p_across and k_v_across, gains.k_f and estimates.force_bandwidth_across"
        }
        Axis::Vertical => "gains.k_p_vertical and k_v_vertical, gains.k_f and estimates.force_bandwidth_vertical",
    };
    let change = match lack.what {
        Shortfall::GainDown { .. } => "the loop inside is too slow for it: lower those of the slower loop, here",
        _ => "it is too fast for this lag, delay and rate: shorten them, or lower",
    };
    format!("the sampled loop {}; {change} {gains}.", lack.axis.name())
}
