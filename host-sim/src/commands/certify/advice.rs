//! The limits of a vehicle under the extended law, in plain words: the meaning of each inequality and each loop, and
//! which number to change.

use controller_core::certificate::path::PathRow;
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
             gains.a_down or reference_bounds.vertical_acceleration."
        }
        "A1 thrust for the reference" => {
            "thrust, for the reference. Rotors that deliver only estimates.scale_least must hold its acceleration and \
             drag beside the weight. Lower reference_bounds.horizontal_acceleration or \
             reference_bounds.vertical_acceleration; or fly lighter."
        }
        "A1 turning rate for the reference" => {
            "how fast the vehicle tilts. The reference's jerk wants the thrust to turn faster than gains.turn_rate. \
             Lower reference_bounds.jerk, or raise gains.turn_rate."
        }
        "A1 turning acceleration" => {
            "how quickly the vehicle begins to tilt. The reference needs more than gains.turn_reserve, the \
             acceleration that is always available. Lower reference_bounds.snap or reference_bounds.jerk; or raise \
             gains.turn_reserve, which takes torque from gains.m_tilt."
        }
        "G floor at the target < thrust" => {
            "how low the thrust can go. A rotor at its least thrust gives no torque, so turning needs some thrust, \
             and hovering leaves too little of it. Lower gains.turn_reserve or gains.yaw_acceleration; or let the \
             rotors idle slower."
        }
        "A1 heading acceleration" => {
            "how quickly the heading begins to turn. Lower reference_bounds.heading_second_derivative, or \
             estimates.force_heading (the wind in which it is followed exactly); or raise gains.yaw_acceleration."
        }
        "T2 roll and pitch torque" => {
            "torque about roll and pitch, limits.torque_max: gains.m_tilt and gains.turn_reserve use it up, as the \
             formulas intend. For more torque, raise limits.torque_max if the rotors can deliver it; if this row \
             fails, lower gains.m_tilt."
        }
        "R rotors' range" => {
            "the rotors. With one at its greatest thrust and another at its least, gains.m_tilt and gains.turn_reserve \
             use up the whole range between them, as the formulas intend. More torque needs stronger rotors; if this \
             row fails, lower gains.m_tilt."
        }
        "T1 thrust floor at the greatest torque" => {
            "the greatest thrust. With gains.m_tilt and gains.turn_reserve in use, no rotor may fall below its least \
             thrust: that takes a thrust near limits.thrust_max. Raise limits.thrust_max if the rotors can deliver \
             it, or lower gains.m_tilt."
        }
        "D greatest torque bias" => {
            "torque beside a bias. A bias of estimates.torque_tilt must leave gains.turn_reserve. Lower \
             estimates.torque_tilt or gains.turn_reserve."
        }
        "T2 yaw torque" => {
            "torque about yaw, limits.torque_max or what the reference's thrust leaves of the rotors. Lower \
             gains.yaw_acceleration."
        }
        _ => "",
    }
}

/// The meaning of a row of the judge of paths, and what to change besides the pace.
#[must_use]
pub fn of_path(row: PathRow) -> &'static str {
    match row {
        PathRow::Fall => {
            "how fast the reference falls. gains.a_down must leave some of gravity to push against. Lower \
             gains.a_down, or fly a flatter path."
        }
        PathRow::Thrust => {
            "thrust, along the reference. Rotors that deliver only estimates.scale_least must hold it beside the force \
             that is kept free. Lower reference.force_kept, or raise estimates.scale_least; or fly lighter."
        }
        PathRow::TurningRate => "how fast the vehicle tilts along the reference. Raise gains.turn_rate.",
        PathRow::Torque => {
            "torque about roll and pitch, along the reference. Raise limits.torque_max if the rotors can deliver it."
        }
        PathRow::Floor => {
            "how low the thrust is along the reference: turning needs some. Lower reference.force_kept, or let the rotors \
             idle slower."
        }
        PathRow::Cone => {
            "how far the vehicle tilts along the reference, and how fast it gets there. Raise gains.tilt_max, or lower \
             reference.force_kept."
        }
    }
}

/// The change for a model flight that does not arrive.
pub const OF_FLIGHT: &str = "a model of the vehicle circles or swings about its target, from far away. Raise \
    gains.turn_rate or gains.k_f, or lower gains.v_across, gains.v_up and gains.v_down; or raise control.rate.";

/// The change for a loop with too little margin.
#[must_use]
pub fn of_loop(lack: &Lack) -> String {
    let gains = match lack.axis {
        Axis::Roll | Axis::Pitch => "gains.k_omega_t and gains.k_tilt",
        Axis::Yaw => "gains.c_2 and gains.c_1",
        Axis::LateralX | Axis::LateralY => {
            "gains.k_p_across and gains.k_v_across, gains.k_f and estimates.force_bandwidth_across"
        }
        Axis::Vertical => "gains.k_p_vertical and gains.k_v_vertical, gains.k_f and estimates.force_bandwidth_vertical",
    };
    let change = match lack.what {
        Shortfall::GainDown { .. } => "the loop inside is too slow for it: lower those of the slower loop, here",
        _ => "it is too fast for this lag, delay and rate: shorten them, or lower",
    };
    format!("the sampled loop {}; {change} {gains}.", lack.axis.name())
}

#[cfg(test)]
mod tests;
