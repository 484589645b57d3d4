use super::*;

const HOME_M: Vector3<f32> = Vector3::new(10.0, -20.0, 1.0);

fn item(leg: Leg, x: f32, y: f32, z: f32) -> MissionItem {
    MissionItem {
        leg,
        position: HOME_M + Vector3::new(x, y, z),
        turn: HeadingSetpoint::Keep,
        radius: ACCEPTANCE_RADIUS_M,
        hold: 0,
    }
}

fn checked(item: &MissionItem) -> Result<(), MissionRefusal> {
    item.check(&HOME_M, &FlightSettings { fence_radius: 5.0, fence_height: 4.0, ..FlightSettings::DEFAULT })
}

#[test]
fn an_item_is_checked_against_the_fence_about_home_and_the_height_of_home() {
    for (x, z, verdict) in [
        (4.9, 3.9, Ok(())),
        (0.0, 0.0, Ok(())),
        (5.1, 2.0, Err(MissionRefusal::OutsideFence)),
        (0.0, 4.1, Err(MissionRefusal::OutsideFence)),
        (0.0, -0.1, Err(MissionRefusal::BelowHome)),
        (f32::NAN, 1.0, Err(MissionRefusal::Number)),
        (0.0, f32::INFINITY, Err(MissionRefusal::Number)),
    ] {
        assert_eq!(checked(&item(Leg::Waypoint, x, 0.0, z)), verdict, "{x} {z}");
    }
}

#[test]
fn a_take_off_is_checked_by_its_height_a_landing_by_its_place_and_a_return_not_at_all() {
    assert_eq!(checked(&item(Leg::TakeOff, 900.0, 0.0, 2.0)), Ok(()));
    assert_eq!(checked(&item(Leg::TakeOff, 0.0, 0.0, 0.4)), Err(MissionRefusal::TakeOffHeight));
    assert_eq!(checked(&item(Leg::TakeOff, 0.0, 0.0, 4.1)), Err(MissionRefusal::OutsideFence));
    assert_eq!(checked(&item(Leg::Land, 1.0, 0.0, -3.0)), Ok(()));
    assert_eq!(checked(&item(Leg::Land, 0.0, 6.0, 0.0)), Err(MissionRefusal::OutsideFence));
    assert_eq!(checked(&item(Leg::Return, f32::NAN, 0.0, 0.0)), Ok(()));
}

#[test]
fn a_landing_is_reached_at_rest_only_and_a_waypoint_in_passing() {
    let (waypoint, landing) = (item(Leg::Waypoint, 1.0, 0.0, 1.0), item(Leg::Land, 1.0, 0.0, 1.0));
    assert!(waypoint.is_reached(0.29, 2.0, false) && !waypoint.is_reached(0.31, 0.0, false));
    assert!(landing.is_reached(0.04, 0.04, false));
    assert!(!landing.is_reached(0.04, 2.0, false) && !landing.is_reached(0.29, 0.0, false));
}
