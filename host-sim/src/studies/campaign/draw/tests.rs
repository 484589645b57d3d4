//! Draws: from seed and number alone, within their ranges, each on its own.

use super::*;
use scenario::campaign::Campaign;

const HUMMINGBIRD: &str = include_str!("../../../../../vehicles/hummingbird.toml");

/// Every range open.
const EVERY_RANGE: &str = "[campaign]\ngust = 2.0\nturbulence = 1.0\npose_delay = 0.05\nmass = 0.1\ninertia = 0.2\n\
    centre_of_mass = 0.01\nthrust_scale = 0.15\nrotor_scales = 0.05\n\
    rotor_failures = 0.5\nthrust_left = [0.1, 0.6]\n";

fn hummingbird(sections: &str) -> Scenario {
    Scenario::parse(&format!("{HUMMINGBIRD}\n{sections}"), "f").unwrap()
}

fn drawn(scenario: &Scenario, number: u64) -> Scenario {
    let Campaign { seed, ranges, .. } = scenario.campaign;
    circumstances(scenario, &ranges, seed, number)
}

#[test]
fn a_draw_is_of_its_seed_and_number_alone() {
    let scenario = hummingbird(EVERY_RANGE);
    let ranges = &scenario.campaign.ranges;
    for number in 0..20 {
        let thrown = circumstances(&scenario, ranges, 7, number);
        assert!(thrown.flies_like(&circumstances(&scenario, ranges, 7, number)));
        assert_ne!(thrown.initial, circumstances(&scenario, ranges, 8, number).initial);
        assert_ne!(thrown.initial, circumstances(&scenario, ranges, 7, number + 2).initial);
        assert_eq!(thrown.configuration, scenario.configuration);
    }
}

/// Published figures name flights by their numbers, so what a number stands for must stay.
#[test]
fn flight_3_stays_what_it_is() {
    let initial = drawn(&hummingbird(""), 3).initial;
    let found = [initial.position.x, initial.velocity.y, initial.attitude.w, initial.angular_velocity.z];
    assert_eq!(found, [3.4593492788651528, -2.809931718080314, 0.6395331473846904, 3.6668904906966704]);
}

#[test]
fn a_range_that_changes_leaves_the_other_draws_as_they_are() {
    let plain = drawn(&hummingbird("[campaign]\n"), 5);
    let open = drawn(&hummingbird(EVERY_RANGE), 5);
    assert_eq!(plain.initial, open.initial);
    assert_eq!(plain.reality.wind.unwrap().steady, open.reality.wind.unwrap().steady);
    let (plain, open) = (plain.reality.sensors.unwrap(), open.reality.sensors.unwrap());
    assert_eq!((plain.gyro_noise, plain.seed), (open.gyro_noise, open.seed));
    assert!(open.delay_ticks > 0);
}

#[test]
fn draws_fill_their_ranges_and_stay_within_them() {
    let scenario = hummingbird(EVERY_RANGE);
    let ranges = scenario.campaign.ranges;
    let model = Truth::model(scenario.configuration.vehicle());
    // Each quantity over its range.
    let mut greatest = [0.0_f64; 12];
    for number in 0..2000 {
        let thrown = drawn(&scenario, number);
        let (start, reality) = (thrown.initial, &thrown.reality);
        let (wind, sensors, truth) = (reality.wind.unwrap(), reality.sensors.unwrap(), reality.truth.clone().unwrap());
        let first = thrown.trajectory.at(0).position.map(f64::from);
        let shares = [
            (start.position - first).norm() / ranges.offset,
            start.velocity.norm() / ranges.velocity,
            start.angular_velocity.xy().norm() / ranges.rate,
            start.angular_velocity.z.abs() / ranges.yaw_rate,
            wind.steady.norm() / ranges.wind,
            wind.gust.unwrap().velocity.norm() / ranges.gust,
            wind.turbulence.unwrap().wind_at_20_feet / ranges.turbulence,
            sensors.attitude_noise / ranges.noise.attitude,
            sensors.delay_ticks as f64 * thrown.timing.period() / ranges.noise.delay,
            (truth.mass / model.mass - 1.0).abs() / ranges.model.mass,
            truth.centre_of_mass.norm() / ranges.model.centre_of_mass,
            (truth.rotor_scales[3] - 1.0).abs() / ranges.model.rotor_scales,
        ];
        for (greatest, share) in greatest.iter_mut().zip(shares) {
            *greatest = greatest.max(share);
        }
        assert!(wind.gust.unwrap().start <= 0.5 * ranges.duration && wind.steady.z == 0.0);
    }
    assert!(greatest.iter().all(|share| (0.95..=1.0 + 1e-12).contains(share)), "{greatest:?}");
}

