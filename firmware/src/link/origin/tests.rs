use super::*;

#[test]
fn there_and_back_is_within_a_centimetre_anywhere() {
    for (latitude, longitude) in [(0, 0), (473_977_420, 85_455_940), (-337_000_000, -708_000_000), (840_000_000, 5)] {
        let origin = Origin::new(latitude, longitude, 488_000).unwrap();
        for ned in [Vector3::new(3.0, -40.0, -2.5), Vector3::new(-100.0, 100.0, 7.0), Vector3::zeros()] {
            let back = origin.local(&origin.place(&ned));
            assert!((back - ned).norm() < 0.02, "{origin:?}: {ned} {back}");
        }
    }
}

#[test]
fn a_degree_of_longitude_is_half_as_long_at_sixty_degrees() {
    let origin = Origin::new(600_000_000, 0, 0).unwrap();
    let place = Place { latitude: 600_000_000, longitude: 10_000, altitude: 0.0 };
    let local = origin.local(&place);
    assert!((local.y - 0.5 * 10_000.0 * M_PER_UNIT).abs() < 0.01, "{local}");
    assert_eq!(local.x, 0.0);
}

#[test]
fn places_that_are_none_are_refused() {
    assert!(Origin::new(860_000_000, 0, 0).is_none() && Origin::new(0, 1_900_000_000, 0).is_none());
    assert!(Origin::new(i32::MIN, i32::MIN, 0).is_none());
}
