use super::*;

fn call(first: f32) -> Call {
    let mut parameters = [0.0; 7];
    parameters[0] = first;
    Call { command: MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, parameters, place: None }
}

#[test]
fn only_the_station_that_armed_disarms_while_it_sends() {
    let mut commander = Commander::default();
    let armed = Some(Stamped { value: Some((255, 1)), time: 0 });
    assert!(
        !commander.may_command(&call(0.0), (254, 1), armed, 1_000)
            && commander.may_command(&call(0.0), (255, 1), armed, 1_000)
    );
    commander.receive((255, 1), armed, 2_000_000);
    commander.receive((254, 1), armed, 2_000_001);
    assert!(!commander.may_command(&call(0.0), (254, 1), armed, 2_000_000 + COMMANDER_TIMEOUT_US));
    assert!(commander.may_command(&call(0.0), (254, 1), armed, 2_000_001 + COMMANDER_TIMEOUT_US));
    // Arming counts as receiving it.
    let later = Some(Stamped { value: Some((9, 1)), time: 9_000_000 });
    assert!(!commander.may_command(&call(0.0), (255, 1), later, 9_000_000 + COMMANDER_TIMEOUT_US));
}

#[test]
fn any_station_may_send_other_requests_and_disarm_what_no_station_armed() {
    let commander = Commander::default();
    let armed = Some(Stamped { value: Some((255, 1)), time: 0 });
    assert!(commander.may_command(&Call { command: MavCmd::MAV_CMD_NAV_LAND, ..call(0.0) }, (7, 1), armed, 0));
    assert!(commander.may_command(&call(1.0), (7, 1), armed, 0));
    for no_station in [None, Some(Stamped { value: None, time: 0 })] {
        assert!(commander.may_command(&call(0.0), (7, 1), no_station, 0));
    }
}
