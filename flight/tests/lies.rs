//! Poses that lie in flight. Whatever the lie, the vehicle does what it does in silence: it goes on by IMU for a
//! second, levels for another, and stops, and reports why the poses are not believed. Where the sender reports that its
//! frame has moved, or where a lost body is found again, it flies on and does not lurch.

use crate::support::{Body, Flight, PERIOD_US, PoseSource, SPOOLING_TICKS, displaced, go_to};
use controller_core::prelude::*;
use estimation::estimator::{Accepted, Rejected};
use flight::rules::COASTING_MAX_US;
use flight::{Mode, Outcome, Output, Reason, Request, Stamped};
use nalgebra::UnitQuaternion;
use std::f64::consts::PI;

const ORIGIN_M: Vector3<f64> = Vector3::new(0.0, 0.0, 0.0);

/// On its way at 2 m/s or more.
fn under_way() -> Flight {
    let mut flight = Flight::armed();
    flight.ticks(50);
    flight.inputs.setpoint = Some(go_to(30.0, 10.0, 3.0));
    flight.ticks(250);
    assert!(flight.body.velocity.norm() > 2.0, "{}", flight.body.velocity);
    flight
}

/// In hover.
fn hovering() -> Flight {
    let mut flight = Flight::armed();
    flight.ticks(100);
    flight
}

/// A flight from the tick on in which poses begin to be those of `source`: it ends as in silence, up to `late` ticks
/// later, and the poses are refused for one of `reasons` when it levels. Returns how far by then the law's state was
/// from the truth, m.
fn ends_as_in_silence(mut flight: Flight, source: PoseSource, late: u64, reasons: &[Rejected]) -> f64 {
    flight.source = source;
    let silence = COASTING_MAX_US / PERIOD_US + 1;
    let (ticks, outcome) = flight.until(Reason::PoseLost, silence + late + 1);
    assert!((silence..=silence + late).contains(&ticks), "{reasons:?}: levelled after {ticks} ticks");
    let Some(Err(rejected)) = outcome.pose else { panic!("{reasons:?}: {:?}", outcome.pose) };
    assert!(reasons.contains(&rejected), "{rejected:?} is not in {reasons:?}");
    assert_eq!(outcome.health.jumps, 0);
    let drift = (outcome.estimated.unwrap().state.position.cast::<f64>() - flight.body.position).norm();
    // It comes down by the IMU alone, however long the poses go on.
    flight.ground = flight.body.position.z - 2.0;
    let (_, outcome) = flight.until(Reason::Landed, 1_000);
    assert_eq!((outcome.output, flight.body.position.z), (Output::Stop, flight.ground));
    assert_eq!(flight.ticks(100).output, Output::Stop);
    drift
}

/// Both flights with a lie that starts at their present time.
fn lie(make: impl Fn(&Flight) -> PoseSource, late: u64, reasons: &[Rejected]) {
    for flight in [under_way(), hovering()] {
        let source = make(&flight);
        let drift = ends_as_in_silence(flight, source, late, reasons);
        assert!(drift < 0.25, "{reasons:?}: {drift} m");
    }
}

#[test]
fn a_frame_sent_again_and_again_stops_as_fast_as_silence() {
    let resent = |flight: &Flight| -> PoseSource {
        let last = displaced(&flight.body, flight.inputs.now, &ORIGIN_M, &ORIGIN_M);
        Box::new(move |_, _| last)
    };
    lie(resent, 1, &[Rejected::Repeated]);
}

#[test]
fn a_frozen_stream_stops_as_fast_as_silence() {
    // In motion: a vehicle that hovers without noise would send the same.
    let flight = under_way();
    let frozen = displaced(&flight.body, flight.inputs.now, &ORIGIN_M, &ORIGIN_M).value;
    ends_as_in_silence(flight, Box::new(move |_, time| Stamped { value: frozen, time }), 2, &[Rejected::Frozen]);
}

#[test]
fn jumps_of_5_and_100_metres_are_not_followed() {
    for distance in [5.0, 100.0] {
        let offset = Vector3::new(0.0, distance, 0.0);
        lie(|_| Box::new(move |body, time| displaced(body, time, &offset, &ORIGIN_M)), 0, &[Rejected::Jump]);
    }
}

