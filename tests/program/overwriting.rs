//! What was in a directory before: commands write over their own files, remove those of theirs that no longer hold, and
//! touch nothing else.

use crate::support::binary;
use crate::support::binary::{brief, files, host_sim, status, stderr, stdout, with};
use host_sim::output::whole_file::WholeFile;
use host_sim::rivals::gains::BUILT_IN;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

const HUMMINGBIRD: &str = include_str!("../../vehicles/hummingbird.toml");
/// Not thrown at all: near where it is to be, at rest, level.
const GENTLE_CAMPAIGN: &str = "[campaign]\nduration = 2\nreference = \"hover\"\nattitude = \"file\"\noffset = 0.1\nvelocity = 0\nrate = 0\nyaw_rate = 0\nwind = 0\n";

/// A directory of this suite, with a gentle campaign of the Hummingbird in it.
fn directory(test: &str) -> PathBuf {
    let directory = binary::directory("cli_overwriting", test);
    let brief = with(HUMMINGBIRD, "duration =", "duration = 2.0");
    fs::write(directory.join("h.toml"), format!("{brief}\n{GENTLE_CAMPAIGN}")).unwrap();
    directory
}

fn write(directory: &Path, name: &str, text: &str) {
    let path = directory.join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, text).unwrap();
}

#[test]
fn a_campaign_and_a_merge_take_no_directory_that_holds_other_files_by_their_names() {
    let directory = directory("taken");
    assert_eq!(status(&host_sim(&directory, &["campaign", "h.toml", "--flights", "2", "--out", "whole"])), 0);
    let campaign = ["campaign", "h.toml", "--flights", "2", "--out", "project"];
    let merge = ["merge", "whole", "--out", "project"];
    for name in ["parts/drawing.step", "scenario.toml", "campaign.arrow", "summary.txt", "report.html"] {
        write(&directory, &format!("project/{name}"), "precious");
        for arguments in [&campaign[..], &merge] {
            let refused = host_sim(&directory, arguments);
            let message = stderr(&refused);
            assert_eq!((status(&refused), message.lines().count()), (2, 1), "{name}: {message}");
            let first = name.split('/').next().unwrap();
            for words in ["project: ", first, "no campaign.json", "another --out"] {
                assert!(message.contains(words), "{words}: {message}");
            }
            assert_eq!(fs::read_to_string(directory.join("project").join(name)).unwrap(), "precious");
            assert_eq!(files(&directory.join("project")), [first]);
        }
        fs::remove_dir_all(directory.join("project")).unwrap();
    }
    // Its own input.
    fs::create_dir(directory.join("project")).unwrap();
    fs::copy(directory.join("h.toml"), directory.join("project/scenario.toml")).unwrap();
    let refused = host_sim(&directory.join("project"), &["campaign", "scenario.toml", "--flights", "2", "--out", "."]);
    assert_eq!(status(&refused), 2, "{}", stderr(&refused));
}

#[test]
fn a_campaign_begins_beside_other_files_and_after_an_end_before_its_manifest_was_written() {
    let directory = directory("beside");
    write(&directory, "project/notes.txt", "mine");
    write(&directory, "project/.campaign.json.77.part", "{");
    let campaign = ["campaign", "h.toml", "--flights", "2", "--out", "project"];
    let flown = host_sim(&directory, &campaign);
    assert_eq!(status(&flown), 0, "{}", stderr(&flown));
    // Other files in a campaign's directory stay as well.
    for name in ["drawing.step", "000000.arrow", "000007.arrow"] {
        write(&directory, &format!("project/parts/{name}"), "mine");
    }
    let again = host_sim(&directory, &campaign);
    assert_eq!(status(&again), 0, "{}", stderr(&again));
    assert_eq!(files(&directory.join("project/parts")), ["000007.arrow", "drawing.step"]);
    assert_eq!(fs::read_to_string(directory.join("project/notes.txt")).unwrap(), "mine");
}

#[test]
fn a_flight_or_a_comparison_does_not_write_over_the_report_of_a_campaign() {
    let directory = directory("report");
    write(&directory, "brief.toml", &brief());
    assert_eq!(status(&host_sim(&directory, &["campaign", "h.toml", "--flights", "4", "--out", "out"])), 0);
    let (names, report) = (files(&directory.join("out")), fs::read(directory.join("out/report.html")).unwrap());
    for arguments in [
        &["campaign", "h.toml", "--flights", "4", "--replay", "3", "--out", "out"][..],
        &["fly", "brief.toml", "--out", "out"],
        &["compare", "h.toml", "--flights", "1", "--out", "out"],
    ] {
        let refused = host_sim(&directory, arguments);
        let message = stderr(&refused);
        assert_eq!((status(&refused), message.lines().count()), (2, 1), "{arguments:?}: {message}");
        assert!(message.contains("out: holds a campaign") && message.contains("another --out"), "{message}");
        assert_eq!(files(&directory.join("out")), names);
        assert_eq!(fs::read(directory.join("out/report.html")).unwrap(), report);
    }
}

