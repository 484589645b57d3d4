//! `host-sim identify` as its user meets it: from a flight to a scenario, and the three ways to be refused.

use crate::support::binary::{self, files, host_sim, status, stderr, stdout};
use scenario::Scenario;
use std::fs;
use std::path::PathBuf;

const IDENTIFY: &str = include_str!("../../scenarios/identify.toml");

fn directory(test: &str) -> PathBuf {
    binary::directory("cli_identify", test)
}

#[test]
fn a_flight_becomes_a_scenario_of_the_vehicle_that_flew() {
    let directory = directory("found");
    // Ten per cent heavier than its file, and slower.
    let truth = "[truth]\nmass = 0.55\nlag = 0.008\ncentre_of_mass = [0.003, -0.002, 0.0]\n";
    // Forces of the air act at the origin: those at the rotors' hubs are beyond what is supposed.
    let (before, rest) = IDENTIFY.split_once("[drag]").unwrap();
    let (_, after) = rest.split_once("[wind]").unwrap();
    let flown = format!("{before}[drag]\nlinear = [0.25, 0.25, 0.15]\n[wind]{after}\n{truth}");
    fs::write(directory.join("flown.toml"), flown).unwrap();
    fs::write(directory.join("bench.toml"), "[weighing]\nmass = [0.5502]\nuncertainty = 0.0005\n").unwrap();
    let _ = host_sim(&directory, &["fly", "flown.toml", "--out", "."]);
    let asked = ["identify", "log.csv", "--scenario", "flown.toml", "--bench", "bench.toml", "--out", "mine.toml"];
    let output = host_sim(&directory, &asked);
    let text = stdout(&output);
    assert_eq!((status(&output), stderr(&output)), (0, String::new()), "{text}");
    for words in ["thrust scale / mass", "what the uncertainty eats", "worst corner", "written to mine.toml"] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let mine = Scenario::load(&directory.join("mine.toml")).unwrap();
    let vehicle = mine.configuration.vehicle();
    assert!((vehicle.mass - 0.55).abs() < 2e-3, "{text}");
    let row = text.lines().find_map(|line| line.strip_prefix("inertia x  ")).unwrap();
    let numbers: Vec<f64> = row.split_whitespace().flat_map(str::parse).collect();
    let [found, _, least, greatest, ..] = numbers[..] else { panic!("{row}") };
    assert!(
        (f64::from(vehicle.inertia.x) / found - 1.0).abs() < 1e-3 && (least..=greatest).contains(&3.65e-3),
        "{text}"
    );
    assert!(greatest - least < 0.2 * found, "{text}");
    // Body rates come a millisecond sooner than the sampled loops count.
    assert!((mine.rotor_lag + mine.delay() - 0.007).abs() < 2e-3, "{text}");
}

#[test]
fn a_hover_is_refused_in_words_and_nothing_is_written() {
    let directory = directory("hover");
    let (before, _) = IDENTIFY.split_once("[reference]").unwrap();
    let hover = "[reference]\nkind = \"hover\"\nposition = [0.0, 0.0, 1.5]\n";
    fs::write(directory.join("hover.toml"), before.to_owned() + hover).unwrap();
    let _ = host_sim(&directory, &["fly", "hover.toml", "--out", "."]);
    let asked = ["identify", "log.csv", "--scenario", "hover.toml", "--out", "mine.toml"];
    let output = host_sim(&directory, &asked);
    let said = stderr(&output);
    assert_eq!((status(&output), stdout(&output)), (1, String::new()), "{said}");
    assert!(said.starts_with("error: log.csv: not identifiable\n") && said.contains("fly there and back"), "{said}");
    assert!(!files(&directory).contains(&"mine.toml".to_owned()));
}

#[test]
fn a_log_that_is_too_short_is_refused_with_what_to_fly() {
    let directory = directory("short");
    fs::write(directory.join("flown.toml"), IDENTIFY).unwrap();
    let _ = host_sim(&directory, &["fly", "flown.toml", "--out", "."]);
    let log = fs::read_to_string(directory.join("log.csv")).unwrap();
    let brief: Vec<&str> = log.lines().take(601).collect();
    fs::write(directory.join("log.csv"), brief.join("\n") + "\n").unwrap();
    let asked = ["identify", "log.csv", "--scenario", "flown.toml", "--out", "mine.toml"];
    let output = host_sim(&directory, &asked);
    let said = stderr(&output);
    assert_eq!((status(&output), stdout(&output)), (1, String::new()), "{said}");
    assert!(said.contains("the flight: 6 s without a gap, at least 15 are needed: fly longer"), "{said}");
    // Fifteen seconds of it tell inertia and delay, and say so.
    let part: Vec<&str> = log.lines().take(1).chain(log.lines().skip(4501).take(1531)).collect();
    fs::write(directory.join("log.csv"), part.join("\n") + "\n").unwrap();
    let output = host_sim(&directory, &asked);
    let said = stderr(&output);
    assert_eq!(status(&output), 1, "{said}");
    assert!(said.contains("\n  thrust scale over mass: known to +- 0.4"), "{said}");
    assert!(said.contains("\n  known all the same: inertia x over thrust scale 0.0037"), "{said}");
    assert!(!files(&directory).contains(&"mine.toml".to_owned()));
}

