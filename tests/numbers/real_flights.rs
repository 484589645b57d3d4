//! Flights that others recorded: a simulated one, whose numbers are known, and the extract of a real one.

use crate::support::binary::directory;
use controller_core::allocation::Thrusts;
use host_sim::flight::Flight;
use host_sim::real_flights::columns::ColumnMap;
use host_sim::real_flights::command::{Refused, Task, identified, replayed_estimator, replayed_law, replayed_model};
use host_sim::real_flights::flown::Flown;
use host_sim::real_flights::forces::Forces;
use host_sim::real_flights::recording::Recording;
use host_sim::real_flights::torques::turnings;
use nalgebra::{UnitQuaternion, Vector3};
use scenario::Scenario;
use std::fmt::Write;
use std::path::PathBuf;

const EXTRACT: &str = include_str!("../real_flights/trefoil.csv");
const CRAZYFLIE: &str = include_str!("../real_flights/crazyflie.toml");
const NANOBENCH: &str = include_str!("../real_flights/nanobench.toml");

/// A task on a file with this text.
fn task(test: &str, log: &str, columns: &str) -> Task {
    let folder = directory("real_flights", test);
    let (csv, map) = (folder.join("log.csv"), folder.join("columns.toml"));
    std::fs::write(&csv, log).unwrap();
    std::fs::write(&map, columns).unwrap();
    Task { log: csv, columns: Some(map), original: CRAZYFLIE.to_owned(), file: "crazyflie.toml".to_owned() }
}

/// The extract with each row's cells changed; `change` gets the row's number, the names' places and the cells.
fn changed(change: impl Fn(usize, &dyn Fn(&str) -> usize, &mut Vec<f64>)) -> String {
    let mut lines = EXTRACT.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let place = |name: &str| header.iter().position(|found| *found == name).unwrap();
    let mut text = header.join(",") + "\n";
    for (row, line) in lines.enumerate() {
        let mut cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        change(row, &place, &mut cells);
        text += &cells.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        text.push('\n');
    }
    text
}

/// The extract with these columns' rows so many later.
fn late(names: &[&str], rows: i64) -> String {
    let cells: Vec<Vec<f64>> =
        EXTRACT.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    changed(|row, place, now| {
        let from = (row as i64 - rows).clamp(0, cells.len() as i64 - 1) as usize;
        for name in names {
            now[place(name)] = cells[from][place(name)];
        }
    })
}

fn refusal(test: &str, log: &str) -> String {
    match identified(&task(test, log, NANOBENCH)) {
        Err(Refused::NotShown(what)) => what,
        Err(Refused::Input(what)) => panic!("{test}: not read: {what}"),
        Ok((report, _)) => panic!("{test}: taken for good:\n{report}"),
    }
}

const GYRO: [&str; 3] = ["imu_gyro_x", "imu_gyro_y", "imu_gyro_z"];
const FORCE: [&str; 3] = ["imu_acc_x", "imu_acc_y", "imu_acc_z"];
const MOTORS: [&str; 4] = ["motor_motor_m1", "motor_motor_m2", "motor_motor_m3", "motor_motor_m4"];
const POSITION: [&str; 3] = ["px", "py", "pz"];
const POSE: [&str; 7] = ["px", "py", "pz", "qw", "qx", "qy", "qz"];

