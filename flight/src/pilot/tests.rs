//! What only a defect could cause, caused on purpose: refusals that checked inputs rule out.

extern crate std;
use super::super::rules::REFUSAL_MAX_US;
use super::super::{Outcome, Pose, Reason, Request, Stamped, Velocity};
use super::*;
use crate::{PERIOD_US, hummingbird};
use estimation::estimator::{Clipped, Estimator, Increment, PoseMeasurement, Settings};
use nalgebra::{Quaternion, Vector3};
use std::boxed::Box;

/// Ticks of rest before arming.
const SETTLING_TICKS: u64 = 160;

/// A tick at rest at the origin.
fn rest(pilot: &mut Pilot, number: u64, request: Option<Request>) -> (Estimate, Outcome) {
    let (now, zero) = (number * PERIOD_US, Vector3::zeros());
    let delta_velocity = Vector3::new(0.0, 0.0, 9.81 * PERIOD_US as f32 * 1e-6);
    let increment =
        Increment { start: now - PERIOD_US, end: now, delta_angle: zero, delta_velocity, clipped: Clipped::NEITHER };
    let pose = Pose::new(zero, Velocity::World(zero), Quaternion::new(1.0, 0.0, 0.0, 0.0)).unwrap();
    let pose = Stamped { value: PoseMeasurement::new(&pose), time: now };
    let body_rate = Some(Stamped { value: zero, time: now });
    let inputs = Inputs { increments: &[increment], body_rate, poses: &[pose], request, ..quiet(now) };
    let estimate = pilot.estimation.tick(&inputs, pilot.mode.is_armed(), pilot.is_airborne(), false);
    let outcome = pilot.decide(&inputs, &estimate);
    (estimate, outcome)
}

/// A tick in which only the ground station's heartbeat comes.
fn quiet(now: u64) -> Inputs<'static> {
    Inputs { now, ground_station: Some(now), ..Inputs::default() }
}

fn pilot() -> Pilot<'static> {
    let certified = hummingbird::certified();
    let settings = Settings::bmi088(certified.configuration().vehicle());
    let estimator = Box::leak(Box::new(Estimator::new(&settings)));
    let memory = Box::leak(Box::new(Memory::EMPTY));
    Pilot::new(Ok(&certified), &GovernorLimits::default(), &FlightSettings::DEFAULT, PERIOD_US, estimator, memory)
}

/// Taking off, with the number of the last tick, and its estimate with an attitude of NaNs.
fn armed() -> (Pilot<'static>, u64, Estimate) {
    let mut pilot = pilot();
    for tick in 1..SETTLING_TICKS {
        rest(&mut pilot, tick, None);
    }
    let (_, arming) = rest(&mut pilot, SETTLING_TICKS, Some(Request::Arm));
    assert_eq!((arming.answer, arming.mode), (Some(Ok(())), Mode::Idling));
    let (mut estimate, rising) = rest(&mut pilot, SETTLING_TICKS + 1, Some(Request::TakeOff(None)));
    assert_eq!((rising.answer, rising.mode), (Some(Ok(())), Mode::TakingOff));
    estimate.state.as_mut().unwrap().state.attitude = Quaternion::new(f32::NAN, 0.0, 0.0, 0.0);
    (pilot, SETTLING_TICKS + 1, estimate)
}

#[test]
fn settings_are_chosen_on_the_ground_and_kept_in_the_air() {
    let other = FlightSettings { take_off_height: 3.0, fence_radius: 7.0, ..FlightSettings::DEFAULT };
    let mut grounded = pilot();
    grounded.fence.place(&Vector3::new(1.0, 2.0, 3.0));
    grounded.use_settings(&other);
    assert_eq!(grounded.settings, other);
    assert!(
        !grounded.fence.contains(&Vector3::new(9.0, 2.0, 3.0)) && grounded.fence.contains(&Vector3::new(7.0, 2.0, 3.0))
    );
    assert_eq!(grounded.fence.home(), Vector3::new(1.0, 2.0, 3.0));
    let (mut flying, ..) = armed();
    flying.use_settings(&other);
    assert_eq!(flying.settings, FlightSettings::DEFAULT);
    assert!(flying.fence.contains(&Vector3::new(9.0, 2.0, 3.0)));
}

