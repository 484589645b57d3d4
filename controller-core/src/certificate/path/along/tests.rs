use super::*;
use crate::certificate::path::FORCE_KEPT_M_PER_S2;
use crate::extended::defaults::NOTHING_GIVEN;
use crate::extended::tests::Random;
use crate::extended::tests::example::Craft;
use crate::math::enclosure::Enclosure;
use crate::reference::ReferenceBounds;
use crate::reference::harmonic::{Harmonic, HarmonicParameters, HeadingParameters};
use crate::reference::hover::Hover;
use crate::reference::waypoints::{Waypoint, Waypoints};

fn judge<R: Real>(craft: &Craft) -> PathJudge<R> {
    let parameters = craft.constants(&NOTHING_GIVEN);
    let configuration = craft.configuration(&parameters, ReferenceBounds::REST);
    PathJudge::new(&configuration, &craft.law(&parameters), FORCE_KEPT_M_PER_S2)
}

/// A figure of eight, `width` m wide and half as high, flown in `seconds`, which nods and shakes its head.
fn eight(width: f64, seconds: f64) -> Harmonic {
    let turn = core::f64::consts::TAU / seconds;
    let heading = HeadingParameters { offset: 0.2, rate: 0.0, amplitude: 0.5, frequency: turn };
    let quarter = core::f64::consts::FRAC_PI_2;
    let parameters = HarmonicParameters {
        center: [0.0; 3],
        amplitude: [0.5 * width, 0.25 * width, 0.02],
        frequency: [turn, 2.0 * turn, 3.0 * turn],
        phase: [0.3, quarter, 1.0],
        heading,
    };
    Harmonic::new(parameters).unwrap()
}

fn through(random: &mut Random, seconds: f32) -> Waypoints {
    let points: [Waypoint; 6] = core::array::from_fn(|number| {
        let position = random.vector(0.7).map(f64::from).into();
        let heading = f64::from(random.signed());
        Waypoint { time: number as f64 * f64::from(seconds), position, heading }
    });
    Waypoints::new(&points).unwrap()
}

/// No instant takes more than is said, one takes nearly as much, and it is the one that is named.
fn covers(judge: &PathJudge, trajectory: &dyn Trajectory, end_us: u64) -> f64 {
    let MaxShare { share, row, at_us } = MaxShare::along(judge, trajectory, end_us);
    let at = |time: u64| judge.shares(&PathMotion::from(&trajectory.at(time)));
    for instant in 0..=5_000 {
        let worst = at(end_us / 5_000 * instant).worst();
        assert!(worst <= share, "{worst} at {instant}: {share}");
    }
    let named = at(at_us);
    assert!(named.row() == row && named.worst() > share * (1.0 - 1.01 * BOUND_TOLERANCE), "{named:?} {share}");
    share
}

#[test]
fn no_instant_takes_more_than_is_said() {
    let mut random = Random(5);
    let (mut min, mut max) = (f64::INFINITY, 0.0_f64);
    for number in 0..20 {
        let craft = if number == 0 { Craft::example() } else { Craft::random(&mut random) };
        let judge = judge(&craft);
        let seconds = random.between(1.5, 3.0);
        for share in [
            covers(&judge, &eight(6.0, f64::from(3.0 * seconds)), 6_000_000),
            covers(&judge, &through(&mut random, seconds), 16_000_000),
        ] {
            (min, max) = (min.min(share), max.max(share));
        }
    }
    assert!(min < 0.9 && max > 1.0, "{min} {max}");
}

/// A trembling that is looked at where nothing but its jerk shows.
#[test]
fn a_peak_between_the_instants_looked_at_is_not_missed() {
    let judge = judge(&Craft::example());
    let heading = HeadingParameters { offset: 0.0, rate: 0.0, amplitude: 0.0, frequency: 0.0 };
    let parameters = HarmonicParameters {
        center: [0.0; 3],
        amplitude: [2e-6, 0.0, 0.0],
        frequency: [core::f64::consts::TAU / 16_384e-6; 3],
        phase: [core::f64::consts::FRAC_PI_2; 3],
        heading,
    };
    let trembling = Harmonic::new(parameters).unwrap();
    let seen = judge.shares(&PathMotion::from(&trembling.at(FIRST_CELL_US / 2))).worst();
    assert!(covers(&judge, &trembling, 2 * FIRST_CELL_US) > 3.0 * seen, "{seen}");
}

#[test]
fn rounding_decides_nothing_along_a_path() {
    let craft = Craft::example();
    for seconds in [3.0, 5.0, 8.0] {
        let eight = eight(6.0, seconds);
        let nearest = MaxShare::along(&judge::<f64>(&craft), &eight, 8_000_000).share;
        let enclosed = MaxShare::along(&judge::<Enclosure>(&craft), &eight, 8_000_000).share;
        assert!(enclosed >= nearest && enclosed < nearest * (1.0 + 1e-9), "{nearest} {enclosed}");
    }
}

#[test]
fn at_rest_a_vehicle_takes_what_hovering_takes() {
    let judge = judge::<f64>(&Craft::example());
    let hover = MaxShare::along(&judge, &Hover::ORIGIN, 3_600_000_000);
    assert_eq!(hover.share, judge.shares(&PathMotion::from(&Hover::ORIGIN.at(0))).worst());
}
