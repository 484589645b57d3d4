use crate::extended::approach::Approach;

/// k_p, k_v, v_c and the acceleration that brakes.
const ONE: [f32; 4] = [20.0, 6.0, 9.0, 7.0];

fn speed(distance: f32, [k_p, k_v, fastest, braking]: [f32; 4]) -> f32 {
    Approach::new(k_p, k_v, fastest).factor(distance * distance, braking) * distance
}

#[test]
fn near_the_target_the_approach_is_k_p_over_k_v_and_far_away_its_greatest_speed() {
    let [k_p, k_v, fastest, _] = ONE;
    assert!((speed(1e-5, ONE) / (1e-5 * k_p / k_v) - 1.0).abs() < 1e-3);
    assert!((speed(1e5, ONE) / fastest - 1.0).abs() < 1e-2);
}

#[test]
fn a_vehicle_that_answers_late_and_then_brakes_stops_within_its_distance() {
    let [k_p, k_v, _, braking] = ONE;
    let answering = k_v / k_p;
    for distance in [0.01_f32, 0.1, 1.0, 10.0, 100.0] {
        let v = speed(distance, ONE);
        let way = v * answering + v * v / (2.0 * braking);
        assert!(way <= distance * 1.0001, "{distance}: {way}");
        // Without a greatest speed it is all of it.
        let v = speed(distance, [k_p, k_v, 1e6, braking]);
        let way = v * answering + v * v / (2.0 * braking);
        assert!((way / distance - 1.0).abs() < 1e-4, "{distance}: {way}");
    }
}

#[test]
fn the_approach_grows_with_the_distance_and_with_what_brakes() {
    let mut before = 0.0;
    for tenths in 1..1_000_u16 {
        let v = speed(0.1 * f32::from(tenths), ONE);
        assert!(v > before);
        before = v;
    }
    let [k_p, k_v, fastest, braking] = ONE;
    assert!(speed(3.0, [k_p, k_v, fastest, 2.0 * braking]) > speed(3.0, ONE));
}