#[test]
fn half_turns_are_not_followed() {
    let cases = [
        (Vector3::z(), [Rejected::Turned, Rejected::Attitude]),
        (Vector3::x(), [Rejected::Gravity, Rejected::Attitude]),
    ];
    for (axis, reasons) in cases {
        lie(|_| Box::new(move |body, time| displaced(body, time, &ORIGIN_M, &(axis * PI))), 0, &reasons);
    }
}

#[test]
fn a_drift_of_half_a_metre_a_second_is_not_followed() {
    let drifting = |flight: &Flight| -> PoseSource {
        let start = flight.inputs.now;
        Box::new(move |body: &Body, time| {
            let gone = (time - start) as f64 * 1e-6;
            displaced(body, time, &(Vector3::x() * (0.5 * gone)), &ORIGIN_M)
        })
    };
    lie(drifting, 5, &[Rejected::Drift]);
}

#[test]
fn poses_whose_sender_has_lost_track_are_none() {
    let untracked = |_: &Flight| -> PoseSource {
        Box::new(|body: &Body, time| {
            let pose = displaced(body, time, &ORIGIN_M, &ORIGIN_M);
            Stamped { value: pose.value.quality(-1), ..pose }
        })
    };
    lie(untracked, 0, &[Rejected::Quality]);
}

#[test]
fn poses_of_another_time_are_none() {
    let future =
        |_: &Flight| -> PoseSource { Box::new(|body, time| displaced(body, time + 50_000, &ORIGIN_M, &ORIGIN_M)) };
    lie(future, 0, &[Rejected::Future]);
    let old =
        |_: &Flight| -> PoseSource { Box::new(|body, time| displaced(body, time - 500_000, &ORIGIN_M, &ORIGIN_M)) };
    lie(old, 0, &[Rejected::TooOld, Rejected::Repeated]);
}

/// How long it takes to hold once true poses come again, after three seconds: in the first `lied` ticks of them the
/// poses are those of `source`, afterwards there are none. `None` if it does not hold within ten seconds.
fn held_again(source: PoseSource, lied: u64) -> Option<u64> {
    let mut flight = hovering();
    flight.source = source;
    flight.ticks(lied);
    flight.present.pose = false;
    flight.ticks(300 - lied);
    assert_eq!(flight.pilot.mode(), Mode::Descending);
    (flight.source, flight.present.pose) = (Flight::new().source, true);
    (1..=1_000).find(|_| flight.tick().mode.is_guided())
}

#[test]
fn poses_are_believed_after_an_outage_if_those_before_it_lied_for_a_moment_only() {
    let astray =
        || -> PoseSource { Box::new(|body, time| displaced(body, time, &Vector3::new(3.0, 0.0, 0.0), &ORIGIN_M)) };
    let silent = held_again(Flight::new().source, 0);
    assert!(silent.is_some_and(|ticks| ticks < 50), "{silent:?}");
    for lied in [1, 10, 25] {
        let held = held_again(astray(), lied);
        assert!(held.is_some_and(|ticks| ticks < 100), "{lied}: {held:?}");
    }
    // Those that had been refused for a while, or still were when it had levelled, are not believed any more.
    for lied in [40, 100, 200] {
        assert_eq!(held_again(astray(), lied), None, "{lied}");
    }
    // Nor does a frame that reports a move at the end of it make them true.
    let end = hovering().inputs.now + 39 * PERIOD_US;
    let moved: PoseSource = Box::new(move |body, time| {
        let pose = displaced(body, time, &Vector3::new(3.0, 0.0, 0.0), &ORIGIN_M);
        Stamped { value: pose.value.reset_counter(u8::from(time >= end)), ..pose }
    });
    assert_eq!(held_again(moved, 40), None);
}

#[test]
fn poses_whose_sender_had_lost_track_or_time_are_believed_again() {
    let track = || -> PoseSource {
        Box::new(|body: &Body, time| {
            let pose = displaced(body, time, &ORIGIN_M, &ORIGIN_M);
            Stamped { value: pose.value.quality(-1), ..pose }
        })
    };
    let late = || -> PoseSource { Box::new(|body, time| displaced(body, time - 600_000, &ORIGIN_M, &ORIGIN_M)) };
    let early = || -> PoseSource { Box::new(|body, time| displaced(body, time + 50_000, &ORIGIN_M, &ORIGIN_M)) };
    for (number, source) in [track(), late(), early()].into_iter().enumerate() {
        let held = held_again(source, 300);
        assert!(held.is_some_and(|ticks| ticks < 100), "{number}: {held:?}");
    }
}

