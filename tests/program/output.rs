//! What cannot be written, what is interrupted, and what would fill the disk. `/dev/full` is a disk that is always
//! full.

use crate::support::binary;
use crate::support::binary::{PAPER, brief, files, host_sim, search, status, stderr, stdout, with};
use std::fs::File;
use std::io::Write;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

const STUDY: &str = include_str!("../../vehicles/study.toml");
const FULL_DEVICE: &str = "/dev/full";

/// A directory of this suite.
fn directory(test: &str) -> PathBuf {
    binary::directory("cli_output", test)
}

fn full() -> File {
    File::options()
        .write(true)
        .open(FULL_DEVICE)
        .unwrap_or_else(|error| panic!("this test needs {FULL_DEVICE}: {error}"))
}

fn command(directory: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_host-sim"));
    command.args(arguments).current_dir(directory).stdin(Stdio::null());
    command
}

/// With nowhere left to write on standard output.
fn into_full(directory: &Path, arguments: &[&str]) -> Output {
    command(directory, arguments).stdout(full()).stderr(Stdio::piped()).output().unwrap()
}

fn assert_not_written(output: &Output, words: &str) {
    let message = stderr(output);
    assert_eq!((status(output), message.lines().count()), (2, 1), "{message}");
    assert!(message.contains(words) && message.contains("cannot be written: No space left on device"), "{message}");
}

/// The commands, as the program's help lists them, but for `help` itself.
fn commands(directory: &Path) -> Vec<String> {
    let help = stdout(&host_sim(directory, &["--help"]));
    let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    // What goes on in a second line is indented by more.
    let named = listed.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let names = named.map(|line| line.split_whitespace().next().unwrap().to_owned());
    names.filter(|name| name != "help").collect()
}

#[test]
fn help_fits_eighty_columns() {
    let directory = directory("help");
    let commands = commands(&directory);
    assert!(commands.len() > 15 && commands.contains(&"sitl".to_owned()), "{commands:?}");
    for arguments in commands.iter().map(|command| vec![command, "--help"]).chain([vec!["--help"]]) {
        let help = stdout(&host_sim(&directory, &arguments));
        let long: Vec<&str> = help.lines().filter(|line| line.chars().count() > 80).collect();
        assert!(!help.is_empty() && long.is_empty(), "{arguments:?}: {long:#?}");
    }
}

#[test]
fn completions_and_manual_pages_know_every_command() {
    let directory = directory("manual");
    let mut pages: Vec<String> = commands(&directory).iter().map(|name| format!("host-sim-{name}.1")).collect();
    for shell in ["bash", "zsh", "fish"] {
        let output = host_sim(&directory, &["completions", shell]);
        assert!(status(&output) == 0 && stdout(&output).contains("rotor-loss"), "{shell}");
    }
    assert_eq!(status(&host_sim(&directory, &["man", "--out", "man"])), 0);
    pages.push("host-sim.1".to_owned());
    pages.sort();
    assert_eq!(files(&directory.join("man")), pages);
    let page = std::fs::read_to_string(directory.join("man/host-sim-sitl.1")).unwrap();
    assert!(page.starts_with(".ie") && page.contains("truth\\-port") && page.contains("battery=9.8@30"), "{page}");
    let refused = host_sim(&directory, &["man", "--out", "man/host-sim.1"]);
    assert_eq!((status(&refused), stderr(&refused).lines().count()), (2, 1));
    assert_not_written(&into_full(&directory, &["completions", "bash"]), "standard output");
}

#[test]
fn what_a_pipe_receives_fits_a_hundred_columns() {
    let directory = directory("columns");
    let mut printed = Vec::new();
    for (name, text) in [
        ("extended.toml", include_str!("../../vehicles/hummingbird.toml")),
        ("paper.toml", include_str!("../../vehicles/hummingbird-paper-law.toml")),
    ] {
        std::fs::write(directory.join(name), text).unwrap();
        printed.push(stdout(&host_sim(&directory, &["certify", name])));
    }
    for text in printed {
        let long = text.lines().find(|line| line.chars().count() > 100);
        assert!(!text.is_empty() && long.is_none(), "{long:?}");
    }
}

