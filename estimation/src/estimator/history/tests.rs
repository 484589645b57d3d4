use super::*;

impl Increment {
    /// What a steady body rate and a steady specific force, both in the body's axes, do between two times.
    pub(in crate::estimator) fn steady(start: u64, end: u64, rate: &Vector3<f32>, force: &Vector3<f32>) -> Self {
        let seconds = (end - start) as f32 * 1e-6;
        let (delta_angle, straight) = (rate * seconds, force * seconds);
        let delta_velocity = straight + delta_angle.cross(&straight) * 0.5;
        Self { start, end, delta_angle, delta_velocity, clipped: Clipped::NEITHER }
    }
}

const RATE: Vector3<f32> = Vector3::new(3.0, -5.0, 2.0);
const FORCE: Vector3<f32> = Vector3::new(1.0, -2.0, 12.0);

fn filled(count: u64) -> History {
    let mut history = History::EMPTY;
    (0..count).for_each(|n| history.push(&Increment::steady(n * 5_000, (n + 1) * 5_000, &RATE, &FORCE)));
    history
}

#[test]
fn a_part_of_a_steady_increment_is_the_steady_motion_of_its_own_time() {
    let whole = Increment::steady(10_000, 15_000, &RATE, &FORCE);
    for (from, to) in [(10_000, 11_000), (11_500, 14_000), (13_000, 15_000)] {
        let (part, expected) = (whole.part(from, to).unwrap(), Increment::steady(from, to, &RATE, &FORCE));
        assert_eq!((part.start, part.end), (from, to));
        assert!((part.delta_angle - expected.delta_angle).norm() < 1e-7);
        // Beyond the first order in the angle, 0.03 rad, of 0.06 m/s.
        assert!((part.delta_velocity - expected.delta_velocity).norm() < 1e-5, "{part:?} {expected:?}");
    }
    assert_eq!(whole.part(0, 100_000), Some(whole));
    assert_eq!(whole.part(0, 10_000), None);
    assert_eq!(whole.part(15_000, 20_000), None);
}

#[test]
fn what_lies_ahead_is_turned_on_by_what_is_under_way_and_the_newest_rate() {
    let last = Increment::steady(0, 5_000, &RATE, &FORCE);
    let ahead = |to: u64| Increment::steady(5_000, to, &RATE, &FORCE);
    for (end, to) in [(6_000, 8_000), (9_000, 9_000), (11_000, 13_000)] {
        let steady = last.turn_ahead(Some(&ahead(end)), to - 5_000);
        assert!((steady - ahead(to).delta_angle).norm() < 1e-7, "{steady}");
    }
    // At 100 rad/s^2, from half an increment's time before its end.
    let speeding = |start: u64, end: u64| {
        let middle = (start + end) as f32 * 0.5e-6;
        Increment::steady(start, end, &(Vector3::x() * (100.0 * middle)), &FORCE)
    };
    let (last, truth) = (speeding(0, 5_000), speeding(5_000, 11_000).delta_angle);
    let late = (truth - last.turn_ahead(None, 6_000)).norm();
    let soon = (truth - last.turn_ahead(Some(&speeding(5_000, 9_000)), 6_000)).norm();
    assert!(late > 3e-3 && soon < 1e-3, "{late} and {soon} rad");
    // One that does not go on from here, or ends later, says nothing.
    for stranger in [Increment::steady(4_000, 6_000, &FORCE, &FORCE), Increment::steady(5_000, 12_000, &FORCE, &FORCE)]
    {
        assert_eq!(last.turn_ahead(Some(&stranger), 6_000), last.turn_ahead(None, 6_000));
    }
}

#[test]
fn times_between_two_instants_are_covered_once_and_in_order() {
    let history = filled(10);
    let (from, to) = (7_300, 41_700);
    let mut reached = from;
    for increment in history.between(from, to) {
        assert_eq!(increment.start, reached);
        reached = increment.end;
    }
    assert_eq!(reached, to);
    assert_eq!(history.between(to, from).count(), 0);
}

#[test]
fn the_oldest_leave_first_and_200_ms_remain() {
    let history = filled(1_000);
    let (start, end) = history.span().unwrap();
    assert_eq!(end, 5_000_000);
    assert_eq!(end - start, INCREMENTS_MAX as u64 * 5_000);
    assert!(end - start >= 200_000);
    assert_eq!(history.leaving().unwrap().start, start);
    assert_eq!(filled(INCREMENTS_MAX as u64 - 1).leaving(), None);
}

#[test]
fn numbers_that_no_imu_gives_and_times_that_make_no_sense_are_not_usable() {
    let good = Increment::steady(0, 5_000, &RATE, &FORCE);
    assert!(good.is_usable(20_000));
    assert!(!good.is_usable(4_999));
    assert!(!Increment { end: 0, ..good }.is_usable(20_000));
    for vector in [Vector3::new(f32::NAN, 0.0, 0.0), Vector3::new(0.0, f32::INFINITY, 0.0), Vector3::repeat(1e20)] {
        assert!(!Increment { delta_angle: vector, ..good }.is_usable(20_000));
        assert!(!Increment { delta_velocity: vector, ..good }.is_usable(20_000));
    }
}