/// Of attitudes that are all alike, each component of the thrust's direction is spread evenly from -1 to 1.
#[test]
fn attitudes_are_uniform() {
    let scenario = hummingbird("");
    let count = 4000_u32;
    for axis in 0..3 {
        let component = |number| {
            let attitude = UnitQuaternion::new_unchecked(drawn(&scenario, number).initial.attitude);
            (attitude * Vector3::z())[axis]
        };
        let mut values: Vec<f64> = (0..u64::from(count)).map(component).collect();
        values.sort_by(f64::total_cmp);
        let distance =
            |(rank, value): (usize, &f64)| ((rank as f64 + 0.5) / f64::from(count) - 0.5 * (1.0 + value)).abs();
        let greatest = values.iter().enumerate().map(distance).fold(0.0, f64::max);
        // Kolmogorov and Smirnov: 1.95 over the root of the count is passed once in a thousand.
        assert!(greatest < 1.95 / f64::from(count).sqrt(), "axis {axis}: {greatest}");
    }
}

#[test]
fn what_the_file_says_of_sensors_stands_but_for_the_seed() {
    let own = hummingbird("[estimator]\npose_delay = 0.03\n");
    let thrown = drawn(&own, 1).reality;
    let (own, estimator) = (own.reality.estimator.unwrap(), thrown.estimator.unwrap());
    assert!(thrown.sensors.is_none() && estimator.seed != own.seed && estimator.pose_delay == own.pose_delay);
    let thrown = drawn(&hummingbird("[sensors]\ngyro_noise = 0.02\n"), 1).reality.sensors.unwrap();
    assert!(thrown.gyro_noise == 0.02 && thrown.seed != 0);
}

#[test]
fn as_many_rotors_fail_as_are_to_each_alike_and_soon_enough() {
    let scenario = hummingbird(EVERY_RANGE);
    let failures: Vec<Failure> = (0..2000).filter_map(|number| drawn(&scenario, number).reality.failure).collect();
    assert!((900..1100).contains(&failures.len()), "{}", failures.len());
    for rotor in 0..4 {
        let own = failures.iter().filter(|failure| failure.rotor == rotor).count();
        assert!((200..300).contains(&own), "{rotor}: {own}");
    }
    let range = |value: fn(&Failure) -> f64| {
        let values = failures.iter().map(value);
        (values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max))
    };
    let ((earliest, latest), (least, greatest)) = (range(|failure| failure.time), range(|failure| failure.thrust_left));
    assert!((0.0..0.5).contains(&earliest) && (29.5..=30.0).contains(&latest), "{earliest} {latest}");
    assert!((0.1..0.11).contains(&least) && (0.59..=0.6).contains(&greatest), "{least} {greatest}");
}

#[test]
fn no_rotor_fails_unless_the_file_has_it() {
    assert!((0..200).all(|number| drawn(&hummingbird(""), number).reality.failure.is_none()));
    let own = hummingbird("[failure]\nrotor = 2\ntime = 3.0\n");
    assert_eq!(drawn(&own, 1).reality.failure, own.reality.failure);
}