#[test]
fn thrusts_that_the_law_refuses_to_renew_are_held_for_five_ticks_and_then_stop() {
    let (mut pilot, last, broken) = armed();
    let thrusts = pilot.chain.as_ref().unwrap().thrusts().cloned().unwrap();
    for tick in 1..=REFUSAL_MAX_US / PERIOD_US {
        let outcome = pilot.decide(&quiet((last + tick) * PERIOD_US), &broken);
        assert!(matches!(outcome.flown, Some(Err(InputError::NotFinite { .. }))), "{outcome:?}");
        assert_eq!(outcome.output, Output::Thrusts(thrusts.clone()));
    }
    let outcome = pilot.decide(&quiet((last + 6) * PERIOD_US), &broken);
    assert_eq!(outcome.transition.map(|transition| transition.reason), Some(Reason::ThrustsRefused));
    assert_eq!((outcome.output, outcome.mode), (Output::Stop, Mode::Stopped));
}

#[test]
fn a_refusal_that_passes_is_flown_through() {
    let (mut pilot, last, broken) = armed();
    for tick in 1..5 {
        pilot.decide(&quiet((last + tick) * PERIOD_US), &broken);
    }
    let sound = Estimate { state: sound(&broken), ..broken };
    for tick in 5..20 {
        let outcome = pilot.decide(&quiet((last + tick) * PERIOD_US), &sound);
        assert!(matches!((outcome.mode, outcome.flown), (Mode::TakingOff, Some(Ok(_)))));
    }
}

/// The estimated state of a vehicle that is level.
fn sound(broken: &Estimate) -> Option<estimation::estimator::EstimatedState> {
    broken.state.map(|mut estimated| {
        estimated.state.attitude = Quaternion::new(1.0, 0.0, 0.0, 0.0);
        estimated
    })
}

#[test]
fn a_jump_to_where_the_governor_cannot_start_is_levelled() {
    let (mut pilot, last, broken) = armed();
    let mut state = sound(&broken);
    state.as_mut().unwrap().state.position = Vector3::repeat(1e8);
    let jumped_from = sound(&broken).map(|estimated| estimated.state);
    let outcome = pilot.decide(&quiet((last + 1) * PERIOD_US), &Estimate { state, jumped_from, ..broken });
    assert_eq!((outcome.mode, outcome.transition.map(|t| t.reason)), (Mode::Descending, Some(Reason::PoseLost)));
}

#[test]
fn a_place_where_the_governor_cannot_start_is_blamed_by_name() {
    let mut pilot = pilot();
    let chain = pilot.chain.as_mut().unwrap();
    let far = chain.start(&Vector3::repeat(1e8), &controller_core::heading::Heading::FORWARD).unwrap_err();
    assert_eq!(far.field(), "initial.position");
}

#[test]
fn a_pilot_and_its_estimator_take_the_memory_their_documentation_says() {
    assert!(size_of::<Pilot>() < 6_400, "{} bytes", size_of::<Pilot>());
    assert!(size_of::<Estimator>() < 12_000, "{} bytes", size_of::<Estimator>());
}

#[test]
fn the_fence_of_a_vehicle_that_idles_goes_along_with_its_frame() {
    let mut pilot = pilot();
    for tick in 1..SETTLING_TICKS {
        rest(&mut pilot, tick, None);
    }
    let (estimate, arming) = rest(&mut pilot, SETTLING_TICKS, Some(Request::Arm));
    assert_eq!(arming.mode, Mode::Idling);
    let mut state = estimate.state;
    let jumped_from = state.map(|estimated| estimated.state);
    state.as_mut().unwrap().state.position = Vector3::new(3.0, 4.0, -20.0);
    pilot.decide(&quiet((SETTLING_TICKS + 1) * PERIOD_US), &Estimate { state, jumped_from, ..estimate });
    assert!((pilot.fence.home() - Vector3::new(3.0, 4.0, -20.0)).norm() < 1e-4, "{}", pilot.fence.home());
}

