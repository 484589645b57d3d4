//! The motors' controllers in MAVLink's messages, as their answers tell: nothing where they do not answer.

use crate::esc::answer::Answer;
use crate::esc::controller::{Controller, RotorSpeeds};
use crate::hardware::MOTOR_COUNT;
use flight::Stamped;
use mavlink::dialects::common::{ESC_INFO_DATA, ESC_STATUS_DATA, EscConnectionType, EscFailureFlags};

/// Revolutions a minute at 1 rad/s.
const RPM_PER_RAD_S: f32 = 60.0 / core::f32::consts::TAU;

/// How fast each motor turns, and its controller's voltage and current; NaN where it does not say.
pub fn status(speeds: Stamped<RotorSpeeds>, controllers: Option<&[Controller; MOTOR_COUNT]>) -> ESC_STATUS_DATA {
    let of = |number: fn(&Controller) -> Option<f32>| {
        controllers.map_or([f32::NAN; MOTOR_COUNT], |all| all.each_ref().map(|one| number(one).unwrap_or(f32::NAN)))
    };
    ESC_STATUS_DATA {
        time_usec: speeds.time,
        rpm: speeds.value.map(|speed| (speed.unwrap_or(0.0) * RPM_PER_RAD_S) as i32),
        voltage: of(|controller| controller.voltage),
        current: of(|controller| controller.current.map(f32::from)),
        index: 0,
    }
}

/// Which controllers answer, how warm they are, and the frames without a valid answer.
pub fn info(speeds: Stamped<RotorSpeeds>, controllers: &[Controller; MOTOR_COUNT]) -> ESC_INFO_DATA {
    let answered = controllers.iter().fold(0, |sum: u32, controller| sum.wrapping_add(controller.answered));
    let failure = |controller: &Controller| {
        let stalls = controller.status.is_some_and(|status| status & Answer::STALLED != 0);
        if stalls { EscFailureFlags::ESC_FAILURE_MOTOR_STUCK } else { EscFailureFlags::empty() }.bits()
    };
    let online = speeds.value.iter().enumerate().filter(|(_, speed)| speed.is_some());
    ESC_INFO_DATA {
        time_usec: speeds.time,
        error_count: controllers.map(|controller| controller.missed),
        counter: answered as u16,
        failure_flags: controllers.each_ref().map(failure),
        // Hundredths of a degree.
        temperature: controllers.map(|controller| controller.temperature.map_or(i16::MAX, |t| 100 * i16::from(t))),
        index: 0,
        count: MOTOR_COUNT as u8,
        connection_type: EscConnectionType::ESC_CONNECTION_TYPE_DSHOT,
        info: online.fold(0, |bits, (index, _)| bits | 1 << index),
    }
}