/// The truth in a frame that has moved by `offset` and turned by `turn` (rad, about the vertical), which its counter
/// says.
fn moved(offset: Vector3<f64>, turn: f64, resets: u8) -> PoseSource {
    Box::new(move |body, time| {
        let turn = Vector3::new(0.0, 0.0, turn);
        let position = UnitQuaternion::from_scaled_axis(turn) * body.position + offset - body.position;
        let pose = displaced(body, time, &position, &turn);
        Stamped { value: pose.value.reset_counter(resets), ..pose }
    })
}

/// The greatest speed in as many ticks, all of them flown, m/s, and the last outcome.
fn speed(flight: &mut Flight, ticks: u64) -> (f64, Outcome) {
    let mut fastest = 0.0_f64;
    for _ in 1..ticks {
        assert_eq!(flight.tick().mode, Mode::Flying);
        fastest = fastest.max(flight.body.velocity.norm());
    }
    (fastest, flight.tick())
}

#[test]
fn a_reported_frame_move_is_flown_through_without_a_lurch() {
    for (offset, turn) in [(Vector3::new(100.0, -5.0, 2.0), 0.0), (Vector3::new(1.0, 2.0, 0.0), 1.5), (ORIGIN_M, PI)] {
        let mut flight = hovering();
        let place = flight.body.position;
        flight.source = moved(offset, turn, 1);
        let rebased = flight.tick();
        assert_eq!((rebased.pose, rebased.health.jumps, rebased.mode), (Some(Ok(Accepted::Rebased)), 1, Mode::Flying));
        let (fastest, last) = speed(&mut flight, 300);
        assert!(fastest < 0.02, "{offset} {turn}: {fastest} m/s");
        assert!((flight.body.position - place).norm() < 0.02, "{offset} {turn}: {}", flight.body.position - place);
        // The reference is in the new frame.
        let there = UnitQuaternion::from_scaled_axis(Vector3::new(0.0, 0.0, turn)) * place + offset;
        let reference = last.flown.unwrap().unwrap().reference;
        assert!((reference.position.cast::<f64>() - there).norm() < 0.02, "{}", reference.position);
    }
}

#[test]
fn a_frame_that_moves_while_the_rotors_are_brought_up_takes_the_reference_along() {
    for request in [Request::FlySetpoints, Request::TakeOff(Some(1.0))] {
        let mut flight = Flight::idling();
        // Long enough for its frame to be an old one.
        flight.ticks(200);
        flight.inputs.request = Some(request);
        flight.inputs.setpoint = Some(go_to(0.0, 0.0, 1.0));
        assert_eq!(flight.tick().answer, Some(Ok(())));
        flight.ticks(20);
        flight.source = moved(Vector3::new(20.0, 0.0, 3.0), 1.0, 1);
        for _ in 20..SPOOLING_TICKS - 2 {
            let outcome = flight.tick();
            assert!(outcome.mode.flies());
            let flown = outcome.flown.unwrap().unwrap();
            assert!(flown.position_error.norm() < 0.01, "{request:?}: {}", flown.position_error);
            assert!(flown.wrench.torque.norm() < 1e-3, "{request:?}: {}", flown.wrench.torque);
        }
        assert_eq!(flight.ticks(300).health.jumps, 1);
        assert!(flight.tilt() < 0.02 && flight.body.velocity.xy().norm() < 0.05, "{request:?}");
    }
}

#[test]
fn a_frame_that_moves_under_way_makes_the_vehicle_brake_and_hold() {
    let [straight, turned] = [0.0, 1.0].map(|turn| {
        let mut flight = under_way();
        let fast = flight.body.velocity.norm();
        flight.source = moved(Vector3::new(3.0, 0.0, 1.0), turn, 1);
        flight.tick();
        let (fastest, _) = speed(&mut flight, 1_500);
        assert!(flight.body.velocity.norm() < 0.02, "{}", flight.body.velocity);
        assert!(flight.tilt() < 0.02);
        fastest - fast
    });
    // It was gathering speed, at 2 m/s^2: what it leans takes a moment to go, and as long whichever way the frame
    // turns.
    assert!(straight < 0.6 && (turned - straight).abs() < 0.02, "{straight} m/s, {turned} m/s");
}

