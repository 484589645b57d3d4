//! Flights in what the model leaves out: the paper's law beside what is known of it there.
//! `cargo test -p host-sim reality -- --nocapture` prints what each flight showed, and how long a campaign takes.

use crate::support::binary::{directory, host_sim, status};
use controller_core::certificate::certified::Certified;
use host_sim::flight::Flight;
use host_sim::flight::course::Course;
use nalgebra::Vector3;
use scenario::Scenario;
use std::time::Instant;
use verification::campaign::fly_all;

const HUMMINGBIRD: &str = include_str!("../../vehicles/hummingbird-paper-law.toml");
const EXTENDED: &str = include_str!("../../vehicles/hummingbird.toml");
const DRAG: &str = include_str!("hummingbird_drag.toml");
const SETTLED_DISTANCE_M: f64 = 0.1;

/// The Hummingbird on its circle of 1 m at 0.25 Hz, at speed from the start, with further sections.
fn circling(sections: &str) -> Scenario {
    let moving = HUMMINGBIRD.replace("[initial]\n", "[initial]\nvelocity = [0.0, 1.57079633, 0.0]\n");
    Scenario::parse(&format!("{moving}{sections}"), "f").unwrap()
}

/// The Hummingbird in hover for so many seconds, with further sections.
fn hovering(duration: f64, sections: &str) -> Scenario {
    hovering_as(HUMMINGBIRD, duration, "", sections)
}

/// The vehicle of a file in hover for so many seconds, with these lines in `[initial]` and further sections.
fn hovering_as(file: &str, duration: f64, initial: &str, sections: &str) -> Scenario {
    let (head, tail) = file.split_once("[initial]").unwrap();
    let (_, bounds) = tail.split_once("[reference_bounds]").unwrap();
    let head = head.replace("duration = 40.0", &format!("duration = {duration:?}"));
    let start = if initial.is_empty() { String::new() } else { format!("[initial]\n{initial}\n") };
    let reference = format!("{start}[reference]\nkind = \"hover\"\nposition = [0.0, 0.0, 1.5]\n[reference_bounds]");
    Scenario::parse(&format!("{head}{reference}{bounds}{sections}"), "f").unwrap()
}

fn course(scenario: &Scenario) -> Course {
    let course = Course::fly(scenario, Flight::new(scenario).unwrap(), SETTLED_DISTANCE_M).unwrap();
    println!(
        "excursion {:8.4} m, end {:8.4} m, RMS {:8.5} m, rotors {:6.4} N per tick, clipped {}",
        course.excursion, course.end_error, course.rms, course.activity, course.clipped
    );
    course
}

#[test]
fn a_constant_force_displaces_the_papers_law_by_its_compliance() {
    let scenario = hovering(120.0, "\n[disturbance]\nacceleration = [0.5, 0.0, 0.0]\n");
    let gains = scenario.configuration.gains().unwrap();
    let (k_p, k_v) = (f64::from(gains.k_p), f64::from(gains.k_v));
    let (k_f, k_s) = (f64::from(gains.k_f), f64::from(gains.k_s));
    // At rest u_f = -d: 1 / k_p + 1 / (k_f k_s) + (k_v / k_p) (1 / k_f + 1 / k_s) per m/s^2 of small forces.
    let compliance = 1.0 / k_p + 1.0 / (k_f * k_s) + k_v / k_p * (1.0 / k_f + 1.0 / k_s);
    let found = course(&scenario).end_error / 0.5;
    assert!((found / compliance - 1.0).abs() < 0.1, "{found} {compliance} m per m/s^2");
}

#[test]
fn drag_and_wind_cost_the_papers_law_what_they_should() {
    let ideal = course(&circling(""));
    let dragged = course(&circling(DRAG));
    let blown = course(&circling(&format!("{DRAG}[wind]\nsteady = [2.0, 0.0, 0.0]\n")));
    assert!(ideal.rms < 0.01 && ideal.end_error < 0.001, "{ideal:?}");
    // Another simulator, with the same drag and lag, found 0.28 m.
    assert!((0.25..0.31).contains(&dragged.rms), "{}", dragged.rms);
    assert!(blown.rms > 5.0 * dragged.rms, "{}", blown.rms);
    // At 5 m/s the wind pushes with more than M_p: the vehicle drifts away.
    let lost = course(&hovering(40.0, &format!("{DRAG}[wind]\nsteady = [5.0, 0.0, 0.0]\n")));
    assert!(lost.settled.is_none() && lost.end_error > 20.0);
}