#[test]
fn what_is_spoiled_is_found_and_named() {
    let scaled = |names: &'static [&'static str], factor: f64| {
        changed(move |_, place, cells| names.iter().for_each(|name| cells[place(name)] *= factor))
    };
    let swapped = |a: &'static str, b: &'static str| changed(move |_, place, cells| cells.swap(place(a), place(b)));
    let cases: [(&str, String, &str); 16] = [
        ("gyro in degrees", scaled(&GYRO, 57.3), "they look like deg/s, read as rad/s: write rates_unit"),
        ("gyro x and y", swapped(GYRO[0], GYRO[1]), "rates = [\"imu_gyro_y\", \"imu_gyro_x\", \"imu_gyro_z\"]"),
        ("gyro x negated", scaled(&GYRO[..1], -1.0), "rates = [\"-imu_gyro_x\", \"imu_gyro_y\", \"imu_gyro_z\"]"),
        ("force in m/s^2", scaled(&FORCE, 9.80665), "force_unit = \"m/s^2\""),
        ("force in mg", scaled(&FORCE, 1e3), "force_unit = \"mg\""),
        ("force x and y", swapped(FORCE[0], FORCE[1]), "x and y exchanged"),
        ("force x and z", swapped(FORCE[0], FORCE[2]), "the column for z looks like \"imu_acc_x\""),
        ("force y negated", scaled(&FORCE[1..2], -1.0), "y with a minus"),
        ("positions in cm", scaled(&POSITION, 100.0), "unit = \"cm\""),
        (
            "quaternion w last",
            changed(|_, place, cells| cells[place("qw")..=place("qz")].rotate_left(1)),
            "looks like w last",
        ),
        ("quaternion world to body", scaled(&POSE[4..], -1.0), "looks like world to body"),
        ("motors 1 and 2", swapped(MOTORS[0], MOTORS[1]), "columns = [\"motor_motor_m2\", \"motor_motor_m1\""),
        (
            "motors turned round",
            changed(|_, place, cells| cells[place(MOTORS[0])..=place(MOTORS[3])].rotate_left(1)),
            "columns = [\"motor_motor_m4\", \"motor_motor_m1\"",
        ),
        ("motors as shares", scaled(&MOTORS, 1.0 / 65535.0), "motors.full"),
        ("motors 0.3 s late", late(&MOTORS, 30), "BEFORE they were written"),
        ("battery in mV", scaled(&["pwr_pm_vbat"], 1e3), "looks like mV"),
    ];
    for (name, log, named) in cases {
        let said = refusal(name, &log);
        assert!(said.contains(named), "{name}: {said}");
    }
}

#[test]
fn poses_with_other_times_are_put_right_and_that_is_said() {
    let of = |test: &str, log: &str| identified(&task(test, log, NANOBENCH)).unwrap().0;
    let (as_it_is, half_a_second) = (of("as it is", EXTRACT), of("poses late", &late(&POSE, 50)));
    assert!(!as_it_is.contains("TIMES OF POSES"), "{as_it_is}");
    assert!(half_a_second.contains("THE TIMES OF POSES ARE OFF: poses are 470 ms late"), "{half_a_second}");
    let drag = |report: &str| report.lines().find(|line| line.starts_with("linear drag x")).unwrap()[..30].to_owned();
    assert_eq!(drag(&as_it_is)[..24], drag(&half_a_second)[..24]);
}

#[test]
fn rows_that_repeat_and_poses_that_freeze_are_left_out() {
    let held = changed_rows(|row| row - row % 4, &POSE);
    let report = identified(&task("held", &held, NANOBENCH)).unwrap().0;
    assert!(report.contains("poses: 430 rows, 25 Hz, 75.0 % repeated or at one time: left out"), "{report}");
    let frozen = changed_rows(|row| if (1000..1200).contains(&row) { 1000 } else { row }, &POSE);
    let report = identified(&task("frozen", &frozen, NANOBENCH)).unwrap().0;
    assert!(report.contains("1 gaps, 2000 ms at most"), "{report}");
    assert!(!report.contains("14.6 s in the air"), "{report}");
}

/// The extract with these columns of another row.
fn changed_rows(from: impl Fn(usize) -> usize, names: &[&str]) -> String {
    let cells: Vec<Vec<f64>> =
        EXTRACT.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    changed(|row, place, now| names.iter().for_each(|name| now[place(name)] = cells[from(row)][place(name)]))
}

/// The first number of a row of a table that begins with these words.
fn figure(report: &str, row: &str, place: usize) -> f64 {
    let line = report.lines().find(|line| line.starts_with(row)).unwrap_or_else(|| panic!("no {row} in\n{report}"));
    let rest = &line[row.len()..];
    rest.split_whitespace().filter_map(|word| word.parse().ok()).nth(place).unwrap()
}