#[test]
fn a_take_off_whose_frame_moves_ends_as_far_up_and_the_fence_goes_along() {
    let (mut pilot, last, broken) = armed();
    let mut found = sound(&broken);
    let jumped_from = found.map(|estimated| estimated.state);
    let here = &mut found.as_mut().unwrap().state;
    here.position = Vector3::new(3.0, 4.0, -20.0);
    here.attitude = Quaternion::new(0.8, 0.0, 0.0, 0.6);
    pilot.decide(&quiet((last + 1) * PERIOD_US), &Estimate { state: found, jumped_from, ..broken });
    assert!((pilot.fence.home() - Vector3::new(3.0, 4.0, -20.0)).norm() < 1e-4, "{}", pilot.fence.home());
    // The reference goes on up on its own; the estimate stands for a vehicle that follows it.
    let mut tick = last + 2;
    while pilot.mode() == Mode::TakingOff {
        let reference = *pilot.chain.as_ref().unwrap().reference();
        let state = found.map(|mut estimated| {
            (estimated.state.position, estimated.state.velocity) = (reference.position, reference.velocity);
            estimated
        });
        let estimate = Estimate { state, jumped_from: None, ..broken };
        pilot.decide(&quiet(tick * PERIOD_US), &estimate);
        tick += 1;
        assert!(tick < last + 2_000, "still taking off");
    }
    let height = pilot.chain.as_ref().unwrap().reference().position.z + 20.0;
    assert_eq!(pilot.mode(), Mode::Holding);
    assert!((height - FlightSettings::DEFAULT.take_off_height).abs() < 0.02, "{height} m");
}

#[test]
fn a_landing_stays_requested_when_the_pose_is_regained_until_a_hold() {
    let (mut pilot, last, broken) = armed();
    let mut found = Estimate { state: sound(&broken), ..broken };
    found.state.as_mut().unwrap().state.position.z = 0.2;
    let lost = Estimate { health: estimation::estimator::Health::NONE, ..found };
    let mut tick = last;
    let mut next = |pilot: &mut Pilot, estimate: &Estimate, request| {
        tick += 1;
        let outcome = pilot.decide(&Inputs { request, ..quiet(tick * PERIOD_US) }, estimate);
        outcome.transition.map(|transition| (transition.to, transition.reason))
    };
    assert_eq!(next(&mut pilot, &found, None), None);
    assert_eq!(next(&mut pilot, &lost, None), Some((Mode::Descending, Reason::PoseLost)));
    assert_eq!(next(&mut pilot, &lost, Some(Request::Land)), None);
    assert_eq!(next(&mut pilot, &found, None), Some((Mode::Landing, Reason::LandingResumed)));
    // Requested in the very tick in which the pose is lost.
    pilot.trust = Trust::default();
    assert_eq!(next(&mut pilot, &found, Some(Request::Hold)), Some((Mode::Holding, Reason::HoldCommanded)));
    assert_eq!(next(&mut pilot, &lost, Some(Request::Land)), Some((Mode::Descending, Reason::PoseLost)));
    assert_eq!(next(&mut pilot, &found, None), Some((Mode::Landing, Reason::LandingResumed)));
    // A vehicle that holds no longer lands.
    pilot.trust = Trust::default();
    assert_eq!(next(&mut pilot, &found, Some(Request::Hold)), Some((Mode::Holding, Reason::HoldCommanded)));
    assert_eq!(next(&mut pilot, &lost, None), Some((Mode::Descending, Reason::PoseLost)));
    assert_eq!(next(&mut pilot, &found, None), Some((Mode::Holding, Reason::PoseRegained)));
    // A landing that was resumed once is not resumed again.
    pilot.trust = Trust::default();
    assert_eq!(next(&mut pilot, &found, Some(Request::Land)), Some((Mode::Landing, Reason::LandCommanded)));
    assert_eq!(next(&mut pilot, &lost, None), Some((Mode::Descending, Reason::PoseLost)));
    assert_eq!(next(&mut pilot, &found, None), Some((Mode::Landing, Reason::LandingResumed)));
    assert_eq!(next(&mut pilot, &lost, None), Some((Mode::Descending, Reason::PoseLost)));
    assert_eq!(next(&mut pilot, &found, None), None);
}
