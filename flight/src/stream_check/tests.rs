extern crate std;
use super::*;
use crate::PERIOD_US;
use controller_core::governor::{Governor, GovernorLimits, HeadingSetpoint, Memory, Motion, Setpoint};
use controller_core::reference::ReferenceBounds;
use nalgebra::Vector3;
use std::boxed::Box;
use std::string::{String, ToString};
use std::vec::Vec;

const BOUNDS: ReferenceBounds = ReferenceBounds {
    horizontal_speed: 5.0,
    horizontal_acceleration: 2.5,
    vertical_acceleration: 0.5,
    jerk: 4.0,
    snap: 10.0,
    heading_rate: 1.3,
    heading_second_derivative: 1.8,
};

/// The reports, with their ticks, of a governor that is sent a circle of so many metres at 1.2 rad/s; of none it rests.
fn reported(radius: impl Fn(u64) -> Option<f32>, ticks: u64) -> Vec<(u64, String)> {
    let memory = Box::leak(Box::new(Memory::EMPTY));
    let period = PERIOD_US as f32 * 1e-6;
    let governor = Governor::new(&BOUNDS, &GovernorLimits::default(), period, memory).unwrap();
    let mut check = StreamCheck::default();
    let mut reports = Vec::new();
    for tick in 0..ticks {
        let (sin, cos) = (1.2 * tick as f32 * period).sin_cos();
        let motion = match radius(tick) {
            Some(radius) => {
                let (out, along) = (Vector3::new(cos, sin, 0.0) * radius, Vector3::new(-sin, cos, 0.0) * radius);
                Motion::PositionVelocityAcceleration { position: out, velocity: along * 1.2, acceleration: out * -1.44 }
            }
            None => Motion::Position(Vector3::zeros()),
        };
        governor.accept(&Setpoint { motion, turn: HeadingSetpoint::Keep }).unwrap();
        governor.tick();
        reports.extend(check.tick(governor.following(), tick * PERIOD_US).map(|said| (tick, said.to_string())));
    }
    reports
}

#[test]
fn a_stream_that_is_too_fast_is_reported_after_two_seconds_and_every_ten_with_what_fits() {
    // 3.6 of 2.5 m/s^2, 4.32 of 4 m/s^3: 1.2 times slower is just enough, and rounded up.
    let said = reported(|_| Some(2.5), 2_500);
    let (ticks, texts): (Vec<_>, Vec<_>) = said.into_iter().unzip();
    assert!(texts.iter().all(|text| text == "Setpoints too fast: smoothed, 1.3x slower fits"), "{texts:?}");
    assert!(ticks.len() == 3 && ticks.first().is_some_and(|first| (200..210).contains(first)), "{ticks:?}");
    assert!(ticks.windows(2).all(|pair| matches!(pair, [one, next] if next - one == 1_000)), "{ticks:?}");
}

#[test]
fn a_stream_that_is_caught_up_with_is_reported_as_late_and_then_as_flown() {
    let texts: Vec<_> = reported(|_| Some(1.2), 3_000).into_iter().map(|(_, text)| text).collect();
    let (last, before) = texts.split_last().unwrap();
    assert!(last == "Setpoints flown as sent" && before.len() == 1, "{texts:?}");
    assert!(before.iter().all(|text| text == "Setpoints smoothed: not caught up with yet"), "{texts:?}");
}

#[test]
fn a_place_to_go_to_and_a_stream_of_less_than_two_seconds_are_not_reported() {
    assert!(reported(|_| None, 1_000).is_empty());
    assert!(reported(|tick| (tick % 300 < 190).then_some(2.5), 2_000).is_empty());
}

#[test]
fn every_text_fits_a_statustext() {
    for said in [Streamed::AsSent, Streamed::Behind, Streamed::smoothed(16.0)] {
        assert!(said.to_string().len() <= 50, "{said}");
    }
}
