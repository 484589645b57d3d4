//! Each scene fails as it says and ends on the ground; and what a law makes of them.

use super::*;
use crate::rivals::choice::LawChoice;
use crate::rivals::gains::Set;
use crate::rivals::kind::RivalKind;
use crate::studies::compare::certified;

const HUMMINGBIRD: &str = include_str!("../../../../../vehicles/hummingbird.toml");

fn hummingbird() -> Scenario {
    Scenario::parse(HUMMINGBIRD, "hummingbird.toml").unwrap()
}

#[test]
fn each_reference_goes_on_after_the_failure_and_then_down_where_it_stopped() {
    let scenes = all(&hummingbird()).unwrap();
    assert_eq!(scenes.len(), 16);
    for Scene { name, scenario, .. } in scenes {
        let failure = scenario.reality.failure.unwrap();
        let at = |time: f64| scenario.trajectory.at((time * 1e6) as u64);
        let goes_on = at(failure.time + AFTER_FAILURE_S);
        assert!(goes_on.position.z.abs() < 0.02, "{name}: {goes_on:?}");
        let circles = name.starts_with("circle");
        assert!((goes_on.velocity.norm() > 1.5) == circles && (goes_on.position.norm() > 0.95) == circles, "{name}");
        let end = scenario.timing.duration();
        let [down, below] = [at(failure.time + AFTER_FAILURE_S + 18.0), at(end)];
        assert!((down.velocity - Vector3::z() * -0.6).norm() < 0.02, "{name}: {down:?}");
        assert!(below.position.z < -12.0 && (below.position - down.position).xy().norm() < 1e-3, "{name}: {below:?}");
        let accelerations = (0..2000).map(|number| at(0.01 * f64::from(number)).acceleration.norm());
        let acceleration = accelerations.fold(0.0, f32::max);
        assert!(acceleration < 3.0, "{name}: {acceleration}");
    }
}

#[test]
fn ours_lands_softly_where_a_rival_that_holds_its_heading_falls() {
    let file = hummingbird();
    let certified = certified(&file).unwrap();
    let rival = Set::built_in(&file, &[RivalKind::Indi]).unwrap().laws().next().unwrap();
    let landed = |law: &LawChoice, name: &str| {
        let law = LawOnVehicle::new(law, &file, Some(&certified)).unwrap();
        fly_loss_scene(&law, all(&file).unwrap().iter().find(|scene| scene.name == name).unwrap())
    };
    for name in ["hover, 0 %", "circle, 0 %", "upside down, 0 %"] {
        let ours = landed(&LawChoice::Ours, name).unwrap();
        assert!(ours.is_soft() && ours.speed > 0.3, "{name}: {ours:?}");
    }
    let rivals = landed(&rival, "hover, 0 %");
    assert!(rivals.is_none_or(|landing| !landing.is_soft() && landing.height_lost > 3.0), "{rivals:?}");
    let rows = rows(&[("hover, 0 %", vec![landed(&LawChoice::Ours, "hover, 0 %"), None])]);
    assert_eq!(rows.len(), 4);
    assert!(rows.iter().all(|row| row.values[0] > 0.0 && row.values[1].is_infinite()), "{rows:?}");
}
