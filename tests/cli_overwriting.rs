//! What was in a directory before: commands write over their own files, remove those of theirs that no longer hold, and touch nothing else.

use crate::support::binary;
use crate::support::binary::{files, host_sim, status, stderr, with};
use std::fs;
use std::path::{Path, PathBuf};

const HUMMINGBIRD: &str = include_str!("../vehicles/hummingbird.toml");
/// Not thrown at all: near where it is to be, at rest, level.
const GENTLE: &str = "[campaign]\nduration = 2\nreference = \"hover\"\nattitude = \"file\"\noffset = 0.1\nvelocity = 0\nrate = 0\nyaw_rate = 0\nwind = 0\n";

/// A directory of this suite, with a gentle campaign of the Hummingbird in it.
fn directory(test: &str) -> PathBuf {
    let directory = binary::directory("cli_overwriting", test);
    let brief = with(HUMMINGBIRD, "duration =", "duration = 2.0");
    fs::write(directory.join("h.toml"), format!("{brief}\n{GENTLE}")).unwrap();
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
    // What somebody puts into a directory that is the campaign's stays as well.
    for name in ["drawing.step", "000000.arrow", "000007.arrow"] {
        write(&directory, &format!("project/parts/{name}"), "mine");
    }
    let again = host_sim(&directory, &campaign);
    assert_eq!(status(&again), 0, "{}", stderr(&again));
    assert_eq!(files(&directory.join("project/parts")), ["000007.arrow", "drawing.step"]);
    assert_eq!(fs::read_to_string(directory.join("project/notes.txt")).unwrap(), "mine");
}