#[test]
fn a_report_that_standard_output_does_not_take_exits_with_2() {
    let directory = directory("stdout");
    std::fs::write(directory.join("brief.toml"), brief()).unwrap();
    for arguments in [
        &["certify"][..],
        &["fly", "brief.toml", "--out", "out"],
        &search("brief.toml", "tuned.toml", "1"),
        &["--help"],
        &["fly", "--help"],
        &["--version"],
    ] {
        assert_not_written(&into_full(&directory, arguments), "standard output");
    }
    // What was flown and found is there nevertheless, whole.
    assert_eq!(files(&directory.join("out")).len(), 7);
    assert!(directory.join("tuned.toml").exists());
}

#[test]
fn a_session_without_a_speed_or_with_two_equal_ports_is_refused_by_name() {
    let directory = directory("hil-arguments");
    std::fs::write(directory.join("study.toml"), STUDY).unwrap();
    for (wrong, named) in [
        (&["--speed", "0"][..], "--speed: must be from 0.1 to 100, found 0"),
        (
            &["--ground", "127.0.0.1:1", "--ground-port", "14540"],
            "--offboard-port, --ground-port, --local-port: must be three",
        ),
    ] {
        let arguments = [&["hil", "study.toml", "--connect", "127.0.0.1:1"], wrong].concat();
        let output = command(&directory, &arguments).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && said.contains(named), "{:?}: {said}", output.status);
    }
}

#[test]
fn an_answer_that_standard_output_does_not_take_exits_with_2() {
    let directory = directory("law");
    let mut child =
        command(&directory, &["law"]).stdin(Stdio::piped()).stdout(full()).stderr(Stdio::piped()).spawn().unwrap();
    writeln!(child.stdin.take().unwrap(), "0 0.01 0 0 0 0 0 0 0 0 0 1 {}", "0 ".repeat(21)).unwrap();
    assert_not_written(&child.wait_with_output().unwrap(), "standard output");
}

#[test]
fn an_error_that_standard_error_does_not_take_keeps_its_status() {
    let directory = directory("stderr");
    let code = |arguments: &[&str]| command(&directory, arguments).stderr(full()).status().unwrap().code();
    assert_eq!(code(&["fly", "nosuch.toml"]), Some(2));
    let log = "t,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz,pdx,pdy,pdz,thrust,tau_x,tau_y,tau_z\n\
               0,0,0,0,1,0,0,0,0,0,0,0,0,0,5,0,0,0\n0.01,0,0,0,1,0,0,0,0,0,0,0,0,0,5,0,0,0\n";
    std::fs::write(directory.join("log.csv"), log).unwrap();
    assert_eq!(code(&["identify", "log.csv"]), Some(1));
}

#[test]
fn a_name_that_a_directory_has_is_refused_before_anything_is_flown_or_replaced() {
    let directory = directory("directories");
    std::fs::write(directory.join("study.toml"), STUDY).unwrap();
    std::fs::write(directory.join("brief.toml"), brief()).unwrap();
    let long = with(PAPER, "duration", "duration = 10000");
    std::fs::write(directory.join("long.toml"), long).unwrap();
    std::fs::create_dir_all(directory.join("out/report.html")).unwrap();
    std::fs::write(directory.join("out/log.csv"), "kept").unwrap();
    for arguments in [
        &["fly", "brief.toml", "--out", "out"][..],
        // A flight of minutes, which is not flown.
        &["fly", "long.toml", "--out", "out"],
        &["sitl", "study.toml", "--duration", "1", "--mcap", "out"],
        &["hil", "study.toml", "--connect", "127.0.0.1:1", "--log", "out"],
    ] {
        let output = host_sim(&directory, arguments);
        let message = stderr(&output);
        assert_eq!((status(&output), message.lines().count(), stdout(&output)), (2, 1, String::new()), "{message}");
        assert!(message.contains("out") && message.contains("cannot be written: is a directory"), "{message}");
    }
    assert_eq!(std::fs::read_to_string(directory.join("out/log.csv")).unwrap(), "kept");
    assert_eq!(files(&directory.join("out")), ["log.csv", "report.html"]);
    let output = host_sim(&directory, &["sitl", "study.toml", "--duration", "1", "--parameters", "none/mine.bin"]);
    assert_eq!((status(&output), stdout(&output)), (2, String::new()));
    assert!(
        stderr(&output).starts_with("error: --parameters none/mine.bin: cannot be written: "),
        "{}",
        stderr(&output)
    );
}

