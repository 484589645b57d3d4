//! The rotation to the desired attitude, and what measured force and torque are for: what the model does not know
//! leaves no offset.

use super::*;
use crate::flight::Flight;
use crate::flight::course::Course;
use crate::flight::tasks::hover;
use crate::rivals::gains::{BUILT_IN, Set};
use crate::rivals::kind::RivalKind;
use scenario::Scenario;
use scenario::reality::truth::Truth;

const HUMMINGBIRD: &str = include_str!("../../../../vehicles/hummingbird.toml");

#[test]
fn the_thrust_axis_goes_the_shortest_way_whatever_the_heading() {
    let state = UnitQuaternion::from_euler_angles(0.4, -0.3, 2.0);
    for (tilt, heading) in [(0.5, 0.0), (2.9, 1.0), (3.1, -3.0), (0.0, 2.0), (1.0, 3.1)] {
        let tilted = UnitQuaternion::from_scaled_axis(Vector3::new(0.6, -0.8, 0.0) * tilt);
        let desired = state * tilted * UnitQuaternion::from_scaled_axis(Vector3::z() * heading);
        let turn = turn(&state, &desired);
        assert!((turn - Vector3::new(0.6 * tilt, -0.8 * tilt, heading)).norm() < 1e-9, "{tilt} {heading}: {turn}");
        let axis = (state * Vector3::z()).angle(&(desired * Vector3::z()));
        assert!((turn.xy().norm() - axis).abs() < 1e-7, "{tilt} {heading}");
    }
}

#[test]
fn a_wrong_mass_weak_rotors_and_an_off_centre_mass_leave_no_offset() {
    let file = Scenario::parse(HUMMINGBIRD, "hummingbird.toml").unwrap();
    let (_, gains, _) = Set::parse(&file, BUILT_IN, "gains.toml", &[RivalKind::Indi]).unwrap().rivals.remove(0);
    let model = Truth::model(file.configuration.vehicle());
    for truth in [
        Truth { mass: 0.7, ..model.clone() },
        Truth { thrust_scale: 0.7, ..model.clone() },
        Truth { centre_of_mass: Vector3::new(0.005, -0.003, 0.0), ..model },
    ] {
        let mut hovering = hover(&file, Vector3::new(0.2, 0.0, 0.1), 12.0).unwrap();
        hovering.reality.truth = Some(truth.clone());
        let course =
            Course::fly(&hovering, Flight::of_rival(&hovering, RivalKind::Indi.build(&file, &gains).unwrap()), 0.1)
                .unwrap();
        assert!(course.end_error < 1e-3, "{truth:?}: {course:?}");
    }
}
