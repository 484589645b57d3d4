//! `campaign` and `merge` as a user meets them: statuses, messages, what a flight flown again shows, and that neither a
//! signal nor a kill loses what was finished.

use crate::support::binary;
use crate::support::binary::{PAPER, files, host_sim, status, stderr, stdout, with};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const HUMMINGBIRD: &str = include_str!("../../vehicles/hummingbird.toml");
const COMPLETE_DIRECTORY: [&str; 5] =
    ["campaign.arrow", "campaign.json", "report.html", "scenario.toml", "summary.txt"];

/// A directory of this suite, with a campaign of the Hummingbird in it.
fn directory(test: &str, campaign: &str) -> PathBuf {
    let directory = binary::directory("cli_campaign", test);
    fs::write(directory.join("h.toml"), format!("{HUMMINGBIRD}\n[campaign]\n{campaign}")).unwrap();
    directory
}

/// Not thrown at all: near where it is to be, at rest, level.
const GENTLE_CAMPAIGN: &str = "duration = 2\nreference = \"hover\"\nattitude = \"file\"\noffset = 0.1\nvelocity = 0\nrate = 0\nyaw_rate = 0\nwind = 0\n";

#[test]
fn the_status_says_whether_every_flight_tracks_and_the_vehicle_is_certified() {
    let directory = directory("statuses", GENTLE_CAMPAIGN);
    let flown = host_sim(&directory, &["campaign", "h.toml", "--flights", "20", "--out", "out"]);
    let text = stdout(&flown);
    assert_eq!((status(&flown), stderr(&flown)), (0, String::new()), "{text}");
    assert!(text.starts_with("hummingbird: 20 flights of 2 s from seed 0, plant step 5 ms\n"), "{text}");
    assert!(text.contains("20 of 20 recover and track; 0 went beyond a certified bound; 0 commanded"), "{text}");
    assert!(text.contains("slowest: ") && !text.contains("failing: "), "{text}");
    assert_eq!(files(&directory.join("out")), COMPLETE_DIRECTORY);
    assert!(text.starts_with(&fs::read_to_string(directory.join("out/summary.txt")).unwrap()));

    // Thrown, and out of time.
    let thrown = host_sim(&directory, &["campaign", "h.toml", "--flights", "20", "--draws", "thrown.toml"]);
    assert_eq!(status(&thrown), 2, "{}", stdout(&thrown));
    fs::write(directory.join("plain.toml"), HUMMINGBIRD).unwrap();
    fs::write(directory.join("thrown.toml"), "[campaign]\nduration = 1.0\n").unwrap();
    let thrown = host_sim(&directory, &["campaign", "plain.toml", "--flights", "20", "--draws", "thrown.toml"]);
    let text = stdout(&thrown);
    assert!(status(&thrown) == 1 && text.contains("failing: 0 (away), 1 (away)"), "{text}{}", stderr(&thrown));
    assert_eq!(files(&directory.join("campaigns/hummingbird")), COMPLETE_DIRECTORY);

    let lagging = with(&fs::read_to_string(directory.join("h.toml")).unwrap(), "lag =", "lag = 1.0");
    fs::write(directory.join("lagging.toml"), lagging).unwrap();
    let flown = host_sim(&directory, &["campaign", "lagging.toml", "--flights", "2", "--out", "lagging"]);
    assert!(status(&flown) == 1 && stdout(&flown).contains("NOT certified: sampled loop"), "{}", stdout(&flown));
}

