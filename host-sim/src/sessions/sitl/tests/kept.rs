//! What a session keeps, or takes at its start: parameters and a key.

use super::*;

#[test]
fn a_key_that_was_kept_is_the_cameras_as_well() {
    let path = std::env::temp_dir().join(format!("sitl-kept-key-{}", std::process::id()));
    let key = Key::new([7; _]);
    let boot = |key| Flown::boot_with(PoseSource::Camera, STUDY, &[], Some(path.clone()), key);
    // Long enough to be saved.
    let mut given = boot(key);
    given.signing.set(key, key::now(), 0);
    given.pass(6.0);
    assert_eq!(given.mode(), Mode::Ready, "{:?}", given.sitl.texts);
    drop(given);
    let mut kept = boot(None);
    kept.signing.set(key, key::now() + 2 * KEPT_AHEAD, 0);
    kept.pass(6.0);
    std::fs::remove_file(&path).unwrap();
    assert_eq!(kept.mode(), Mode::Ready, "{:?}", kept.sitl.texts);
    assert!(!kept.said("Refused: not signed"));
}

#[test]
fn parameters_outlast_a_session_and_count_at_the_next_boot() {
    use firmware::parameters::table::Name;
    let file = std::env::temp_dir().join(format!("sitl-parameters-{}", std::process::id()));
    let mut first = Flown::boot(STUDY, &[], Some(file.clone()));
    first.pass(1.0);
    first.sitl.shared.parameters.set(Name::TakeOffHeight, 3.0).unwrap();
    first.pass(1.0);
    let second = Flown::boot(STUDY, &[], Some(file.clone()));
    assert_eq!(second.sitl.shared.parameters.get(Name::TakeOffHeight), 3.0);
    std::fs::write(&file, "something else").unwrap();
    let refused = DeskFlash::open(Some(file.clone())).unwrap_err();
    std::fs::remove_file(&file).unwrap();
    assert!(refused.contains("is no file of parameters"), "{refused}");
}

#[test]
fn a_gain_is_set_refused_or_certified_and_flown_after_a_restart() {
    use firmware::parameters::table::Name;
    use mavlink::dialects::common::{MavParamType, PARAM_SET_DATA};
    let mut flown = Flown::boot(STUDY, &[], None);
    flown.pass(5.0);
    let set = |flown: &mut Flown, name: &str, param_value: f32| {
        let param_type = MavParamType::MAV_PARAM_TYPE_REAL32;
        let ids = (1, 1);
        flown.send(&PARAM_SET_DATA {
            param_value,
            target_system: ids.0,
            target_component: ids.1,
            param_id: name.into(),
            param_type,
        });
        flown.pass(0.2);
    };
    set(&mut flown, "ROT_THR_MAX", 2.0);
    let row = "R rotors' range: needs ";
    assert!(flown.said("ROT_THR_MAX: refused") && flown.said(row), "{:?}", flown.sitl.texts);
    set(&mut flown, "GAIN_ATT_P", 80.0);
    assert!(flown.said("GAIN_ATT_P: may be flown, from the next boot on"), "{:?}", flown.sitl.texts);
    let before: *const _ = flown.sitl.shared;
    flown.command(MavCmd::MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1.0);
    flown.pass(6.0);
    assert_ne!(before, std::ptr::from_ref(flown.sitl.shared), "{:?}", flown.sitl.texts);
    assert_eq!(flown.sitl.shared.parameters.get(Name::GainAttitude), 80.0);
    assert_eq!(flown.mode(), Mode::Ready, "{:?}", flown.sitl.texts);
    flown.command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, 1.0);
    flown.command(MavCmd::MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1.0);
    assert!(flown.said("Restart: only disarmed"), "{:?}", flown.sitl.texts);
    flown.command(MavCmd::MAV_CMD_NAV_TAKEOFF, 0.0);
    flown.pass(14.8);
    assert_eq!(flown.mode(), Mode::Holding, "{:?}", flown.sitl.texts);
    assert!((flown.sitl.hardware.state().position.z - 1.5).abs() < 0.05);
}

#[test]
fn a_vehicle_with_a_key_believes_its_camera_and_obeys_who_signs() {
    const ARM: MavCmd = MavCmd::MAV_CMD_COMPONENT_ARM_DISARM;
    let key = Key::new([0x5A; 32]);
    let mut flown = Flown::boot_with(PoseSource::Camera, STUDY, &[], None, key);
    // A ground station's frames count only if it signs.
    flown.pass(5.0);
    assert_eq!(flown.mode(), Mode::Checks);
    flown.signing.set(key, key::now(), 0);
    flown.pass(1.0);
    assert_eq!(flown.mode(), Mode::Ready, "{:?}", flown.sitl.texts);
    flown.signing.set(None, 0, 0);
    flown.command(ARM, 1.0);
    assert_eq!((flown.mode(), flown.said("Refused: not signed")), (Mode::Ready, true));
    flown.signing.set(key, key::now(), 0);
    flown.command(ARM, 1.0);
    assert_eq!(flown.mode(), Mode::Idling, "{:?}", flown.sitl.texts);
    flown.command(ARM, 0.0);
    flown.command(MavCmd::MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1.0);
    flown.pass(6.0);
    // Key and received stamps outlast a restart: this client did not receive how far the stamps have come.
    flown.command(ARM, 1.0);
    assert_eq!((flown.mode(), flown.said("its time stamp was used before")), (Mode::Checks, true));
    flown.signing.set(key, key::now() + 2 * KEPT_AHEAD, 0);
    flown.pass(1.0);
    flown.command(ARM, 1.0);
    assert_eq!(flown.mode(), Mode::Idling, "{:?}", flown.sitl.texts);
}