#[test]
fn a_counter_that_runs_is_flown_no_longer_than_silence() {
    // Each frame elsewhere, with a count of its own; so many ticks from pose to pose.
    for every in [1, 5, 20, 100] {
        let mut flight = hovering();
        let from = flight.inputs.now;
        flight.source = Box::new(move |body, time| {
            let frame = (time - from) / PERIOD_US / every;
            let pose = displaced(body, time, &Vector3::new(3.0 * frame as f64, 0.0, 0.0), &ORIGIN_M);
            Stamped { value: pose.value.reset_counter(frame as u8), ..pose }
        });
        for tick in 1..=1_000 {
            flight.present.pose = tick % every == 0;
            let mode = flight.tick().mode;
            let expected = if tick <= COASTING_MAX_US / PERIOD_US { Mode::Flying } else { Mode::Descending };
            assert!(
                mode == expected || tick.abs_diff(COASTING_MAX_US / PERIOD_US) <= every,
                "{every}: {mode:?} in tick {tick}"
            );
        }
    }
}

#[test]
fn a_body_found_where_coasting_may_have_led_is_flown_on_from_without_a_lurch() {
    let mut flight = hovering();
    let place = flight.body.position;
    flight.present.pose = false;
    flight.ticks(40);
    flight.present.pose = true;
    flight.source = Box::new(|body, time| displaced(body, time, &Vector3::new(0.15, 0.0, 0.0), &ORIGIN_M));
    let mut found = 0;
    for _ in 0..300 {
        let outcome = flight.tick();
        found += u32::from(outcome.pose == Some(Ok(Accepted::Refound)));
        assert_eq!(outcome.mode, Mode::Flying);
        assert!(flight.body.velocity.norm() < 0.05, "{}", flight.body.velocity);
    }
    assert_eq!(found, 1);
    assert!((flight.body.position - place).norm() < 0.1, "{}", flight.body.position);
}

#[test]
fn a_lie_that_ends_in_time_costs_nothing_but_what_was_coasted() {
    for seconds in [0.9, 1.8] {
        let mut flight = under_way();
        let offset = Vector3::new(5.0, 0.0, 0.0);
        flight.source = Box::new(move |body, time| displaced(body, time, &offset, &ORIGIN_M));
        let ticks = (seconds * 100.0) as u64;
        let mode = flight.ticks(ticks).mode;
        let [lost, found] = if seconds < 1.0 { [Mode::Flying; 2] } else { [Mode::Descending, Mode::Holding] };
        assert_eq!(mode, lost);
        flight.source = Flight::new().source;
        assert_eq!(flight.tick().mode, found, "{seconds} s");
        let last = flight.ticks(1_500);
        assert_eq!((last.mode, last.health.jumps), (found, 0));
    }
}

#[test]
fn a_gap_in_the_imu_or_a_number_that_is_none_stops_the_motors() {
    let mut gap = under_way();
    gap.present.imu = false;
    gap.tick();
    gap.present.imu = true;
    gap.until(Reason::ImuLost, 1);
    let mut none = under_way();
    none.imu = Box::new(|imu| imu.delta_angle.z = f32::NAN);
    none.until(Reason::ImuLost, 1);
}

#[test]
fn sensors_that_lie_in_flight_end_it_within_two_seconds_and_never_in_a_nan() {
    let lies: [fn(&mut Flight); 3] = [
        |flight| flight.imu = Box::new(|imu| imu.delta_velocity = -imu.delta_velocity),
        |flight| flight.imu = Box::new(|imu| imu.delta_velocity = Vector3::zeros()),
        |flight| flight.gyro_bias.y = 10.0,
    ];
    for (number, lie) in lies.into_iter().enumerate() {
        let mut flight = hovering();
        lie(&mut flight);
        let mut levelled = false;
        let stopped = (1..=220).find(|_| {
            let outcome = flight.tick();
            levelled |= outcome.mode == Mode::Descending;
            assert!(matches!(outcome.flown, None | Some(Ok(_))), "{number}");
            outcome.output == Output::Stop
        });
        assert!(levelled && stopped.is_some_and(|ticks| ticks > 100), "{number}: {stopped:?}");
    }
}
