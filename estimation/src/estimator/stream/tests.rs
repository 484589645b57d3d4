use super::*;
use crate::measurement::{Pose, Velocity};
use nalgebra::{Quaternion, Vector3};

fn pose(x: f32, time: u64) -> Stamped<PoseMeasurement> {
    let velocity = Velocity::World(Vector3::zeros());
    let pose = Pose::new(Vector3::new(x, 0.0, 0.0), velocity, Quaternion::identity()).unwrap();
    Stamped { value: PoseMeasurement::new(&pose), time }
}

#[test]
fn a_time_serves_once_however_long_it_is_resent() {
    let mut stream = Stream::EMPTY;
    for n in 1..=100_u64 {
        assert_eq!(stream.admit(&pose(n as f32, n * 10_000), n * 10_000), Ok(()));
        assert_eq!(stream.admit(&pose(0.0, n * 10_000), n * 10_000), Err(Rejected::Repeated));
    }
    // One that is newer than some that are remembered, but was not there, is news.
    assert_eq!(stream.admit(&pose(0.0, 995_000), 1_000_000), Ok(()));
    // For an hour at 100 Hz, the last frames one by one, and one long forgotten.
    for n in 0..360_000_u64 {
        let time = (90 + n % 11) * 10_000;
        assert_eq!(stream.admit(&pose((n % 1_000) as f32, time), 1_000_000 + n * 10_000), Err(Rejected::Repeated));
        assert_eq!(stream.admit(&pose(2.5, 20_000), 1_000_000 + n * 10_000), Err(Rejected::TooOld));
    }
}

#[test]
fn the_future_is_refused_and_not_remembered() {
    let mut stream = Stream::EMPTY;
    assert_eq!(stream.admit(&pose(0.0, 11_001), 10_000), Err(Rejected::Future));
    assert_eq!(stream.admit(&pose(0.0, u64::MAX), 10_000), Err(Rejected::Future));
    assert_eq!(stream.admit(&pose(0.0, 11_000), 10_000), Ok(()));
    assert_eq!(stream.admit(&pose(1.0, 11_001), 10_001), Ok(()));
}

#[test]
fn a_failed_tracking_is_no_pose() {
    let mut stream = Stream::EMPTY;
    for (n, quality) in [(1, 100), (2, 0), (3, -1), (4, -128)] {
        let Stamped { value, time } = pose(n as f32, n * 10_000);
        let expected = if quality < 0 { Err(Rejected::Quality) } else { Ok(()) };
        assert_eq!(stream.admit(&Stamped { value: value.quality(quality), time }, time), expected);
    }
}

#[test]
fn rounded_poses_may_be_identical_for_a_second() {
    let mut stream = Stream::EMPTY;
    for n in 0..200_u64 {
        stream.note(true);
        let Stamped { value, time } = pose(1.0, n * 10_000);
        let expected = if n >= u64::from(ROUNDED_IDENTICAL_MAX) { Err(Rejected::Frozen) } else { Ok(()) };
        assert_eq!(stream.admit(&Stamped { value: value.rounded(), time }, time), expected, "{n}");
    }
}

#[test]
fn a_place_that_stands_still_is_frozen_whatever_attitude_goes_with_it() {
    let mut stream = Stream::EMPTY;
    for n in 0..20_u64 {
        stream.note(true);
        let mut stamped = pose(1.0, n * 10_000);
        stamped.value.attitude.i += n as f32 * 1e-3;
        stamped.value = stamped.value.place(0.01, 1.0);
        let expected = if n >= u64::from(IDENTICAL_MAX) { Err(Rejected::Frozen) } else { Ok(()) };
        assert_eq!(stream.admit(&stamped, stamped.time), expected, "{n}");
    }
}

#[test]
fn identical_poses_are_frozen_once_the_vehicle_has_moved() {
    for (moves, frozen) in [(false, false), (true, true)] {
        let mut stream = Stream::EMPTY;
        for n in 0..100_u64 {
            stream.note(moves);
            let expected = if frozen && n >= u64::from(IDENTICAL_MAX) { Err(Rejected::Frozen) } else { Ok(()) };
            assert_eq!(stream.admit(&pose(1.0, n * 10_000), n * 10_000), expected, "{n}");
        }
        // It thaws with the first pose that differs.
        assert_eq!(stream.admit(&pose(1.001, 1_000_000), 1_000_000), Ok(()));
        assert_eq!(stream.admit(&pose(1.001, 1_010_000), 1_010_000), Ok(()));
    }
}
