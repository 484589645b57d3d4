//! What only a defect could cause, caused on purpose: refusals that checked inputs rule out.

extern crate std;
use super::super::example;
use super::super::rules::REFUSALS_MAX;
use super::super::{Reason, Stamped, Velocity};
use super::*;
use nalgebra::{Quaternion, Vector3};
use std::boxed::Box;

const NAN: Quaternion<f32> = Quaternion::new(f32::NAN, 0.0, 0.0, 0.0);

fn inputs(now: u64) -> Inputs {
    let imu = ImuSample { angular_velocity: Vector3::zeros(), specific_force: Vector3::new(0.0, 0.0, 9.81) };
    Inputs { now, imu: Some(Stamped { value: imu, time: now }), ground_station: Some(now), ..Inputs::default() }
}

fn pose(time: u64) -> Option<Stamped<Pose>> {
    let still = Velocity::World(Vector3::zeros());
    let value = Pose::new(Vector3::zeros(), still, Quaternion::new(1.0, 0.0, 0.0, 0.0)).unwrap();
    Some(Stamped { value, time })
}

fn pilot() -> Pilot<'static> {
    let memory = Box::leak(Box::new(Memory::EMPTY));
    Pilot::new(Ok(&example::certified()), &GovernorLimits::default(), memory)
}

/// Armed at time zero and flown for a second tick.
fn armed() -> Pilot<'static> {
    let mut pilot = pilot();
    let arming = pilot.tick(&Inputs { request: Some(Request::Arm), pose: pose(0), ..inputs(0) });
    assert_eq!(arming.answer, Some(Ok(())));
    pilot.tick(&Inputs { pose: pose(PERIOD), ..inputs(PERIOD) });
    pilot
}

#[test]
fn thrusts_that_the_law_refuses_to_renew_are_held_for_five_ticks_and_then_stop() {
    let mut pilot = armed();
    let last = pilot.chain.as_ref().unwrap().thrusts().cloned().unwrap();
    for tick in 1..=u64::from(REFUSALS_MAX) {
        pilot.attitude = Some(PropagatedAttitude::new(NAN, Vector3::zeros(), 0));
        let outcome = pilot.tick(&inputs((1 + tick) * PERIOD));
        assert!(matches!(outcome.flown, Some(Err(InputError::NotFinite { .. }))), "{outcome:?}");
        assert_eq!(outcome.output, Output::Thrusts(last.clone()));
    }
    let outcome = pilot.tick(&inputs(7 * PERIOD));
    assert_eq!(outcome.transition.map(|transition| transition.reason), Some(Reason::ThrustsRefused));
    assert_eq!((outcome.output, outcome.mode), (Output::Stop, Mode::Disarmed));
}

#[test]
fn a_refusal_that_passes_is_flown_through() {
    let mut pilot = armed();
    pilot.attitude = Some(PropagatedAttitude::new(NAN, Vector3::zeros(), 0));
    for tick in 2..6 {
        pilot.tick(&inputs(tick * PERIOD));
    }
    for tick in 6..20 {
        let outcome = pilot.tick(&Inputs { pose: pose(tick * PERIOD), ..inputs(tick * PERIOD) });
        assert!(matches!((outcome.mode, outcome.flown), (Mode::Flying, Some(Ok(_)))));
    }
}

#[test]
fn a_place_where_the_governor_cannot_start_is_blamed_by_name() {
    let mut pilot = pilot();
    let chain = pilot.chain.as_mut().unwrap();
    let far = chain.start(&Vector3::repeat(1e8), &crate::heading::Heading::FORWARD).unwrap_err();
    assert_eq!(field(far), "initial.position");
}

#[test]
fn a_pilot_takes_the_memory_its_documentation_says() {
    assert!(size_of::<Pilot>() < 2_600, "{} bytes", size_of::<Pilot>());
}