#[test]
fn the_extract_shows_a_crazyflie_and_says_why_no_inertia() {
    let (report, text) = identified(&task("extract", EXTRACT, NANOBENCH)).unwrap();
    assert!((0.8..1.0).contains(&figure(&report, "thrust scale  ", 0)), "{report}");
    for axis in ["x", "y"] {
        assert!((0.009..0.012).contains(&figure(&report, &format!("linear drag {axis}"), 0)), "{report}");
        let why = format!("the log cannot show inertia {axis}: a loop of 500 Hz wrote commands that change between");
        assert!(report.contains(&why), "{report}");
    }
    assert!((0.03..0.15).contains(&figure(&report, "rotor lag up", 0)), "{report}");
    assert!(report.contains("kept are the poses' times"), "{report}");
    // What is written is a vehicle.
    Scenario::parse(&text, "found").unwrap();
}

#[test]
fn half_of_the_extract_foretells_the_other_better_than_a_hover() {
    let report = replayed_model(&task("halves", EXTRACT, NANOBENCH)).unwrap();
    for (horizon, better) in [("0.5 s", 0.85), ("1 s", 0.75)] {
        let [gyro, hover] = ["gyro", "hover"].map(|way| figure(&report, &format!("{way:<10}{horizon}"), 0));
        assert!(gyro < better * hover, "{horizon}: {gyro} {hover}\n{report}");
    }
}

#[test]
fn the_estimator_is_nearer_than_the_vehicles_own_and_outlasts_gaps() {
    let report = replayed_estimator(&task("estimator", EXTRACT, NANOBENCH)).unwrap();
    let ours = figure(&report, "the same; noise as a radio's log deserves", 0);
    let own = figure(&report, "the vehicle's own filter", 0);
    assert!(ours < 0.5 && own > 2.0 * ours, "{report}");
    assert!(figure(&report, "the same, without poses for 0.5 s of 4", 1) < 10.0, "{report}");
    // What a measurement shows against us: a board's settings do not suit an IMU that a radio logged.
    assert!(report.contains("noise as boards believe  LOST"), "{report}");
}

#[test]
fn our_law_flies_the_extract_certified_and_within_a_metre() {
    let (report, result) = replayed_law(&task("law", EXTRACT, NANOBENCH)).unwrap();
    assert!(result.certified, "{report}");
    assert!(result.reference.rms < 0.03 && result.ours.greatest < 1.0, "{report}");
    assert!((0.28..0.35).contains(&result.flown.rms), "{report}");
    assert_eq!(result.clipped, 0, "{report}");
}

/// How a simulated flight is written.
struct Written {
    /// Of a hundred rows a second, one of so many.
    every: usize,
    /// Speeds of the rotors, not commands.
    speeds: bool,
    /// Whether it is read with an accelerometer.
    accelerometer: bool,
}

/// A simulated flight as a CSV, with its rotors' commands or speeds, and the vehicle.
fn simulated(how: &Written) -> (String, String) {
    let text = include_str!("../../scenarios/identify.toml");
    let text = without_sections(text, &["estimator", "wind"]).replace("lag = 0.005 ", "lag = 0.03 ");
    let scenario = Scenario::parse(&text, "identify").unwrap();
    let mut flight = Flight::new(&scenario).unwrap();
    let mut csv = "t,px,py,pz,qw,qx,qy,qz,gx,gy,gz,ax,ay,az,m1,m2,m3,m4\n".to_owned();
    let rotors = scenario.configuration.rotors().unwrap().clone();
    let mut before: Option<(Vector3<f64>, UnitQuaternion<f64>)> = None;
    let mut lines: Vec<String> = Vec::new();
    for tick in 0..3000 {
        let tick_now = flight.tick().unwrap();
        let state = tick_now.state;
        let attitude = UnitQuaternion::new_normalize(state.attitude);
        let speeds: Vec<f64> = rotors
            .iter()
            .zip(&tick_now.rotors)
            .map(|(rotor, thrust)| f64::from(rotor.speed_at(*thrust as f32)))
            .collect();
        let commands: Thrusts = tick_now.rotor_thrusts.clone();
        let motors: Vec<f64> =
            if how.speeds { speeds } else { commands.iter().map(|thrust| f64::from(*thrust)).collect() };
        // Over the period before: half a period old, as a real accelerometer's mean would be.
        if let Some((velocity, middle)) = before.replace((state.velocity, attitude)) {
            let force = middle
                .slerp(&attitude, 0.5)
                .inverse_transform_vector(&((state.velocity - velocity) / 0.01 + Vector3::z() * 9.81));
            let [p, r] = [state.position, state.angular_velocity];
            let q = attitude;
            let mut line = format!("{:.3},{:.6},{:.6},{:.6}", tick as f64 * 0.01, p.x, p.y, p.z + 1.0);
            write!(line, ",{:.7},{:.7},{:.7},{:.7}", q.w, q.i, q.j, q.k).unwrap();
            write!(line, ",{:.6},{:.6},{:.6},{:.6},{:.6},{:.6}", r.x, r.y, r.z, force.x, force.y, force.z).unwrap();
            write!(line, ",{:.6},{:.6},{:.6},{:.6}", motors[0], motors[1], motors[2], motors[3]).unwrap();
            lines.push(line);
        }
    }
    csv += &lines.iter().step_by(how.every).cloned().collect::<Vec<_>>().join("\n");
    (csv, text)
}

