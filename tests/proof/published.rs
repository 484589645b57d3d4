//! Vehicles of other projects, from the numbers those publish: `vehicles/published/` gives mass, inertia, rotors and
//! lag, and not one constant of a law. Each is certified and comes back from upside down.
//! `cargo test -p host-sim published -- --nocapture` prints the table that stands in `vehicles/README.md`.

use crate::support::extended::{published, vehicle};
use controller_core::configuration::Configuration;
use host_sim::flight::Flight;
use host_sim::flight::course::Course;
use host_sim::flight::tasks::{hover, recovery};
use nalgebra::Vector3;
use scenario::Scenario;
use scenario::body::attitude_from_euler;
use scenario::verdict::Verdict;
use std::f64::consts::PI;
use std::fs;
use std::path::Path;

const ARRIVAL_DISTANCE_M: f64 = 0.1;

/// From upside down, under an INDI on differenced velocity, with gains searched for each vehicle.
const INDI_HEIGHTS_LOST_M: [(&str, f64); 13] = [
    ("airsim-quad", 1.39),
    ("cf-rotorpy", 1.97),
    ("cf2-forster", 1.19),
    ("cf2x-pybullet", 0.495),
    ("cfb-rotorpy", 1.75),
    ("cpc-racer", 0.429),
    ("firefly", 2.82),
    ("flightmare", 0.631),
    ("grasp-nano", 1.25),
    ("iris", 6.9),
    ("pelican", 1.26),
    ("racer-pybullet", 0.565),
    ("x500", 2.27),
];

/// Greatest height lost in multiples of that, and latest time of return, s: for a vehicle that lifts twice its weight,
/// and for a weaker one, whose thrust brakes a fall hardly faster than gravity made it.
const HEIGHT_AND_TIME_MAX: (f64, f64) = (1.5, 3.0);
const REQUIRED_WEAK: (f64, f64) = (2.0, 5.0);

/// Until the heading is within 0.1 rad for good after half a turn, s, where yaw's torque at hover needs no longer than
/// the time beside it.
const HALF_A_TURN: (f64, f64) = (4.0, 2.7);

/// Greatest thrust of all rotors over weight.
fn thrust_to_weight(scenario: &Scenario) -> f64 {
    let vehicle = scenario.configuration.vehicle();
    let thrust: f32 = scenario.configuration.rotors().unwrap().iter().map(|rotor| rotor.thrust_max).sum();
    f64::from(thrust / (vehicle.mass * vehicle.gravity))
}

fn read(name: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../vehicles/published");
    assert_eq!(fs::read_dir(&folder).unwrap().count(), INDI_HEIGHTS_LOST_M.len());
    fs::read_to_string(folder.join(format!("{name}.toml"))).unwrap()
}

#[test]
fn published_vehicles_are_certified_and_come_back_from_upside_down_without_a_constant_given() {
    println!(
        "| vehicle | rotors | thrust / weight | height lost, m (over INDI's) | within 0.1 m, s | tightest, margin |\n\
         |---|---|---|---|---|---|"
    );
    for (name, indi) in INDI_HEIGHTS_LOST_M {
        let text = read(name);
        assert!(!["[gains]", "[estimates]", "[reference_bounds]"].iter().any(|section| text.contains(section)));
        let scenario = Scenario::parse(&text, name).unwrap();
        let verdict = Verdict::judge(&scenario).unwrap();
        assert!(verdict.refusal().is_none(), "{name}: refused");
        let tightest = verdict.certificate().tightest().unwrap();

        let upside_down = recovery(&scenario, 15.0).unwrap();
        let flight = Flight::certified(&upside_down, verdict.certified().unwrap()).unwrap();
        let Course { height_lost, settled, clipped, .. } =
            Course::fly(&upside_down, flight, ARRIVAL_DISTANCE_M).unwrap();
        let settled = settled.unwrap_or(f64::INFINITY);
        let lift = thrust_to_weight(&scenario);
        println!(
            "| `{name}` | {} | {lift:.2} | {height_lost:.2} ({:.2}) | {settled:.2} | {tightest}, {:.1} % |",
            scenario.configuration.rotors().unwrap().len(),
            height_lost / indi,
            100.0 * tightest.margin()
        );
        let (times, latest) = if lift < 2.0 { REQUIRED_WEAK } else { HEIGHT_AND_TIME_MAX };
        assert!(height_lost < times * indi && settled < latest, "{name}: {height_lost} m, {settled} s");
        assert_eq!(clipped, 0, "{name}: a rotor was commanded beyond its limits");
    }
}

/// The greatest torque about z in hover, N m: what every rotor has left without any for the tilt, at most the limit.
fn yaw_at_hover(configuration: &Configuration) -> f64 {
    let (vehicle, rotors) = (configuration.vehicle(), configuration.rotors().unwrap());
    let weight = f64::from(vehicle.mass * vehicle.gravity);
    let most = rotors.iter().zip(rotors.pseudo_inverse()).map(|(rotor, row)| {
        let alone = row.x * weight;
        let [below, above] = [alone - f64::from(rotor.thrust_min), f64::from(rotor.thrust_max) - alone];
        below.min(above) / row.w.abs()
    });
    most.fold(configuration.limits().torque_max.z.into(), f64::min)
}

#[test]
fn half_a_turn_of_heading_takes_four_seconds_at_most_where_yaws_torque_allows_that() {
    println!("| vehicle | within 0.1 rad, s | least, s |\n|---|---|---|");
    let own = ["hummingbird", "study"].map(vehicle);
    for scenario in own.into_iter().chain(published()) {
        let configuration = &scenario.configuration;
        let torque = yaw_at_hover(configuration);
        let least = 2.0 * (PI * f64::from(configuration.vehicle().inertia.z) / torque).sqrt();
        let mut turning = hover(&scenario, Vector3::zeros(), 30.0).unwrap();
        turning.initial.attitude = attitude_from_euler(0.0, 0.0, 179.0_f64.to_radians());
        let Course { turned, excursion, clipped, .. } =
            Course::fly(&turning, Flight::new(&turning).unwrap(), ARRIVAL_DISTANCE_M).unwrap();
        let turned = turned.unwrap_or(f64::INFINITY);
        println!("| `{}` | {turned:.2} | {least:.2} |", scenario.name);
        let (latest, allowed) = HALF_A_TURN;
        assert!(turned <= latest || least > allowed, "{}: {turned} s", scenario.name);
        // Tilt does not know the heading.
        assert!(excursion < 0.05 && clipped == 0, "{}: {excursion} m", scenario.name);
    }
}

#[test]
fn a_published_yaw_inertia_that_no_body_has_is_refused_by_its_field() {
    for name in ["firefly", "iris"] {
        let text = read(name);
        let published = text.replace("0.0806492]", "0.0977]");
        assert_ne!(published, text);
        let error = Scenario::parse(&published, "published.toml").err().unwrap().to_string();
        assert!(error.contains("vehicle.inertia"), "{error}");
    }
}