/// A velocity from positions alone is late. How slow its filter may be, the sampled loops say, and the vehicle flies
/// so.
#[test]
fn a_velocity_from_positions_makes_the_loops_as_slow_as_they_say() {
    let (head, tail) = EXTENDED.split_once("[drag]").unwrap();
    let still = format!("{head}[initial]{}", tail.split_once("[initial]").unwrap().1);
    let measured = |bandwidth: f64| {
        let sections = format!("[sensors]\nvelocity = \"alpha-beta\"\nvelocity_bandwidth = {bandwidth:?}\n");
        hovering_as(&still, 60.0, "position = [0.0, 0.0, 1.5]\neuler_deg = [0.2, 0.0, 0.0]", &sections)
    };
    let radius = |bandwidth: f64| {
        let loops = measured(bandwidth).loops().unwrap();
        loops.reports().map(|report| report.spectral_radius).into_iter().fold(0.0, f64::max)
    };
    let (mut slow, mut quick) = (1.0_f64, 1000.0);
    assert!(radius(slow) > 1.0 && radius(quick) < 1.0);
    while quick / slow > 1.01 {
        let middle = (slow * quick).sqrt();
        if radius(middle) > 1.0 { slow = middle } else { quick = middle }
    }
    println!("slowest filter, rad/s: {quick:.1}");
    let [lost, kept] = [0.9, 1.1].map(|share| course(&measured(share * quick)).end_error);
    // What oscillates is held by the law's levels, and before these by the bend of its approach.
    assert!(lost > 2e-5 && kept < 1e-6, "{quick} rad/s: {lost} and {kept} m");
}

#[test]
fn noise_and_lateness_keep_the_rotors_busy_and_the_vehicle_near() {
    let noise = |velocity: &str| {
        format!(
            "[sensors]\ngyro_noise = 0.01\nposition_noise = 0.002\nattitude_noise_deg = 0.2\ndelay = 0.02\n{velocity}"
        )
    };
    let exact = course(&hovering(40.0, &noise("")));
    let filtered = course(&hovering(40.0, &noise("velocity = \"alpha-beta\"\nvelocity_bandwidth = 20.0\n")));
    // Another simulator, with the same noise and delay, found 0.0096 m and 0.016 N.
    assert!((0.002..0.02).contains(&exact.rms) && (0.014..0.018).contains(&exact.activity), "{exact:?}");
    assert!(filtered.rms < 0.1 && filtered.settled.is_some(), "{filtered:?}");
}

#[test]
fn a_failing_rotor_ends_a_flight_and_a_lost_share_does_not_stop_the_simulation() {
    let fallen = course(&hovering(10.0, "[ground]\nheight = 0.0\n[failure]\nrotor = 1\ntime = 2.0\n"));
    // It comes down to the ground, within a step of it, and lies there.
    assert!((fallen.height_lost - 1.5).abs() < 0.02 && fallen.settled.is_none(), "{fallen:?}");
    let before = course(&hovering(2.0, "[failure]\nrotor = 1\ntime = 2.0\n"));
    assert!(before.excursion < 1e-4);
}

