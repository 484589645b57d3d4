//! `certify` and `tune` as a user meets them: exit statuses, one clear line for each refusal, no file half-written.

use crate::support::binary;
use crate::support::binary::{PAPER, files, host_sim, search, status, stderr, stdout, with};
use scenario::Scenario;
use std::path::PathBuf;
use std::time::{Duration, Instant};

const STUDY: &str = include_str!("../../vehicles/study-paper-law.toml");

/// A directory of this suite.
fn directory(test: &str) -> PathBuf {
    binary::directory("cli_certify", test)
}

#[test]
fn certify_exits_with_0_for_the_paper_and_says_why() {
    let directory = directory("paper");
    let output = host_sim(&directory, &["certify"]);
    assert_eq!((status(&output), stderr(&output)), (0, String::new()));
    let text = stdout(&output);
    for words in
        ["paper: CERTIFIED", "as printed: fails in T2 yaw torque", "sharp: every inequality holds", "published"]
    {
        assert!(text.contains(words), "{words}: {text}");
    }
    assert!(files(&directory).is_empty());
}

#[test]
fn certify_exits_with_1_where_an_inequality_fails() {
    let directory = directory("refused");
    std::fs::write(directory.join("weak.toml"), with(PAPER, "thrust_max", "thrust_max = 5.0")).unwrap();
    let output = host_sim(&directory, &["certify", "weak.toml"]);
    assert_eq!(status(&output), 1);
    assert!(stdout(&output).contains("NOT certified") && stdout(&output).contains("T1 greatest thrust"));
    assert_eq!(stderr(&output), "");
}

#[test]
fn bad_input_exits_with_2_and_one_line_that_names_field_and_reason() {
    let directory = directory("bad");
    let cases: &[(&str, &str, &[&str])] = &[
        ("inertia", "inertia = [2.24e-3, 0.0, 5.3e-3]", &["vehicle.inertia[1]", "greater than zero"]),
        ("inertia", "inertia = [2.24e-3, -2.9e-3, 5.3e-3]", &["vehicle.inertia[1]", "greater than zero"]),
        ("inertia", "inertia = [2.24e-3, 2.9e-3, 9.0e-3]", &["vehicle.inertia", "triangle inequality"]),
        ("thrust_max", "thrust_max = 4.0", &["limits.thrust_max", "above 4.51", "found 4"]),
        ("torque_max", "torque_max = [0.5, 0.5, 0.0]", &["limits.torque_max[2]", "greater than zero"]),
        ("speed", "speed = [100.0, 400.0]", &["rotors.speed", "cannot hover", "4.51"]),
        ("speed", "speed = [500.0, 800.0]", &["rotors.speed", "cannot hover"]),
        ("speed", "speed = [800.0, 100.0]", &["rotors.speed", "least < greatest"]),
        ("spin", "spin = [\"cw\", \"cw\", \"cw\", \"cw\"]", &["rotors", "cannot produce thrust and all three torques"]),
        ("spin", "spin = [\"cw\", \"ccw\", \"cw\"]", &["rotors.spin", "4 positions, found 3"]),
        ("m_p", "m_p = 9.7", &["gains.m_p", "below 9.63", "K_a3"]),
        ("thrust_floor", "thrust_floor = 4.5", &["control.thrust_floor", "found 4.5"]),
        ("delay", "delay = 0.0123456", &["sampling.delay", "whole number of plant steps"]),
        ("jerk", "jerk = 0.1", &["reference_bounds.jerk", "which [reference] takes"]),
        ("snap", "snop = 6.0", &["reference_bounds.snop", "\"snap\""]),
    ];
    for (line, replacement, words) in cases {
        std::fs::write(directory.join("bad.toml"), with(STUDY, line, replacement)).unwrap();
        for arguments in [["certify", "bad.toml"], ["tune", "bad.toml"], ["fly", "bad.toml"]] {
            let output = host_sim(&directory, &arguments);
            let message = stderr(&output);
            assert_eq!((status(&output), message.lines().count()), (2, 1), "{replacement}: {message}");
            assert_eq!(stdout(&output), "");
            for word in ["bad.toml"].iter().chain(*words) {
                assert!(message.contains(word), "{replacement}: {message:?} does not say {word:?}");
            }
        }
    }
    assert_eq!(files(&directory), ["bad.toml"]);
}