#[test]
fn a_flight_without_a_recording_leaves_no_recording_of_another() {
    let directory = directory("recording");
    write(&directory, "brief.toml", &brief());
    write(&directory, "out/other.mcap", "mine");
    assert_eq!(status(&host_sim(&directory, &["fly", "brief.toml", "--mcap", "--out", "out"])), 0);
    assert!(directory.join("out/flight.mcap").exists());
    assert_eq!(status(&host_sim(&directory, &["fly", "brief.toml", "--out", "out"])), 0);
    assert!(!directory.join("out/flight.mcap").exists() && directory.join("out/other.mcap").exists());
}

#[test]
fn a_comparison_does_not_stand_beside_gains_that_did_not_fly() {
    let directory = directory("gains");
    // Found by an earlier comparison, perhaps in hours: not to be thrown away either.
    write(&directory, "out/rivals.toml", BUILT_IN);
    let plain = ["compare", "h.toml", "--flights", "1", "--out", "out"];
    let refused = host_sim(&directory, &plain);
    let message = stderr(&refused);
    assert_eq!((status(&refused), message.lines().count()), (2, 1), "{message}");
    for words in ["out/rivals.toml: ", "--gains out/rivals.toml", "another --out"] {
        assert!(message.contains(words), "{words}: {message}");
    }
    assert_eq!(files(&directory.join("out")), ["rivals.toml"]);
    let flown = host_sim(&directory, &[&plain[..], &["--gains", "out/rivals.toml"]].concat());
    assert_eq!(status(&flown), 0, "{}{}", stdout(&flown), stderr(&flown));
}

#[test]
fn gains_that_were_found_for_a_name_with_a_dot_are_read_again() {
    let directory = directory("dotted");
    let dotted = with(&fs::read_to_string(directory.join("h.toml")).unwrap(), "name =", "name = \"hummingbird.v2\"");
    fs::write(directory.join("dotted.toml"), dotted).unwrap();
    let search = ["compare", "dotted.toml", "--tune", "1", "--population", "4", "--flights", "1", "--out", "out"];
    let found = host_sim(&directory, &search);
    assert!(directory.join("out/rivals.toml").exists(), "{}", stderr(&found));
    let read = ["campaign", "dotted.toml", "--law", "lee", "--gains", "out/rivals.toml", "--flights", "1"];
    let flown = host_sim(&directory, &read);
    assert!(status(&flown) < 2, "{}", stderr(&flown));
}

#[test]
fn two_runs_at_a_time_do_not_write_one_file() {
    let directory = directory("shared-file");
    // As another run holds it, for as long as it lives: a number of a process that is not this one's.
    let other = WholeFile::alone(&directory.join("out.file")).unwrap();
    let commands = [
        &["tune", "h.toml", "--out", "out.file"][..],
        &["identify", "log.csv", "--scenario", "h.toml", "--out", "out.file"],
        &["hil", "h.toml", "--listen", "127.0.0.1:0", "--log", "out.file"],
        &["sitl", "--mcap", "out.file"],
        &["sitl", "--parameters", "out.file"],
    ];
    for command in commands {
        let refused = host_sim(&directory, command);
        let message = stderr(&refused);
        assert_eq!((status(&refused), message.lines().count()), (2, 1), "{command:?}: {message}");
        let words = "out.file: cannot be written: another run writes it; wait for its end";
        assert!(message.contains(words), "{command:?}: {message}");
    }
    assert!(!directory.join("out.file").exists());
    drop(other);
    assert_eq!(files(&directory), ["h.toml"]);
}

#[test]
fn a_comparison_keeps_its_directory_from_its_beginning() {
    let directory = directory("shared-comparison");
    fs::create_dir(directory.join("out")).unwrap();
    let other = fs::File::open(directory.join("out")).unwrap();
    other.try_lock().unwrap();
    let started = Instant::now();
    // 100,000 flights would take minutes.
    let refused = host_sim(&directory, &["compare", "h.toml", "--flights", "100000", "--out", "out"]);
    let message = stderr(&refused);
    assert_eq!((status(&refused), message.lines().count()), (2, 1), "{message}");
    assert!(message.contains("out: cannot be written: another run writes into it"), "{message}");
    assert!(started.elapsed() < Duration::from_secs(60));
}
