//! A policy, from the ground station's mode to the station's texts. The firmware's usual build carries none and
//! refuses. CI runs this with `POLICY=vehicles/policies/hover.toml` and with `raptor.toml` too: then the network flies.

use super::flight::Flight;
use ::flight::{Aboard, Mode};
use firmware::configuration::Policy;
use mavlink::dialects::common::MavResult;

#[test]
fn a_policy_flies_to_a_setpoint_where_one_is_built_in_and_is_refused_where_none_is() {
    let mut flight = Flight::in_the_air();
    flight.station.go_to([0.0, 0.0, 2.0]);
    flight.pass(6.0);
    flight.station.forget_acknowledgements();
    flight.station.fly_policy();
    flight.pass(1.0);
    if !Policy::EXISTS {
        assert_eq!(flight.station.acknowledged(), Some(MavResult::MAV_RESULT_DENIED));
        assert!(flight.station.received("Refused: no policy is built in").is_some());
        assert!(!flight.report().flies_policy);
        return;
    }
    assert_eq!(flight.station.acknowledged(), Some(MavResult::MAV_RESULT_ACCEPTED));
    assert!(flight.station.received("Policy flies").is_some(), "{:?}", flight.station.texts());
    flight.station.go_to([1.5, -1.0, 2.5]);
    flight.pass(10.0);
    assert!(flight.distance([1.5, -1.0, 2.5]) < 0.1, "{}", flight.distance([1.5, -1.0, 2.5]));
    let report = flight.report();
    assert!(report.flies_policy && report.mode == Mode::Flying);
    assert_eq!(flight.station.received("Law flies"), None);
    flight.station.hold();
    flight.pass(3.0);
    let report = flight.report();
    assert!(!report.flies_policy && report.mode == Mode::Holding);
    assert!(flight.distance([1.5, -1.0, 2.5]) < 0.1);
}
