//! Bounds left out, stated and refused.

use super::*;

const REFERENCE_TAKES: ReferenceBounds = ReferenceBounds {
    horizontal_speed: 5.0,
    horizontal_acceleration: 2.0,
    vertical_acceleration: 0.25,
    jerk: 3.0,
    snap: 5.0,
    heading_rate: 1.0,
    heading_second_derivative: 1.5,
};

const WIDER_SECTION: &str = "[reference_bounds]
horizontal_acceleration = 2.5
vertical_acceleration = 0.5
jerk = 4.0
snap = 7.0
heading_rate = 1.0
heading_second_derivative = 2.0
";

fn read(text: &str) -> Result<ReferenceBounds, FieldError> {
    read_bounds(&Section::root(&text.parse().unwrap()), &REFERENCE_TAKES, || REFERENCE_TAKES)
}

#[test]
fn left_out_they_are_the_references_own() {
    assert_eq!(read(""), Ok(REFERENCE_TAKES));
}

#[test]
fn left_out_they_are_what_the_vehicle_can_fly_where_that_is_more() {
    let flyable = ReferenceBounds { horizontal_speed: 5.0, jerk: 6.0, snap: 4.0, ..ReferenceBounds::REST };
    assert_eq!(REFERENCE_TAKES.covering(&flyable), ReferenceBounds { jerk: 6.0, ..REFERENCE_TAKES });
    // Stated ones are what was stated, and those that are left out beside them are what the vehicle can fly.
    let stated = |text: &str| read_bounds(&Section::root(&text.parse().unwrap()), &ReferenceBounds::REST, || flyable);
    assert_eq!(stated(WIDER_SECTION).unwrap().jerk, 4.0);
    let wider = ReferenceBounds { snap: 9.0, ..REFERENCE_TAKES };
    assert_eq!(read("[reference_bounds]\nsnap = 9.0"), Ok(wider));
    // What would be zero is needed.
    let needed = stated("[reference_bounds]\nsnap = 3.0").unwrap_err();
    assert_eq!(needed.field, "reference_bounds.horizontal_acceleration");
}

#[test]
fn stated_they_replace_the_references_own() {
    let wider = ReferenceBounds {
        horizontal_speed: 5.0,
        horizontal_acceleration: 2.5,
        vertical_acceleration: 0.5,
        jerk: 4.0,
        snap: 7.0,
        heading_rate: 1.0,
        heading_second_derivative: 2.0,
    };
    assert_eq!(read(WIDER_SECTION), Ok(wider));
    assert_eq!(read(&crate::constants::written(wider.entries())), Ok(wider));
}

#[test]
fn each_unusable_bound_is_named_with_the_reason() {
    for (from, to, field, words) in [
        ("jerk = 4.0", "jerk = 2.9", "reference_bounds.jerk", "at least 3, which [reference] takes, found 2.9"),
        ("jerk = 4.0", "jerk = -1", "reference_bounds.jerk", "found -1"),
        ("jerk = 4.0", "jerk = nan", "reference_bounds.jerk", "finite"),
        ("jerk = 4.0", "jerk = \"hard\"", "reference_bounds.jerk", "must be a number"),
        ("snap = 7.0", "snapp = 7.0", "reference_bounds.snapp", "did you mean \"snap\"?"),
        ("heading_rate = 1.0", "heading_rate = 0.999", "reference_bounds.heading_rate", "at least 1"),
    ] {
        assert!(WIDER_SECTION.contains(from), "{from}");
        let error = read(&WIDER_SECTION.replace(from, to)).unwrap_err();
        assert!(error.field == field && error.problem.contains(words), "{to}: {error}");
    }
    assert_eq!(read("reference_bounds = 3").unwrap_err().field, "reference_bounds");
}
