//! Parameters that the certificate depends on: certified when they are set, and again when they are booted with.

use crate::hil_takeover::increment;
use crate::parameters::chip_with;
use crate::support::PERIOD_US;
use crate::support::Simulated;
use crate::support::chip::{Chip, Words};
use crate::support::receiver::{Fed, Local, replies, report, texts};
use controller_core::tuning::judged::JudgedLoops;
use firmware::control::Control;
use firmware::hardware::MotorCommand;
use firmware::parameters::storage::Storage;
use firmware::parameters::table::{Name, PARAMETERS};
use firmware::parameters::tuned::Built;
use firmware::shared::{Flag, QueuedRequest, Reply};
use firmware::{boot, configuration};
use flight::{Grounded, Mode, Output, Request};
use mavlink::dialects::common::{MavParamType, PARAM_SET_DATA};
use std::cell::RefCell;

/// Boots on `shared`; why it can never arm, if so.
fn boot_on(shared: &Local) -> Option<Grounded> {
    let (pilot, _) = boot::start(Box::leak(Box::new(boot::Place::new())), shared.for_boot()).unwrap();
    pilot.grounded()
}

/// What this image is built for.
fn built() -> Built {
    Built {
        configuration: configuration::embedded().unwrap(),
        motor: configuration::MOTOR,
        loops: &configuration::LOOPS,
        identity: configuration::IDENTITY,
        period: PERIOD_US,
        follows_rotors: false,
    }
}

/// Booted with nothing set.
fn booted() -> Local {
    let shared = Local::new();
    assert_eq!(boot_on(&shared), None);
    shared
}

fn set(name: Name, param_value: f32) -> PARAM_SET_DATA {
    let param_type = MavParamType::MAV_PARAM_TYPE_REAL32;
    PARAM_SET_DATA { param_value, target_system: 1, target_component: 1, param_id: name.row().name.into(), param_type }
}

/// Sets a parameter by a message; the texts about it.
fn texts_of_setting(shared: &Local, name: Name, value: f32) -> Vec<String> {
    Fed::new(shared).message(&set(name, value), 0);
    assert_eq!(replies(shared), [Reply::Parameter(name)]);
    assert!(!shared.is_busy());
    texts(shared)
}

#[test]
fn every_row_of_the_configuration_shows_what_was_built() {
    let shared = booted();
    let configuration = configuration::embedded().unwrap();
    let shown = |name: Name| shared.parameters.get(name);
    assert_eq!(shown(Name::Mass), configuration.vehicle().mass);
    assert_eq!(shown(Name::TorqueMaxZ), configuration.limits().torque_max.z);
    assert_eq!(shown(Name::Snap), configuration.bounds().snap);
    assert_eq!(shown(Name::RotorThrustMax), configuration.rotors().unwrap()[0].thrust_max);
    assert_eq!([shown(Name::MotorIdle), shown(Name::ThrustCurve)], [0.055, 0.0]);
    for row in PARAMETERS.iter().filter(|row| row.parameter.is_tuned()) {
        let value = shown(row.parameter);
        assert!(row.allows(value) && (row.unit != "%" || value == 100.0), "{}: {value}", row.name);
    }
}

#[test]
fn a_good_value_is_taken_from_the_next_boot_on_and_survives_it() {
    let chip = Chip::erased();
    let shared = Local::new();
    let mut storage = Storage::load(Words::<4>(&chip), shared.for_storage());
    assert_eq!(boot_on(&shared), None);
    assert_eq!(texts_of_setting(&shared, Name::Mass, 0.4), ["MASS: may be flown, from the next boot on"]);
    assert_eq!(
        texts_of_setting(&shared, Name::GainAttitude, 90.0),
        ["GAIN_ATT_P: may be flown, from the next boot on"]
    );
    let clock = Simulated::default();
    clock.run(10_000, storage.keep(&clock, shared.for_storage()), |_| ());

    let again = Local::new();
    Storage::load(Words::<4>(&chip), again.for_storage());
    assert_eq!(boot_on(&again), None, "{:?}", texts(&again));
    assert_eq!((again.parameters.get(Name::Mass), again.parameters.get(Name::GainAttitude)), (0.4, 90.0));
    assert_eq!(again.parameters.set_by_hand().collect::<Vec<_>>(), [Name::Mass, Name::GainAttitude]);
    // What flies is lighter, and turns more gently.
    let built = built();
    let flown = built.tuned(|name| again.parameters.raw(name)).unwrap();
    assert_eq!(flown.vehicle().mass, 0.4);
    assert_ne!(flown.law(), built.configuration.law());
    // Back as it was built: nothing is left to be kept.
    texts_of_setting(&again, Name::Mass, built.configuration.vehicle().mass);
    texts_of_setting(&again, Name::GainAttitude, 100.0);
    assert_eq!(again.parameters.set_by_hand().count(), 0);
}