#[test]
fn certify_shows_the_constants_that_a_file_leaves_out() {
    let directory = directory("show");
    std::fs::write(directory.join("v.toml"), include_str!("../../scenarios/paper-extended.toml")).unwrap();
    let output = host_sim(&directory, &["certify", "v.toml", "--show"]);
    assert_eq!((status(&output), stderr(&output)), (0, String::new()));
    let shown = stdout(&output);
    for words in ["[gains]\n", "k_p_across = ", "[estimates]\n", "[reference_bounds]\n"] {
        assert!(shown.contains(words), "{words}: {shown}");
    }
    std::fs::write(
        directory.join("pasted.toml"),
        format!("{}\n{shown}", include_str!("../../scenarios/paper-extended.toml")),
    )
    .unwrap();
    let [own, pasted] = ["v.toml", "pasted.toml"].map(|file| stdout(&host_sim(&directory, &["certify", file])));
    assert_eq!(own, pasted);
}

#[test]
fn tune_writes_a_scenario_that_certifies_and_can_be_flown() {
    let directory = directory("tune");
    std::fs::write(directory.join("start.toml"), PAPER).unwrap();
    let output = host_sim(&directory, &[&search("start.toml", "mine.toml", "1")[..], &["--widen"]].concat());
    assert_eq!(status(&output), 0, "{}", stderr(&output));
    // On a busy machine it takes long enough to show progress.
    assert!(stderr(&output).lines().all(|line| line.starts_with("tuning: ")), "{}", stderr(&output));
    let text = stdout(&output);
    for words in ["upside down: height lost", "before", "mine: CERTIFIED", "times as demanding"] {
        assert!(text.contains(words), "{words}: {text}");
    }
    assert_eq!(files(&directory), ["mine.toml", "start.toml"]);
    assert_eq!(std::fs::read_to_string(directory.join("start.toml")).unwrap(), PAPER, "the input is not touched");
    let tuned = Scenario::load(&directory.join("mine.toml")).unwrap();
    assert_eq!(tuned.name, "mine");
    assert_eq!(status(&host_sim(&directory, &["certify", "mine.toml"])), 0);

    // The widest bounds are printed as the section they are: it can be pasted, and certifies.
    let (_, section) = text.split_once("[reference_bounds]").unwrap();
    let found = std::fs::read_to_string(directory.join("mine.toml")).unwrap();
    std::fs::write(directory.join("wide.toml"), format!("{found}\n[reference_bounds]{section}")).unwrap();
    assert_eq!(status(&host_sim(&directory, &["certify", "wide.toml"])), 0);
}

#[test]
fn a_search_that_finds_nothing_exits_with_1_and_writes_nothing() {
    let directory = directory("nothing");
    std::fs::write(directory.join("start.toml"), PAPER).unwrap();
    let output = host_sim(&directory, &["tune", "start.toml", "--margin", "0.97", "--generations", "1"]);
    assert_eq!((status(&output), stdout(&output)), (1, String::new()));
    let message = stderr(&output);
    let message = message.lines().filter(|line| !line.starts_with("tuning: ")).collect::<Vec<_>>().join("\n");
    assert!(message.lines().count() == 1 && message.contains("the closest fail in: certificate"), "{message}");
    assert_eq!(files(&directory), ["start.toml"]);
}

#[test]
fn an_output_that_cannot_be_written_is_refused_before_the_search() {
    let directory = directory("unwritable");
    std::fs::write(directory.join("start.toml"), PAPER).unwrap();
    std::fs::create_dir(directory.join("folder.toml")).unwrap();
    for (out, words) in [
        ("start.toml", "must be another file than the one tuned"),
        ("./start.toml", "must be another file than the one tuned"),
        ("nowhere/mine.toml", "nowhere/mine.toml: cannot be written"),
        ("folder.toml", "folder.toml: cannot be written"),
        ("my file.toml", "letters, digits"),
    ] {
        let started = Instant::now();
        // A search of this length would take hours.
        let output = host_sim(&directory, &["tune", "start.toml", "--generations", "100000", "--out", out]);
        assert!(started.elapsed() < Duration::from_secs(20), "{out}: refused only after a search");
        let message = stderr(&output);
        assert_eq!((status(&output), message.lines().count()), (2, 1), "{out}: {message}");
        assert!(message.contains(words), "{out}: {message}");
    }
    assert_eq!(files(&directory), ["folder.toml", "start.toml"]);
    assert_eq!(std::fs::read_to_string(directory.join("start.toml")).unwrap(), PAPER);
}