#[test]
fn a_sessions_summary_that_standard_output_does_not_take_exits_with_2() {
    let directory = directory("hil");
    std::fs::write(directory.join("study.toml"), STUDY).unwrap();
    let board = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = board.local_addr().unwrap().to_string();
    let leaves = std::thread::spawn(move || drop(board.accept().unwrap()));
    assert_not_written(&into_full(&directory, &["hil", "study.toml", "--connect", &address]), "standard output");
    leaves.join().unwrap();
}

#[test]
fn files_that_a_full_disk_does_not_take_exit_with_2_and_leave_nothing_half_written() {
    let directory = directory("files");
    std::fs::write(directory.join("brief.toml"), brief()).unwrap();
    drop(full());
    std::fs::create_dir(directory.join("out")).unwrap();
    for name in ["log.csv", "fig1.svg", "report.md", "report.html"] {
        let place = directory.join("out").join(name);
        std::os::unix::fs::symlink(FULL_DEVICE, &place).unwrap();
        let output = host_sim(&directory, &["fly", "brief.toml", "--out", "out"]);
        assert_not_written(&output, &format!("out/{name}"));
        assert_eq!((stdout(&output), files(&directory.join("out"))), (String::new(), vec![name.to_owned()]));
        std::fs::remove_file(place).unwrap();
    }
    std::os::unix::fs::symlink(FULL_DEVICE, directory.join("tuned.toml")).unwrap();
    let tuned = host_sim(&directory, &search("brief.toml", "tuned.toml", "1"));
    assert_not_written(&tuned, "tuned.toml");
    assert_eq!(files(&directory), ["brief.toml", "out", "tuned.toml"]);
}

#[test]
fn a_disk_that_fills_up_in_flight_exits_with_2_and_keeps_the_last_flight() {
    let directory = directory("filling");
    std::fs::write(directory.join("brief.toml"), brief()).unwrap();
    assert_eq!(status(&host_sim(&directory, &["fly", "brief.toml", "--out", "out"])), 0);
    let read = |name: &str| std::fs::read(directory.join("out").join(name)).unwrap();
    let before: Vec<_> = files(&directory.join("out")).iter().map(|name| read(name)).collect();
    // A hundred rows are some seventy blocks of a kilobyte; a file may grow to thirty.
    let limited = "trap '' XFSZ; ulimit -f 30; exec \"$@\"";
    let output = Command::new("sh")
        .args(["-c", limited, "sh", env!("CARGO_BIN_EXE_host-sim"), "fly", "brief.toml", "--out", "out"])
        .current_dir(&directory)
        .output()
        .unwrap();
    let message = stderr(&output);
    assert_eq!((status(&output), message.lines().count()), (2, 1), "{message}");
    assert!(message.contains("out/log.csv: cannot be written: File too large"), "{message}");
    let after: Vec<_> = files(&directory.join("out")).iter().map(|name| read(name)).collect();
    assert!(before == after, "{:?}", files(&directory.join("out")));
}

#[test]
fn a_reader_that_goes_away_changes_no_verdict() {
    let directory = directory("pipe");
    std::fs::write(directory.join("brief.toml"), brief()).unwrap();
    for arguments in [&["certify"][..], &["fly", "brief.toml", "--out", "out"], &["--help"]] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = command(&directory, arguments).stdout(writer).stderr(Stdio::piped()).output().unwrap();
        assert_eq!((status(&output), stderr(&output)), (0, String::new()), "{arguments:?}");
    }
}

#[test]
fn a_log_beyond_a_gigabyte_says_so_before_the_flight_and_needs_large_log() {
    let directory = directory("large");
    std::fs::write(directory.join("month.toml"), with(PAPER, "duration", "duration = 2592000")).unwrap();
    let output = host_sim(&directory, &["fly", "month.toml", "--out", "out"]);
    let message = stderr(&output);
    assert_eq!((status(&output), message.lines().count()), (2, 1), "{message}");
    for words in ["month.toml", "log.csv", "GB", "259200000 rows", "--large-log", "duration", "control.rate"] {
        assert!(message.contains(words), "{words}: {message}");
    }
    assert_eq!(files(&directory), ["month.toml"]);
    // With --large-log it is flown, with the same message.
    let mut child = spawn(&directory, &["fly", "month.toml", "--out", "out", "--large-log"]);
    wait_for(|| directory.join("out").exists() && !files(&directory.join("out")).is_empty());
    interrupt(&mut child, "TERM");
    let output = child.wait_with_output().unwrap();
    assert!(stderr(&output).lines().next().is_some_and(|line| line.contains("GB")), "{}", stderr(&output));
}