#[test]
fn a_value_that_does_not_certify_changes_nothing_and_the_inequality_is_reported() {
    let shared = booted();
    let before = shared.parameters.get(Name::RotorThrustMax);
    let words = texts_of_setting(&shared, Name::RotorThrustMax, 3.0);
    assert_eq!(words[0], "ROT_THR_MAX: refused, cannot be flown");
    assert!(words[1].starts_with("R rotors' range: needs 0.4"), "{words:?}");
    assert_eq!(shared.parameters.get(Name::RotorThrustMax), before);
    // What one value does not allow, another may make possible.
    assert_eq!(texts_of_setting(&shared, Name::Mass, 1.1)[0], "MASS: refused, cannot be flown");
    assert_eq!(
        texts_of_setting(&shared, Name::RotorThrustMax, 4.5),
        ["ROT_THR_MAX: may be flown, from the next boot on"]
    );
    assert_eq!(texts_of_setting(&shared, Name::Mass, 1.1), ["MASS: may be flown, from the next boot on"]);
    assert_eq!(texts_of_setting(&shared, Name::RotorThrustMax, before)[0], "ROT_THR_MAX: refused, cannot be flown");
}

/// The least and the greatest thrust, N, of the first rotor with what is set on `shared`.
fn range_with(shared: &Local) -> [f32; 2] {
    let built = built();
    let rotors = built.tuned(|name| shared.parameters.raw(name)).unwrap().rotors().unwrap().to_vec();
    [rotors[0].thrust_min, rotors[0].thrust_max]
}

#[test]
fn what_motors_make_when_they_idle_is_certified_as_the_least_thrust() {
    let shared = booted();
    let [least, most] = range_with(&shared);
    assert_eq!(least, built().configuration.rotors().unwrap()[0].thrust_min);
    let said = |name: Name| [format!("{}: may be flown, from the next boot on", name.row().name)];
    // The file's least speed pushes more than that.
    assert_eq!(texts_of_setting(&shared, Name::MotorIdle, 0.09), said(Name::MotorIdle));
    assert_eq!(range_with(&shared), [least, most]);
    // A curve with a linear part makes more of the same command, and so does a higher one.
    assert_eq!(texts_of_setting(&shared, Name::ThrustCurve, 0.5), said(Name::ThrustCurve));
    let [curved, _] = range_with(&shared);
    let command = 0.09 / 0.8;
    assert!((curved / most - 0.5 * (command + command * command)).abs() < 1e-6 && curved > least, "{curved}");
    let words = texts_of_setting(&shared, Name::MotorIdle, 0.3);
    assert_eq!(words[0], "MOT_IDLE: refused, cannot be flown");
    assert!(words.len() == 2 && shared.parameters.get(Name::MotorIdle) == 0.09, "{words:?}");
    // A least thrust below it counts for nothing.
    assert_eq!(texts_of_setting(&shared, Name::RotorThrustMin, 0.01), said(Name::RotorThrustMin));
    assert_eq!(range_with(&shared), [curved, most]);
}

#[test]
fn stored_motors_that_do_not_certify_keep_it_on_the_ground_and_are_named() {
    let stored = [(Name::ThrustCurve, 1.0), (Name::MotorIdle, 0.3)];
    let (grounded, texts, _) = booted_with(configuration::IDENTITY, &stored);
    assert!(grounded.is_some());
    assert_eq!(texts, ["THR_CURVE 1: cannot be flown", "MOT_IDLE 0.3: cannot be flown"]);
}

#[test]
fn motors_idle_as_they_were_when_it_booted() {
    let stored = [(Name::MotorIdle, 0.08)];
    let (grounded, _, shared) = booted_with(configuration::IDENTITY, &stored);
    assert_eq!(grounded, None);
    let (_, outputs) = boot::start(Box::leak(Box::new(boot::Place::new())), shared.for_boot()).unwrap();
    assert_eq!(outputs.command(&Output::Idle, 1.0), MotorCommand::Run([0.08; 4]));
    // Of another configuration's nothing is left.
    let (_, texts, shared) = booted_with(configuration::IDENTITY ^ 1, &stored);
    assert_eq!(texts, ["Another configuration was tuned: as built now"]);
    assert_eq!(shared.parameters.get(Name::MotorIdle), 0.055);
}

#[test]
fn a_value_for_which_there_is_no_vehicle_is_refused_by_field() {
    let shared = booted();
    let words = texts_of_setting(&shared, Name::ThrustMax, 4.0);
    assert_eq!(words[0], "THR_MAX: refused, cannot be flown");
    assert!(words[1].starts_with("limits.thrust_max: must be above 4.5"), "{words:?}");
    assert_eq!(texts_of_setting(&shared, Name::GainRate, 95.0), ["GAIN_ATT_D: allowed are 70 to 130 % by 10"]);
    assert_eq!(texts_of_setting(&shared, Name::Mass, f32::NAN), ["MASS: allowed are 0.01 to 100.00 kg"]);
    assert_eq!(texts_of_setting(&shared, Name::TunedOn, 1.0), ["CFG_ID: is read-only"]);
    assert_eq!(shared.parameters.set_by_hand().count(), 0);
}