/// A scenario's text without these sections.
fn without_sections(text: &str, names: &[&str]) -> String {
    let mut keeps = true;
    let kept = text.lines().filter(|line| {
        if line.starts_with('[') {
            keeps = !names.iter().any(|name| line.starts_with(&format!("[{name}")));
        }
        keeps
    });
    kept.collect::<Vec<_>>().join("\n") + "\n"
}

fn columns(unit: &str) -> String {
    format!(
        "[time]\ncolumn = \"t\"\n\
         [pose]\nposition = [\"px\", \"py\", \"pz\"]\nattitude = [\"qw\", \"qx\", \"qy\", \"qz\"]\n\
         [imu]\nrates = [\"gx\", \"gy\", \"gz\"]\nforce = [\"ax\", \"ay\", \"az\"]\n\
         [motors]\ncolumns = [\"m1\", \"m2\", \"m3\", \"m4\"]\nunit = \"{unit}\"\n"
    )
}

/// What is found of a simulated flight, with the truth.
fn found(test: &str, how: &Written) -> (Scenario, Forces, Flown, PathBuf) {
    let (csv, text) = simulated(how);
    let mut columns = columns(if how.speeds { "rad/s" } else { "N" });
    if !how.accelerometer {
        columns = columns.replace("force = [\"ax\", \"ay\", \"az\"]\n", "");
    }
    let map = ColumnMap::parse(&columns).unwrap();
    let path = directory("real_flights", test).join("log.csv");
    std::fs::write(&path, csv).unwrap();
    let scenario = Scenario::parse(&text, "identify").unwrap();
    let recording = Recording::read(&path, &map).unwrap();
    let flown = Flown::new(&recording, scenario.configuration.rotors().unwrap()).unwrap();
    let forces = Forces::new(&flown, recording.measure, 9.81).unwrap();
    (scenario, forces, flown, path)
}

#[test]
fn a_simulated_flight_shows_the_vehicle_that_flew_it() {
    let (scenario, forces, flown, _) = found("simulated", &Written { every: 1, speeds: false, accelerometer: true });
    let vehicle = scenario.configuration.vehicle();
    let mass = f64::from(vehicle.mass);
    assert!((forces.strength.value * mass - 1.0).abs() < 0.02, "{forces:?}");
    let [up, down] = forces.lag_values();
    // The accelerometer's mean is half a period old.
    for lag in [up, down] {
        assert!((lag - scenario.rotor_lag).abs() < 0.02, "{lag} {}", scenario.rotor_lag);
    }
    let inertia = vehicle.inertia.map(f64::from);
    let turnings = turnings(&flown, scenario.configuration.rotors().unwrap(), forces.lag_values());
    for (axis, turning) in turnings.iter().take(2).enumerate() {
        let (_, [least, greatest]) = turning.inertia(100.0, None).unwrap();
        let scale = forces.strength.value * mass;
        assert!((scale * least..scale * greatest).contains(&inertia[axis]), "{axis}: {least} {greatest}");
    }
    // Its turns are slower than what is looked at.
    assert!(turnings[2].inertia(100.0, None).unwrap_err().contains("fly steps or turns about it"));
}