#[test]
fn a_search_reads_its_file_once_so_that_a_pipe_will_do() {
    let directory = directory("pipe");
    std::fs::write(directory.join("start.toml"), PAPER).unwrap();
    let search = |file: &str, out: &str| {
        let arguments = search(file, out, "1").join(" ");
        let line = format!("\"$0\" {arguments}");
        let mut command = std::process::Command::new("bash");
        command.args(["-c", &line, env!("CARGO_BIN_EXE_host-sim")]).current_dir(&directory).output().unwrap()
    };
    let (piped, plain) = (search("<(cat start.toml)", "piped.toml"), search("start.toml", "plain.toml"));
    assert_eq!((status(&piped), status(&plain)), (0, 0), "{}{}", stderr(&piped), stderr(&plain));
    let read = |name: &str| std::fs::read_to_string(directory.join(name)).unwrap();
    assert_eq!(read("piped.toml").replace("piped", "plain"), read("plain.toml"));
}

#[test]
fn unusable_requirements_exit_with_2_and_name_the_argument() {
    let directory = directory("arguments");
    std::fs::write(directory.join("start.toml"), PAPER).unwrap();
    for (name, value) in [
        ("--margin", "1"),
        ("--margin", "nan"),
        ("--gain-margin", "0.9"),
        ("--gain-margin", "inf"),
        ("--delay-margin", "0"),
        ("--position-error", "nan"),
        ("--mrp-error", "0"),
        ("--recovery", "0"),
        ("--recovery", "0.01"),
        ("--recovery", "1.9"),
        ("--recovery", "inf"),
        ("--generations", "0"),
        ("--population", "3"),
    ] {
        let output = host_sim(&directory, &["tune", "start.toml", name, value]);
        let message = stderr(&output);
        assert_eq!((status(&output), message.lines().count()), (2, 1), "{name} {value}: {message}");
        assert!(message.contains(name), "{message}");
    }
    assert_eq!(status(&host_sim(&directory, &["tune"])), 2);
    assert_eq!(status(&host_sim(&directory, &["tune", "nowhere.toml"])), 2);
    assert_eq!(files(&directory), ["start.toml"]);
}

#[test]
fn a_recovery_is_three_lines_and_a_status_of_1_because_no_height_is_proven() {
    let directory = directory("recovery");
    std::fs::write(directory.join("v.toml"), include_str!("../../vehicles/hummingbird.toml")).unwrap();
    let few =
        ["certify", "v.toml", "--recovery", "--flights=20", "--search=10", "--lag-error=0.02", "--inertia-error=0.01"];
    let output = host_sim(&directory, &few);
    let text = stdout(&output);
    for line in ["\nH ", "\nT ", "\nr "] {
        assert_eq!(text.matches(line).count(), 1, "{line:?}: {text}");
    }
    let reason = stderr(&output);
    assert!(status(&output) == 1 && reason.lines().count() == 1 && reason.contains("NOT proven"), "{reason}");
    let calm = host_sim(&directory, &[&few[..], &["--gust", "0", "--spin", "0"]].concat());
    assert!(status(&calm) == 1 && stdout(&calm) != text && stdout(&calm).contains("|omega| <= 0 rad/s"));
    std::fs::write(directory.join("paper.toml"), STUDY).unwrap();
    let refused = host_sim(&directory, &["certify", "paper.toml", "--recovery"]);
    assert_eq!((status(&refused), stdout(&refused)), (1, String::new()));
    assert!(stderr(&refused).starts_with("error: paper.toml: control.law: "), "{}", stderr(&refused));
    for arguments in [&["--recovery", "--flights", "0"][..], &["--recovery", "--gust=nan"], &["--gust", "1"]] {
        let output = host_sim(&directory, &[&["certify", "v.toml"], arguments].concat());
        assert_eq!((status(&output), stdout(&output)), (2, String::new()), "{arguments:?}");
        assert!(stderr(&output).contains("--"), "{}", stderr(&output));
    }
}