#[test]
fn gains_whose_loops_nobody_found_with_margin_are_refused_whatever_the_certificate_says() {
    let shared = Local::new();
    let built = Built { loops: &JudgedLoops::BUILT, identity: 7, ..built() };
    boot::start_with(Box::leak(Box::new(boot::Place::new())), shared.for_boot(), built).unwrap();
    let words = texts_of_setting(&shared, Name::GainRate, 110.0);
    assert_eq!(words, ["GAIN_ATT_D: refused, cannot be flown", "sampled loops: without margin at these gains"]);
    assert_eq!(texts_of_setting(&shared, Name::Mass, 0.4), ["MASS: may be flown, from the next boot on"]);
}

#[test]
fn what_was_built_for_no_vehicle_never_arms_and_says_what_to_do() {
    let shared = Local::new();
    let built = Built { identity: 7, ..built() };
    let place = Box::leak(Box::new(boot::Place::new()));
    let (pilot, _) = boot::start_named(place, shared.for_boot(), built, false).unwrap();
    assert_eq!(texts(&shared), ["No vehicle: build with SCENARIO"]);
    assert_eq!(pilot.grounded().unwrap().to_string(), "Cannot fly with no vehicle: build with SCENARIO");
}

#[test]
fn before_anything_is_built_there_is_nothing_to_tune() {
    let shared = Local::new();
    assert_eq!(texts_of_setting(&shared, Name::Mass, 0.4), ["MASS: not yet"]);
}

#[test]
fn nothing_is_certified_while_a_motor_turns() {
    for mode in Mode::ALL {
        let shared = booted();
        report(&shared, mode, 0);
        let words = texts_of_setting(&shared, Name::Mass, 0.4);
        let turns = mode.is_armed() || mode == Mode::MotorTest;
        assert_eq!(shared.parameters.get(Name::Mass) != 0.4, turns, "{mode:?}: {words:?}");
    }
}

#[test]
fn arming_is_refused_while_a_procedure_runs() {
    let flags: [fn(&Local) -> &Flag; 3] = [|s| &s.saving, |s| &s.judging, |s| &s.restarting];
    for flag in flags {
        let shared = Local::new();
        let (pilot, outputs) = boot::start(Box::leak(Box::new(boot::Place::new())), shared.for_boot()).unwrap();
        let mut control = Control::new(shared.for_control(), pilot, outputs);
        let mut refused = |now: u64| {
            for end in [now - 5_000, now] {
                shared.increment(increment(end));
            }
            shared.request(QueuedRequest { request: Request::Arm, order: None, setpoints: None });
            control.tick(now);
            texts(&shared)
        };
        refused(10_000);
        flag(&shared).raise();
        assert_eq!(refused(20_000), ["Refused: parameters in work, or a restart"]);
        flag(&shared).lower();
        assert_ne!(refused(30_000), ["Refused: parameters in work, or a restart"]);
    }
}

/// Booted with these values stored, the configuration's number among them.
fn booted_with(identity: u32, stored: &[(Name, f32)]) -> (Option<Grounded>, Vec<String>, Local) {
    let mut values = PARAMETERS.map(|row| row.default);
    values[Name::TunedOn as usize] = identity as f32;
    stored.iter().for_each(|&(name, value)| values[name as usize] = value);
    let chip: RefCell<Chip> = chip_with(&values);
    let shared = Local::new();
    Storage::load(Words::<4>(&chip), shared.for_storage());
    let grounded = boot_on(&shared);
    let texts = texts(&shared);
    (grounded, texts, shared)
}

#[test]
fn stored_values_that_do_not_certify_keep_it_on_the_ground_and_are_named() {
    let stored = [(Name::Mass, 0.46), (Name::RotorThrustMax, 3.0)];
    let (grounded, texts, shared) = booted_with(configuration::IDENTITY, &stored);
    assert_eq!(grounded, Some(Grounded::Inequality("R rotors' range")));
    assert_eq!(texts, ["MASS 0.46: cannot be flown", "ROT_THR_MAX 3: cannot be flown"]);
    // It can be mended from the ground.
    assert_eq!(
        texts_of_setting(&shared, Name::RotorThrustMax, 3.6),
        ["ROT_THR_MAX: may be flown, from the next boot on"]
    );
    let (grounded, texts, _) = booted_with(configuration::IDENTITY, &[(Name::ThrustMax, 4.0)]);
    assert_eq!(grounded, Some(Grounded::Parameter("limits.thrust_max")));
    assert_eq!(texts, ["THR_MAX 4: cannot be flown"]);
}

#[test]
fn values_tuned_on_another_configuration_are_dropped_and_reported() {
    let (grounded, texts, shared) =
        booted_with(configuration::IDENTITY ^ 1, &[(Name::Mass, 0.4), (Name::SystemId, 9.0)]);
    assert_eq!(grounded, None);
    assert_eq!(texts, ["Another configuration was tuned: as built now"]);
    assert_eq!(shared.parameters.get(Name::Mass), configuration::embedded().unwrap().vehicle().mass);
    assert_eq!(shared.parameters.get(Name::SystemId), 9.0);
}