#[test]
fn a_flight_flown_again_is_the_flight_of_the_campaign() {
    let directory = directory("replay", "duration = 1.0\nseed = 4\n");
    assert_eq!(status(&host_sim(&directory, &["campaign", "h.toml", "--flights", "8", "--out", "out"])), 1);
    let flown = fs::File::open(directory.join("out/campaign.arrow")).unwrap();
    let rows = arrow_ipc::reader::FileReader::try_new(flown, None).unwrap().next().unwrap().unwrap();
    let again = host_sim(&directory, &["campaign", "h.toml", "--replay", "6"]);
    assert!(stdout(&again).starts_with("hummingbird-6: 1 s flown"), "{}", stdout(&again));
    let log = fs::read_to_string(directory.join("flights/hummingbird-6/log.csv")).unwrap();
    let names: Vec<&str> = log.lines().next().unwrap().split(',').collect();
    let column = |name: &str| {
        let place = names.iter().position(|found| *found == name).unwrap();
        log.lines().skip(1).map(|row| row.split(',').nth(place).unwrap().parse().unwrap()).collect::<Vec<f64>>()
    };
    let row = |name: &str| {
        use arrow_array::cast::AsArray;
        rows.column_by_name(name).unwrap().as_primitive::<arrow_array::types::Float64Type>().value(6)
    };
    for (name, logged) in [("start_px", "px"), ("start_qw", "qw"), ("start_wz", "wz"), ("wind_x", "wind_x")] {
        assert_eq!(row(name), column(logged)[0], "{name}");
    }
    // What was drawn stands above the file in its report.
    let report = fs::read_to_string(directory.join("flights/hummingbird-6/report.html")).unwrap();
    let start = format!("initial.position = [{:?}, ", row("start_px"));
    assert!(report.contains("# Flight 6 of the campaign with seed 4.") && report.contains(&start), "{start}");
    let heights = column("pz");
    let lowest = heights.iter().copied().fold(f64::INFINITY, f64::min);
    assert_eq!(row("height_lost"), (heights[0] - lowest).max(0.0));
    let error = ["x", "y", "z"].map(|axis| {
        let (is, wanted) = (column(&format!("p{axis}")), column(&format!("pd{axis}")));
        // The reference is logged in single precision.
        is[99] - f64::from(wanted[99] as f32)
    });
    assert!((row("final_error") - error.iter().map(|e| e * e).sum::<f64>().sqrt()).abs() < 1e-12);
}

#[test]
fn rotors_fail_in_as_many_flights_as_the_file_says_and_again_where_one_is_flown_again() {
    use arrow_array::cast::AsArray;
    use arrow_array::types::{Float64Type, UInt64Type};
    let gentle = GENTLE_CAMPAIGN.replace("duration = 2", "duration = 6");
    let directory = directory("failing", &format!("{gentle}rotor_failures = 0.5\nthrust_left = [0.0, 0.1]\n"));
    let flown = host_sim(&directory, &["campaign", "h.toml", "--flights", "20", "--out", "out"]);
    let file = fs::File::open(directory.join("out/campaign.arrow")).unwrap();
    let rows = arrow_ipc::reader::FileReader::try_new(file, None).unwrap().next().unwrap().unwrap();
    let rotors =
        |name: &str| rows.column_by_name(name).unwrap().as_primitive::<UInt64Type>().iter().collect::<Vec<_>>();
    let (failed, found) = (rotors("failed_rotor"), rotors("found_rotor"));
    let number = failed.iter().position(Option::is_some).unwrap();
    let count = failed.iter().flatten().count();
    assert!((4..17).contains(&count) && failed == found, "{failed:?} {found:?}");
    let text = stdout(&flown);
    let expected = [
        format!("a rotor failed in {count} flights, {count} of which end within 3 m"),
        format!("the law found it in {count}, another one or too early in 0, none in 0"),
        "false alarms, of rotors that had not failed: 0\n".to_owned(),
    ];
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ") + "\n";
    assert!(expected.iter().all(|line| text.contains(line.trim_end())), "{text}");

    let again = host_sim(&directory, &["campaign", "h.toml", "--replay", &number.to_string()]);
    let report = fs::read_to_string(directory.join(format!("flights/hummingbird-{number}/report.html"))).unwrap();
    let time = rows.column_by_name("failure_time").unwrap().as_primitive::<Float64Type>().value(number);
    let failure = format!("failure.rotor = {}, failure.time = {time:?} s", failed[number].unwrap());
    assert!(report.contains(&failure), "{failure}\n{}{}", stdout(&again), stderr(&again));
}