fn spawn(directory: &Path, arguments: &[&str]) -> Child {
    command(directory, arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

fn wait_for(condition: impl Fn() -> bool) {
    let started = Instant::now();
    while !condition() {
        assert!(started.elapsed() < Duration::from_secs(60), "waited in vain");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Sends a signal by its name.
fn interrupt(child: &mut Child, signal: &str) {
    let sent = Command::new("sh").args(["-c", &format!("kill -{signal} {}", child.id())]).status().unwrap();
    assert!(sent.success());
}

#[test]
fn an_interrupted_flight_leaves_no_file() {
    let directory = directory("interrupted");
    std::fs::write(directory.join("long.toml"), with(PAPER, "duration", "duration = 10000")).unwrap();
    for (signal, code) in [("INT", 130), ("TERM", 143), ("HUP", 129)] {
        let mut child = spawn(&directory, &["fly", "long.toml", "--out", "out"]);
        wait_for(|| directory.join("out").exists() && !files(&directory.join("out")).is_empty());
        interrupt(&mut child, signal);
        let output = child.wait_with_output().unwrap();
        let message = stderr(&output);
        assert_eq!((status(&output), message.lines().count()), (code, 1), "{message}");
        assert!(message.contains("interrupted") && message.contains("nothing is written"), "{message}");
        assert_eq!((stdout(&output), files(&directory)), (String::new(), vec!["long.toml".to_owned()]));
    }
}

#[test]
fn a_terminal_that_closes_ends_no_flight_that_nohup_keeps() {
    let directory = directory("nohup");
    std::fs::write(directory.join("long.toml"), with(PAPER, "duration", "duration = 10000")).unwrap();
    // `exec`: the number is that of the flight.
    let kept = "trap '' HUP; exec \"$@\"";
    let mut child = Command::new("sh")
        .args(["-c", kept, "sh", env!("CARGO_BIN_EXE_host-sim"), "fly", "long.toml", "--out", "out"])
        .current_dir(&directory)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    wait_for(|| directory.join("out").exists() && !files(&directory.join("out")).is_empty());
    interrupt(&mut child, "HUP");
    std::thread::sleep(Duration::from_millis(300));
    assert!(child.try_wait().unwrap().is_none());
    interrupt(&mut child, "TERM");
    assert_eq!(status(&child.wait_with_output().unwrap()), 143);
}

#[test]
fn an_interrupted_search_writes_the_best_it_has_and_says_so() {
    let directory = directory("search");
    std::fs::write(directory.join("start.toml"), PAPER).unwrap();
    // How long the first accepted candidate takes depends on the machine.
    for patience in [1, 4, 16, 64] {
        let mut child = spawn(&directory, &search("start.toml", "best.toml", "100000"));
        std::thread::sleep(Duration::from_secs(patience));
        interrupt(&mut child, "INT");
        let output = child.wait_with_output().unwrap();
        assert_eq!(status(&output), 130, "{}", stderr(&output));
        if directory.join("best.toml").exists() {
            let text = stdout(&output);
            assert!(text.contains("best: CERTIFIED") && text.contains("interrupted: the best so far"), "{text}");
            assert_eq!(files(&directory), ["best.toml", "start.toml"]);
            assert_eq!(status(&host_sim(&directory, &["certify", "best.toml"])), 0);
            return;
        }
        assert_eq!((stdout(&output), files(&directory)), (String::new(), vec!["start.toml".to_owned()]));
        assert!(stderr(&output).contains("interrupted") && stderr(&output).contains("nothing is written"));
    }
    panic!("nothing acceptable within a minute");
}

#[test]
fn an_interrupted_session_ends_as_if_its_time_were_over() {
    let directory = directory("session");
    std::fs::write(directory.join("study.toml"), STUDY).unwrap();
    let board = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = board.local_addr().unwrap().to_string();
    let mut child = spawn(&directory, &["hil", "study.toml", "--connect", &address, "--log", "log.csv"]);
    let connection = board.accept().unwrap();
    wait_for(|| files(&directory).len() == 2);
    interrupt(&mut child, "INT");
    let output = child.wait_with_output().unwrap();
    assert!(status(&output) == 130 && stdout(&output).contains("interrupted"), "{}", stderr(&output));
    assert_eq!(files(&directory), ["log.csv", "study.toml"]);
    drop(connection);
}