#[test]
fn what_cannot_be_read_is_named_with_its_place() {
    let directory = directory("bad");
    let file = |name: &str, text: &str| fs::write(directory.join(name), text).unwrap();
    file("other.csv", "a,b\n1,2\n");
    file("mass.toml", "[weighing]\nmass = [0.5]\n");
    file(
        "log.csv",
        "t,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz,pdx,pdy,pdz,thrust,tau_x,tau_y,tau_z\n0,0,0,0,1,0,0,0,0,0,0,0,0,0,5,0,zero,0\n",
    );
    let header = "t,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz,pdx,pdy,pdz,thrust,tau_x,tau_y,tau_z\n";
    file("few.csv", &format!("{header}0,0,0,0,1,0,0,0,0,0,0,0,0,0,5,0,0,0\n0.01,0,0,0,1,0,0\n"));
    file("infinite.csv", &format!("{header}0,0,0,inf,1,0,0,0,0,0,0,0,0,0,5,0,0,0\n"));
    file("narrow.csv", "t,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz,pdx,pdy,pdz,thrust,tau_x,tau_y\n");
    file("still.csv", &format!("{header}{0}{0}", "1,0,0,0,1,0,0,0,0,0,0,0,0,0,5,0,0,0\n"));
    file("empty.csv", "");
    file("marked.csv", &format!("\u{feff}{header}0,0,0,0,1,0,0,0,0,0,0,0,0,0,inf,0,0,0\n"));
    file("key.toml", "\"a\\nb\\u001Bc\" = 1\n");
    file("cut.ulg", "ULog\u{1}\u{12}5 and nothing else");
    file("blackbox.bbl", "H Product:Blackbox flight data recorder by Nicholas Sherlock\n");
    fs::write(directory.join("ardupilot.bin"), [0xA3, 0x95, 0x80, 0x80, 89]).unwrap();
    fs::write(directory.join("station.tlog"), [0, 6, 1, 2, 3, 4, 5, 6, 0xFD, 9]).unwrap();
    fs::write(directory.join("noise"), [0xC0, 0xC1, 0xFE]).unwrap();
    for (asked, said) in [
        (vec!["none.csv"], "error: none.csv: cannot be read"),
        (vec!["other.csv"], "error: other.csv: line 1: has no column t"),
        (vec!["log.csv"], "error: log.csv: line 2, tau_y: must be a finite number, found \"zero\""),
        (vec!["few.csv"], "error: few.csv: line 3, qz: is missing"),
        (vec!["infinite.csv"], "error: infinite.csv: line 2, vz: must be a finite number, found \"inf\""),
        (vec!["narrow.csv"], "error: narrow.csv: line 1: has no column tau_z"),
        (vec!["still.csv"], "error: still.csv: t: must increase from row to row"),
        (vec!["empty.csv"], "error: empty.csv: line 1: has no column t"),
        (vec!["marked.csv"], "error: marked.csv: line 2, thrust: must be a finite number, found \"inf\""),
        (vec!["log.csv", "--bench", "key.toml"], "error: key.toml: a\\nb\\u{1b}c: unknown key"),
        (vec!["cut.ulg"], "error: cut.ulg: holds no record of a tick, nor PX4's actuator_motors"),
        (vec!["blackbox.bbl"], "error: blackbox.bbl: is a Blackbox log of Betaflight or INAV"),
        (vec!["ardupilot.bin"], "error: ardupilot.bin: is a DataFlash log of ArduPilot"),
        (vec!["station.tlog"], "error: station.tlog: is a telemetry log (tlog), too slow to identify from"),
        (vec!["noise"], "error: noise: neither a log.csv nor a ULog: identify reads ULog"),
        (vec!["log.csv", "--bench", "mass.toml"], "error: mass.toml: weighing.uncertainty: is missing"),
    ] {
        let output = host_sim(&directory, &[&["identify"], &asked[..]].concat());
        let found = stderr(&output);
        assert_eq!((status(&output), found.lines().count()), (2, 1), "{found}");
        assert!(found.starts_with(said), "{found}");
    }
}

#[test]
fn no_file_that_was_read_is_written_over_and_what_cannot_be_written_shows_before_the_fit() {
    let directory = directory("out");
    // No flight: the fit would refuse it with another status.
    let log = "t,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz,pdx,pdy,pdz,thrust,tau_x,tau_y,tau_z\n\
               0,0,0,0,1,0,0,0,0,0,0,0,0,0,5,0,0,0\n0.01,0,0,0,1,0,0,0,0,0,0,0,0,0,5,0,0,0\n";
    let bench = "[weighing]\nmass = [0.5]\nuncertainty = 0.001\n";
    let given = [("log.csv", log), ("bench.toml", bench), ("flown.toml", IDENTIFY)];
    given.iter().for_each(|(name, text)| fs::write(directory.join(name), text).unwrap());
    fs::create_dir(directory.join("taken.toml")).unwrap();
    for (out, said) in [
        ("log.csv", "error: log.csv: --out must be another file than the log\n"),
        ("./bench.toml", "error: ./bench.toml: --out must be another file than the bench file\n"),
        ("flown.toml", "error: flown.toml: --out must be another file than the scenario\n"),
        ("taken.toml", "error: taken.toml: cannot be written: is a directory\n"),
        ("none/mine.toml", "error: none/mine.toml: cannot be written: No such file or directory (os error 2)\n"),
        ("a name\n.toml", "error: --out: becomes the scenario's name: "),
    ] {
        let asked = ["identify", "log.csv", "--scenario", "flown.toml", "--bench", "bench.toml", "--out", out];
        let output = host_sim(&directory, &asked);
        let found = stderr(&output);
        assert_eq!(status(&output), 2, "{found}");
        assert!(found.starts_with(said), "{found}");
    }
    for (name, text) in given {
        assert_eq!(fs::read_to_string(directory.join(name)).unwrap(), text);
    }
    assert_eq!(files(&directory), ["bench.toml", "flown.toml", "log.csv", "taken.toml"]);
}
