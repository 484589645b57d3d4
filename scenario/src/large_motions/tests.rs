//! That the model flies as vehicles do, and what cycles.

use super::*;
use crate::Scenario;

fn scenario(text: &str) -> Scenario {
    Scenario::parse(text, "f").unwrap()
}

fn found(text: &str) -> Result<Farthest, NotArrived> {
    let scenario = scenario(text);
    let certified = Certified::new(scenario.configuration.clone()).unwrap();
    flown(&certified, &scenario.loop_timing()).unwrap()
}

const FIREFLY: &str = include_str!("../../../vehicles/published/firefly.toml");

#[test]
fn a_thrust_direction_that_may_hardly_turn_makes_a_cycle_that_is_certified_and_named() {
    // A weak yaw: the vehicle falls until its spin is gone.
    let farthest = found(FIREFLY).unwrap();
    assert!(farthest.start == "a spin upside down" && farthest.distance > 100.0, "{farthest:?}");
    let slow = format!("{FIREFLY}\n[control]\nlaw = \"extended\"\n[gains]\nturn_rate = 0.6\n");
    let not_arrived = found(&slow).unwrap_err();
    assert!(not_arrived.distance > 0.5, "{not_arrived:?}");
    let text = not_arrived.to_string();
    assert!(text.starts_with("model flight from ") && text.contains("gains.turn_rate"), "{text}");
}