#[test]
fn everything_at_once_is_the_same_every_time() {
    let everything = format!(
        "{DRAG}
[truth]
mass = 0.52
centre_of_mass = [0.002, 0.0, 0.0]
rotor_scales = [1.0, 0.98, 1.0, 1.0]
[wind]
steady = [1.0, 0.0, 0.0]
gust = {{ kind = \"pulse\", start = 3.0, velocity = [0.0, 1.0, 0.0], duration = 1.0 }}
turbulence = {{ wind_at_20_feet = 2.0, altitude = 5.0, seed = 4 }}
[battery]
full_voltage = 12.6
empty_voltage = 10.5
resistance = 0.03
capacity = 1.5
efficiency = 0.6
[sensors]
gyro_noise = 0.01
position_noise = 0.002
attitude_noise_deg = 0.2
velocity = \"observer\"
velocity_bandwidth = 10.0
accelerometer_noise = 0.1
pose_rate = 50.0
dropout = 0.02
delay = 0.01
"
    );
    let scenario = hovering(10.0, &everything);
    let (first, second) = (course(&scenario), course(&scenario));
    assert_eq!(first, second);
    assert!(first.end_error.is_finite() && first.activity > 1e-3);
    // A clone goes on as its original does, random numbers and all.
    let mut flight = Flight::new(&scenario).unwrap();
    for _ in 0..100 {
        flight.tick().unwrap();
    }
    let mut clone = flight.clone();
    for _ in 0..100 {
        assert_eq!(flight.tick().unwrap().state, clone.tick().unwrap().state);
    }
}

#[test]
fn a_logged_flight_says_what_it_was_flown_in() {
    let folder = directory("reality", "logged");
    let short = HUMMINGBIRD.replace("duration = 40.0", "duration = 2.0");
    let sections = "[wind]\nsteady = [1.5, 0.0, -0.5]\n[sensors]\ngyro_bias = [0.25, 0.0, 0.0]\n";
    std::fs::write(folder.join("windy.toml"), format!("{short}{DRAG}{sections}")).unwrap();
    std::fs::write(folder.join("still.toml"), short).unwrap();
    for (file, beyond) in [("windy", true), ("still", false)] {
        // It starts at rest on a moving reference: it does not arrive within these two seconds, and says so.
        assert_eq!(status(&host_sim(&folder, &["fly", &format!("{file}.toml"), "--out", file])), 1);
        let log = std::fs::read_to_string(folder.join(file).join("log.csv")).unwrap();
        let rows: Vec<Vec<&str>> = log.lines().map(|row| row.split(',').collect()).collect();
        assert!(rows.len() == 201 && rows.iter().all(|row| row.len() == rows[0].len()));
        let value = |row: &[&str], name: &str| {
            let column = rows[0].iter().position(|column| *column == name)?;
            row[column].parse::<f64>().ok()
        };
        for row in &rows[1..] {
            assert_eq!((value(row, "wind_x"), value(row, "wind_z")), (beyond.then_some(1.5), beyond.then_some(-0.5)));
            let bias = value(row, "measured_wx").zip(value(row, "wx")).map(|(measured, truly)| measured - truly);
            assert!(bias.map_or(!beyond, |bias| (bias - 0.25).abs() < 1e-6), "{bias:?}");
        }
        let report = std::fs::read_to_string(folder.join(file).join("report.md")).unwrap();
        assert_eq!(report.contains("beyond the model, with [drag], [wind], [sensors]"), beyond);
        assert_eq!(report.contains("beyond"), beyond);
    }
}

#[test]
fn a_campaign_of_disturbed_flights_takes_moments() {
    let sections =
        format!("{DRAG}[wind]\nsteady = [1.0, 0.0, 0.0]\n[sensors]\ngyro_noise = 0.01\nposition_noise = 0.002\n");
    let scenario = hovering(20.0, &sections);
    let certified = Certified::new(scenario.configuration.clone()).unwrap();
    let started = Instant::now();
    let circumstances = |number: u64| {
        let mut case = scenario.clone();
        let angle = number as f64;
        if let Some(wind) = &mut case.reality.wind {
            wind.steady = Vector3::new(angle.cos(), angle.sin(), 0.0);
        }
        if let Some(sensors) = &mut case.reality.sensors {
            sensors.seed = number;
        }
        case
    };
    let flown =
        fly_all(&certified, 200, circumstances, |scenario, flight| Course::fly(scenario, flight, SETTLED_DISTANCE_M))
            .unwrap();
    let seconds = started.elapsed().as_secs_f64();
    println!("200 flights of 20 s in {seconds:.2} s: {:.0} simulated seconds per second", 4000.0 / seconds);
    assert!(flown.iter().all(|course| course.as_ref().is_ok_and(|course| course.excursion < 10.0)));
    // Wind from all sides pushes to all sides alike.
    let ends: Vec<f64> = flown.iter().flatten().map(|course| course.end_error).collect();
    let (least, greatest) = ends.iter().fold((f64::MAX, 0.0_f64), |(a, b), x| (a.min(*x), b.max(*x)));
    assert!(greatest < 1.2 * least, "{least} {greatest}");
}

#[test]
fn a_campaign_is_its_flights_one_by_one_in_order() {
    let sections =
        "[drag]\nframe = [0.005, 0.005, 0.01]\n[wind]\nsteady = [1, 0, 0]\n[sensors]\nposition_noise = 0.002\n";
    let text = format!("{HUMMINGBIRD}\n{sections}").replace("duration = 40.0", "duration = 2.0");
    let scenario = Scenario::parse(&text, "f").unwrap();
    let certified = Certified::new(scenario.configuration.clone()).unwrap();
    let circumstances = |number: u64| {
        let mut case = scenario.clone();
        case.initial.velocity.y = 0.1 * number as f64;
        if let Some(sensors) = &mut case.reality.sensors {
            sensors.seed = number;
        }
        case
    };
    let course = |scenario: &Scenario, flight| Course::fly(scenario, flight, 0.1).unwrap();
    let all = fly_all(&certified, 12, circumstances, course).unwrap();
    let one_by_one: Vec<Course> = (0..12)
        .map(|number| course(&circumstances(number), Flight::certified(&circumstances(number), &certified).unwrap()))
        .collect();
    assert_eq!(all, one_by_one);
    assert!(all.windows(2).all(|pair| pair[0] != pair[1]));
}
