//! Gusts against their formulas, at the step at which they begin.

use super::*;

const STEP_S: f64 = 1e-3;

fn blowing(shape: Shape) -> MovingAir {
    let gust = Gust { shape, start: 0.3, velocity: Vector3::new(4.0, 0.0, -2.0) };
    MovingAir::new(&Wind { steady: Vector3::new(1.0, 2.0, 3.0), gust: Some(gust), turbulence: None }, STEP_S)
}

/// The wind less the steady wind, over the gust's velocity.
fn share_at(air: &MovingAir, step: u64, part: f64) -> f64 {
    let extra = air.velocity(step, part) - Vector3::new(1.0, 2.0, 3.0);
    assert!((extra.z + 0.5 * extra.x).abs() < 1e-12 && extra.y == 0.0);
    extra.x / 4.0
}

#[test]
fn a_step_is_there_from_its_plant_step_on_and_not_at_the_end_of_the_one_before() {
    let air = blowing(Shape::Step);
    assert_eq!((share_at(&air, 299, 1.0), share_at(&air, 300, 0.0), share_at(&air, 9000, 0.5)), (0.0, 1.0, 1.0));
    for (time, step) in [(0.0, 0), (0.3, 300), (0.3004, 301), (0.7, 700), (1e4, 10_000_000)] {
        assert_eq!(first_step(time, STEP_S), step);
    }
}

#[test]
fn cosines_rise_as_they_should_and_stay_or_fall() {
    let (rising, pulse) = (blowing(Shape::OneCosine(2.0)), blowing(Shape::Pulse(2.0)));
    // A quarter, a half and the whole of 2 s after 0.3 s.
    let quarter = 0.5 * (1.0 - (PI / 4.0).cos());
    for (step, up, there_and_back) in
        [(299, 0.0, 0.0), (300, 0.0, 0.0), (800, quarter, 0.5), (1300, 0.5, 1.0), (2300, 1.0, 0.0), (4000, 1.0, 0.0)]
    {
        assert!((share_at(&rising, step, 0.0) - up).abs() < 1e-12, "{step}");
        assert!((share_at(&pulse, step, 0.0) - there_and_back).abs() < 1e-12, "{step}");
    }
    // Within a step as well: the method's stages see the gust of their own time.
    assert!((share_at(&rising, 799, 1.0) - share_at(&rising, 800, 0.0)).abs() < 1e-12);
    assert!(share_at(&rising, 800, 0.5) > share_at(&rising, 800, 0.0));
}
