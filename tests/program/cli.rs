//! The binary as a user meets it: exit statuses, messages, files, and the law in lock-step.

use crate::support::binary;
use crate::support::binary::{PAPER, brief, files, host_sim, status, stderr, stdout, with};
use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// A directory of this suite.
fn directory(test: &str) -> PathBuf {
    binary::directory("cli", test)
}

#[test]
fn a_recording_is_written_beside_the_log_with_mcap() {
    let directory = directory("recording");
    let run = host_sim(&directory, &["fly", "--mcap", "--out", "out"]);
    assert_eq!(status(&run), 0, "{}", stderr(&run));
    let recording = std::fs::read(directory.join("out/flight.mcap")).unwrap();
    // Magic at both ends: whole; and what was attached is what was flown.
    let magic = b"\x89MCAP0\r\n";
    assert!(recording.starts_with(magic) && recording.ends_with(magic));
    assert!(recording.windows(PAPER.len()).any(|window| window == PAPER.as_bytes()));
}

#[test]
fn a_replay_is_a_gif_or_is_refused_with_nothing_written() {
    let directory = directory("replay");
    std::fs::write(directory.join("brief.toml"), with(PAPER, "duration", "duration = 2.0")).unwrap();
    let run = |more: &[&str]| host_sim(&directory, &[&["replay", "brief.toml", "--gif", "out.gif"], more].concat());
    for (more, words) in [
        (vec!["--speed", "0"], "--speed: must be from 0.05 to 100, found 0"),
        (vec!["--from", "2"], "two moments of the flight, which takes 2 s, in order; found 2 and 2"),
        (vec!["--to", "nan"], "found 0 and NaN"),
        (vec!["--to", "3"], "found 0 and 3"),
    ] {
        let refused = run(&more);
        assert_eq!(status(&refused), 2);
        assert!(stderr(&refused).contains(words), "{}", stderr(&refused));
    }
    let onto_itself = host_sim(&directory, &["replay", "brief.toml", "--gif", "brief.toml"]);
    assert!(stderr(&onto_itself).contains("--gif must be another file than the scenario"), "{}", stderr(&onto_itself));
    assert_eq!(files(&directory), ["brief.toml"]);
    let written = run(&["--from", "0.5", "--speed", "2"]);
    assert_eq!(status(&written), 0, "{}", stderr(&written));
    let gif = std::fs::read(directory.join("out.gif")).unwrap();
    assert!(gif.starts_with(b"GIF89a") && gif.ends_with(b";") && gif.len() > 5_000, "{} bytes", gif.len());
}

