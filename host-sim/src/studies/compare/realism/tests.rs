//! The scenes differ from the file in what they say, and in nothing else; and what a law makes of them.

use super::*;
use crate::rivals::choice::LawChoice;
use crate::rivals::gains::Set;
use crate::rivals::kind::RivalKind;

const HUMMINGBIRD: &str = include_str!("../../../../../vehicles/hummingbird.toml");

fn hummingbird() -> Scenario {
    Scenario::parse(HUMMINGBIRD, "hummingbird.toml").unwrap()
}

#[test]
fn each_scene_has_its_difference() {
    let file = hummingbird();
    let scenes = all(&file).unwrap();
    let of = |name: &str| &scenes.iter().find(|scene| scene.name == name).unwrap().scenario;
    assert_eq!(of("delay").delay_steps, file.delay_steps + 20);
    let truth = |name: &str| of(name).reality.truth.clone().unwrap();
    assert!((truth("mass").mass - 0.8).abs() < 1e-6 && (truth("wind").mass - 0.5).abs() < 1e-6);
    assert!((of("battery").reality.battery.unwrap().full_voltage - 0.75).abs() < 1e-12);
    assert_eq!(of("wind").reality.wind.unwrap().steady, Vector3::x() * 8.0);
    // 2 k_m w lag at 469 rad/s.
    assert!((truth("flywheels").rotor_inertia - 6.4e-7).abs() < 1e-8, "{}", truth("flywheels").rotor_inertia);
    let drag = of("drag").reality.drag.unwrap();
    assert!((drag.rotor_across - 2.0 * 1.19e-4).abs() < 1e-12 && drag.flapping > 1e-7, "{drag:?}");
    assert_eq!((truth("deadband").deadband, truth("mild").deadband), (0.02, 0.01));
    // Neighbours are 0.24 m apart.
    assert!((truth("ground").rotor_radius - 0.108).abs() < 1e-3 && of("ground").reality.ground.is_some());
    assert!(scenes.iter().all(|scene| scene.name == "ground" || scene.scenario.reality.ground.is_none()));
}

#[test]
fn a_strong_law_holds_the_vehicle_in_every_scene_and_its_figures_are_rows() {
    let file = hummingbird();
    let set = Set::built_in(&file, &[RivalKind::Indi]).unwrap();
    let law: LawChoice = set.laws().next().unwrap();
    let law = LawOnVehicle::new(&law, &file, None).unwrap();
    let figures: Vec<_> =
        all(&file).unwrap().iter().map(|scene| (scene.name, vec![fly_realism_scene(&law, scene)])).collect();
    let rows = rows(&figures);
    assert_eq!(rows.len(), 4 * 9);
    let of = |scene: &str, figure: &str| rows.iter().find(|row| row.scene == scene && row.figure == figure).unwrap();
    for row in rows.iter().filter(|row| row.figure == "lost") {
        assert_eq!(row.values, [0.0], "{}", row.scene);
    }
    assert!(of("mass", "height lost").values[0] > 0.1);
    assert!(
        of("wind", "position error, last half, RMS").values[0]
            > of("flywheels", "position error, last half, RMS").values[0]
    );
    // A flight that ended early.
    let early = super::rows(&[("delay", vec![None])]);
    assert_eq!((early[0].values[0], early[1].values[0]), (1.0, f64::INFINITY));
}
