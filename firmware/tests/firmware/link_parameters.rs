//! Parameters read and set over a link: what is taken, and what is answered.

use crate::support::receiver::{Fed, Local, disarm, replies, report, texts};
use firmware::parameters::table::{Name, PARAMETERS};
use firmware::shared::Reply;
use flight::Mode;
use mavlink::dialects::common::{
    COMMAND_LONG_DATA, MavParamType, PARAM_REQUEST_LIST_DATA, PARAM_REQUEST_READ_DATA, PARAM_SET_DATA,
};

fn set(name: &str, param_value: f32) -> PARAM_SET_DATA {
    let param_type = MavParamType::MAV_PARAM_TYPE_REAL32;
    PARAM_SET_DATA { param_value, target_system: 1, target_component: 1, param_id: name.into(), param_type }
}

#[test]
fn a_parameter_is_set_and_its_value_sent() {
    let shared = Local::new();
    Fed::new(&shared).message(&set("TLM_RATE", 50.0), 0);
    assert_eq!(shared.parameters.get(Name::TelemetryRate), 50.0);
    assert_eq!(replies(&shared), [Reply::Parameter(Name::TelemetryRate)]);
}

#[test]
fn a_value_that_is_not_allowed_changes_nothing_and_is_refused_in_words() {
    for value in [51.0, 9.0, 20.5, f32::NAN, f32::INFINITY, -25.0] {
        let shared = Local::new();
        Fed::new(&shared).message(&set("TLM_RATE", value), 0);
        assert_eq!(shared.parameters.get(Name::TelemetryRate), 25.0, "{value}");
        assert_eq!(texts(&shared), ["TLM_RATE: allowed are 10.00 to 50.00 Hz"]);
        assert_eq!(replies(&shared), [Reply::Parameter(Name::TelemetryRate)]);
    }
    let shared = Local::new();
    let param_type = MavParamType::MAV_PARAM_TYPE_INT32;
    Fed::new(&shared).message(&PARAM_SET_DATA { param_type, ..set("TLM_RATE", 50.0) }, 0);
    assert_eq!(shared.parameters.get(Name::TelemetryRate), 25.0);
}

#[test]
fn parameters_do_not_change_in_flight() {
    for mode in Mode::ALL {
        let shared = Local::new();
        report(&shared, mode, 0);
        Fed::new(&shared).message(&set("TLM_RATE", 50.0), 0);
        assert_eq!(shared.parameters.get(Name::TelemetryRate) == 50.0, !mode.is_armed(), "{mode:?}");
    }
}

#[test]
fn parameters_are_read_by_name_by_index_and_all_together() {
    let read = |param_index: i16, name: &str| PARAM_REQUEST_READ_DATA {
        param_index,
        target_system: 1,
        target_component: 0,
        param_id: name.into(),
    };
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    for (index, row) in PARAMETERS.iter().enumerate() {
        fed.message(&read(-1, row.name), 0);
        fed.message(&read(index as i16, ""), 0);
        assert_eq!(replies(&shared), [Reply::Parameter(row.parameter), Reply::Parameter(row.parameter)]);
    }
    for missing in [read(-1, "K_P"), read(PARAMETERS.len() as i16, ""), read(i16::MIN, "")] {
        fed.message(&missing, 0);
    }
    fed.message(&set("K_P", 1.0), 0);
    assert!(replies(&shared).is_empty());
    fed.message(&PARAM_REQUEST_LIST_DATA { target_system: 1, target_component: 1 }, 0);
    assert_eq!(replies(&shared), [Reply::AllParameters]);
}

#[test]
fn the_vehicle_answers_to_its_new_number_at_once() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    fed.message(&set("SYS_ID", 9.0), 0);
    fed.message(&disarm(), 0);
    assert!(!shared.disarm.is_raised());
    fed.message(&COMMAND_LONG_DATA { target_system: 9, ..disarm() }, 0);
    assert!(shared.disarm.is_raised());
}
