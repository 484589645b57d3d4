use super::*;

const DELTA: f32 = 0.02;
const ALPHA: f32 = 0.25;

fn about_x(angle: f32) -> Quaternion<f32> {
    Quaternion::new((0.5 * angle).cos(), (0.5 * angle).sin(), 0.0, 0.0)
}

#[test]
fn a_fresh_lift_takes_the_shorter_way() {
    let lifted = lift(None, &-about_x(1.0), switching_scalar(DELTA), ALPHA);
    assert!(lifted.quaternion.w > 0.0 && lifted.mrp.x > 0.0 && lifted.lift.sign == 1.0);
}

#[test]
fn an_exact_half_turn_lifts_to_its_positive_axis() {
    for q in [Quaternion::new(0.0, 0.0, -1.0, 0.0), Quaternion::new(-0.0, 0.0, 1.0, 0.0)] {
        assert!(lift(None, &q, switching_scalar(DELTA), ALPHA).mrp.y == 1.0);
    }
}

#[test]
fn the_lift_follows_its_path_through_a_half_turn_and_switches_once_past_the_hysteresis() {
    let mut memory = None;
    let mut switches = 0;
    for step in 0..628 {
        let lifted = lift(memory.as_ref(), &about_x(0.01 * step as f32), switching_scalar(DELTA), ALPHA);
        assert!(lifted.mrp.norm() <= 1.0 + DELTA + 1e-6);
        if let Some(Lift { sign, .. }) = memory {
            switches += usize::from(sign != lifted.lift.sign);
        }
        memory = Some(lifted.lift);
    }
    assert_eq!(switches, 1);
}

#[test]
fn the_switch_happens_at_one_plus_delta() {
    let scalar = switching_scalar(DELTA);
    assert!((((1.0 - scalar) / (1.0 + scalar)).sqrt() - (1.0 + DELTA)).abs() < 1e-6);
}

#[test]
fn the_memory_follows_in_steps_of_alpha() {
    let start = lift(None, &about_x(0.0), switching_scalar(DELTA), ALPHA);
    let near = lift(Some(&start.lift), &about_x(1.0), switching_scalar(DELTA), ALPHA);
    let far = lift(Some(&start.lift), &about_x(1.6), switching_scalar(DELTA), ALPHA);
    assert_eq!(near.lift.memory, start.lift.memory);
    assert!((far.lift.memory - about_x(1.6)).norm() < 1e-6);
}
