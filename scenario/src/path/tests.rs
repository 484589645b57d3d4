use super::*;
use crate::Scenario;

fn swing(scenario: &Scenario) -> Option<Swing> {
    Swing::find(&scenario.reference, &*scenario.trajectory)
}

/// The paper's vehicle on five gates, one leg much longer than the others: the smoothest path dives.
fn gates(change: impl Fn(&str) -> String) -> Result<Scenario, String> {
    let points = [(0.0, 0.0, 1.0), (4.0, 4.0, 2.0), (16.0, 5.0, 2.0), (20.0, 0.0, 2.5), (24.0, 0.0, 1.0)]
        .map(|(t, x, z)| format!("{{ t = {t:?}, position = [{x:?}, 0.0, {z:?}] }}"));
    let (head, _) = crate::PAPER.split_once("[initial]").unwrap();
    let text = format!("{head}[reference]\nkind = \"waypoints\"\npoints = [{}]\n", points.join(", "));
    Scenario::parse(&change(&text), "gates").map_err(|error| error.to_string())
}

fn lifted(text: &str) -> String {
    text.replace(", 1.0] }", ", 11.0] }").replace(", 2.0] }", ", 12.0] }").replace(", 2.5] }", ", 12.5] }")
}

#[test]
fn a_path_that_leaves_the_box_of_its_points_says_by_how_much_where_and_when() {
    let scenario = gates(lifted).unwrap();
    let swing = swing(&scenario).expect("the smoothest path swings out");
    let found = scenario.trajectory.at((swing.at.time * 1e6) as u64).position.map(f64::from);
    assert!((found - swing.at.position).norm() < 1e-3, "{swing:?}");
    let corners = [Vector3::new(0.0, 0.0, 11.0), Vector3::new(5.0, 0.0, 12.5)];
    let out = found - found.sup(&corners[0]).inf(&corners[1]);
    assert!((out.norm() - swing.distance).abs() < 1e-3 && swing.distance > 0.5, "{swing:?}");
    // No instant of a finer grid is further out.
    for i in 0..24_000 {
        let found = scenario.trajectory.at(i * 1_000).position.map(f64::from);
        let out = (found - found.sup(&corners[0]).inf(&corners[1])).norm();
        assert!(out <= swing.distance + 1e-3, "{out} at {i} ms: {swing:?}");
    }
}

#[test]
fn a_path_inside_does_not_swing_out() {
    let inside = |text: &str| text.replace("kind = \"waypoints\"", "kind = \"waypoints\"\npath = \"inside\"");
    assert_eq!(swing(&gates(inside).unwrap()), None);
    let smooth = |text: &str| lifted(&text.replace("kind = \"waypoints\"", "kind = \"waypoints\"\npath = \"smooth\""));
    assert_eq!(swing(&gates(smooth).unwrap()), swing(&gates(lifted).unwrap()));
    let wrong = |text: &str| text.replace("kind = \"waypoints\"", "kind = \"waypoints\"\npath = \"straight\"");
    let refused = gates(wrong).err().unwrap();
    assert!(refused.contains("reference.path: must be \"smooth\" or \"inside\", found \"straight\""), "{refused}");
}

#[test]
fn a_reference_below_the_ground_is_refused_with_the_place_and_time() {
    let refused = gates(str::to_owned).err().unwrap();
    let words = "gates: reference.points: the path must stay above the ground at 0 m, found (";
    assert!(refused.starts_with(words) && refused.contains("path = \"inside\""), "{refused}");
    // Whose points lie below zero does not call that the ground; with [ground] the file says where it is.
    let sunk = |text: &str| text.replace("[0.0, 0.0, 1.0]", "[0.0, 0.0, -0.1]");
    gates(sunk).unwrap();
    let above = gates(|text| lifted(text) + "[ground]\nheight = 10.5\n").err().unwrap();
    assert!(above.contains("the path must stay above the ground at 10.5 m"), "{above}");
    for (reference, field) in [
        ("kind = \"hover\"\nposition = [0.0, 0.0, 1.0]", "reference.position"),
        (
            "kind = \"harmonic\"\ncenter = [0.0, 0.0, 2.4]\namplitude = [0.0, 0.0, 0.5]\nfrequency = [0.5, 0.5, 0.5]",
            "reference.center",
        ),
    ] {
        let (head, _) = crate::PAPER.split_once("[reference]").unwrap();
        let with = |height: f64| {
            let text = format!("{head}[reference]\n{reference}\n[ground]\nheight = {height:?}\n");
            Scenario::parse(&text, "low").map(drop).map_err(|error| error.to_string())
        };
        let refused = with(2.0).unwrap_err();
        assert!(refused.contains(&format!("{field}: the path must stay above the ground at 2 m")), "{refused}");
        assert_eq!(with(0.9), Ok(()));
    }
}