#[test]
fn without_arguments_it_flies_the_paper() {
    let directory = directory("paper");
    let output = host_sim(&directory, &[]);
    assert_eq!(status(&output), 0, "{}", stderr(&output));
    let text = stdout(&output);
    assert!(text.contains("claim") && text.contains("required") && text.contains("flown") && text.contains("verdict"));
    assert!(text.contains("every claim holds") && !text.contains("FAILS"), "{text}");
    assert_eq!(stderr(&output), "", "nothing on stderr, no progress bar into a pipe");

    let flight = directory.join("flights/paper");
    assert_eq!(
        files(&flight),
        ["fig1.svg", "fig2.svg", "first-seconds.svg", "flight.svg", "log.csv", "report.html", "report.md"]
    );
    let log = std::fs::read_to_string(flight.join("log.csv")).unwrap();
    let mut lines = log.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    assert_eq!((header[0], header[19], header[39]), ("t", "thrust", "s_omega"));
    let rows: Vec<Vec<f64>> = lines.map(|row| row.split(',').map(|word| word.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len(), 4000);
    assert!(rows.iter().all(|row| row.len() == header.len()));
    assert_eq!(rows[0][..4], [0.0, 5.0, 5.0, 10.0]);
    assert_eq!(rows[3999][0], 39.99);
    for figure in ["fig1.svg", "fig2.svg", "first-seconds.svg", "flight.svg"] {
        let svg = std::fs::read_to_string(flight.join(figure)).unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"), "{figure}");
    }
}

#[test]
fn a_flight_whose_claims_fail_exits_with_1_and_still_writes_everything() {
    let directory = directory("failing");
    // Enough to hover, too little for what the law commands.
    std::fs::write(directory.join("weak.toml"), with(PAPER, "thrust_max", "thrust_max = 4.9")).unwrap();
    let output = host_sim(&directory, &["fly", "weak.toml", "--out", "results"]);
    assert_eq!(status(&output), 1, "{}", stderr(&output));
    assert!(stdout(&output).contains("FAILS"));
    assert_eq!(files(&directory.join("results")).len(), 7);
}

#[test]
fn the_published_figures_are_claims_about_the_papers_scenario_only() {
    let directory = directory("renamed");
    std::fs::write(directory.join("same.toml"), with(PAPER, "name", "name = \"same\"")).unwrap();
    std::fs::write(directory.join("other.toml"), with(PAPER, "duration", "duration = 41.0")).unwrap();
    let same = host_sim(&directory, &["fly", "same.toml"]);
    assert!(stdout(&same).contains("published") && directory.join("flights/same/log.csv").exists());
    let other = stdout(&host_sim(&directory, &["fly", "other.toml", "--out", "other"]));
    assert!(!other.contains("published") && other.contains("Theorem 1") && other.contains("reported"), "{other}");
}

#[test]
fn malformed_scenarios_exit_with_2_name_the_field_and_leave_no_output() {
    let cases: &[(&str, &str, &[&str])] = &[
        ("mass", "mass = 0.0", &["vehicle.mass", "greater than zero"]),
        ("mass", "mass = -1", &["vehicle.mass", "greater than zero", "-1"]),
        ("mass", "mass = nan", &["vehicle.mass", "finite"]),
        ("mass", "mass = 3.4e38", &["vehicle.mass", "must have a weight", "3.4e38"]),
        ("mass", "mass = \"heavy\"", &["vehicle.mass", "must be a number", "string"]),
        ("mass", "", &["vehicle.mass", "missing"]),
        ("mass", "mas = 0.46", &["vehicle.mas", "unknown key", "\"mass\""]),
        ("inertia", "inertia = [2.24e-3, 2.9e-3, 9.0e-3]", &["vehicle.inertia", "triangle inequality", "0.00514"]),
        ("inertia", "inertia = [2.24e-3, inf, 5.3e-3]", &["vehicle.inertia[1]", "finite"]),
        ("inertia", "inertia = [2.24e-3, 0.0, 5.3e-3]", &["vehicle.inertia[1]", "greater than zero"]),
        ("inertia", "inertia = [2.24e-3, 2.9e-3]", &["vehicle.inertia", "three numbers"]),
        ("gravity", "gravity = -9.81", &["vehicle.gravity", "greater than zero"]),
        ("thrust_max", "thrust_max = 4.5", &["limits.thrust_max", "above 4.51", "4.5"]),
        ("thrust_max", "thrust_max = inf", &["limits.thrust_max", "finite"]),
        ("torque_max", "torque_max = [0.5, -0.5, 0.5]", &["limits.torque_max[1]", "greater than zero", "-0.5"]),
        ("k_p", "k_p = 0.0", &["gains.k_p", "greater than zero"]),
        ("k_theta", "k_tehta = 100.0", &["gains.k_tehta", "unknown key", "\"k_theta\""]),
        ("delta", "delta = 0.0", &["gains.delta", "greater than zero"]),
        ("delta", "delta = -0.02", &["gains.delta", "greater than zero"]),
        ("alpha", "alpha = 1.0", &["gains.alpha", "below 1"]),
        ("m_p", "m_p = 9.7", &["gains.m_p", "below 9.63", "9.7", "K_a3"]),
        ("m_p", "m_p = 1e39", &["gains.m_p", "within"]),
        ("rate", "rate = 0.0", &["control.rate", "from 10", "0"]),
        ("rate", "rate = 300.0", &["control.rate", "whole number of microseconds", "300.03"]),
        ("rate", "rate = nan", &["control.rate", "finite"]),
        ("step", "step = 0.0", &["plant.step", "greater than zero"]),
        ("step", "step = 0.003", &["plant.step", "whole number of steps"]),
        ("duration", "duration = 0", &["duration", "from one control period"]),
        ("torque_max", "", &["limits.torque_max", "missing", "[rotors]"]),
        ("inertia", "inertia = [[2e-3, 1e-4, 0], [1e-4, 3e-3, 0], [0, 0, 5e-3]]", &["vehicle.inertia", "yaw of -5.65"]),
        ("name", "name = \"../elsewhere\"", &["name", "letters, digits"]),
        ("name", "nmae = \"x\"", &["nmae", "unknown key", "\"name\""]),
        ("position", "position = [5.0, nan, 10.0]", &["initial.position[1]", "finite"]),
        ("position", "position = [5.0, 1e20, 10.0]", &["initial.position", "within"]),
        ("angular_velocity", "angular_velocity = [0, 0, 1e6]", &["initial.angular_velocity", "at most 500"]),
        ("kind", "kind = \"harmonics\"", &["reference.kind", "\"waypoints\" or \"trajectory\"", "harmonics"]),
        ("kind", "kind = \"hover\"", &["reference.amplitude", "unknown key"]),
        ("frequency", "frequency = [0.4, 0.4, inf]", &["reference.frequency[2]", "finite"]),
        ("frequency", "frequency = [0.4, 0.4, 4.0]", &["gains.m_p", "K_a3"]),
        ("heading", "heading = { ofset = 0.0 }", &["reference.heading.ofset", "unknown key", "\"offset\""]),
        ("[plant]", "[plants]", &["plants", "unknown key", "\"plant\""]),
        ("[gains]", "[gains", &["line 14", "not TOML"]),
        ("k_v", "k_p = 6.0", &["line 16", "not TOML"]),
    ];
    let directory = directory("malformed");
    let file = directory.join("bad.toml");
    for (line, replacement, words) in cases {
        std::fs::write(&file, with(PAPER, line, replacement)).unwrap();
        for arguments in [["fly", "bad.toml"], ["law", "bad.toml"]] {
            let output = host_sim(&directory, &arguments);
            let message = stderr(&output);
            assert_eq!(status(&output), 2, "{replacement}: {message}");
            assert_eq!(message.lines().count(), 1, "{replacement}: {message}");
            assert_eq!(stdout(&output), "", "{replacement}");
            for word in ["bad.toml"].iter().chain(*words) {
                assert!(message.contains(word), "{replacement}: {message:?} does not say {word:?}");
            }
        }
    }
    assert_eq!(files(&directory), ["bad.toml"]);
}

#[test]
fn whatever_texts_and_file_names_hold_an_error_is_one_line_that_no_terminal_acts_on() {
    let directory = directory("escaped");
    let text = "\"\"\"a\nb\\u001B[31mc\"\"\"";
    for (section, field) in [
        (format!("[sensors]\nvelocity = {text}\n"), "sensors.velocity"),
        (format!("[campaign]\nreference = {text}\n"), "campaign.reference"),
        (format!("[drag]\nlinear = [0.1, 0.1, 0.1]\n[wind]\ngust = {{ kind = {text} }}\n"), "wind.gust.kind"),
        (
            format!(
                "[rotors]\nposition = [[0, 0, 0]]\nspin = [{text}]\nthrust_coefficient = 1\ndrag_coefficient = 1\nspeed = [0, 1]\n"
            ),
            "rotors.spin[0]",
        ),
        (
            format!(
                "[rotors]\nposition = []\nspin = []\nthrust_coefficient = 1\ndrag_coefficient = 1\nspeed = [0, {text}]\n"
            ),
            "rotors.speed",
        ),
    ] {
        std::fs::write(directory.join("bad.toml"), format!("{PAPER}\n{section}")).unwrap();
        let output = host_sim(&directory, &["fly", "bad.toml"]);
        let message = stderr(&output);
        assert_eq!((status(&output), message.lines().count()), (2, 1), "{message}");
        assert!(message.contains(field) && message.contains("a\\nb\\u{1b}[31mc"), "{message}");
    }
    let name = "a\nb\u{1b}[31m.toml";
    std::fs::write(directory.join(name), "name = 1\n").unwrap();
    for arguments in [["certify", name], ["certify", "a\u{1b}none.toml"], ["identify", "a\u{1b}none.csv"]] {
        let message = stderr(&host_sim(&directory, &arguments));
        assert!(
            message.lines().count() == 1 && message.contains("\\u{1b}") && !message.contains('\u{1b}'),
            "{message:?}"
        );
    }
}

#[test]
fn a_mark_of_byte_order_before_draws_is_read_over() {
    let directory = directory("marked");
    std::fs::write(directory.join("brief.toml"), brief()).unwrap();
    std::fs::write(directory.join("draws.toml"), "\u{feff}[campaign]\nflightz = 1\n").unwrap();
    let message = stderr(&host_sim(&directory, &["campaign", "brief.toml", "--draws", "draws.toml"]));
    assert!(message.contains("draws.toml: campaign.flightz: unknown key"), "{message}");
}

#[test]
fn a_sessions_errors_name_the_file() {
    let directory = directory("named");
    std::fs::write(directory.join("mine.toml"), PAPER).unwrap();
    let output = host_sim(&directory, &["sitl", "mine.toml"]);
    assert!(stderr(&output).starts_with("error: mine.toml: rotors: missing"), "{}", stderr(&output));
    let board = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = board.local_addr().unwrap().to_string();
    let output = host_sim(&directory, &["hil", "mine.toml", "--connect", &address]);
    assert!(stderr(&output).starts_with("error: mine.toml: rotors: a flight controller"), "{}", stderr(&output));
    assert_eq!(status(&output), 2);
}

#[test]
fn malformed_waypoints_name_the_point() {
    let directory = directory("waypoints");
    let head: String = PAPER.split("[initial]").next().unwrap().to_owned();
    let cases: &[(&str, &[&str])] = &[
        ("points = []", &["reference.points", "at least"]),
        ("points = 3", &["reference.points", "list of tables"]),
        ("points = [{ t = 0, position = [0, 0, 1] }, 7]", &["reference.points[1]", "table"]),
        ("points = [{ t = 1, position = [0, 0, 1] }]", &["reference.points[0].t", "zero"]),
        (
            "points = [{ t = 0, position = [0, 0, 1] }, { t = 0, position = [0, 0, 2] }]",
            &["reference.points[1].t", "increasing"],
        ),
        (
            "points = [{ t = 0, position = [0, 0, 1], heading = 3 }]",
            &["reference.points[0].heading", "\"heading_deg\""],
        ),
        ("points = [{ t = 0, position = [0, 0, nan] }]", &["reference.points[0].position[2]", "finite"]),
        ("points = [{ position = [0, 0, 1] }]", &["reference.points[0].t", "missing"]),
    ];
    for (points, words) in cases {
        std::fs::write(directory.join("bad.toml"), format!("{head}[reference]\nkind = \"waypoints\"\n{points}\n"))
            .unwrap();
        let output = host_sim(&directory, &["fly", "bad.toml"]);
        let message = stderr(&output);
        assert!(status(&output) == 2 && message.lines().count() == 1, "{points}: {message}");
        for word in *words {
            assert!(message.contains(word), "{points}: {message:?} does not say {word:?}");
        }
    }
    assert_eq!(files(&directory), ["bad.toml"]);
}

#[test]
fn unusable_arguments_exit_with_2() {
    let directory = directory("arguments");
    let missing = host_sim(&directory, &["fly", "nowhere.toml"]);
    assert_eq!(status(&missing), 2);
    assert!(stderr(&missing).contains("nowhere.toml: cannot be read"), "{}", stderr(&missing));
    assert_eq!(status(&host_sim(&directory, &["flee"])), 2);
    std::fs::write(directory.join("occupied"), "a file where the results should go").unwrap();
    let occupied = host_sim(&directory, &["fly", "--out", "occupied"]);
    assert!(status(&occupied) == 2 && stderr(&occupied).contains("occupied"), "{}", stderr(&occupied));
    let help = host_sim(&directory, &["--help"]);
    assert_eq!(status(&help), 0);
    assert!(stdout(&help).contains("Examples") && stdout(&help).contains("Exit status"));
    assert_eq!(files(&directory), ["occupied"]);
}

#[test]
fn a_second_flight_replaces_the_first_and_a_failed_one_leaves_it() {
    let directory = directory("replaced");
    let quick = brief();
    std::fs::write(directory.join("quick.toml"), &quick).unwrap();
    assert_eq!(status(&host_sim(&directory, &["fly", "quick.toml", "--out", "out"])), 0);
    let first = std::fs::read(directory.join("out/log.csv")).unwrap();
    assert_eq!(status(&host_sim(&directory, &["fly", "quick.toml", "--out", "out"])), 0);
    assert_eq!(std::fs::read(directory.join("out/log.csv")).unwrap(), first);
    std::fs::write(directory.join("quick.toml"), quick.replace("mass = 0.460", "mass = -0.460")).unwrap();
    assert_eq!(status(&host_sim(&directory, &["fly", "quick.toml", "--out", "out"])), 2);
    assert_eq!(std::fs::read(directory.join("out/log.csv")).unwrap(), first);
}

/// A law process and both its ends.
struct Law {
    child: std::process::Child,
    answers: std::io::Lines<BufReader<std::process::ChildStdout>>,
}

impl Law {
    fn start() -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_host-sim"))
            .arg("law")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let answers = BufReader::new(child.stdout.take().unwrap()).lines();
        Self { child, answers }
    }

    /// Writes one line and waits for its answer: hangs if the answer is not flushed.
    fn ask(&mut self, line: &str) -> String {
        writeln!(self.child.stdin.as_mut().unwrap(), "{line}").unwrap();
        self.answers.next().unwrap().unwrap()
    }

    fn end(mut self) -> i32 {
        drop(self.child.stdin.take());
        assert!(self.answers.next().is_none());
        self.child.wait().unwrap().code().unwrap()
    }
}