#[test]
fn a_flight_that_comes_late_recovers_neither_in_its_campaign_nor_flown_again() {
    use arrow_array::cast::AsArray;
    let directory = directory("late", "duration = 2.5\n");
    let flown = host_sim(&directory, &["campaign", "h.toml", "--flights", "200", "--out", "out"]);
    let file = fs::File::open(directory.join("out/campaign.arrow")).unwrap();
    let (mut number, mut in_time, mut late) = (0, 0, Vec::new());
    for rows in arrow_ipc::reader::FileReader::try_new(file, None).unwrap().map(Result::unwrap) {
        let column = |name: &str| rows.column_by_name(name).unwrap().as_primitive::<arrow_array::types::Float64Type>();
        let reached = ["settled", "attitude", "heading"].map(column);
        let verdicts = rows.column_by_name("verdict").unwrap().as_string::<i32>();
        for (row, verdict) in verdicts.iter().flatten().enumerate() {
            // The latest of the three.
            let times = reached.map(|column| column.iter().nth(row).flatten());
            let settled =
                times.into_iter().collect::<Option<Vec<f64>>>().map(|times| times.into_iter().fold(0.0, f64::max));
            let expected = match settled {
                Some(settled) if settled <= 0.9 * 2.5 => "holds",
                Some(_) => "late",
                None => "away",
            };
            assert_eq!(verdict, expected, "{number}");
            in_time += u64::from(verdict == "holds");
            late.extend((verdict == "late").then_some(number));
            number += 1;
        }
    }
    let text = stdout(&flown);
    assert!(text.contains(&format!("{in_time} of 200 recover and track;")) && late.len() > 5, "{late:?}\n{text}");
    assert!(text.contains("(late)"), "{text}");
    for number in &late[..3] {
        let again = host_sim(&directory, &["campaign", "h.toml", "--replay", &number.to_string()]);
        let text = stdout(&again);
        let row = text.lines().find(|line| line.starts_with("within 0.2 m of the reference for good")).unwrap();
        assert!(status(&again) == 1 && row.contains("<= 2.25 s") && row.ends_with("FAILS"), "{number}: {text}");
    }
}

#[cfg_attr(not(unix), expect(dead_code, reason = "for signals"))]
fn spawn(directory: &Path, out: &str) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_host-sim"));
    command.args(["campaign", "h.toml", "--out", out]).current_dir(directory);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Waits until more than so many chunks are finished.
#[cfg_attr(not(unix), expect(dead_code, reason = "for signals"))]
fn more_chunks(out: &Path, than: usize) -> Vec<String> {
    let started = Instant::now();
    loop {
        let parts = out.join("parts");
        let done: Vec<String> = if parts.exists() {
            files(&parts).into_iter().filter(|name| !name.starts_with('.')).collect()
        } else {
            Vec::new()
        };
        if done.len() > than {
            return done;
        }
        assert!(started.elapsed() < Duration::from_secs(60), "waited in vain");
        std::thread::sleep(Duration::from_millis(5));
    }
}