#[test]
fn measured_speeds_of_rotors_leave_no_question_of_lag() {
    let (scenario, forces, ..) = found("speeds", &Written { every: 1, speeds: true, accelerometer: true });
    assert!(forces.lags.is_none());
    let mass = f64::from(scenario.configuration.vehicle().mass);
    assert!((forces.strength.value * mass - 1.0).abs() < 0.02, "{forces:?}");
    assert!(forces.left[0] < 0.3 * forces.left[1], "{forces:?}");
}

#[test]
fn without_an_accelerometer_forces_are_how_speed_changes() {
    let with = found("felt", &Written { every: 1, speeds: false, accelerometer: true }).1;
    let (scenario, without, flown, _) = found("seen", &Written { every: 1, speeds: false, accelerometer: false });
    assert!(!flown.is_felt);
    let mass = f64::from(scenario.configuration.vehicle().mass);
    assert!((without.strength.value * mass - 1.0).abs() < 0.02, "{without:?}");
    for (with, without) in with.drag.iter().zip(&without.drag) {
        assert!((without.value / with.value - 1.0).abs() < 0.1, "{with:?} {without:?}");
    }
    for lag in without.lag_values() {
        assert!((lag - scenario.rotor_lag).abs() < 0.025, "{lag}");
    }
}

#[test]
fn columns_that_cannot_be_are_refused_by_name() {
    let refused = |text: &str| ColumnMap::parse(text).unwrap_err();
    for (from, to, named) in [
        ("[imu]", "[imv]", "imv: unknown key, did you mean \"imu\"?"),
        ("column = \"t\"", "column = 3", "time.column"),
        ("unit = \"rad/s\"", "unit = \"knots\"", "motors.unit: must be"),
        ("\"qz\"]", "\"qz\", \"qz\"]", "pose.attitude: must be a list of 4 or 3 or 9 names"),
        ("\"gz\"]", "\"gz\"]\nrates_unit = \"rpm\"", "imu.rates_unit: must be one of \"rad/s\", \"deg/s\""),
        ("[motors]", "[motors]\nbattery = \"v\"", "motors.battery: is for unit = \"share\" alone"),
    ] {
        let said = refused(&columns("rad/s").replace(from, to));
        assert!(said.contains(named), "{to}: {said}");
    }
    assert!(
        refused(&columns("share").replace("[motors]", "[motors]\nbattery = \"v\"")).contains("motors.full_voltage")
    );
    assert!(refused("x = ").starts_with("not TOML"));
}

#[test]
fn streams_may_lie_in_several_files_with_clocks_of_their_own() {
    let folder = directory("real_flights", "several");
    let mut lines = EXTRACT.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let (mut motors, mut rest) =
        ("ms,".to_owned() + &MOTORS.join(",") + ",v\n", EXTRACT.lines().next().unwrap().to_owned() + "\n");
    let place = |name: &str| header.iter().position(|found| *found == name).unwrap();
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let of: Vec<&str> = MOTORS.iter().map(|name| cells[place(name)]).collect();
        let time = 1000.0 * cells[0].parse::<f64>().unwrap() + 5000.0;
        writeln!(motors, "{time},{},{}", of.join(","), cells[place("pwr_pm_vbat")]).unwrap();
        writeln!(rest, "{line}").unwrap();
    }
    std::fs::write(folder.join("motors.csv"), motors).unwrap();
    std::fs::write(folder.join("log.csv"), rest).unwrap();
    let map = NANOBENCH.replace(
        "battery = \"pwr_pm_vbat\"",
        "battery = \"v\"\nfile = \"motors.csv\"\ntime = \"ms\"\ntime_unit = \"ms\"\noffset = -5.0",
    );
    std::fs::write(folder.join("columns.toml"), &map).unwrap();
    let task = Task {
        log: folder.join("log.csv"),
        columns: Some(folder.join("columns.toml")),
        original: CRAZYFLIE.to_owned(),
        file: "crazyflie.toml".to_owned(),
    };
    let [several, one] = [identified(&task).unwrap().0, identified(&self::task("one", EXTRACT, NANOBENCH)).unwrap().0];
    for row in ["thrust scale  ", "rotor lag up", "linear drag x"] {
        let (a, b) = (figure(&several, row, 0), figure(&one, row, 0));
        assert!((a / b - 1.0).abs() < 0.01, "{row}: {a} {b}");
    }
}