/// A line at `tick`, upside down beside a hover at the origin, `q` as x y z w.
fn line(tick: u32, q: &str) -> String {
    let zeros = "0 ".repeat(18);
    format!("{} 0.01 1.0 -2.0 3.0 0 0 0 {q} 0.1 0.2 0.3 {zeros}", f64::from(tick) * 0.01)
}

#[test]
fn the_law_answers_line_by_line_and_an_unusable_line_changes_nothing() {
    let (mut plain, mut disturbed) = (Law::start(), Law::start());
    let mut answers = Vec::new();
    for tick in 0..20 {
        let good = line(tick, "1 0 0 0");
        let answer = plain.ask(&good);
        for bad in
            ["", "1 2 3", &good.replace("3.0", "nan"), &good.replace("0.01 1.0", "0 1.0"), &line(tick, "2 0 0 0")]
        {
            let refusal = disturbed.ask(bad);
            assert!(refusal.starts_with("error: "), "{bad}: {refusal}");
        }
        assert_eq!(disturbed.ask(&good), answer);
        let numbers: Vec<f32> = answer.split(' ').map(|word| word.parse().unwrap()).collect();
        assert_eq!(numbers.len(), 4);
        answers.push(numbers);
    }
    // The filters start at zero and move: hover thrust first, another one later.
    assert!((answers[0][0] - 0.46 * 9.81).abs() < 1e-5);
    assert!((answers[19][0] - answers[0][0]).abs() > 0.01);
    assert_eq!((plain.end(), disturbed.end()), (0, 0));
}

#[test]
fn the_law_does_not_mind_the_quaternions_sign() {
    let (mut one, mut other) = (Law::start(), Law::start());
    for tick in 0..5 {
        assert_eq!(one.ask(&line(tick, "0.6 0 0 0.8")), other.ask(&line(tick, "-0.6 0 0 -0.8")));
    }
    assert_eq!((one.end(), other.end()), (0, 0));
}
