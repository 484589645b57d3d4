//! A configuration whose certificate fails: it boots and answers, and never arms.

use super::flight::Flight;
use controller_core::certificate::certified::{Certified, Refused};
use controller_core::configuration::Configuration;
use controller_core::governor::GovernorLimits;
use controller_core::reference::ReferenceBounds;
use estimation::estimator::{Estimator, EstimatorParameters, Settings};
use firmware::configuration::{self, Pilot};
use firmware::hardware::MotorCommand;
use firmware::outputs::Outputs;
use flight::{FlightSettings, Memory, Mode};
use mavlink::dialects::common::MavResult;

/// The embedded vehicle, with references that its torques are not enough for.
fn too_agile() -> Configuration {
    let configuration = configuration::embedded().unwrap();
    let bounds = *configuration.bounds();
    configuration.with_bounds(ReferenceBounds { snap: 50.0 * bounds.snap, ..bounds }).unwrap()
}

/// A flight under a refusal, and the inequality that failed first.
fn refused() -> (Flight, &'static str) {
    let refused = Certified::new(too_agile()).unwrap_err();
    let Refused::Fails(certificate) = &refused else { panic!("{refused:?}") };
    let failed = certificate.inequalities().find(|inequality| !inequality.holds()).unwrap().name;
    let memory = Box::leak(Box::new(Memory::EMPTY));
    let settings = Settings::new(&EstimatorParameters::BMI088).unwrap();
    let estimator = Box::leak(Box::new(Estimator::new(&settings)));
    let (limits, flight_settings) = (GovernorLimits::default(), FlightSettings::DEFAULT);
    let pilot = Box::leak(Box::new(Pilot::carrying(
        Err(&refused),
        &limits,
        &flight_settings,
        configuration::PERIOD_US,
        estimator,
        memory,
        configuration::policy(),
    )));
    let flight = Flight::with(|_| (pilot, Outputs::new(too_agile().rotors().unwrap(), configuration::MOTOR).unwrap()));
    (flight, failed)
}

#[test]
fn it_boots_answers_and_refuses_to_arm_naming_the_inequality() {
    let (mut flight, failed) = refused();
    flight.pass(2.0);
    assert_eq!(flight.report().mode, Mode::Locked);
    let texts: Vec<_> = flight.station.texts().into_iter().map(|(_, text)| text).collect();
    assert_eq!(texts, ["Locked: not certified to fly"]);
    // Telemetry, watchdog, timing: all as ever.
    assert!(flight.report().state.is_some());
    assert!(flight.now() - flight.hardware.fed() <= 10_000);
    for _ in 0..3 {
        let (result, texts) = flight.ask_to_arm();
        assert_eq!(result, Some(MavResult::MAV_RESULT_DENIED));
        assert_eq!(texts, [format!("Not certified: {failed:.35}")]);
        flight.station.fly_setpoints();
        flight.station.go_to([0.0, 0.0, 1.0]);
        // The same text is said once a second.
        flight.pass(1.0);
        assert_eq!((flight.report().mode, flight.hardware.command()), (Mode::Locked, MotorCommand::Stop));
    }
    assert_eq!(flight.report().timing.missed, 0);
}

#[test]
fn its_motors_can_be_tested_all_the_same() {
    let (mut flight, _) = refused();
    flight.pass(1.5);
    flight.station.test_motor(4, 10.0, 0.5);
    flight.pass(0.1);
    assert_eq!(flight.hardware.command(), MotorCommand::One { motor: 3, level: 0.1 });
    flight.pass(0.5);
    assert_eq!(flight.hardware.command(), MotorCommand::Stop);
}
