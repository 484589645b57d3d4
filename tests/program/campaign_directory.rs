//! A campaign's directory as users find it: changed by hand, damaged, or in use by another program.

use crate::support::binary;
use crate::support::binary::{files, host_sim, status, stderr};
use std::fs;
use std::path::PathBuf;

const HUMMINGBIRD: &str = include_str!("../../vehicles/hummingbird.toml");

/// A directory of this suite, with a short campaign of the Hummingbird in it.
fn directory(test: &str) -> PathBuf {
    let directory = binary::directory("cli_campaign_directory", test);
    fs::write(directory.join("h.toml"), format!("{HUMMINGBIRD}\n[campaign]\nduration = 1.0\n")).unwrap();
    directory
}

#[test]
fn a_shard_whose_scenario_was_changed_after_it_was_flown_is_not_merged() {
    let directory = directory("changed");
    for (shard, out) in [("1/2", "one"), ("2/2", "two")] {
        host_sim(&directory, &["campaign", "h.toml", "--flights", "60", "--shard", shard, "--out", out]);
    }
    for out in ["one", "two"] {
        let path = directory.join(out).join("scenario.toml");
        let original = fs::read_to_string(&path).unwrap();
        fs::write(&path, original.replace("mass = 0.500", "mass = 0.600")).unwrap();
        let refused = host_sim(&directory, &["merge", "one", "two", "--out", "whole"]);
        let message = stderr(&refused);
        assert_eq!((status(&refused), message.lines().count()), (2, 1), "{message}");
        assert!(message.contains(&format!("{out}/scenario.toml: ")) && message.contains("was changed"), "{message}");
        assert!(!directory.join("whole").exists());
        fs::write(&path, original).unwrap();
    }
    let merged = host_sim(&directory, &["merge", "one", "two", "--out", "whole"]);
    assert_eq!((status(&merged), stderr(&merged)), (1, String::new()));
}

#[test]
fn a_damaged_result_is_refused_by_merge_and_flown_again_by_its_campaign() {
    let directory = directory("damaged");
    let campaign = ["campaign", "h.toml", "--flights", "20", "--out", "out"];
    host_sim(&directory, &campaign);
    let (result, manifest) = (directory.join("out/campaign.arrow"), directory.join("out/campaign.json"));
    let (whole, described) = (fs::read(&result).unwrap(), fs::read_to_string(&manifest).unwrap());
    // As it was described before results were hashed.
    let older = described.lines().filter(|line| !line.contains("result_sha256")).collect::<Vec<_>>().join("\n");
    assert!(described.contains("result_sha256"), "{described}");
    // At the last two of these places, in the footer, Arrow's reader panics, and at some between.
    for place in (0..whole.len()).step_by(whole.len() / 97).chain([whole.len() - 31, whole.len() - 19]) {
        let mut damaged = whole.clone();
        damaged[place] ^= 0x80;
        fs::write(&result, &damaged).unwrap();
        let refused = host_sim(&directory, &["merge", "out", "--out", "merged"]);
        let message = stderr(&refused);
        assert_eq!((status(&refused), message.lines().count()), (2, 1), "byte {place}: {message}");
        assert!(message.contains("campaign.arrow is missing or damaged"), "byte {place}: {message}");

        // Without a hash not every damage shows; none of it ends the program.
        fs::write(&manifest, &older).unwrap();
        let read = host_sim(&directory, &["merge", "out", "--out", "merged"]);
        let message = stderr(&read);
        assert!((0..=2).contains(&status(&read)) && message.lines().count() <= 1, "byte {place}: {message}");
        fs::write(&manifest, &described).unwrap();
        let _ = fs::remove_dir_all(directory.join("merged"));
    }
    let again = host_sim(&directory, &campaign);
    assert_eq!((status(&again), stderr(&again)), (1, String::new()));
    assert_eq!(fs::read(&result).unwrap(), whole);
    assert_eq!(fs::read_to_string(&manifest).unwrap(), described);
    // And one without a hash is taken as it is.
    fs::write(&manifest, &older).unwrap();
    assert_eq!(status(&host_sim(&directory, &["merge", "out", "--out", "merged"])), 1);
}

#[test]
fn two_runs_at_a_time_do_not_share_a_directory() {
    let directory = directory("shared");
    let campaign = ["campaign", "h.toml", "--flights", "20", "--out", "out"];
    let flight = ["fly", "h.toml", "--out", "out"];
    fs::create_dir(directory.join("out")).unwrap();
    // As another run holds it, for as long as it lives.
    let other = fs::File::open(directory.join("out")).unwrap();
    other.try_lock().unwrap();
    for command in [&campaign[..], &flight] {
        let refused = host_sim(&directory, command);
        let message = stderr(&refused);
        assert_eq!((status(&refused), message.lines().count()), (2, 1), "{message}");
        assert!(message.contains("out: cannot be written: another run writes into it; wait for its end"), "{message}");
        assert_eq!(files(&directory.join("out")), [""; 0]);
    }
    drop(other);
    assert_eq!(status(&host_sim(&directory, &campaign)), 1);
}
