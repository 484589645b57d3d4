//! `[campaign]` as users may write it, and as they must not.

use super::*;
use crate::Scenario;

const HUMMINGBIRD: &str = include_str!("../../../vehicles/hummingbird.toml");

fn parse(file: &str, section: &str) -> Result<Campaign, String> {
    Scenario::parse(&format!("{file}\n{section}"), "f").map(|scenario| scenario.campaign).map_err(|error| error.what)
}

fn hummingbird(keys: &str) -> Result<Campaign, String> {
    parse(HUMMINGBIRD, &format!("[campaign]\n{keys}"))
}

/// The page's table of keys, of which the third column has the defaults.
#[test]
fn the_documented_defaults_are_the_defaults() {
    let page = include_str!("../../../docs/scenario-file.md");
    let (_, page) = page.split_once("\n## campaign\n").unwrap();
    let (table, _) = page.split_once("\n## ").unwrap();
    let mut written = String::new();
    for row in table.lines().filter(|line| line.starts_with("| `")) {
        let columns: Vec<&str> = row.split('|').map(str::trim).collect();
        let [_, keys, _, defaults, ..] = columns[..] else { panic!("{row}") };
        let (defaults, _) = defaults.split_once(';').unwrap_or((defaults, ""));
        let list: Vec<&str> = match defaults.strip_prefix('`') {
            Some(text) => vec![text.trim_end_matches('`')],
            None => defaults.split(", ").collect(),
        };
        for (place, key) in keys.split('`').skip(1).step_by(2).enumerate() {
            written += &format!("{key} = {}\n", list.get(place).unwrap_or(&list[0]));
        }
    }
    assert_eq!(written.lines().count(), LAYOUT.keys.len(), "{written}");
    assert_eq!(hummingbird(&written).unwrap(), parse(HUMMINGBIRD, "").unwrap());
}

#[test]
fn every_key_is_read() {
    let keys = "flights = 7\nseed = 3\nduration = 9\nreference = \"hover\"\nattitude = \"file\"\noffset = 1\nvelocity = 2\n\
        rate = 3\nyaw_rate = 4\nwind = 5.5\ngust = 6\nturbulence = 7\ngyro_noise = 0.08\nposition_noise = 0.09\n\
        attitude_noise_deg = 18\npose_delay = 0.11\nmass = 0.12\ninertia = 0.13\ncentre_of_mass = 0.14\n\
        thrust_scale = 0.15\nrotor_scales = 0.16\nrotor_failures = 0.17\nthrust_left = [0.18, 0.19]\n";
    let Campaign { flights, seed, ranges } = hummingbird(keys).unwrap();
    assert_eq!((flights, seed), (7, 3));
    let noise = NoiseRanges { gyro: 0.08, position: 0.09, attitude: 18_f64.to_radians(), delay: 0.11 };
    let model = ModelRanges { mass: 0.12, inertia: 0.13, centre_of_mass: 0.14, thrust_scale: 0.15, rotor_scales: 0.16 };
    let expected = Ranges {
        duration: 9.0,
        reference: Task::Hover,
        attitude: false,
        offset: 1.0,
        velocity: 2.0,
        rate: 3.0,
        yaw_rate: 4.0,
        wind: 5.5,
        gust: 6.0,
        turbulence: 7.0,
        noise,
        model,
        failure: FailureRanges { flights: 0.17, thrust_left: [0.18, 0.19] },
    };
    assert_eq!(ranges, expected);
}

#[test]
fn what_cannot_be_is_refused_by_name() {
    for (keys, expected) in [
        ("flihgts = 3", "campaign.flihgts: unknown key, did you mean \"flights\"?"),
        ("flights = 0", "campaign.flights: must be a whole number from 1 to"),
        ("flights = 2.5", "campaign.flights: must be a whole number from 1 to"),
        ("seed = -1", "campaign.seed: must be a whole number from 0 to"),
        ("duration = 0", "campaign.duration: must be from 1 to 100000 s"),
        ("duration = 0.99", "campaign.duration: must be from 1 to 100000 s"),
        ("reference = \"none\"", "campaign.reference: must be one of \"in-turn\", \"file\", \"hover\", found \"none\""),
        ("attitude = 3", "campaign.attitude: must be a text"),
        ("rate = 501.0", "campaign.rate: must be from 0 to 500 rad/s"),
        ("yaw_rate = 501.0", "campaign.yaw_rate: must be from 0 to 500 rad/s"),
        ("mass = 0.95", "campaign.mass: must be from 0 to 0.9"),
        ("wind = nan", "campaign.wind: must be a finite number"),
        ("wind = -1", "campaign.wind: must be from 0 to 100 m/s"),
        ("gyro_noise = 0.1\n[sensors]\n", "campaign.gyro_noise: [sensors] says what is measured"),
        ("rotor_failures = 1.5", "campaign.rotor_failures: must be from 0 to 1, found 1.5"),
        (
            "thrust_left = 0.5",
            "campaign.thrust_left: must be [least, greatest], 0 <= least <= greatest < 1, found float",
        ),
        ("thrust_left = [0.5, 0.4]", "campaign.thrust_left: must be [least, greatest], 0 <= least <= greatest < 1"),
        ("thrust_left = [0, 1]", "campaign.thrust_left: must be [least, greatest], 0 <= least <= greatest < 1"),
        (
            "rotor_failures = 0.1\n[failure]\nrotor = 1\ntime = 2",
            "campaign.rotor_failures: [failure] says which rotor fails",
        ),
        ("pose_delay = 0.1\n[estimator]\n", "campaign.pose_delay: [estimator] says what is measured"),
    ] {
        let what = hummingbird(keys).unwrap_err();
        assert!(what.starts_with(expected), "{keys}: {what}");
    }
    for key in ["rotor_scales", "rotor_failures"] {
        let what = parse(crate::PAPER, &format!("[campaign]\n{key} = 0.1\n")).unwrap_err();
        assert_eq!(what, format!("campaign.{key}: needs [rotors]: add that section or leave this key out"));
    }
}

#[test]
fn default_wind_and_duration_are_within_the_laws_abilities() {
    let drawn = |campaign: Campaign| (campaign.ranges.wind, campaign.ranges.duration);
    assert_eq!(drawn(parse(crate::PAPER, "").unwrap()), (0.0, 180.0));
    assert_eq!(drawn(hummingbird("").unwrap()), (5.0, 60.0));
    let extended = include_str!("../../../scenarios/paper-extended.toml");
    let weak = extended.replace("[control]", "[estimates]\nforce_across = 0.3\n\n[control]");
    assert!((parse(&weak, "").unwrap().ranges.wind - 0.48).abs() < 1e-6);
}