// Windows has no such signal.
#[cfg(unix)]
#[test]
fn neither_a_signal_nor_a_kill_loses_what_was_finished() {
    let directory = directory("interrupted", "duration = 4\nflights = 400\n");
    let (broken, whole) = (directory.join("broken"), directory.join("whole"));
    let mut killed = spawn(&directory, "broken");
    more_chunks(&broken, 0);
    killed.kill().unwrap();
    killed.wait().unwrap();
    let kept = more_chunks(&broken, 0);
    assert!(!broken.join("campaign.arrow").exists() && kept.len() < 6, "{kept:?}: it was over before it was killed");
    let times = |names: &[String]| {
        names
            .iter()
            .map(|name| broken.join("parts").join(name).metadata().unwrap().modified().unwrap())
            .collect::<Vec<_>>()
    };
    let before = times(&kept);

    let interrupted = spawn(&directory, "broken");
    // Before that it may not have come to listen for signals.
    more_chunks(&broken, kept.len());
    let sent = Command::new("sh").args(["-c", &format!("kill -INT {}", interrupted.id())]).status().unwrap();
    let output = interrupted.wait_with_output().unwrap();
    let message = stderr(&output);
    assert!(sent.success() && status(&output) == 130 && message.lines().count() == 1, "{message}");
    assert!(message.contains("interrupted by signal 2; what was finished is kept"), "{message}");
    assert_eq!(times(&kept), before, "what was finished was flown again");

    spawn(&directory, "broken").wait_with_output().unwrap();
    spawn(&directory, "whole").wait_with_output().unwrap();
    assert_eq!(files(&broken), COMPLETE_DIRECTORY);
    for name in COMPLETE_DIRECTORY {
        assert_eq!(fs::read(broken.join(name)).unwrap(), fs::read(whole.join(name)).unwrap(), "{name}");
    }
}

#[test]
fn what_cannot_be_flown_is_refused_in_one_line_and_leaves_nothing() {
    let directory = directory("refusals", "duration = 1e5\n");
    fs::write(directory.join("ground.toml"), format!("{PAPER}\n[ground]\nheight = 0\n")).unwrap();
    fs::write(directory.join("more.toml"), "[campaign]\nwind = 1\n[truth]\nmass = 1\n").unwrap();
    fs::write(directory.join("windy.toml"), "[campaign]\nwind = 1\n").unwrap();
    fs::write(directory.join("paper.toml"), PAPER).unwrap();
    for (arguments, expected) in [
        (&["h.toml", "--shard", "0/2"][..], "must be I/N with I from 1 to N"),
        (&["h.toml", "--shard", "3/2"], "must be I/N with I from 1 to N"),
        (&["h.toml", "--flights", "0"], "--flights: must be from 1 to 100000000, found 0"),
        (&["h.toml", "--plant-step", "0.003"], "--plant-step: must be the control period, 0.01 s, over a whole number"),
        (&["h.toml", "--plant-step", "nan"], "--plant-step: must be the control period"),
        (&["none.toml"], "none.toml: cannot be read: "),
        (&["ground.toml"], "ground.toml: ground: a campaign throws its vehicles into the air anywhere"),
        (
            &["ground.toml", "--replay", "3"],
            "ground.toml: ground: a campaign throws its vehicles into the air anywhere",
        ),
        (
            &["h.toml", "--replay", "3"],
            "10000000 rows: take a shorter campaign.duration, a lower control.rate, or allow it with --large-log",
        ),
        (
            &["h.toml", "--flights", "50", "--shard", "2/2"],
            "shard: 50 flights in chunks of 50 are 1 chunk, so there can be at most 1 shard, found 2",
        ),
        (
            &["h.toml", "--flights", "51", "--shard", "1/3"],
            "51 flights in chunks of 50 are 2 chunks, so there can be at most 2 shards, found 3",
        ),
        (&["paper.toml", "--draws", "more.toml"], "more.toml: must hold a [campaign] section and nothing else"),
        (&["h.toml", "--draws", "none.toml"], "none.toml: cannot be read: "),
        (&["h.toml", "--draws", "windy.toml"], "h.toml: campaign: must be left out where --draws has it"),
    ] {
        let output = host_sim(&directory, &[&["campaign"], arguments, &["--out", "out"]].concat());
        let message = stderr(&output);
        assert!(status(&output) == 2 && message.contains(expected), "{arguments:?}: {message}");
        assert!(!directory.join("out").exists(), "{arguments:?}");
    }
    let output = host_sim(&directory, &["merge", "none", "--out", "out"]);
    assert_eq!((status(&output), stderr(&output).lines().count()), (2, 1));
    assert!(stderr(&output).contains("none: holds no campaign: there is no campaign.json"), "{}", stderr(&output));
}
